#pragma once

#include "free_motion.h"
#include "step_costs.h"
#include "step_problem.h"

namespace nsfd
{
  /** What MoreauJean has for a step, for the models of bodies. */
  template <int dim>
  struct StepParts {
    const SceneInput &input;
    const Discretization<dim> &discretization;
    DelassusOperator<dim> &delassus;
    OneStepProblem<dim> &problem; ///< of the points of the mesh
    FreeMotion<dim> &free_motion;
    const StepProblem<dim> &step_problem;
    StepTimings &timings;
  };
} // namespace nsfd
