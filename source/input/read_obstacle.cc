#include "read_sections.h"

#include "nsfd/obstacles/obstacle_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace nsfd
{
  namespace
  {
    /** Null, and reported, if what the other entries mean is unknown. */
    std::unique_ptr<ObstacleShape> read_shape(SectionReader &reader,
                                              const ObstacleSetting &setting,
                                              ObstacleInput &obstacle)
    {
      const unsigned int n_before = reader.errors().n_errors();
      obstacle.shape_name = reader.choice(
          "shape", "plane", obstacle_shape_names(),
          setting.dimension == 2
              ? "plane, or sphere: a disc; spheres need motion = large"
              : "plane, sphere or cylinder (without ends); spheres and "
                "cylinders need motion = large");
      auto shape =
          ObstacleShapeRegistry::instance().create(obstacle.shape_name);
      shape->demand(reader, setting);
      if (reader.errors().n_errors() == n_before)
        return shape;
      reader.accept_everything();
      return nullptr;
    }

    void read_motion(SectionReader &reader, const SceneInput &scene,
                     ObstacleInput &obstacle)
    {
      if (!scene.large_motion)
        return reader.refuse({"velocity x", "velocity y", "velocity z"},
                             "obstacles move only in scenes with motion = "
                             "large");
      for (unsigned int c = 0; c < scene.dimension; ++c) {
        const std::string name = component_name("velocity", c);
        auto &velocity = obstacle.velocity[c];
        velocity = read_optional_expression(reader, name, units::velocity,
                                            "m/s, of t");
        if (velocity && velocity->depends_on_position())
          reader.error(name,
                       fmt::format("{} = {} depends on the place, but an "
                                   "obstacle moves as a whole",
                                   name, velocity->text()),
                       "write an expression of t");
      }
      refuse_third_component(reader, {"velocity"}, scene);
    }

    ObstacleInput read_obstacle(SectionReader &reader, const SceneInput &scene)
    {
      ObstacleInput obstacle;
      obstacle.name = reader.block_name();
      obstacle.where = read_where(
          reader, "all", WhereUse::boundary_faces, scene,
          "boundary faces that may touch it: all, a side, a group or "
          "an expression");
      const ObstacleSetting setting{scene.dimension, scene.large_motion};
      const std::shared_ptr<ObstacleShape> shape =
          read_shape(reader, setting, obstacle);
      if (!shape)
        return obstacle;
      obstacle.shape = shape;
      const std::vector<double> point =
          reader.numbers("point", "", units::length, Range::any(),
                         scene.dimension, shape->point_text());
      std::copy(point.begin(), point.end(), obstacle.point.begin());
      shape->read(reader, setting, obstacle);
      read_motion(reader, scene, obstacle);
      obstacle.friction = read_friction(reader);
      obstacle.restitution =
          reader.number("restitution", "0", units::none, Range::closed(0., 1.),
                        "of Newton's impact law");
      obstacle.sliding = read_sliding(reader, obstacle.friction);
      return obstacle;
    }
  } // namespace

  void read_obstacles(ParameterFile &file, InputErrors &errors,
                      SceneInput &scene)
  {
    for (ParameterSection *block : file.open_blocks("Obstacle")) {
      SectionReader reader(*block, errors);
      scene.obstacles.push_back(read_obstacle(reader, scene));
    }
  }
} // namespace nsfd
