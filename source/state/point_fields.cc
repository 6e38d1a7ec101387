#include "point_fields.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  bool has_field(const SceneInput &input, const PointField &field)
  {
    switch (field.use) {
    case PointField::Use::always:
      return true;
    case PointField::Use::mixed_laws:
      return std::any_of(input.interfaces.begin(), input.interfaces.end(),
                         [](const InterfaceInput &block) {
                           return block.law && block.law->mixed();
                         });
    case PointField::Use::sliding_lift:
      return has_sliding_lift(input);
    case PointField::Use::crack_pressure:
      return has_crack_pressure(input);
    default:
      return false;
    }
  }
} // namespace nsfd
