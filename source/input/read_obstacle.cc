#include "read_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    struct KnownShape {
      ObstacleShape shape;
      const char *name, *place; ///< what `point` is
    };

    const KnownShape known_shapes[] = {
        {ObstacleShape::plane, "plane", "m, on its surface"},
        {ObstacleShape::sphere, "sphere", "m, its centre"},
        {ObstacleShape::cylinder, "cylinder", "m, on its axis"},
    };

    /** Null, and reported, if what the other entries mean is unknown. */
    const KnownShape *read_shape(SectionReader &reader, const SceneInput &scene)
    {
      const unsigned int n_before = reader.errors().n_errors();
      const std::string name = reader.choice(
          "shape", "plane", {"plane", "sphere", "cylinder"},
          scene.dimension == 2
              ? "plane, or sphere: a disc; spheres need motion = large"
              : "plane, sphere or cylinder (without ends); spheres and "
                "cylinders need motion = large");
      if (name == "cylinder" && scene.dimension == 2)
        reader.error("shape", "shape = cylinder needs dimension = 3, not 2",
                     "write sphere, which is a disc in the plane");
      else if (name != "plane" && !scene.large_motion)
        reader.error("shape",
                     fmt::format("shape = {} needs motion = large: bodies of "
                                 "motion = small touch planes",
                                 name),
                     "write at the top: set motion = large");
      if (reader.errors().n_errors() > n_before) {
        reader.accept_everything();
        return nullptr;
      }
      return std::find_if(
          std::begin(known_shapes), std::end(known_shapes),
          [&](const KnownShape &known) { return known.name == name; });
    }

    /** Of length one. */
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

    void read_shape_entries(SectionReader &reader, const unsigned int dim,
                            ObstacleInput &obstacle)
    {
      const bool is_plane = obstacle.shape == ObstacleShape::plane;
      if (is_plane) {
        obstacle.normal = read_direction(reader, "normal", dim,
                                         "out of the obstacle, of any length");
        reader.refuse({"radius", "axis", "hollow"}, "the obstacle is a plane");
        return;
      }
      if (obstacle.shape == ObstacleShape::cylinder)
        obstacle.normal = read_direction(reader, "axis", dim, "of any length");
      else
        reader.refuse({"axis"}, "the obstacle is a sphere");
      reader.refuse({"normal"}, "only a plane has one");
      obstacle.radius =
          reader.number("radius", "", units::length, Range::positive(), "m");
      obstacle.hollow = reader.boolean(
          "hollow", false, "true: bodies are inside, as in a drum or a pipe");
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
      const KnownShape *const known = read_shape(reader, scene);
      if (!known)
        return obstacle;
      obstacle.shape = known->shape;
      const std::vector<double> point =
          reader.numbers("point", "", units::length, Range::any(),
                         scene.dimension, known->place);
      std::copy(point.begin(), point.end(), obstacle.point.begin());
      read_shape_entries(reader, scene.dimension, obstacle);
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
