#pragma once

#include "core/communicator.h"
#include "one_step_problem.h"

#include <vector>

namespace nsfd
{
  /** What rows with a prescribed velocity do beyond it, over all ranks. */
  struct RowWork {
    double energy = 0.; ///< sum |P . (U - given)| over the points, J
    /// sum R P^2 over them, and over all points, J
    double impulses = 0., all_impulses = 0.;

    /**
     * Below this the energy is round-off of U = U_free + W P, in J: U is not
     * known better than to the last bits of the terms that it is the sum of,
     * |W P|_(1/R) <= |P|_R. Only a motion of nodes tells more, see NodeMotion.
     */
    double round_off(double energy_scale) const;
  };

  /** At velocities @p U of impulses @p P. Collective. */
  template <int dim>
  RowWork row_work(const OneStepProblem<dim> &problem,
                   const Communicator &communicator,
                   const std::vector<double> &U, const std::vector<double> &P);

  /** As RowWork::round_off(). */
  double round_off_of_rows(double impulses, double all_impulses,
                           double energy_scale);
} // namespace nsfd
