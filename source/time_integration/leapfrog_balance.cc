#include "leapfrog_points.h"

#include "healed_chains.h"

#include <algorithm>
#include <cmath>

// What the points did in a step, and what they keep of it.

namespace nsfd
{
  namespace
  {
    enum Row {
      stored,
      impact,
      numerical,
      n_rows_of_springs,
      damage = n_rows_of_springs,
      friction,
      positive_friction,
      viscous,
      broken,
      n_rows
    };

    /// where the second chain of a point starts that the first one has opened,
    /// as a share of toughness over strength
    constexpr double share_at_start = 1e-9;

    /**
     * A softening point has one solution as long as h^2 w (1/m_1 + 1/m_2)
     * max|T'| < 2, against single groups.
     */
    template <int dim>
    bool is_beyond_unique(const OneStepProblem<dim> &p, const unsigned int a,
                          const PointEnergies<dim> &energies)
    {
      const auto &interaction = p.interactions[p.interaction[a]];
      if (!interaction.law ||
          !past_peak(*interaction.law, p.opening_factor[a], energies.history))
        return false;
      const double softening = p.strength_factor[a] * p.opening_factor[a] *
                               interaction.law->steepest_softening();
      const double h = p.time_step * p.theta;
      return h * p.time_step * p.weight[a] * p.majorant_normal[a] * softening >=
             2.;
    }

    /** Chains of point @p a that are not broken, as hold_of_face_ counts. */
    template <int dim>
    unsigned int n_holding(const LeapfrogChains<dim> &chains,
                           const unsigned int a)
    {
      return unsigned(chains.beta[a] >= 1e-3) +
             unsigned(chains.other.beta[a] >= 1e-3);
    }

    /** What comes some turns after the @p row th. */
    template <typename Spring>
    void fetch(const std::vector<const Spring *> &springs,
               const std::size_t row)
    {
      constexpr std::size_t ahead = 12;
      if (row + ahead < springs.size() && springs[row + ahead])
        prefetch(springs[row + ahead], sizeof(Spring));
    }
  } // namespace

  /** account_point() of one that was a spring, held or apart: it took nothing.
   */
  template <int dim>
  void LeapfrogPoints<dim>::account_spring(const unsigned int a,
                                           const std::size_t row,
                                           Balance &balance)
  {
    const OneStepProblem<dim> &p = chains_.problem;
    const std::size_t n = moved_.size();
    const double w = p.weight[a], wH = w * p.time_step;
    const double *P = &chains_.impulse[a * dim],
                 *U = &chains_.velocity[a * dim],
                 *before = &chains_.old_velocity[a * dim];
    const auto &law = springs_[row]->law;
    const bool closed = springs_[row]->closed;
    chains_.closed[a] = closed;
    if (law.one_sided)
      balance.penetration =
          std::max(balance.penetration,
                   -(p.jump_free[a * dim] + p.time_step * p.theta * U[0]) -
                       chains_.released[a]);
    if (law.broken && !closed)
      return; // apart: nothing acts
    if (law.holds) {
      double work = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        work += P[c] * (U[c] + before[c]) / 2.;
      terms_[numerical * n + row] = -work;
      return;
    }
    const auto energies = law.energies(p, a, U);
    double cohesive_work = 0., residual = 0.;
    for (unsigned int c = 0; c < dim; ++c) {
      const double mean = (U[c] + before[c]) / 2.,
                   pull = wH * energies.traction[c],
                   rest = (P[c] + pull) * mean;
      cohesive_work -= pull * mean;
      if (c == 0 && closed)
        terms_[impact * n + row] = -rest;
      else
        residual += rest;
    }
    const double change = w * (energies.stored - energies.stored_old);
    terms_[stored * n + row] = change;
    terms_[numerical * n + row] = -residual - cohesive_work - change;
    balance.active += closed;
  }

  template <int dim>
  void LeapfrogPoints<dim>::account_point(const unsigned int a,
                                          const std::size_t row,
                                          Balance &balance)
  {
    const OneStepProblem<dim> &p = chains_.problem;
    const std::size_t n = moved_.size();
    const auto put = [&](const Row line, const double value) {
      terms_[line * n + row] += value;
    };
    const double w = p.weight[a], wH = w * p.time_step;
    const double *P = &chains_.impulse[a * dim];
    const auto &solution = chains_.solution[a];
    std::array<double, dim> U, mean, contact;
    for (unsigned int c = 0; c < dim; ++c) {
      U[c] = chains_.velocity[a * dim + c];
      mean[c] = (U[c] + chains_.old_velocity[a * dim + c]) / 2.;
    }
    if (p.kind[a] == PointKind::free && P[0] == 0.) {
      chains_.closed[a] = 0; // apart: nothing acts
      return;
    }
    const auto &energies = energies_[row] =
        point_energies<dim>(p, a, U, solution.frozen);
    double cohesive_work = 0., residual = 0.;
    for (unsigned int c = 0; c < dim; ++c) {
      const double pull = wH * energies.cohesive_traction[c];
      cohesive_work -= pull * mean[c];
      contact[c] = P[c] + pull;
    }
    if (p.kind[a] == PointKind::rigid && !solution.damages) {
      for (unsigned int c = 0; c < dim; ++c)
        residual += contact[c] * mean[c];
      chains_.closed[a] = 0;
    } else {
      chains_.closed[a] = solution.contact_impulse > 0.;
      if (chains_.closed[a])
        put(impact, -contact[0] * mean[0]);
      else
        residual += contact[0] * mean[0];
      double rubbing = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        rubbing += contact[c] * mean[c];
      if (solution.frozen.threshold > 0.) {
        put(friction, -rubbing);
        put(positive_friction, std::max(0., rubbing));
      } else
        residual += rubbing;
      balance.beyond_unique |=
          solution.damages && is_beyond_unique<dim>(p, a, energies);
      balance.active += chains_.closed[a] || solution.damages;
    }
    put(stored, w * (energies.stored - energies.stored_old));
    put(damage, w * energies.damage);
    double spent =
        w * (energies.stored + energies.overlap_released - energies.stored_old);
    if (energies.viscous > 0.) {
      put(viscous, w * energies.viscous);
      spent += w * energies.viscous;
    }
    put(numerical, w * energies.overlap_released - residual - cohesive_work -
                       spent - w * energies.damage);
    if (heals_ && may_heal(p, a)) {
      const HealedChains<dim> healed(chains_, a, energies);
      put(stored, -w * healed.dissipated());
      put(damage, w * healed.dissipated());
    }
    if (energies.beta < 1e-3 && chains_.beta[a] >= 1e-3) {
      put(broken, w);
    }
    if (p.compression_stiffness[a] == 0.)
      balance.penetration =
          std::max(balance.penetration,
                   -(p.jump_free[a * dim] + p.time_step * p.theta * U[0]) -
                       chains_.released[a]);
  }

  /**
   * Jump and way of the chain at the end of the step. What is held stays where
   * it is, without the round-off of its velocity: the points of a cycle could
   * not all undo that, and would hold each other until one of them is released.
   */
  template <int dim>
  void LeapfrogPoints<dim>::keep_jump(const unsigned int a, const bool held)
  {
    OneStepProblem<dim> &p = chains_.problem;
    const double h = p.time_step * p.theta;
    const double *U = &chains_.velocity[a * dim];
    for (unsigned int c = 0; c < dim; ++c)
      p.jump_old[a * dim + c] = held ? 0. : p.jump_free[a * dim + c] + h * U[c];
    if (chains_.closed[a])
      p.jump_old[a * dim] = p.jump_free[a * dim] + h * p.target[a];
    if (chains_.closed[a]) {
      double square = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        square += U[c] * U[c];
      chains_.slip[a] += h * std::sqrt(square);
    }
    std::copy_n(U, dim, &chains_.old_velocity[a * dim]);
  }

  /** History of the chain at the end of the step. */
  template <int dim>
  void LeapfrogPoints<dim>::keep(const unsigned int a,
                                 const PointEnergies<dim> &energies)
  {
    OneStepProblem<dim> &p = chains_.problem;
    const double *P = &chains_.impulse[a * dim];
    if (p.kind[a] == PointKind::free && P[0] == 0.)
      return;
    if (energies.beta < 1e-3 && chains_.beta[a] >= 1e-3)
      separates_ |=
          --hold_of_face_[discretization_.points().face_of[chains_.point[a]]] ==
          0;
    p.opening_max[a] = energies.history.opening;
    if (!p.slip_max.empty())
      p.slip_max[a] = energies.history.slip;
    const auto &interaction = p.interactions[p.interaction[a]];
    if (p.kind[a] == PointKind::rigid && chains_.solution[a].damages) {
      p.kind[a] = PointKind::cohesive;
      if (chains_.other.kind[a] == PointKind::rigid) {
        chains_.other.kind[a] = PointKind::cohesive;
        chains_.other.opening_max[a] =
            share_at_start * interaction.law->toughness() /
            interaction.law->strength() / p.opening_factor[a];
      }
    }
    if (p.kind[a] != PointKind::cohesive)
      return;
    chains_.beta[a] = std::min(chains_.beta[a], energies.beta);
    if (energies.beta < 1. && p.compression_stiffness[a] > 0.) {
      p.compression_stiffness[a] = 0.; // its overlap is in the energies
      chains_.released[a] = std::max(
          {chains_.released[a], -p.jump_old[a * dim], -p.jump_free[a * dim]});
    }
    if (chains_.beta[a] <= 0.)
      p.kind[a] = PointKind::free;
  }

  template <int dim>
  auto LeapfrogPoints<dim>::account(const Communicator &communicator) -> Balance
  {
    Balance balance;
    const std::size_t n = moved_.size();
    bool springs = true;
    for (const auto *spring : springs_)
      springs = springs && spring;
    const std::size_t rows =
        communicator.any(!springs) ? n_rows : n_rows_of_springs;
    terms_.assign(rows * n, 0.);
    energies_.resize(n);
    const bool warms = discretization_.input().has_heat();
    for (std::size_t k = 0; k < n; ++k) {
      const unsigned int active = balance.active;
      fetch(springs_, k);
      if (springs_[k])
        account_spring(moved_[k], k, balance);
      else
        account_point(moved_[k], k, balance);
      if (warms && !springs_[k])
        balance.heat.emplace_back(chains_.point[moved_[k]],
                                  terms_[damage * n + k] +
                                      terms_[friction * n + k]);
      if (counts_[k])
        continue;
      balance.active = active;
      for (std::size_t row = 0; row < rows; ++row)
        terms_[row * n + k] = 0.;
    }
    auto sums = communicator.sums(terms_.data(), rows, n);
    sums.resize(n_rows, 0.);
    balance.stored = sums[stored];
    balance.damage = sums[damage];
    balance.friction = sums[friction];
    balance.positive_friction = sums[positive_friction];
    balance.impact = sums[impact];
    balance.numerical = sums[numerical];
    balance.viscous = sums[viscous];
    balance.broken = sums[broken];
    balance.penetration = communicator.max(balance.penetration);
    for (const unsigned int a : moved_)
      if (chains_.closed[a]) {
        double square = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          square +=
              chains_.velocity[a * dim + c] * chains_.velocity[a * dim + c];
        balance.way = std::max(balance.way, square);
      }
    if (discretization_.input().large_motion)
      balance.way = communicator.max(balance.way);
    balance.way = chains_.problem.time_step * chains_.problem.theta *
                  std::sqrt(balance.way);
    balance.beyond_unique = communicator.any(balance.beyond_unique);
    balance.active = unsigned(communicator.sum_integer(balance.active));
    const auto set = [&](const WatchedLine line, const Row row) {
      balance.changes.taken[std::size_t(line)] = sums[row];
      balance.changes.worst[std::size_t(line)] = LineChanges::no_point;
      if (row >= rows || !(sums[row] < 0.))
        return;
      const auto first = terms_.begin() + long(row * n);
      const auto least = std::min_element(first, first + long(n));
      if (n > 0 && *least < 0.)
        balance.changes.worst[std::size_t(line)] =
            chains_.point[moved_[std::size_t(least - first)]];
    };
    set(WatchedLine::friction, friction);
    set(WatchedLine::damage, damage);
    set(WatchedLine::impact, impact);
    set(WatchedLine::scheme, numerical);
    return balance;
  }

  template <int dim>
  bool LeapfrogPoints<dim>::accept()
  {
    separates_ = false;
    for (std::size_t k = 0; k < moved_.size(); ++k) {
      const unsigned int a = moved_[k];
      fetch(springs_, k);
      const bool held = springs_[k]
                            ? springs_[k]->law.holds
                            : chains_.problem.kind[a] == PointKind::rigid &&
                                  !chains_.solution[a].damages;
      if (springs_[k]) {
        keep_jump(a, held);
        continue;
      }
      // kind, history or overlap may change, and what opens starts the other
      // chain
      Node &node = nodes_.of(mesh_.node_of_point(chains_.point[a]));
      for (auto &elastic : node.elastic)
        elastic.is_new = true;
      if (!heals_ || !may_heal(chains_.problem, a)) {
        keep_jump(a, held);
        keep(a, energies_[k]);
      } else {
        // as in the balance, from what has not been kept yet
        const HealedChains<dim> healed(chains_, a, energies_[k]);
        keep_jump(a, held);
        keep(a, energies_[k]);
        if (healed.heals()) {
          unsigned int &hold =
              hold_of_face_[discretization_.points().face_of[chains_.point[a]]];
          hold -= n_holding(chains_, a);
          healed.keep(chains_);
          hold += n_holding(chains_, a);
        }
      }
    }
    OneStepProblem<dim> &p = chains_.problem;
    const double h = p.time_step * p.theta;
    for (const std::size_t a : parted_)
      for (std::size_t k = a * dim; k < (a + 1) * dim; ++k) {
        p.jump_old[k] = p.jump_free[k] + h * chains_.velocity[k];
        chains_.old_velocity[k] = chains_.velocity[k];
      }
    chains_.swap();
    chain_ = 1 - chain_;
    return separates_;
  }

  template typename LeapfrogPoints<2>::Balance
  LeapfrogPoints<2>::account(const Communicator &);
  template typename LeapfrogPoints<3>::Balance
  LeapfrogPoints<3>::account(const Communicator &);
  template bool LeapfrogPoints<2>::accept();
  template bool LeapfrogPoints<3>::accept();
} // namespace nsfd
