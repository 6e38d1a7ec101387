#include "interface_entries.h"
#include "read_sections.h"
#include "temperature_factors.h"

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

    constexpr const char *adhesion_text =
        "a cohesive law that holds what touches it at t = 0; default: none";

    /** A cohesive law that an obstacle may have; empty, and reported, if not.
     */
    std::string read_law_of_obstacle(SectionReader &reader)
    {
      const std::string name =
          collapse_blanks(reader.word("law", "", adhesion_text));
      const std::vector<std::string> known =
          CohesiveLawRegistry::instance().names();
      if (std::find(known.begin(), known.end(), name) == known.end())
        reader.error("law", fmt::format("law = {} is not a cohesive law", name),
                     advice_on_name(name, known,
                                    "`nsfd --list` prints all names; without "
                                    "`law` bodies touch the obstacle and do "
                                    "not stick to it"));
      else
        return name;
      reader.accept_everything();
      return "";
    }

    /** What holds while beta = 1. */
    IntactFaces read_intact_adhesion(SectionReader &reader,
                                     const InterfaceInput &input)
    {
      if (input.law && input.law->extrinsic()) {
        reader.refuse({"intact faces"},
                      fmt::format("the law {} is extrinsic: faces do not move "
                                  "until their strength is reached",
                                  input.law_name));
        return IntactFaces::rigid;
      }
      return reader.choice("intact faces", "spring", {"spring", "unilateral"},
                           "intrinsic laws, while beta = 1: spring or "
                           "unilateral") == "unilateral"
                 ? IntactFaces::unilateral
                 : IntactFaces::spring;
    }

    /** The law that holds bodies on it, if the block has one: a further block
       of SceneInput::interfaces. */
    void read_adhesion(SectionReader &reader, SceneInput &scene,
                       ObstacleInput &obstacle)
    {
      if (scene.large_motion)
        return reader.refuse({"law"}, "bodies stick to obstacles in small "
                                      "motions alone, where they touch them at "
                                      "the same places throughout");
      if (!reader.optional("law", adhesion_text)) {
        reader.refuse(cohesive_entries(), "the obstacle has no cohesive `law`");
        reader.refuse({"friction exponent", "broken", "intact faces"},
                      "the obstacle has no cohesive `law`");
        return;
      }
      InterfaceInput input;
      input.name = obstacle.name;
      input.where = obstacle.where;
      input.law_name = read_law_of_obstacle(reader);
      if (input.law_name.empty())
        return;
      input.obstacle = int(scene.obstacles.size());
      read_cohesive_block(reader, scene, input);
      input.friction = obstacle.friction;
      input.restitution = obstacle.restitution;
      input.sliding = obstacle.sliding;
      input.heat.friction = obstacle.friction_factor;
      check_lift(reader, input);
      read_damage_start(reader, input);
      input.intact = read_intact_adhesion(reader, input);
      obstacle.cohesion = int(scene.interfaces.size());
      scene.interfaces.push_back(std::move(input));
    }

    ObstacleInput read_obstacle(SectionReader &reader, SceneInput &scene)
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
      obstacle.friction_factor = read_friction_factor(
          reader, scene, obstacle.friction, obstacle.sliding);
      read_adhesion(reader, scene, obstacle);
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
