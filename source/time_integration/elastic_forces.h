#pragma once

#include "delassus/delassus_operator.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  /**
   * K q at both ends of explicit steps. The energy balance of a step ask for
   * the force that moves the next one, and of bonded bodies it is the most
   * expensive part of either.
   */
  template <int dim>
  class ElasticForces
  {
  public:
    explicit ElasticForces(const DelassusOperator<dim> &delassus);

    /** Of the state that a step starts from; other bonds than in the last step
        are other forces. Collective. */
    void start(const State &old, bool bonds_changed);
    /** Of the state that it leads to. Collective. */
    void finish(const State &next);

    const std::vector<double> &at_start() const { return start_.force; }
    const std::vector<double> &at_end() const { return end_.force; }

  private:
    struct Known {
      std::vector<double> force; ///< N, by unknown
      bool known = false;
      unsigned int step = 0;
      double time = 0.;
    };
    void evaluate(const State &state, Known &result) const;

    const DelassusOperator<dim> &delassus_;
    Known start_, end_;
  };
} // namespace nsfd
