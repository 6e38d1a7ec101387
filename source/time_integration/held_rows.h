#pragma once

#include "step_parts.h"

#include "bodies/moving_bodies.h"
#include "nonsmooth/one_step_problem.h"

#include <vector>

namespace nsfd
{
  class Expression;
  struct State;

  /**
   * What joints, pins and supports of large motions ask for.
   *
   * Between deformable cells the rows of a joint are the same in every step, up
   * to a rotation of all of its components, and so are those of a support. They
   * ask for the velocity at the end: rows that depend on each other stay
   * consistent, and what a solver leaves has no part in later steps. The arms
   * of rigid bodies turn: there all rows of a scene ask for the mean velocity.
   * Points then move as they are asked to, rows of one step are consistent
   * whatever the velocities at its start are, and joints do no work.
   *
   * A mean velocity would turn round for ever what is wrong at the start.
   * Therefore the first step asks for the velocity at the end if the scene
   * begins with another one: an impact.
   */
  template <int dim>
  class HeldRows
  {
  public:
    HeldRows(const StepParts<dim> &parts, const MovingBodies<dim> &bodies)
        : parts_(parts), bodies_(bodies)
    {
    }

    /** A step from @p old. Collective. */
    void start(const State &old);

    /** @p problem, whose supports ask for velocities at the end, and @p old
        have the points of the step. */
    void set(const std::vector<PointOrigin> &origins, const State &old,
             OneStepProblem<dim> &problem) const;

  private:
    bool has_turning_arms(const State &old) const;
    bool begins_otherwise(const State &old) const;
    double given_before(const Expression &velocity, std::size_t point, double U,
                        double time_step) const;
    void set_supports(const State &old, OneStepProblem<dim> &problem) const;

    const StepParts<dim> parts_;
    const MovingBodies<dim> &bodies_;
    // of the step
    double start_ = 0.;
    LoadClock clock_;
    bool is_mean_ = false;   ///< what joints, and supports of their bodies, ask
    bool is_impact_ = false; ///< nothing asks for a mean velocity
  };
} // namespace nsfd
