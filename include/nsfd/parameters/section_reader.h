#pragma once

#include "nsfd/parameters/expression.h"

#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  class ParameterSection; // one parsed subsection, with source locations
  class SourceText;       // a text that knows its lines and columns
  class InputErrors;      // collects every error of the input

  /** Dimension of a quantity: exponents of kg, m, s, K. */
  struct Unit {
    int kilogram = 0, metre = 0, second = 0, kelvin = 0;
  };

  namespace units
  {
    constexpr Unit none{0, 0, 0}, length{0, 1, 0}, time{0, 0, 1}, mass{1, 0, 0},
        velocity{0, 1, -1}, acceleration{0, 1, -2}, density{1, -3, 0},
        pressure{1, -1, -2}, energy_per_area{1, 0, -2},
        stiffness_per_area{1, -2, -2}, force_per_volume{1, -2, -2},
        viscosity{1, -1, -1}, viscosity_per_length{1, -2, -1},
        damage_viscosity{1, 0, -1}, wear_coefficient{-1, 1, 2},
        mass_per_area{1, -2, 0}, mass_per_length{1, -1, 0}, inertia{1, 2, 0},
        inertia_per_length{1, 1, 0}, temperature{0, 0, 0, 1},
        heat_capacity{0, 2, -2, -1}, conductivity{1, 1, -3, -1},
        conductance{1, 0, -3, -1}, heat_flux{1, 0, -3};
  } // namespace units

  /** Closed or open interval a number must lie in; reported when it does not.
   */
  struct Range {
    double lower, upper;
    bool lower_open = false, upper_open = false;
    static Range any();
    static Range positive();
    static Range non_negative();
    static Range closed(double lower, double upper);
  };

  /**
   * Reads the entries of one section. A call declares an entry (name, default,
   * text) and returns its value; what is wrong goes into InputErrors with file,
   * line, caret and advice, and the default is returned, so that all errors
   * are found in one pass. Only the parts that a scene names read their
   * entries; what nobody read is reported as stray with the nearest name.
   *
   * A `std::string` default is written as in a file ("0.5", "1 um"). An empty
   * default of a number or expression means that the entry must be given.
   */
  class SectionReader
  {
  public:
    SectionReader(ParameterSection &section, InputErrors &errors);

    /** "Interface: midline" etc., "" at the top. */
    const std::string &section_name() const;
    /** "midline" of "Interface: midline", else "". */
    std::string block_name() const;

    /** True if the file or --set gives this entry. Does not declare it. */
    bool has(const std::string &name) const;

    double number(const std::string &name, const std::string &default_text,
                  Unit unit, Range range, const std::string &text);
    unsigned int integer(const std::string &name,
                         const std::string &default_text, unsigned int lower,
                         unsigned int upper, const std::string &text);
    bool boolean(const std::string &name, bool default_value,
                 const std::string &text);
    std::string word(const std::string &name, const std::string &default_text,
                     const std::string &text);
    std::string choice(const std::string &name, const std::string &default_text,
                       const std::vector<std::string> &choices,
                       const std::string &text);
    std::vector<double> numbers(const std::string &name,
                                const std::string &default_text, Unit unit,
                                Range range, unsigned int count,
                                const std::string &text);
    std::vector<unsigned int> integers(const std::string &name,
                                       const std::string &default_text,
                                       unsigned int lower, unsigned int count,
                                       const std::string &text);
    /** As many numbers as the file gives; none if it does not. */
    std::vector<double> number_list(const std::string &name, Unit unit,
                                    Range range, const std::string &text);
    Expression expression(const std::string &name,
                          const std::string &default_text, Unit unit,
                          const std::string &text);

    /**
     * The text of an entry with its place, for values of a kind of their own.
     * Empty (and reported) if it must be given and is not.
     */
    std::optional<SourceText> raw(const std::string &name,
                                  const std::string &default_text,
                                  const std::string &text,
                                  const std::string &example_text = "");

    /**
     * Path of a file that must be given: relative to the folder of the
     * parameter file that names it, from --set to where the program runs. The
     * echo has it in full and can be run from anywhere. Empty (and reported)
     * if it is not given.
     */
    std::string file(const std::string &name, const std::string &text,
                     const std::string &example_text);

    /**
     * Declare an entry that has no default and may be left out. True if the
     * file gives it: then it is to be read by one of the calls above.
     */
    bool optional(const std::string &name, const std::string &text);

    /**
     * These entries exist in other scenes, but not here. Reports each one that
     * the file gives, with the reason: "the law `rigid` never slides".
     */
    void refuse(const std::vector<std::string> &names,
                const std::string &reason);

    /** What stands here cannot be judged: report no stray entries. */
    void accept_everything();

    /** A number in a text of its own, as number() reads it. */
    double number_in(const SourceText &value, const std::string &name,
                     const std::string &example_text, Unit unit, Range range);

    /** A formula in a text of its own, as expression() reads it. */
    Expression expression_in(const SourceText &value, const std::string &name,
                             Unit unit);

    /** Report an error at the value of @p name (or at the section). */
    void error(const std::string &name, const std::string &message,
               const std::string &advice = "");

    /** As error(), but the scene may run. */
    void warning(const std::string &name, const std::string &message,
                 const std::string &advice = "");

    InputErrors &errors();

  private:
    ParameterSection &section_;
    InputErrors &errors_;

    std::vector<SourceText> list(const std::string &name,
                                 const std::string &default_text,
                                 unsigned int count, const std::string &text,
                                 const std::string &example_text);
    std::optional<unsigned int> integer_in(const SourceText &value,
                                           const std::string &name,
                                           const std::string &example_text,
                                           unsigned int lower,
                                           unsigned int upper);
  };
} // namespace nsfd
