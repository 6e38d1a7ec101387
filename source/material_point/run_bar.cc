#include "run_bar.h"

#include "bar_charts.h"
#include "curve_names.h"
#include "law_table.h"

#include "core/output_folder.h"
#include "drive_point.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    std::string csv(const BarRun &run)
    {
      std::string text = "time,grip,opening,velocity,pull,cohesion,beta,bar,"
                         "kinetic,stored,damage,viscous,left_over,work\n";
      for (const BarRow &row : run.rows)
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                            row.time, row.grip, row.opening, row.velocity,
                            row.pull, row.cohesion, row.beta, row.elastic,
                            row.kinetic, row.stored, row.damage, row.viscous,
                            row.excess, row.work);
      return text;
    }

    nlohmann::json jumps_of(const CohesiveLaw &law, const double stiffness)
    {
      nlohmann::json result = nlohmann::json::array();
      for (const BarJump &jump : bar_jumps(law, stiffness))
        result.push_back({{"grip", jump.grip},
                          {"opening_from", jump.opening_from},
                          {"opening_to", jump.opening_to},
                          {"traction_from", jump.traction_from},
                          {"traction_to", jump.traction_to},
                          {"excess", jump.excess}});
      return result;
    }

    nlohmann::json summary(const LawInput &input,
                           const std::vector<BarRun> &runs,
                           const SpeedSweep &sweep)
    {
      nlohmann::json result = {{"completed", true},
                               {"path", input.path_name},
                               {"stiffness", input.bar->stiffness},
                               {"curves", nlohmann::json::array()}};
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const CohesiveLaw &law = law_of(input, i);
        const BarRow &end = runs[i].rows.back();
        nlohmann::json curve = {
            {"name", input.curves[i].name},
            {"law", input.curves[i].law_name},
            {"file", curve_file(input, i)},
            {"strength", law.strength()},
            {"toughness", law.toughness()},
            {"steepest_softening", law.steepest_softening()},
            {"slope_ratio", slope_ratio(law, input.bar->stiffness)},
            {"jumps", jumps_of(law, input.bar->stiffness)},
            {"steps", runs[i].n_steps},
            {"grip", end.grip},
            {"opening", end.opening},
            {"beta", end.beta},
            {"bar", end.elastic},
            {"kinetic", end.kinetic},
            {"stored", end.stored},
            {"damage", end.damage},
            {"viscous", end.viscous},
            {"left_over", end.excess},
            {"numerical", end.numerical()},
            {"work", end.work},
        };
        if (input.bar->mode == BarMode::dynamic) {
          curve["unique_step"] = unique_step(law, *input.bar);
          curve["ambiguous_steps"] = runs[i].n_ambiguous;
        }
        result["curves"].push_back(curve);
      }
      if (!sweep.speeds.empty()) {
        result["speeds"] = sweep.speeds;
        result["viscous_of_speeds"] = sweep.viscous;
      }
      return result;
    }

    void print_jumps(const CohesiveLaw &law, const double k)
    {
      const double ratio = slope_ratio(law, k);
      table_line("bar k = E/L", engineering(k, "Pa/m", 4));
      table_line(
          "steepest softening",
          std::isinf(ratio)
              ? "the traction drops: every bar jumps (Acary & Monerie 2006, "
                "(42))"
              : fmt::format("{} = {:.4g} k: {} (Acary & Monerie 2006, (42))",
                            engineering(law.steepest_softening(), "Pa/m", 4),
                            ratio,
                            ratio <= 1. ? "one equilibrium for every U"
                                        : "the equilibrium jumps"));
      for (const BarJump &jump : bar_jumps(law, k)) {
        table_line("jump at U_a", engineering(jump.grip, "m", 5));
        table_line("  from u_a", engineering(jump.opening_from, "m", 5) +
                                     "  at " +
                                     engineering(jump.traction_from, "Pa", 4));
        table_line("  to u_b", engineering(jump.opening_to, "m", 5) + "  at " +
                                   engineering(jump.traction_to, "Pa", 4));
        table_line("  released", share_of(jump.excess, law.toughness()));
      }
    }

    void print_dynamic(const CohesiveLaw &law, const Bar &bar,
                       const BarRun &run)
    {
      const double bound = unique_step(law, bar);
      table_line("step h", engineering(bar.step, "s"));
      table_line("one solution",
                 bound == 0. ? "at no step: the traction drops"
                 : std::isinf(bound)
                     ? "at any step: the bar is stiff enough"
                     : "of steps below " + engineering(bound, "s", 4));
      if (bar.step >= bound)
        table_line("several solutions",
                   fmt::format("found in {} of {} steps", run.n_ambiguous,
                               run.n_steps));
    }

    void print_table(const LawInput &input, const std::vector<BarRun> &runs)
    {
      const Bar &bar = *input.bar;
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const LawCurveInput &curve = input.curves[i];
        const CohesiveLaw &law = law_of(input, i);
        const BarRow &end = runs[i].rows.back();
        const double G = law.toughness();
        std::cout << curve.name
                  << (curve.name == curve.law_name ? "" : ": " + curve.law_name)
                  << "\n";
        table_line("strength", engineering(law.strength(), "Pa"));
        table_line("toughness G", engineering(G, "J/m²", 4));
        print_jumps(law, bar.stiffness);
        if (bar.mode == BarMode::dynamic)
          print_dynamic(law, bar, runs[i]);
        table_line("work of the grip", share_of(end.work, G));
        table_line("energy removed", share_of(end.damage, G));
        if (bar.mode == BarMode::viscous)
          table_line("viscosity took", share_of(end.viscous, G));
        table_line("in bar and point", share_of(end.elastic + end.stored, G));
        if (bar.mode == BarMode::dynamic)
          table_line("kinetic", share_of(end.kinetic, G));
        if (bar.mode != BarMode::quasi_static)
          table_line("lost by the rule", share_of(end.numerical(), G));
      }
    }

    /** Up to the opening after the jump, or the final one. */
    SpeedSweep sweep_speeds(const LawInput &input)
    {
      SpeedSweep sweep;
      if (input.curves.size() != 1)
        return sweep;
      const CohesiveLaw &law = law_of(input, 0);
      double opened = opening_scale(law);
      for (const BarJump &jump : bar_jumps(law, input.bar->stiffness))
        opened = std::max(opened, jump.opening_to);
      sweep.speeds = input.bar->speeds;
      std::sort(sweep.speeds.begin(), sweep.speeds.end());
      for (const double speed : sweep.speeds) {
        Bar bar = *input.bar;
        bar.speed = speed;
        bar.end.reset();
        sweep.viscous.push_back(
            pull_bar(input.curves[0].interaction, bar).viscous_at(opened));
      }
      return sweep;
    }
  } // namespace

  void run_bar(const LawInput &input, const bool quiet)
  {
    const Bar &bar = *input.bar;
    std::vector<BarRun> runs;
    for (const LawCurveInput &curve : input.curves)
      runs.push_back(pull_bar(curve.interaction, bar));
    const SpeedSweep sweep = sweep_speeds(input);

    std::vector<std::string> written;
    const auto write = [&](const std::string &name, const std::string &text) {
      write_file_atomically(input.directory + "/" + name, text);
      written.push_back(name);
    };
    for (std::size_t i = 0; i < runs.size(); ++i)
      write(curve_file(input, i), csv(runs[i]));
    write("bar.svg", bar_chart(input, runs));
    // one that waits has nothing to be drawn against
    if (bar.mode != BarMode::viscous || bar.speed > 0.)
      write("grip.svg", grip_chart(input, runs));
    write("energies.svg", bar_energy_chart(input, runs));
    if (runs.size() == 1 && bar.mode == BarMode::viscous) {
      const auto jumps = bar_jumps(law_of(input, 0), bar.stiffness);
      if (!jumps.empty())
        write("floor.svg", floor_chart(input, jumps[0]));
      if (!sweep.speeds.empty())
        write("speeds.svg", speed_chart(input, sweep));
    }
    if (runs.size() == 1 && bar.mode == BarMode::dynamic)
      write("slopes.svg", slope_chart(input));
    write_file_atomically(input.directory + "/parameters.prm", input.echo);
    write_file_atomically(input.directory + "/summary.json",
                          summary(input, runs, sweep).dump(2) + "\n");
    if (quiet)
      return;
    if (!input.entries.empty())
      std::cout << "with " << input.entries << "\n";
    std::cout << input.path_name << "\n";
    print_table(input, runs);
    std::cout << "in " << input.directory << ": "
              << fmt::format("{}\n", fmt::join(written, ", "));
  }
} // namespace nsfd
