#pragma once

#include "state.h"

namespace nsfd
{
  struct SceneInput;

  /** One vector of State over the points. */
  struct PointField {
    enum class Shape {
      scalar,
      vector ///< dim values per point, in its frame
    };
    enum class Life {
      step,   ///< every step sets it anew
      memory, ///< every step sets it anew, from what it was; new meshes take it
      history ///< stays as it is until a step changes it; new meshes take it
    };
    enum class Use {
      always,
      mixed_laws,     ///< of two damage scalars
      sliding_lift,   ///< dilatancy or wear
      crack_pressure, ///< on broken points
      others ///< bonds, equilibria: what sets it knows whether it is there
    };

    const char *name; ///< in checkpoints
    Shape shape;
    Life life;
    Use use;

    unsigned int width(const unsigned int dimension) const
    {
      return shape == Shape::vector ? dimension : 1;
    }
  };

  /** The scene has what the field is for. */
  bool has_field(const SceneInput &input, const PointField &field);

  /**
   * What is joined has no jump, no impulse and no history: most lists of the
   * points are zeros, and need no memory where faces stay as they are.
   */
  void release_zeros(State &state);

  /**
   * Call @p visit(PointField, member of State, born, added) for every field, in
   * the order of checkpoints: @p born is the value of a point of the mesh at
   * t = 0, @p added that of a contact of one step. A further field is a member
   * of State and a line here.
   */
  template <typename Visit>
  void for_point_fields(Visit &&visit)
  {
    constexpr auto scalar = PointField::Shape::scalar,
                   vector = PointField::Shape::vector;
    constexpr auto step = PointField::Life::step,
                   memory = PointField::Life::memory,
                   history = PointField::Life::history;
    using Use = PointField::Use;
    const auto field = [&](const char *name, const PointField::Shape shape,
                           const PointField::Life life, const Use use,
                           auto State::*const member, const auto born,
                           const auto added) {
      visit(PointField{name, shape, life, use}, member, born, added);
    };
    // clang-format off
    field("jump",              vector, step,    Use::always, &State::jump, 0., 0.);
    field("relative_velocity", vector, step,    Use::always, &State::relative_velocity, 0., 0.);
    field("impulse",           vector, step,    Use::always, &State::impulse, 0., 0.);
    field("beta",              scalar, history, Use::always, &State::beta, 1., 0.);
    field("opening_max",       scalar, history, Use::always, &State::opening_max, 0., 0.);
    field("slip_max",          scalar, history, Use::mixed_laws, &State::slip_max, 0., 0.);
    field("slip",              scalar, history, Use::always, &State::slip, 0., 0.);
    field("dilated",           scalar, memory,  Use::sliding_lift, &State::dilated, 0., 0.);
    field("worn",              scalar, memory,  Use::sliding_lift, &State::worn, 0., 0.);
    field("dilation_speed",    scalar, memory,  Use::sliding_lift, &State::dilation_speed, 0., 0.);
    field("wear_speed",        scalar, memory,  Use::sliding_lift, &State::wear_speed, 0., 0.);
    field("released_overlap",  scalar, history, Use::always, &State::released_overlap, 0., 0.);
    field("approach",          scalar, history, Use::always, &State::approach, 0., 0.);
    field("kind",              scalar, history, Use::always, &State::kind, PointKind::prescribed, PointKind::free);
    field("two_sided",         scalar, history, Use::always, &State::two_sided, 0, 0);
    field("contact",           scalar, memory,  Use::always, &State::contact, 0, 0);
    field("bond_traction",     vector, step,    Use::others, &State::bond_traction, 0., 0.);
    field("pressure",          scalar, memory,  Use::crack_pressure, &State::pressure, 0., 0.);
    field("point_force",       vector, step,    Use::others, &State::point_force, 0., 0.);
    // clang-format on
  }

  /** What bodies and points are at a time, against each other. */
  inline void swap_motion(State &one, State &other)
  {
    one.displacement.swap(other.displacement);
    one.velocity.swap(other.velocity);
    for_point_fields(
        [&](const PointField &, const auto member, const auto &...) {
          (one.*member).swap(other.*member);
        });
  }
} // namespace nsfd
