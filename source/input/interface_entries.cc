#include "interface_entries.h"

#include "read_sections.h"
#include "temperature_factors.h"

#include <fmt/format.h>

#include <limits>

namespace nsfd
{
  const std::vector<std::string> &cohesive_entries()
  {
    static const std::vector<std::string> entries = {
        "opening viscosity",
        "viscous limit",
        "strength factor",
        "toughness factor",
        "scatter",
        "strength scatter",
        "toughness scatter",
        "strength modulus",
        "toughness modulus",
        "unloading",
        "strength at temperatures",
        "toughness at temperatures"};
    return entries;
  }

  namespace
  {
    void read_viscosity(SectionReader &reader, InterfaceInput &input)
    {
      input.opening_viscosity =
          reader.number("opening viscosity", "0", units::viscosity_per_length,
                        Range::non_negative(),
                        "Pa s/m: traction over opening speed until broken");
      const std::string limit = "viscous limit",
                        text = "Pa: traction that it does not exceed, "
                               "eta v / (1 + eta v / limit); default: none";
      if (input.opening_viscosity == 0.)
        reader.refuse({limit}, "there is no `opening viscosity`");
      else if (reader.optional(limit, text))
        input.viscous_limit =
            reader.number(limit, "", units::pressure, Range::positive(), text);
    }

    Expression read_factor(SectionReader &reader, const std::string &what)
    {
      const std::string name = what + " factor";
      Expression factor = read_initial_expression(
          reader, name, "1", units::none,
          "times the " + what + ", of x, y, z; the shape of the law stays");
      if (factor.is_constant() && !(factor(0., 0., 0.) > 0.))
        reader.error(
            name, fmt::format("{} = {} must be positive", name, factor.text()));
      return factor;
    }

    Scatter read_scatter(SectionReader &reader, const std::string &what,
                         const bool weibull)
    {
      const std::string width = what + " scatter", modulus = what + " modulus";
      if (!weibull) {
        reader.refuse({modulus}, "the scatter is uniform: write scatter = "
                                 "weibull, or `" +
                                     width + "`");
        const double half_width =
            reader.number(width, "0", units::none, {0., 1., false, true},
                          "relative half width of random factors");
        return half_width > 0. ? Scatter{Scatter::Kind::uniform, half_width}
                               : Scatter{};
      }
      reader.refuse({width}, "the scatter is weibull: write `" + modulus + "`");
      const std::string text =
          "Weibull modulus of random factors of mean 1; default: no scatter";
      if (!reader.optional(modulus, text))
        return {};
      return {Scatter::Kind::weibull,
              reader.number(modulus, "", units::none,
                            {1., std::numeric_limits<double>::infinity()},
                            text)};
    }

    /** Strength and toughness from point to point. */
    void read_point_factors(SectionReader &reader, InterfaceInput &input)
    {
      input.strength_factor = read_factor(reader, "strength");
      input.toughness_factor = read_factor(reader, "toughness");
      const bool weibull =
          reader.choice("scatter", "uniform", {"uniform", "weibull"},
                        "uniform or weibull: distribution of random "
                        "factors, by the position") == "weibull";
      if (weibull && !reader.has("strength modulus") &&
          !reader.has("toughness modulus"))
        reader.error("scatter", "scatter = weibull without a modulus",
                     "write `strength modulus`, `toughness modulus` or both");
      input.strength_scatter = read_scatter(reader, "strength", weibull);
      input.toughness_scatter = read_scatter(reader, "toughness", weibull);
      input.seed = reader.integer("seed", "1", 0,
                                  std::numeric_limits<unsigned int>::max(),
                                  "of the scatter");
    }

  } // namespace

  void read_damage_start(SectionReader &reader, InterfaceInput &input)
  {
    input.friction_exponent = read_friction_exponent(reader, input.law.get());
    input.broken = read_initial_expression(
        reader, "broken", "false", units::none,
        "true, or an expression: open at t = 0 where it is not 0");
    input.has_broken = !input.broken.is_zero();
  }

  void read_cohesive_block(SectionReader &reader, const SceneInput &scene,
                           InterfaceInput &input)
  {
    input.law = read_cohesive_law(reader, input.law_name);
    read_point_factors(reader, input);
    read_law_factors(reader, scene, input);
    if (input.law && input.law->adds_openings())
      reader.refuse(
          {"opening viscosity", "viscous limit"},
          fmt::format("the law {} has no viscosity beside it", input.law_name));
    else
      read_viscosity(reader, input);
    input.plateau = read_plateau(reader, input.law.get(), input.law_name);
  }

  void check_lift(SectionReader &reader, const InterfaceInput &input)
  {
    if (!input.law || !input.law->adds_openings())
      return;
    const auto refuse = [&](const bool lifts, const std::string &name) {
      if (lifts)
        reader.error(name,
                     fmt::format("the law {} holds surfaces that are closed "
                                 "at the opening 0, and {} moves that place",
                                 input.law_name, name),
                     "remove it, or take law = camacho-ortiz");
    };
    refuse(input.sliding.dilatancy > 0., "dilatancy");
    refuse(input.sliding.wear > 0., "wear coefficient");
  }
} // namespace nsfd
