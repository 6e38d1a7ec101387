#include "round.h"

#include "nsfd/parameters/section_reader.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    double length_of(const ObstacleShape::Vector &r)
    {
      return std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    }
  } // namespace

  double RoundObstacle::gap(const ObstacleInput &obstacle,
                            const Vector &x) const
  {
    const double distance = length_of(radial(obstacle, x)) - obstacle.radius;
    return obstacle.hollow ? -distance : distance;
  }

  ObstacleShape::Vector RoundObstacle::normal(const ObstacleInput &obstacle,
                                              const Vector &x) const
  {
    Vector r = radial(obstacle, x);
    const double length = length_of(r);
    if (length == 0.)
      return {};
    const double factor = (obstacle.hollow ? -1. : 1.) / length;
    for (double &component : r)
      component *= factor;
    return r;
  }

  double RoundObstacle::thickness(const ObstacleInput &obstacle) const
  {
    return obstacle.hollow ? ObstacleShape::thickness(obstacle)
                           : 2. * obstacle.radius;
  }

  void RoundObstacle::read_radius(SectionReader &reader,
                                  ObstacleInput &obstacle)
  {
    reader.refuse({"normal"}, "only a plane has one");
    obstacle.radius =
        reader.number("radius", "", units::length, Range::positive(), "m");
    obstacle.hollow = reader.boolean(
        "hollow", false, "true: bodies are inside, as in a drum or a pipe");
  }
} // namespace nsfd
