#include "step_check.h"

#include "nonsmooth/row_work.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nsfd
{
  StepCheck::StepCheck(const SceneInput &input, Describe describe)
      : input_(input), describe_(std::move(describe))
  {
  }

  void StepCheck::check_solution(const double h, const double time,
                                 const SolverReport &report,
                                 const std::size_t worst_point,
                                 const StepRejected::Cure cure) const
  {
    if (report.converged)
      return;
    throw StepRejected(
        fmt::format(
            "the step of {:.4g} at t = {:.6g} was not solved: residual {:.2e} "
            "after {} Newton steps and {} sweeps; worst face {}",
            h, time, report.residual, report.newton, report.sweeps,
            describe_(worst_point)),
        cure);
  }

  void StepCheck::check_balance(const TakenStep &step, const StepReport &report)
  {
    // what is not a number is not within the bound
    starts_cold_ = true;
    if (!(report.balance_residual * step.next.largest_energy <=
          1e-6 * std::max(step.next.largest_energy, step.energy_scale)))
      throw StepRejected(fmt::format(
          "the energies of the step of {:.4g} at t = {:.6g} do not add up "
          "(relative defect {:.1e}): redundant joints have made "
          "impulses too large; worst face {}",
          step.time_step, step.old.time, report.balance_residual,
          describe_(step.worst_point)));
    starts_cold_ = false;
  }

  void StepCheck::watch_energy(const TakenStep &step, StepReport &report)
  {
    const State &old = step.old, &next = step.next;
    LineChanges &changes = report.changes;
    changes.taken[std::size_t(WatchedLine::scheme)] =
        next.energy.numerical - old.energy.numerical -
        changes.taken[std::size_t(WatchedLine::large_motion)];
    // at rest there is no energy but what the loads would give in a step
    changes.scale = std::max(next.largest_energy, step.energy_scale);
    // |P - P*|_R times |U|_(1/R): impulses of rows that ask for the same may be
    // far larger than what moves
    changes.terms = work_of_impulses(step.energy_scale, changes.impulses);
    const double noise = report.solver.residual * changes.terms;
    changes.of_rows = round_off_of_rows(changes.impulses_of_rows,
                                        changes.impulses, step.energy_scale);
    // Rows of large motions turn with the bodies: where those that depend on
    // each other keep Newton's iteration from round-off, it leaves |P|_R of
    // them times |U - given|_(1/R), which is |P - P*|_R there.
    if (input_.large_motion)
      changes.of_rows = std::max(
          noise, report.solver.residual *
                     std::sqrt(changes.impulses_of_rows *
                               std::max(changes.impulses, step.energy_scale)));
    const double bound = energy_round_off * changes.scale + noise +
                         // no line is known better than the balance closes
                         10. * changes.defect;
    for (std::size_t k = 0; k < n_watched_lines; ++k) {
      const auto line = WatchedLine(k);
      const bool two_sided =
          line == WatchedLine::joints || line == WatchedLine::supports;
      const double given =
          two_sided ? std::abs(changes.taken[k]) : -changes.taken[k];
      // velocities of rows are known to the tolerance, impulses of rows that
      // ask for the same to less, and `numerical` is a difference of large
      // numbers in very long steps: the certificate holds their sum, a step is
      // given up only where hardly any digits are left
      const double more = line == WatchedLine::large_motion
                              ? most_of_large_motion
                          : two_sided || line == WatchedLine::scheme ? 1e-4
                                                                     : 0.;
      if (given <= more * changes.scale + bound ||
          (line != WatchedLine::large_motion && !never_gives(line, input_)))
        continue;
      starts_cold_ = true;
      throw StepRejected(fmt::format(
          "the step of {:.4g} s at t = {:.6g} s would give {:.3g} J to `{}`, "
          "{:.1e} of the largest energy{}",
          next.time - old.time, old.time, given, name_of(line),
          given / changes.scale,
          changes.worst[k] == LineChanges::no_point
              ? ""
              : "; worst face " + describe_(changes.worst[k])));
    }
  }
} // namespace nsfd
