#include "point_name.h"

#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    std::string name_of_block(const SceneInput &input,
                              const PointOrigin &origin)
    {
      switch (origin.kind) {
      case PointOrigin::Kind::interface:
        return input.interfaces[origin.block].section();
      case PointOrigin::Kind::motion:
        return "Boundary: " + input.boundaries[origin.block].name;
      case PointOrigin::Kind::obstacle:
        return "Obstacle: " + input.obstacles[origin.block].name;
      case PointOrigin::Kind::surface:
        return "Contact: " + input.contacts[origin.block].name;
      case PointOrigin::Kind::pin:
        return "Pin: " + input.pins[origin.block].name;
      }
      return "";
    }
  } // namespace

  template <int dim>
  std::string name_of_point(const SceneInput &input,
                            const std::vector<PointOrigin> &origins,
                            const std::vector<double> &positions,
                            const std::size_t i)
  {
    if (i >= origins.size())
      return "unknown";
    std::string place;
    for (unsigned int c = 0; c < dim; ++c)
      place += fmt::format("{}{:.6g}", c ? ", " : "", positions[i * dim + c]);
    return fmt::format("at ({}) of `{}`", place,
                       name_of_block(input, origins[i]));
  }

#define INSTANTIATE(dim)                                                       \
  template std::string name_of_point<dim>(                                     \
      const SceneInput &, const std::vector<PointOrigin> &,                    \
      const std::vector<double> &, std::size_t)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
