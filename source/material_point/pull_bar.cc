#include "bar.h"
#include "drive_point.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    double end_of(const CohesiveLaw &law, const Bar &bar)
    {
      return bar.end.value_or(default_end(law, bar.stiffness));
    }

    // ------------------------------------------------------------ equilibrium

    /** The point at this opening, reached along the envelope. */
    BarRow in_equilibrium(const CohesiveLaw &law, const double k,
                          const double u, const double excess)
    {
      BarRow row;
      row.opening = u;
      row.pull = row.cohesion = law.traction(u);
      row.grip = u + row.pull / k;
      row.beta = law.beta(u);
      row.elastic = 0.5 * row.pull * row.pull / k;
      row.stored = 0.5 * row.pull * u;
      row.damage = law.energy(u) - row.stored;
      row.excess = excess;
      row.work = row.elastic + law.energy(u) + excess;
      return row;
    }

    /** Openings of the law at which a curve should have a row. */
    std::vector<double> with_kinks_between(const CohesiveLaw &law,
                                           const double from, const double to,
                                           const unsigned int n)
    {
      std::vector<double> places;
      for (unsigned int i = 0; i <= n; ++i)
        places.push_back(i == n ? to : from + i * (to - from) / n);
      for (const double d :
           {law.elastic_limit(), law.peak_opening(), law.final_opening()})
        if (d > from && d < to)
          places.push_back(d);
      std::sort(places.begin(), places.end());
      return places;
    }

    /** The largest opening of a stable branch with at most this grip. */
    double opening_at(const CohesiveLaw &law, const double k, const double U,
                      double low)
    {
      double high = std::max(U, low);
      for (unsigned int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high))
          break;
        (middle + law.traction(middle) / k <= U ? low : high) = middle;
      }
      return high + law.traction(high) / k <= U ? high : low;
    }

    BarRun in_equilibrium(const CohesiveLaw &law, const Bar &bar)
    {
      BarRun run;
      const double k = bar.stiffness, end = end_of(law, bar);
      double from = 0., excess = 0.;
      const auto add_branch = [&](const double to) {
        // at least a tenth of the steps to every branch
        const double share = (to - from) / opening_scale(law);
        const auto n = static_cast<unsigned int>(std::clamp(share, 0.1, 1.) *
                                                 std::max(bar.n_steps, 20u));
        for (const double u : with_kinks_between(law, from, to, n))
          run.rows.push_back(in_equilibrium(law, k, u, excess));
      };
      // a rigid joint waits for its strength
      run.rows.emplace_back();
      if (law.extrinsic() && law.strength() / k > end) {
        BarRow &row = run.rows.emplace_back();
        row.grip = end;
        row.pull = row.cohesion = k * end;
        row.work = row.elastic = 0.5 * k * end * end;
        return run;
      }
      for (const BarJump &jump : bar_jumps(law, k)) {
        if (jump.grip > end)
          break;
        add_branch(jump.opening_from);
        from = jump.opening_to;
        excess += jump.excess;
      }
      add_branch(opening_at(law, k, end, from));
      run.n_steps = static_cast<unsigned int>(run.rows.size()) - 1;
      return run;
    }

    // ---------------------------------------------------------------- viscous

    /**
     * A massless point: steps that open it by at most a share of the final
     * opening, and that resolve its own time eta / (k + b) before it would
     * ring with theta = 1/2.
     */
    class ViscousPull
    {
    public:
      ViscousPull(const Interaction &interaction, const Bar &bar)
          : law_(*interaction.law), bar_(bar), step_(interaction, bar),
            largest_(opening_scale(law_) / std::max(bar.n_steps, 1u)),
            last_(default_end(law_, bar.stiffness)),
            jumps_(bar_jumps(law_, bar.stiffness))
      {
      }

      BarRun run()
      {
        BarRun result;
        result.rows = {start()};
        BarRow row = result.rows.back();
        double h = longest();
        while (!finished(row)) {
          h = std::min(h, longest());
          double grip = row.grip + bar_.speed * h;
          LocalSolution<2> solution = solve(h, row.grip, grip);
          while (step_.end_opening(solution) - row.opening > largest_) {
            h *= 0.5;
            grip = row.grip + bar_.speed * h;
            solution = solve(h, row.grip, grip);
          }
          step_.accept(solution, grip, row);
          result.rows.push_back(row);
          ++result.n_steps;
          h *= 1.4;
        }
        return result;
      }

    private:
      const CohesiveLaw &law_;
      const Bar &bar_;
      BarStep step_;
      double largest_, last_; ///< opening of a step, of all steps
      std::vector<BarJump> jumps_;

      LocalSolution<2> solve(const double h, const double old,
                             const double grip)
      {
        return step_.solve(h, old, grip, step_.largest_opening());
      }

      /** At rest; or, where the grip is held, past the lost equilibrium. */
      BarRow start()
      {
        if (bar_.speed > 0. || jumps_.empty())
          return {};
        const double u = nudged(), k = bar_.stiffness, U = jumps_[0].grip;
        BarRow row = in_equilibrium(law_, k, u, 0.);
        row.grip = U;
        row.pull = k * (U - u);
        row.elastic = 0.5 * k * (U - u) * (U - u);
        row.work = row.elastic + row.stored + row.damage;
        step_.set_state(u, 0.);
        return row;
      }

      /** From u_a as far as leaves out 1e-9 of the energy to come. */
      double nudged() const
      {
        const BarJump &jump = jumps_[0];
        const double k = bar_.stiffness, u = jump.opening_from;
        double nudge = 1e-4 * (jump.opening_to - u);
        const auto left_out = [&] {
          return nudge * (k * (jump.grip - u) - 0.5 * k * nudge) -
                 law_.energy_increment(u, u + nudge);
        };
        while (left_out() > 1e-9 * jump.excess && u + 0.1 * nudge > u)
          nudge *= 0.1;
        return u + nudge;
      }

      double longest() const
      {
        const double d = step_.largest_opening();
        const double b = law_.extrinsic()
                             ? 0.
                             : law_.secant(std::max(d, law_.elastic_limit()));
        return bar_.viscosity / (bar_.stiffness + b);
      }

      bool finished(const BarRow &row) const
      {
        if (bar_.speed == 0.)
          return jumps_.empty() ||
                 jumps_[0].opening_to - row.opening <=
                     1e-7 * (jumps_[0].opening_to - jumps_[0].opening_from);
        return bar_.end ? row.grip >= *bar_.end : row.opening >= last_;
      }
    };

    // ---------------------------------------------------------------- dynamic

    BarRun with_mass(const Interaction &interaction, const Bar &bar)
    {
      const CohesiveLaw &law = *interaction.law;
      BarRun run;
      BarRow row;
      run.rows = {row};
      BarStep step(interaction, bar);
      const double end = end_of(law, bar);
      const bool unique = bar.step < unique_step(law, bar);
      const auto n = static_cast<unsigned int>(
          std::ceil(end / (bar.speed * bar.step) * (1. - 1e-12)));
      for (unsigned int i = 1; i <= n; ++i) {
        const double grip = std::min(i * bar.speed * bar.step, end);
        const LocalSolution<2> solution =
            step.solve(bar.step, row.grip, grip, step.largest_opening());
        if (!unique && row.beta > 0. && step.count_solutions() > 1)
          ++run.n_ambiguous;
        step.accept(solution, grip, row);
        run.rows.push_back(row);
      }
      run.n_steps = n;
      return run;
    }
  } // namespace

  double BarRun::viscous_at(const double opening) const
  {
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const BarRow &a = rows[i - 1], &b = rows[i];
      if (b.opening >= opening && b.opening > a.opening)
        return a.viscous + (opening - a.opening) / (b.opening - a.opening) *
                               (b.viscous - a.viscous);
    }
    return rows.back().viscous;
  }

  BarRun pull_bar(const Interaction &interaction, const Bar &bar)
  {
    switch (bar.mode) {
    case BarMode::viscous:
      return ViscousPull(interaction, bar).run();
    case BarMode::dynamic:
      return with_mass(interaction, bar);
    default:
      return in_equilibrium(*interaction.law, bar);
    }
  }
} // namespace nsfd
