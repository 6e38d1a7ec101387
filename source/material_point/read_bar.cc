#include "read_bar.h"

#include "drive_point.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    CohesionRule read_rule_of_bar(SectionReader &reader)
    {
      const std::string name = reader.choice(
          "cohesion rule", "exact", {"end point", "end velocity", "exact"},
          "end point, end velocity or exact (means over the steps, no energy "
          "is lost)");
      return name == "exact"          ? CohesionRule::exact
             : name == "end velocity" ? CohesionRule::end_velocity
                                      : CohesionRule::end_point;
    }

    void read_theta(SectionReader &reader, Bar &bar)
    {
      bar.theta =
          reader.number("theta", "0.5", units::none, Range::closed(0.5, 1.),
                        "of the scheme; 1/2 dissipates nothing");
      bar.rule = read_rule_of_bar(reader);
    }

    void read_viscous(SectionReader &reader, LawInput &input, Bar &bar)
    {
      bar.viscosity =
          reader.number("viscosity", "", units::viscosity_per_length,
                        Range::positive(), "eta, Pa s/m, of the opening");
      bar.speed = reader.number(
          "speed", "0", units::velocity, Range::non_negative(),
          "of the grip, m/s; 0: it waits where the equilibrium ends");
      bar.speeds = reader.number_list(
          "compared speeds", units::velocity, Range::positive(),
          "of the grip, m/s: what viscosity takes at each, drawn in "
          "speeds.svg");
      read_theta(reader, bar);
      if (bar.speed == 0. && bar.end)
        reader.error("end", "the grip waits, its `end` is not used",
                     "give its speed, or remove `end`");
      if (reader.errors().has_errors())
        return;
      for (const LawCurveInput &curve : input.curves) {
        const CohesiveLaw *law = curve.interaction.law.get();
        if (bar.speed == 0. && bar_jumps(*law, bar.stiffness).empty())
          reader.error(
              "speed",
              fmt::format("`{}` stays in equilibrium with a grip that waits",
                          curve.name),
              fmt::format("pull with a speed, or take a stiffness below the "
                          "steepest softening, {:.4g} Pa/m",
                          law->steepest_softening()));
        // resolved with the time eta / (k + C) of the intact point
        double slowest = bar.speed;
        for (const double speed : bar.speeds)
          slowest = slowest > 0. ? std::min(slowest, speed) : speed;
        const double C = law->extrinsic() ? 0. : law->normal_stiffness();
        const double n_steps =
            slowest > 0. ? default_end(*law, bar.stiffness) / slowest *
                               (bar.stiffness + C) / bar.viscosity
                         : 0.;
        if (n_steps > 1e7)
          reader.error(slowest < bar.speed || bar.speed == 0.
                           ? "compared speeds"
                           : "speed",
                       fmt::format("a grip at {:.3g} m/s takes {:.1g} steps",
                                   slowest, n_steps),
                       "pull faster or with more viscosity; a grip that waits "
                       "(speed = 0) is the limit");
      }
    }

    /** Says which step has one solution where the given one does not. */
    void judge_step(SectionReader &reader, const LawCurveInput &curve,
                    const Bar &bar)
    {
      const CohesiveLaw &law = *curve.interaction.law;
      const double bound = unique_step(law, bar);
      if (bar.step < bound)
        return;
      if (bound == 0.)
        return reader.warning(
            "step",
            fmt::format("the traction of `{}` drops: a step can have several "
                        "solutions, however short it is",
                        curve.name),
            "take a law that softens with a finite slope");
      const double chi = bar.rule == CohesionRule::exact ? 0.5 : 1.;
      reader.warning(
          "step",
          fmt::format("a step of {:.4g} s can have several solutions: its "
                      "slope is {:.4g} Pa/m, `{}` needs more than {:.4g} Pa/m",
                      bar.step, dynamic_slope(bar, bar.step), curve.name,
                      chi * law.steepest_softening()),
          fmt::format("write for example: set step = {:.3g} s", 0.95 * bound));
    }

    void read_dynamic(SectionReader &reader, LawInput &input, Bar &bar)
    {
      bar.mass =
          reader.number("mass", "", units::mass_per_area, Range::positive(),
                        "M/S, kg/m^2, between bar and point");
      bar.speed = reader.number("speed", "", units::velocity, Range::positive(),
                                "of the grip, m/s");
      bar.step = reader.number("step", "", units::time, Range::positive(),
                               "h in s, all steps the same");
      bar.steps = reader.number_list(
          "compared steps", units::time, Range::positive(),
          "in s: slopes M/(S theta h^2) + theta k in slopes.svg; default "
          "`step`");
      read_theta(reader, bar);
      if (reader.errors().has_errors())
        return;
      for (const LawCurveInput &curve : input.curves) {
        const CohesiveLaw *law = curve.interaction.law.get();
        judge_step(reader, curve, bar);
        const double n_steps =
            bar.end.value_or(default_end(*law, bar.stiffness)) /
            (bar.speed * bar.step);
        if (n_steps > 1e7)
          reader.error(
              "speed",
              fmt::format("the grip takes {:.1g} steps to its end", n_steps),
              "pull faster");
      }
    }
  } // namespace

  void read_bar(SectionReader &reader, LawInput &input)
  {
    Bar bar;
    const std::string mode = reader.choice(
        "mode", "static", {"static", "viscous", "dynamic"},
        "static (jumps where there is no equilibrium), viscous (massless, the "
        "point resists its opening) or dynamic (a mass behind the point)");
    bar.mode = mode == "viscous"   ? BarMode::viscous
               : mode == "dynamic" ? BarMode::dynamic
                                   : BarMode::quasi_static;
    bar.stiffness =
        reader.number("stiffness", "", units::stiffness_per_area,
                      Range::positive(), "k = E/L of the bar, Pa/m");
    const std::string text = "of the grip, m; default beyond failure";
    if (reader.optional("end", text))
      bar.end =
          reader.number("end", "", units::length, Range::positive(), text);
    input.normalised =
        reader.boolean("normalised", false,
                       "pictures over final opening and strength of the law");

    const auto refuse = [&](const char *entry, const char *reason) {
      reader.refuse({entry}, reason);
    };
    if (bar.mode != BarMode::dynamic) {
      bar.n_steps = reader.integer(
          "steps", "400", 20, 100000,
          bar.mode == BarMode::viscous
              ? "one opens the point by at most this part of the final opening"
              : "of the point up to its final opening");
      for (const char *entry : {"mass", "step", "compared steps"})
        refuse(entry, "only mode = dynamic has a mass");
    } else
      refuse("steps", "the steps of mode = dynamic are given by `step`");
    if (bar.mode != BarMode::viscous)
      for (const char *entry : {"viscosity", "compared speeds"})
        refuse(entry, "only mode = viscous has a viscosity");
    if (bar.mode == BarMode::quasi_static)
      for (const char *entry : {"speed", "theta", "cohesion rule"})
        refuse(entry, "mode = static knows no time");

    if (bar.mode == BarMode::viscous)
      read_viscous(reader, input, bar);
    if (bar.mode == BarMode::dynamic)
      read_dynamic(reader, input, bar);
    input.path_name = "bar: " + mode;
    input.bar = bar;
  }
} // namespace nsfd
