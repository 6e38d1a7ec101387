#include "held_rows.h"

#include "driven_motion.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    bool is_joint(const PointOrigin &origin, const PointKind kind)
    {
      return origin.kind == PointOrigin::Kind::interface && is_joined(kind);
    }
  } // namespace

  template <int dim>
  void HeldRows<dim>::start(const State &old)
  {
    start_ = old.time;
    clock_ = old.clock;
    const Communicator &all = parts_.delassus.communicator();
    is_mean_ = !parts_.input.pins.empty() || all.any(has_turning_arms(old));
    is_impact_ = old.last_step == 0. && begins_otherwise(old);
  }

  /** A joint, on this rank, has a rigid body on one of its sides. */
  template <int dim>
  bool HeldRows<dim>::has_turning_arms(const State &old) const
  {
    const auto &table = parts_.discretization.body_table();
    const auto &points = parts_.discretization.points();
    if (table.n_rigid == 0)
      return false;
    for (std::size_t i = 0; i < points.n_points; ++i) {
      if (!is_joint(parts_.discretization.origins()[i], old.kind[i]))
        continue;
      for (const auto cell : points.faces[points.face_of[i]].cells)
        if (table.is_rigid(table.body_of_global(cell)))
          return true;
    }
    return false;
  }

  /** Not with the velocities that joints, pins and supports ask for. */
  template <int dim>
  bool HeldRows<dim>::begins_otherwise(const State &old) const
  {
    const auto &origins = parts_.discretization.origins();
    const DrivenMotion<dim> &motion = parts_.step_problem.motion();
    double off = 0., size = 0.;
    for (std::size_t i = 0; i < old.kind.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c) {
        const double U = old.relative_velocity[i * dim + c];
        if (is_joint(origins[i], old.kind[i]))
          off = std::max(off, std::abs(U));
        else if (origins[i].kind == PointOrigin::Kind::motion &&
                 motion.drives(i, c))
          if (const Expression *velocity = motion.velocity(i, c)) {
            const double given = motion.at(*velocity, i, old.time);
            off = std::max(off, std::abs(U - given));
            size = std::max(size, std::abs(given));
          }
      }
    const auto &rigid = bodies_.rigid_motions();
    for (unsigned int k = 0; k < parts_.input.pins.size(); ++k)
      if (bodies_.layout().is_own(rigid.body_of_pin(k)))
        for (const double v : rigid.pin_velocity(k, old))
          off = std::max(off, std::abs(v));
    constexpr double round_off = 1e-12;
    const Communicator &all = parts_.delassus.communicator();
    return all.max(off) >
           round_off * (all.max(size) + bodies_.largest_speed(old));
  }

  template <int dim>
  void HeldRows<dim>::set(const std::vector<PointOrigin> &origins,
                          const State &old, OneStepProblem<dim> &problem) const
  {
    const double share = (1. - problem.theta) / problem.theta;
    for (std::size_t i = 0; i < problem.n_points; ++i)
      if (problem.kind[i] == PointKind::prescribed &&
          origins[i].kind != PointOrigin::Kind::motion)
        for (std::size_t k = i * dim; k < (i + 1) * dim; ++k) {
          problem.given_velocity[k] =
              is_mean_ && !is_impact_ ? -share * old.relative_velocity[k] : 0.;
          // of arms that turn this is no remainder: the joint makes it good
          if (is_mean_ && old.kind[i] == PointKind::rigid)
            problem.jump_free[k] = problem.time_step * (1. - problem.theta) *
                                   old.relative_velocity[k];
        }
    if (!is_impact_)
      set_supports(old, problem);
    bodies_.rigid_motions().supports().project(
        [&](const std::size_t point, const unsigned int c) -> double & {
          return problem
              .given_velocity[bodies_.contacts().mesh_point(point) * dim + c];
        });
  }

  /**
   * What was given at the start of the step. Where that jumps there, the last
   * step, whose end is known to round-off, had one side of it: that one which
   * @p U is near to.
   */
  template <int dim>
  double HeldRows<dim>::given_before(const Expression &velocity,
                                     const std::size_t point, const double U,
                                     const double time_step) const
  {
    constexpr double aside = 1e-6, much = 0.1, jump = 1e-3;
    const DrivenMotion<dim> &motion = parts_.step_problem.motion();
    const auto at = [&](const double steps) {
      return motion.velocity_at(velocity, point, start_ + steps * time_step,
                                clock_);
    };
    const double now = at(0.);
    double given = now;
    for (const double side : {-1., 1.}) {
      const double other = at(aside * side);
      // what varies smoothly hardly changes so near
      if (std::abs(U - other) < much * std::abs(U - given) &&
          std::abs(other - now) > jump * std::abs(at(side) - now))
        given = other;
    }
    return given;
  }

  /** Those of rigid bodies, and all where joints ask for the mean velocity. */
  template <int dim>
  void HeldRows<dim>::set_supports(const State &old,
                                   OneStepProblem<dim> &problem) const
  {
    const auto &origins = parts_.discretization.origins();
    const auto &points = bodies_.points();
    const DrivenMotion<dim> &motion = parts_.step_problem.motion();
    const double share = (1. - problem.theta) / problem.theta;
    for (std::size_t j = 0; j < origins.size(); ++j) {
      if (origins[j].kind != PointOrigin::Kind::motion)
        continue;
      const std::size_t i = bodies_.contacts().mesh_point(j);
      const int body = points.faces[points.face_of[i]].bodies[0];
      if (!is_mean_ &&
          (body < 0 || !bodies_.layout()[std::size_t(body)].is_rigid()))
        continue;
      for (unsigned int c = 0; c < dim; ++c)
        if (motion.drives(j, c))
          if (const Expression *velocity = motion.velocity(j, c)) {
            const double U = old.relative_velocity[i * dim + c];
            problem.given_velocity[i * dim + c] -=
                share * (U - given_before(*velocity, j, U, problem.time_step));
          }
    }
  }

  template class HeldRows<2>;
  template class HeldRows<3>;
} // namespace nsfd
