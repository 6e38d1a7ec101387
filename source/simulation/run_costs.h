#pragma once

#include "model.h"

#include "core/cost.h"
#include "nsfd/core/message_counts.h"
#include "nsfd/records/cost_record.h"

#include <array>
#include <map>

namespace nsfd
{
  /** Iterations of the accepted steps, and at the end the costs of a run. */
  template <int dim>
  class RunCosts
  {
  public:
    /** @p applications of W since the run began. */
    void record(const SolverReport &report, unsigned long long applications);

    /** Measures the machine if the run took more than a second. Collective. */
    CostRecord finish(const Communicator &communicator,
                      const DelassusOperator<dim> *delassus) const;

    void serialize(Archive &archive);

  private:
    /// in how many steps a number of iterations was needed
    std::array<std::map<unsigned int, unsigned long long>, 4> counts_;
    unsigned long long applications_ = 0;
    std::vector<CostLine> before_; ///< of the run up to its checkpoint
    std::vector<CostLine> lines() const;
    MessageCounts sent_before_; ///< on the first rank
    MessageCounts sent() const;
    void measure(const DelassusOperator<dim> &delassus, CostRecord &cost) const;
  };

  /** Seconds of CPU by stage of the step, in the order to print. */
  template <int dim>
  std::vector<std::pair<std::string, double>>
  stage_timings(const Model<dim> &model, double setup, double output);
} // namespace nsfd
