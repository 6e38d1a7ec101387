#include "round.h"

#include "nsfd/parameters/section_reader.h"

namespace nsfd
{
  /** A cylinder without ends, in space only. */
  class Cylinder final : public RoundObstacle
  {
  public:
    unsigned int place() const override { return 2; }
    void demand(SectionReader &reader,
                const ObstacleSetting &setting) const override
    {
      if (setting.dimension == 2)
        reader.error("shape", "shape = cylinder needs dimension = 3, not 2",
                     "write sphere, which is a disc in the plane");
      else
        demand_large_motion(reader, setting, "cylinder");
    }
    std::string point_text() const override { return "m, on its axis"; }

    void read(SectionReader &reader, const ObstacleSetting &setting,
              ObstacleInput &obstacle) override
    {
      obstacle.normal =
          read_direction(reader, "axis", setting.dimension, "of any length");
      read_radius(reader, obstacle);
    }
    std::string text(unsigned int) const override { return "cylinder"; }

  private:
    Vector radial(const ObstacleInput &obstacle, const Vector &x) const override
    {
      const Vector &a = obstacle.normal;
      const double along = x[0] * a[0] + x[1] * a[1] + x[2] * a[2];
      return {{x[0] - along * a[0], x[1] - along * a[1], x[2] - along * a[2]}};
    }
  };

  NSFD_REGISTER(ObstacleShapeRegistry, Cylinder, "cylinder",
                "a rod or a pipe without ends, in space; motion = large",
                "axis = 1, 2, -1; radius = 2 m",
                "axis = 0, 0, 3; radius = 2 m; hollow = true");
} // namespace nsfd
