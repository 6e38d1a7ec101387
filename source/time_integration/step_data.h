#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"

namespace nsfd
{
  struct SceneInput;
  struct State;
  template <int dim>
  class DrivenMotion;

  /** C_N of a point before damage, in Pa/m. */
  template <int dim>
  double intact_stiffness(const OneStepProblem<dim> &problem,
                          std::size_t point);

  /** The part of the data that no step changes. */
  template <int dim>
  OneStepProblem<dim> constant_data(const SceneInput &input,
                                    const Discretization<dim> &discretization);

  /** Of it what points have by themselves; the other lists are empty. */
  template <int dim>
  OneStepProblem<dim>
  point_constants(const SceneInput &input,
                  const Discretization<dim> &discretization);

  /**
   * The data of the step from @p old over @p time_step, all but the free
   * velocity: kinds of points, forecast and targets of contact, prescribed
   * motion, majorants of the diagonal blocks of W. @p origins are those of the
   * points of @p problem.
   */
  template <int dim>
  void set_step(const SceneInput &input,
                const Discretization<dim> &discretization,
                const std::vector<PointOrigin> &origins,
                const DelassusOperator<dim> &delassus,
                const DrivenMotion<dim> &motion, const State &old,
                double time_step, OneStepProblem<dim> &problem);
} // namespace nsfd
