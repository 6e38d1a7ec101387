#pragma once

#include "nonsmooth/frictional_contact/contact_problem.h"
#include "nonsmooth/solver.h"

namespace nsfd
{
  /**
   * The contacts of a one-step problem alone: every point that may touch in
   * this step, with all other rows eliminated. Joints and given motions keep
   * their velocities; springs and cohesion are affine in U with the secant,
   * damage and kappa(beta) of @p evaluation, next to the contact impulse where
   * a point has both. With P_s = -(a + D U) in these rows,
   *
   *     (W_ss + D^-1) P_s = -(U_free,s + D^-1 a) - W_sc P_c,
   *
   * D^-1 = 0 and a / D = -U_given for a given velocity. Targets (restitution,
   * gaps) and sliding offsets are in q, so that u_N >= 0 is the contact.
   *
   * Dense, on one rank; no contacts if there are none, or if more than
   * @p largest rows take part. If the step is solved, `solution` holds its
   * contact impulses.
   */
  template <int dim>
  ContactProblem condense_contacts(const OneStepProblem<dim> &problem,
                                   const DelassusOperator<dim> &delassus,
                                   const LawEvaluation<dim> &evaluation,
                                   std::size_t largest = 3000);
} // namespace nsfd
