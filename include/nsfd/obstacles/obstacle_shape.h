#pragma once

#include "nsfd/core/registry.h"
#include "nsfd/scene/scene_input.h"

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class SectionReader;

  /** What the entries of an obstacle depend on besides its own block. */
  struct ObstacleSetting {
    unsigned int dimension = 2;
    bool large_motion = false;
  };

  /**
   * A surface that does not deform: what `shape` of an Obstacle block names. A
   * class in one file that registers itself; an instance belongs to one block
   * and may keep numbers of its own. Places are relative to `point` of the
   * obstacle, in m; in the plane the third component is 0.
   */
  class ObstacleShape
  {
  public:
    using Vector = std::array<double, 3>;

    virtual ~ObstacleShape() = default;

    /** Lists name shapes in this order, those of equal place by their names. */
    virtual unsigned int place() const { return 100; }

    /** Report at the entry `shape` where the shape cannot be in the scene. */
    virtual void demand(SectionReader &reader,
                        const ObstacleSetting &setting) const = 0;

    /** What `point` is, for the manual: "m, its centre". */
    virtual std::string point_text() const = 0;

    /** Read all that stands in the block of this shape alone. */
    virtual void read(SectionReader &reader, const ObstacleSetting &setting,
                      ObstacleInput &obstacle) = 0;

    /** Distance from the surface, negative inside the obstacle. */
    virtual double gap(const ObstacleInput &obstacle,
                       const Vector &x) const = 0;

    /**
     * Normal there, out of the obstacle, of unit length; zero where one
     * direction is as good as another, as at a centre.
     */
    virtual Vector normal(const ObstacleInput &obstacle,
                          const Vector &x) const = 0;

    /** A body that moves farther in a step may fly through; in m. */
    virtual double thickness(const ObstacleInput &) const
    {
      return std::numeric_limits<double>::infinity();
    }

    /** "plane", "disc": what reports call it. */
    virtual std::string text(unsigned int dimension) const = 0;
  };

  using ObstacleShapeRegistry = Registry<ObstacleShape>;

  /** The names of all shapes, in the order of lists. */
  std::vector<std::string> obstacle_shape_names();

  /** A vector of length one; reported where it has no direction. */
  std::array<double, 3> read_direction(SectionReader &reader,
                                       const std::string &name,
                                       unsigned int dim,
                                       const std::string &text);

  /** Report a shape that needs motion = large in a scene of small motions. */
  void demand_large_motion(SectionReader &reader,
                           const ObstacleSetting &setting,
                           const std::string &shape);
} // namespace nsfd
