#include "round.h"

#include "nsfd/parameters/section_reader.h"

namespace nsfd
{
  /** A ball, a disc in the plane. */
  class Sphere final : public RoundObstacle
  {
  public:
    unsigned int place() const override { return 1; }
    void demand(SectionReader &reader,
                const ObstacleSetting &setting) const override
    {
      demand_large_motion(reader, setting, "sphere");
    }
    std::string point_text() const override { return "m, its centre"; }

    void read(SectionReader &reader, const ObstacleSetting &,
              ObstacleInput &obstacle) override
    {
      reader.refuse({"axis"}, "the obstacle is a sphere");
      read_radius(reader, obstacle);
    }
    std::string text(const unsigned int dimension) const override
    {
      return dimension == 2 ? "disc" : "sphere";
    }

  private:
    Vector radial(const ObstacleInput &, const Vector &x) const override
    {
      return x;
    }
  };

  NSFD_REGISTER(ObstacleShapeRegistry, Sphere, "sphere",
                "a ball or a shell, a disc in the plane; motion = large",
                "radius = 2 m", "radius = 2 m; hollow = true");
} // namespace nsfd
