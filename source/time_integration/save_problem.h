#pragma once

#include "nonsmooth/solver.h"

namespace nsfd
{
  struct SceneInput;

  /**
   * `save problems`: the contacts of a step as OUTPUT/problems/step_NNNN.hdf5,
   * all of them or those of steps that were rejected or needed a hand-over.
   * A step that is tried again gets step_NNNN_2, ...
   */
  template <int dim>
  void save_problem(const SceneInput &input, const OneStepProblem<dim> &problem,
                    const DelassusOperator<dim> &delassus,
                    const LawEvaluation<dim> &evaluation,
                    const SolverReport &report, unsigned int step, double time);
} // namespace nsfd
