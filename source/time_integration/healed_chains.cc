#include "healed_chains.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  HealedChains<dim>::HealedChains(const LeapfrogChains<dim> &chains,
                                  const unsigned int a,
                                  const PointEnergies<dim> &energies)
      : a_(a)
  {
    const OneStepProblem<dim> &p = chains.problem;
    if (!chains.closed[a])
      return;
    const double h = p.time_step * p.theta;
    std::array<double, dim> now{}, before{}; // pressed: no opening now
    before[0] = std::max(0., p.jump_free[a * dim]);
    for (unsigned int c = 1; c < dim; ++c) {
      before[c] = p.jump_free[a * dim + c];
      now[c] = before[c] + h * chains.velocity[a * dim + c];
    }
    const double pressure =
        chains.solution[a].contact_impulse / (p.weight[a] * p.time_step);
    of_step_ =
        healing_of<dim>(p, a, std::min(chains.beta[a], energies.beta),
                        energies.history.opening, now.data(), pressure, h);
    if (!of_step_.heals)
      return;
    of_other_ =
        healing_of<dim>(p, a, chains.other.beta[a], chains.other.opening_max[a],
                        before.data(), pressure, h);
    if (!of_other_.heals) {
      of_other_.opening_max = chains.other.opening_max[a];
      of_other_.beta = chains.other.beta[a];
    }
    auto left = before;
    for (unsigned int c = 1; c < dim; ++c) {
      shift_[c] = (1. - of_step_.slip_share) * now[c];
      left[c] -= shift_[c];
    }
    const double change =
        stored_by_law<dim>(p, a, chains.other.beta[a],
                           chains.other.opening_max[a], before.data()) -
        stored_by_law<dim>(p, a, of_other_.beta, of_other_.opening_max,
                           left.data());
    dissipated_ = of_step_.dissipated + change;
    // what slides fast has no place where new bonds hold
    heals_ = dissipated_ >= 0. && is_within<dim>(p, a, of_other_, left.data());
  }

  template <int dim>
  void HealedChains<dim>::keep(LeapfrogChains<dim> &chains) const
  {
    OneStepProblem<dim> &p = chains.problem;
    p.kind[a_] = PointKind::cohesive;
    p.opening_max[a_] = of_step_.opening_max;
    chains.beta[a_] = of_step_.beta;
    if (of_other_.beta > 0.)
      chains.other.kind[a_] = PointKind::cohesive;
    chains.other.opening_max[a_] = of_other_.opening_max;
    chains.other.beta[a_] = of_other_.beta;
    for (unsigned int c = 1; c < dim; ++c) {
      p.jump_old[a_ * dim + c] -= shift_[c];
      p.jump_free[a_ * dim + c] -= shift_[c];
    }
  }

  template class HealedChains<2>;
  template class HealedChains<3>;
} // namespace nsfd
