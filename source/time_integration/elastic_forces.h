#pragma once

#include "delassus/delassus_operator.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  /**
   * K q and K v at both ends of explicit steps, which act with
   * K (q_k + h v_k / 2). The energy that they keep is
   * v.(M - h_0^2 K / 4) v / 2 + q.K q / 2, h_0 the kept step of the bodies, and
   * what asks for its parts after a step asks for the forces of the next one.
   */
  template <int dim>
  class ElasticForces
  {
  public:
    explicit ElasticForces(const DelassusOperator<dim> &delassus);

    /** Of the state that a step of length @p h starts from; other bonds than in
        the last step are other forces. Collective. */
    void start(const State &old, double h, bool bonds_changed);
    /** Of the state that it leads to. Collective. */
    void finish(const State &next);

    /** K (q_k + h v_k / 2). */
    const std::vector<double> &in_step() const { return in_step_; }
    const std::vector<double> &at_end() const { return end_.of_displacement; }

    /** h_0^2 v.K v / 8 at the end of the last step, @p state. Collective. */
    double kinetic_share(const State &state) const;
    /** What the present step takes from the energy that is kept because the
        one before kept that of another h_0, as the first one and one on
        another mesh: (h_0^2 - h_0,k^2) v_k.K v_k / 8, J. */
    double share_of_step() const { return share_of_step_; }

  private:
    struct Known {
      std::vector<double> of_displacement, of_velocity; ///< N, by unknown
      bool known = false;
      unsigned int step = 0;
      double time = 0.;
    };
    void evaluate(const State &state, Known &result) const;
    double product(const std::vector<double> &velocity,
                   const Known &forces) const;

    const DelassusOperator<dim> &delassus_;
    Known start_, end_;
    std::vector<double> in_step_;
    double share_of_step_ = 0.;
  };
} // namespace nsfd
