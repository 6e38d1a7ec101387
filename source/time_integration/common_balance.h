#pragma once

#include "energy_watch.h"
#include "nonsmooth/point_law.h"
#include "state/point_fields.h"
#include "time_integrator.h"

#include <algorithm>
#include <cmath>

/** What the energy balances of a dynamic and of a quasi-static step share. */
namespace nsfd
{
  /** What points keep, before a step has changed any of it. */
  inline void carry_history(const State &old, State &next)
  {
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          if (field.life == PointField::Life::history)
            next.*member = old.*member;
        });
    next.contact.assign(old.kind.size(), 0);
  }

  /**
   * The damage of point @p i after a step; @p lets_go: it was rigid and is not
   * any more. @return true if it is broken since this step. Tails count as
   * broken once they carry a thousandth.
   */
  template <int dim>
  bool record_damage(const PointEnergies<dim> &energies, const std::size_t i,
                     const bool lets_go, const State &old, State &next)
  {
    next.opening_max[i] = energies.history.opening;
    if (!next.slip_max.empty())
      next.slip_max[i] = energies.history.slip;
    if (lets_go)
      next.kind[i] = PointKind::cohesive;
    if (next.kind[i] != PointKind::cohesive)
      return false;
    next.beta[i] = std::min(old.beta[i], energies.beta);
    if (energies.beta < 1.)
      next.two_sided[i] = 0; // its overlap is in point_energies()
    if (next.beta[i] <= 0.)
      next.kind[i] = PointKind::free;
    return next.beta[i] < 1e-3 && old.beta[i] >= 1e-3;
  }

  /** How far the sum of the lines is off, J, @p initial_energy included. */
  inline double balance_defect(const EnergyLines &energy,
                               const double initial_energy)
  {
    return energy.kinetic + energy.elastic + energy.cohesive + energy.damage +
           energy.friction + energy.viscous + energy.plastic + energy.impact +
           energy.numerical + energy.absorbed - energy.work - initial_energy;
  }

  /**
   * The largest energy so far, how far the sum of the lines is off, and what of
   * that came with this step: not a number if one of them is none.
   */
  inline void close_balance(const State &old, State &next, StepReport &report)
  {
    const EnergyLines &energy = next.energy;
    next.largest_energy = std::max(
        {old.largest_energy, energy.kinetic, energy.elastic, energy.cohesive,
         std::abs(energy.work), energy.damage, energy.impact, energy.friction,
         energy.viscous, energy.plastic, energy.absorbed});
    const double defect = balance_defect(energy, next.initial_energy);
    report.changes.defect =
        std::abs(defect - balance_defect(old.energy, next.initial_energy));
    report.balance_residual = next.largest_energy > 0. || !std::isfinite(defect)
                                  ? std::abs(defect) / next.largest_energy
                                  : 0.;
  }

  /**
   * The defect over the largest energy so far. At rest there is none but
   * round-off of the kinetic energy that impulses have to move in each step, as
   * in EnergyWatch. @p energy_scale as for LawEvaluation: four times as much as
   * they have to move.
   */
  inline void relate_defect(const double energy_scale, const State &next,
                            StepReport &report)
  {
    const double round_off = round_off_of_step(work_of_impulses(
                                 energy_scale, report.changes.impulses)) *
                             next.step;
    const double moved =
        std::min(energy_scale / 4., round_off / energy_round_off);
    if (moved > next.largest_energy)
      report.balance_residual *= next.largest_energy / moved;
  }
} // namespace nsfd
