#include "nsfd/obstacles/obstacle_shape.h"

#include "nsfd/parameters/section_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nsfd
{
  std::vector<std::string> obstacle_shape_names()
  {
    const auto &registry = ObstacleShapeRegistry::instance();
    std::vector<std::pair<unsigned int, std::string>> shapes;
    for (const std::string &name : registry.names())
      shapes.emplace_back(registry.create(name)->place(), name);
    std::sort(shapes.begin(), shapes.end());
    std::vector<std::string> names;
    for (const auto &shape : shapes)
      names.push_back(shape.second);
    return names;
  }

  std::array<double, 3> read_direction(SectionReader &reader,
                                       const std::string &name,
                                       const unsigned int dim,
                                       const std::string &text)
  {
    const std::vector<double> given =
        reader.numbers(name, "", units::none, Range::any(), dim, text);
    // scaled first: squares of huge or tiny components stay finite
    double largest = 0., length = 0.;
    for (const double n : given)
      largest = std::max(largest, std::abs(n));
    std::array<double, 3> direction{};
    if (largest == 0.) {
      reader.error(name, name + " = 0 has no direction",
                   dim == 2 ? "write for example: 0, 1"
                            : "write for example: 0, 0, 1");
      return direction;
    }
    for (const double n : given)
      length += (n / largest) * (n / largest);
    for (unsigned int d = 0; d < dim; ++d)
      direction[d] = given[d] / largest / std::sqrt(length);
    return direction;
  }

  void demand_large_motion(SectionReader &reader,
                           const ObstacleSetting &setting,
                           const std::string &shape)
  {
    if (!setting.large_motion)
      reader.error("shape",
                   fmt::format("shape = {} needs motion = large: bodies of "
                               "motion = small touch planes",
                               shape),
                   "write at the top: set motion = large");
  }
} // namespace nsfd
