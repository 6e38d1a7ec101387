#include "nsfd/obstacles/obstacle_shape.h"
#include "nsfd/parameters/section_reader.h"

namespace nsfd
{
  /** A half space behind a plane; the only one that bodies of small motion may
   * touch. */
  class Plane final : public ObstacleShape
  {
  public:
    unsigned int place() const override { return 0; }
    void demand(SectionReader &, const ObstacleSetting &) const override {}
    std::string point_text() const override { return "m, on its surface"; }

    void read(SectionReader &reader, const ObstacleSetting &setting,
              ObstacleInput &obstacle) override
    {
      obstacle.normal = read_direction(reader, "normal", setting.dimension,
                                       "out of the obstacle, of any length");
      reader.refuse({"radius", "axis", "hollow"}, "the obstacle is a plane");
    }

    double gap(const ObstacleInput &obstacle, const Vector &x) const override
    {
      const Vector &n = obstacle.normal;
      return n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
    }
    Vector normal(const ObstacleInput &obstacle, const Vector &) const override
    {
      return obstacle.normal;
    }
    std::string text(unsigned int) const override { return "plane"; }
  };

  NSFD_REGISTER(ObstacleShapeRegistry, Plane, "plane",
                "a half space; small or large motion", "normal = 1, 2, -2");
} // namespace nsfd
