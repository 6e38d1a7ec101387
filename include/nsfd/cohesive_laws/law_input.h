#pragma once

#include "nsfd/parameters/section_reader.h"

#include <cmath>
#include <optional>
#include <string>

/** Entries that several cohesive laws read in the same way. */
namespace nsfd::laws
{
  /** The value of an entry, if the file gives it. */
  inline std::optional<double> given(SectionReader &reader,
                                     const std::string &name, const Unit unit,
                                     const std::string &text)
  {
    if (!reader.has(name))
      return {};
    return reader.number(name, "", unit, Range::positive(), text);
  }

  /** What the file gives of G = zeta R_max d_c besides zeta. */
  struct Separation {
    std::optional<double> strength, toughness, critical_opening;
    std::string opening_name;

    explicit Separation(SectionReader &reader,
                        const std::string &name = "critical opening",
                        const std::string &text = "Opening d_c at separation")
        : strength(given(reader, "strength", units::pressure,
                         "Largest traction R_max")),
          toughness(given(reader, "toughness", units::energy_per_area,
                          "Fracture energy G")),
          critical_opening(given(reader, name, units::length, text)),
          opening_name(name)
    {
    }

    unsigned int n_given() const
    {
      return strength.has_value() + toughness.has_value() +
             critical_opening.has_value();
    }

    /**
     * Strength and critical opening from two of the three, for a law with
     * G = @p zeta R_max d_c, as @p relation says in words.
     */
    void complete(SectionReader &reader, const std::string &law,
                  const double zeta, const std::string &relation)
    {
      if (n_given() == 3)
        reader.error("toughness",
                     "`strength`, `toughness` and `" + opening_name +
                         "` are tied by " + relation +
                         " and cannot all be given",
                     "remove one of the three");
      if (n_given() < 2)
        reader.error("strength",
                     "the law " + law +
                         " needs two of `strength`, `toughness` and `" +
                         opening_name + "`",
                     "add the missing ones");
      const double G = toughness.value_or(1.);
      if (!critical_opening)
        critical_opening = G / (zeta * strength.value_or(1.));
      if (!strength)
        strength = G / (zeta * *critical_opening);
    }
  };

  /** C_N and the opening d_0 at the peak, of a law with G = zeta R_max^2 / C.
   */
  struct ElasticPeak {
    double stiffness, opening;
  };

  /**
   * From two of stiffness, strength and toughness; @p relation says
   * G = @p zeta R_max^2 / C in words.
   */
  inline ElasticPeak read_elastic_peak(SectionReader &reader,
                                       const std::string &law,
                                       const double zeta,
                                       const std::string &relation)
  {
    const auto stiffness = given(reader, "stiffness", units::stiffness_per_area,
                                 "Normal stiffness C_N");
    const auto strength =
        given(reader, "strength", units::pressure, "Largest traction R_max");
    const auto toughness =
        given(reader, "toughness", units::energy_per_area, "Fracture energy G");
    const int n_given =
        stiffness.has_value() + strength.has_value() + toughness.has_value();
    if (n_given == 3)
      reader.error("toughness",
                   "`stiffness`, `strength` and `toughness` are tied by " +
                       relation + " and cannot all be given",
                   "remove one of the three");
    if (n_given < 2)
      reader.error("strength",
                   "the law " + law +
                       " needs two of `stiffness`, `strength` and `toughness`",
                   "add the missing ones");
    const double R_max = strength.value_or(1.), G = toughness.value_or(1.),
                 C = stiffness ? *stiffness : zeta * (R_max / G) * R_max;
    return {C, strength ? R_max / C : std::sqrt(G / C / zeta)};
  }

  /** delta_N / delta_T of d = |(u_N, u_T delta_N / delta_T)|. */
  inline double read_opening_ratio(SectionReader &reader,
                                   const double critical_opening)
  {
    const std::string text =
        "Slip delta_T at full separation; default: the critical opening";
    return reader.optional("tangential critical opening", text)
               ? critical_opening / reader.number("tangential critical opening",
                                                  "", units::length,
                                                  Range::positive(), text)
               : 1.;
  }

  /** a^2 of d^2 = u_N^2 + a^2 u_T^2. */
  inline double read_shear_weight(SectionReader &reader)
  {
    const double a = reader.number(
        "mode mixity", "1", units::none, Range::positive(),
        "Weight a of the slip in the opening, d^2 = u_N^2 + a^2 u_T^2");
    return a * a;
  }

  /** How fast the intensity of an adhesion grows where it is pressed. */
  struct Healing {
    double time = 0.; ///< s; 0: it never does
    double pressure = 0.;

    /** 1/s, over the driving force of the surface energy. */
    double rate(const double under) const
    {
      return (under >= pressure ? 1. : under / pressure) / time;
    }
  };

  inline Healing read_healing(SectionReader &reader)
  {
    Healing healing;
    const std::string text = "Of a pressed face, in which the intensity grows "
                             "from 0 to 1, s; without it nothing heals";
    if (!reader.optional("healing time", text)) {
      reader.refuse({"healing pressure"}, "there is no `healing time`");
      return healing;
    }
    healing.time =
        reader.number("healing time", "", units::time, Range::positive(), text);
    healing.pressure = reader.number(
        "healing pressure", "0", units::pressure, Range::non_negative(),
        "Below it a face heals slower in proportion, Pa; 0: the same under any "
        "pressure");
    return healing;
  }

  /** C_T / C_N. */
  inline double read_stiffness_ratio(SectionReader &reader,
                                     const double normal_stiffness)
  {
    const std::string text = "Stiffness C_T in shear; default C_N";
    return reader.optional("tangential stiffness", text)
               ? reader.number("tangential stiffness", "",
                               units::stiffness_per_area, Range::positive(),
                               text) /
                     normal_stiffness
               : 1.;
  }
} // namespace nsfd::laws
