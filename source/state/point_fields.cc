#include "point_fields.h"

#include "core/pages_of_zeros.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <type_traits>

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

  void release_zeros(State &state)
  {
    release_pages_of_zeros(state.displacement);
    release_pages_of_zeros(state.velocity);
    for_point_fields(
        [&](const PointField &, const auto member, const auto &...) {
          using List = std::decay_t<decltype(state.*member)>;
          if constexpr (!std::is_same_v<List, std::vector<PointKind>>)
            release_pages_of_zeros(state.*member);
        });
  }
} // namespace nsfd
