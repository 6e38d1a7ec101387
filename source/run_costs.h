#pragma once

#include "nsfd/nonsmooth/one_step_problem.h"
#include "nsfd/output/cost_record.h"

#include <array>

namespace nsfd
{
  template <int dim>
  class Dynamics;

  /** Iterations of the accepted steps, and at the end the costs of a run. */
  template <int dim>
  class RunCosts
  {
  public:
    /** @p applications of W since the run began. */
    void record(const SolverReport &report, unsigned long long applications);

    /** Measures the machine if the run took more than a second. */
    CostRecord finish(const Dynamics<dim> &dynamics) const;

  private:
    std::array<std::vector<unsigned int>, 4> counts_;
    unsigned long long applications_ = 0;
  };
} // namespace nsfd
