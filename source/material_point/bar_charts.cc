#include "bar_charts.h"

#include "curve_names.h"

#include "drive_point.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/scene/scene_input.h"
#include "visualization/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace nsfd
{
  namespace
  {
    using Colour = LineChart::Colour;
    using Values = std::vector<double>;
    using Value = std::function<double(const BarRow &)>;

    constexpr double gap = std::numeric_limits<double>::quiet_NaN();

    /** Units and labels of the axes. */
    struct BarAxes {
      const LawInput &input;

      double opening(const std::size_t i) const
      {
        return input.normalised ? opening_scale(law_of(input, i)) : 1.;
      }
      double traction(const std::size_t i) const
      {
        return input.normalised ? law_of(input, i).strength() : 1.;
      }
      double energy(const std::size_t i) const
      {
        return input.normalised ? law_of(input, i).toughness() : 1.;
      }
      LineChart::Axis of_opening(const std::string &name) const
      {
        return input.normalised
                   ? LineChart::Axis{name + " over final opening", ""}
                   : LineChart::Axis{name, "m"};
      }
      LineChart::Axis of_traction() const
      {
        return input.normalised ? LineChart::Axis{"traction over strength", ""}
                                : LineChart::Axis{"traction", "Pa"};
      }
      LineChart::Axis of_energy() const
      {
        return input.normalised ? LineChart::Axis{"energy over G", ""}
                                : LineChart::Axis{"energy", "J/m²"};
      }
    };

    Values over(Values values, const double unit)
    {
      for (double &value : values)
        value /= unit;
      return values;
    }

    /** Of the rows; with @p with_gaps not across the jumps of a static bar. */
    Values values_of(const BarRun &run, const Value &value, const double unit,
                     const bool with_gaps)
    {
      Values values;
      for (std::size_t i = 0; i < run.rows.size(); ++i) {
        if (with_gaps && i > 0 && run.rows[i].excess != run.rows[i - 1].excess)
          values.push_back(gap);
        values.push_back(value(run.rows[i]) / unit);
      }
      return values;
    }

    /** From the last row before each jump to the first one after it. */
    Values jumps_of(const BarRun &run, const Value &value, const double unit)
    {
      Values values;
      for (std::size_t i = 1; i < run.rows.size(); ++i)
        if (run.rows[i].excess != run.rows[i - 1].excess) {
          values.push_back(value(run.rows[i - 1]) / unit);
          values.push_back(value(run.rows[i]) / unit);
          values.push_back(gap);
        }
      return values;
    }

    /** The envelope with its kinks, drops upright. */
    void sample(const CohesiveLaw &law, const double end, Values &u, Values &T)
    {
      u.clear();
      for (unsigned int i = 0; i <= 600; ++i)
        u.push_back(i * end / 600.);
      for (const double d :
           {law.elastic_limit(), law.peak_opening(), law.final_opening()})
        if (d > 0. && d < end) {
          u.push_back(d * (1. - 1e-9));
          u.push_back(d * (1. + 1e-9));
        }
      std::sort(u.begin(), u.end());
      T.assign(law.extrinsic() ? 1 : 0, 0.);
      for (const double d : u)
        T.push_back(law.traction(d));
      if (law.extrinsic())
        u.insert(u.begin(), 0.);
    }

    /** From @p a to @p b, in so many points that they are not drawn as dots. */
    Values straight(const double a, const double b)
    {
      Values values;
      for (unsigned int i = 0; i <= 30; ++i)
        values.push_back(a + i * (b - a) / 30.);
      return values;
    }

    /** T = slope (zero - u) where 0 <= T <= top. */
    void add_line_of(LineChart &chart, const std::string &name,
                     const double slope, const double zero, const double top,
                     const BarAxes &axes, const Colour colour)
    {
      const double high = std::min(top, slope * zero);
      chart.add_line(name,
                     over(straight(zero - high / slope, zero), axes.opening(0)),
                     over(straight(high, 0.), axes.traction(0)), colour, true);
    }

    const Value opening = [](const BarRow &row) { return row.opening; };
    const Value grip = [](const BarRow &row) { return row.grip; };
    const Value pull = [](const BarRow &row) { return row.pull; };

    /** The rows up to the first one that is opened this far. */
    BarRun up_to(const BarRun &run, const double end)
    {
      BarRun result;
      for (const BarRow &row : run.rows) {
        result.rows.push_back(row);
        if (row.opening >= end)
          break;
      }
      return result;
    }
  } // namespace

  std::string bar_chart(const LawInput &input, const std::vector<BarRun> &runs)
  {
    const BarAxes axes{input};
    const Bar &bar = *input.bar;
    const bool single = runs.size() == 1,
               is_static = bar.mode == BarMode::quasi_static;
    LineChart chart(chart_title(input, "law and bar"),
                    axes.of_opening("opening u"), axes.of_traction());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const CohesiveLaw &law = law_of(input, i);
      const auto jumps = bar_jumps(law, bar.stiffness);
      double end = 1.1 * opening_scale(law);
      for (const BarJump &jump : jumps)
        end = std::max(end, 1.1 * jump.opening_to);
      const BarRun shown = up_to(runs[i], end);
      const Colour mine = single ? Colour::blue : LineChart::palette(i);
      Values u, T;
      sample(law, end, u, T);
      const double x = axes.opening(i), y = axes.traction(i);
      if (single) {
        chart.add_line("law", over(u, x), over(T, y), Colour::grey, true);
        if (!jumps.empty())
          add_line_of(chart, "bar, grip at U_a", bar.stiffness, jumps[0].grip,
                      1.15 * law.strength(), axes, Colour::green);
      }
      const std::string what = is_static ? "equilibrium" : "pull of the bar";
      chart.add_line(single ? what : input.curves[i].name,
                     values_of(shown, opening, x, is_static),
                     values_of(shown, pull, y, is_static), mine);
      if (is_static && !jumps.empty())
        chart.add_line(single ? "jump" : input.curves[i].name + ": jump",
                       jumps_of(shown, opening, x), jumps_of(shown, pull, y),
                       single ? Colour::red : mine, !single);
    }
    return chart.svg(SvgUse::file);
  }

  std::string grip_chart(const LawInput &input, const std::vector<BarRun> &runs)
  {
    const BarAxes axes{input};
    const bool single = runs.size() == 1,
               is_static = input.bar->mode == BarMode::quasi_static;
    LineChart chart(chart_title(input, "pull of the bar"),
                    axes.of_opening("displacement U of the grip"),
                    axes.of_traction());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const double x = axes.opening(i), y = axes.traction(i);
      if (single && !is_static) {
        Bar rest;
        rest.stiffness = input.bar->stiffness;
        rest.end = runs[i].rows.back().grip;
        const BarRun statics = pull_bar(input.curves[i].interaction, rest);
        chart.add_line("static", values_of(statics, grip, x, false),
                       values_of(statics, pull, y, false), Colour::grey, true);
      }
      const Colour mine = single ? Colour::blue : LineChart::palette(i);
      chart.add_line(single ? (is_static ? "equilibrium" : "computed")
                            : input.curves[i].name,
                     values_of(runs[i], grip, x, is_static),
                     values_of(runs[i], pull, y, is_static), mine);
      const Values jumps = jumps_of(runs[i], grip, x);
      if (!jumps.empty())
        chart.add_line(single ? "jump" : input.curves[i].name + ": jump", jumps,
                       jumps_of(runs[i], pull, y), single ? Colour::red : mine,
                       !single);
    }
    return chart.svg(SvgUse::file);
  }

  std::string bar_energy_chart(const LawInput &input,
                               const std::vector<BarRun> &runs)
  {
    const BarAxes axes{input};
    const Bar &bar = *input.bar;
    // a grip that is held leaves the opening to tell the places apart
    const bool held = bar.mode == BarMode::viscous && bar.speed == 0.;
    LineChart chart(
        chart_title(input, "energy"),
        axes.of_opening(held ? "opening u" : "displacement U of the grip"),
        axes.of_energy());
    const bool single = runs.size() == 1;
    struct Part {
      const char *name;
      Value value;
      Colour colour;
      bool is_shown, dashed;
    };
    const std::vector<Part> parts = {
        {"work of the grip", [](auto &row) { return row.work; }, Colour::grey,
         single, true},
        // bar and mass pass their energy to and fro
        {bar.mode == BarMode::dynamic ? "bar and mass" : "bar",
         [](auto &row) { return row.elastic + row.kinetic; }, Colour::green,
         single, false},
        {"damage", [](auto &row) { return row.damage; }, Colour::red, true,
         false},
        {"viscosity", [](auto &row) { return row.viscous; }, Colour::orange,
         bar.mode == BarMode::viscous, true},
        {"lost by the rule", [](auto &row) { return row.numerical(); },
         Colour::violet,
         bar.mode != BarMode::quasi_static &&
             (bar.theta > 0.5 || bar.rule != CohesionRule::exact),
         true},
        {"released", [](auto &row) { return row.excess; }, Colour::orange,
         bar.mode == BarMode::quasi_static, true}};
    for (std::size_t i = 0; i < runs.size(); ++i)
      for (const Part &part : parts)
        if (part.is_shown)
          chart.add_line(
              single ? part.name : input.curves[i].name + ": " + part.name,
              values_of(runs[i], held ? opening : grip, axes.opening(i), false),
              values_of(runs[i], part.value, axes.energy(i), false),
              single ? part.colour : LineChart::palette(i), part.dashed);
    return chart.svg(SvgUse::file);
  }

  std::string floor_chart(const LawInput &input, const BarJump &jump)
  {
    const BarAxes axes{input};
    const CohesiveLaw &law = law_of(input, 0);
    const double k = input.bar->stiffness;
    LineChart chart(chart_title(input, "least energy that viscosity takes"),
                    axes.of_opening("opening u"), axes.of_traction());
    Values u, T, x, lower, upper;
    sample(law, 1.1 * std::max(jump.opening_to, opening_scale(law)), u, T);
    for (std::size_t i = 0; i < u.size(); ++i)
      if (u[i] > jump.opening_from && u[i] < jump.opening_to) {
        x.push_back(u[i]);
        lower.push_back(T[i]);
        upper.push_back(k * (jump.grip - u[i]));
      }
    chart.add_band("between bar and law, from u_a to u_b",
                   over(x, axes.opening(0)), over(lower, axes.traction(0)),
                   over(upper, axes.traction(0)), Colour::sky);
    chart.add_line("law", over(u, axes.opening(0)), over(T, axes.traction(0)),
                   Colour::blue);
    add_line_of(chart, "bar, grip at U_a", k, jump.grip, 1.15 * law.strength(),
                axes, Colour::green);
    return chart.svg(SvgUse::file);
  }

  std::string speed_chart(const LawInput &input, const SpeedSweep &sweep)
  {
    const BarAxes axes{input};
    const CohesiveLaw &law = law_of(input, 0);
    const Bar &bar = *input.bar;
    const double G = axes.energy(0),
                 unit = input.normalised ? law.strength() / bar.viscosity : 1.;
    LineChart chart(chart_title(input, "energy that viscosity takes"),
                    input.normalised
                        ? LineChart::Axis{"speed over strength / viscosity", ""}
                        : LineChart::Axis{"speed", "m/s"},
                    axes.of_energy());
    const double last = sweep.speeds.back();
    chart.add_line(
        "imposed on the opening: η v Δ", over(straight(0., last), unit),
        over(straight(0., bar.viscosity * last * opening_scale(law)), G),
        Colour::blue);
    double floor = 0.;
    for (const BarJump &jump : bar_jumps(law, bar.stiffness))
      floor += jump.excess;
    chart.add_line("imposed on the grip of the bar", over(sweep.speeds, unit),
                   over(sweep.viscous, G), Colour::red);
    chart.add_line("floor: released by the jump",
                   over(straight(0., last), unit),
                   over(straight(floor, floor), G), Colour::grey, true);
    return chart.svg(SvgUse::file);
  }

  std::string slope_chart(const LawInput &input)
  {
    const BarAxes axes{input};
    const CohesiveLaw &law = law_of(input, 0);
    const Bar &bar = *input.bar;
    Values u, T;
    sample(law, 1.1 * opening_scale(law), u, T);
    // lines through the middle of the steepest fall
    std::size_t steepest = law.extrinsic() ? 2 : 1;
    const auto fall = [&](const std::size_t i) {
      return u[i] > u[i - 1] ? (T[i - 1] - T[i]) / (u[i] - u[i - 1]) : 0.;
    };
    for (std::size_t i = steepest; i < u.size(); ++i)
      if (fall(i) > fall(steepest) * (1. + 1e-6))
        steepest = i;
    const double at = 0.5 * (u[steepest] + u[steepest - 1]),
                 traction = 0.5 * (T[steepest] + T[steepest - 1]);
    LineChart chart(chart_title(input, "slopes of law, bar and step"),
                    axes.of_opening("opening u"), axes.of_traction());
    chart.add_line("law", over(u, axes.opening(0)), over(T, axes.traction(0)),
                   Colour::blue);
    const auto add = [&](const std::string &name, const double slope,
                         const Colour colour) {
      add_line_of(chart, name, slope, at + traction / slope,
                  1.15 * law.strength(), axes, colour);
    };
    add("bar: k", bar.stiffness, Colour::grey);
    const double bound = unique_step(law, bar);
    const Values steps = bar.steps.empty() ? Values{bar.step} : bar.steps;
    for (std::size_t i = 0; i < steps.size(); ++i)
      add(fmt::format("h = {}: {}", engineering(steps[i], "s"),
                      steps[i] < bound ? "one solution" : "several"),
          dynamic_slope(bar, steps[i]), LineChart::palette(i + 1));
    return chart.svg(SvgUse::file);
  }
} // namespace nsfd
