#include "nsfd/parameters/section_reader.h"

#include "former_words.h"
#include "formula.h"
#include "parameter_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace nsfd
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    bool contains(const Range &range, const double value)
    {
      return (range.lower_open ? value > range.lower : value >= range.lower) &&
             (range.upper_open ? value < range.upper : value <= range.upper);
    }

    std::string describe(const Range &range)
    {
      if (range.lower == 0. && range.upper == infinity)
        return range.lower_open ? "must be positive" : "must not be negative";
      std::string result = "must be ";
      if (range.lower != -infinity)
        result += fmt::format("{} {:g}",
                              range.lower_open ? "greater than" : "at least",
                              range.lower);
      if (range.lower != -infinity && range.upper != infinity)
        result += " and ";
      if (range.upper != infinity)
        result += fmt::format(
            "{} {:g}", range.upper_open ? "less than" : "at most", range.upper);
      return result;
    }

    /**
     * Why a value is none of this world, or nothing. Far beyond any body and
     * any matter, so that products of a few of them stay numbers.
     */
    std::string strangeness(const double value, const Unit &unit)
    {
      const double size = std::abs(value);
      const double limit = unit == units::length ? 1e20 : 1e45;
      if (size > limit)
        return fmt::format("is beyond {:g}", limit);
      if (unit != units::none && size > 0. && size < 1. / limit)
        return fmt::format("is below {:g}", 1. / limit);
      return "";
    }

    /** Some number in the range, to go on with after an error. */
    double number_inside(const Range &range)
    {
      if (range.lower != -infinity && range.upper != infinity)
        return 0.5 * (range.lower + range.upper);
      if (range.lower != -infinity)
        return range.lower + 1.;
      return range.upper != infinity ? range.upper - 1. : 1.;
    }

    /** Sensible sizes, where the unit alone would suggest an odd one. */
    std::string example_value(const std::string &name,
                              const std::string &default_text, const Unit &unit)
    {
      if (name == "strength")
        return "300 MPa";
      if (name.compare(0, 8, "traction") == 0 || name == "pressure")
        return "10 MPa";
      if (name.find("Poisson ratio") != std::string::npos)
        return "0.32";
      return default_text.empty() ? example(unit) : default_text;
    }

    std::string for_example(const std::string &value)
    {
      return value.empty() ? "" : "write for example: " + value;
    }
  } // namespace

  Range Range::any() { return {-infinity, infinity}; }
  Range Range::positive() { return {0., infinity, true, false}; }
  Range Range::non_negative() { return {0., infinity}; }
  Range Range::closed(const double lower, const double upper)
  {
    return {lower, upper};
  }

  SectionReader::SectionReader(ParameterSection &section, InputErrors &errors)
      : section_(section), errors_(errors)
  {
  }

  const std::string &SectionReader::section_name() const
  {
    return section_.name();
  }

  std::string SectionReader::block_name() const
  {
    return section_.block_name();
  }

  bool SectionReader::has(const std::string &name) const
  {
    section_.mention(name);
    return section_.find(name) != nullptr;
  }

  std::optional<SourceText> SectionReader::raw(const std::string &name,
                                               const std::string &default_text,
                                               const std::string &text,
                                               const std::string &example_text)
  {
    const std::string advice = for_example(
        example_text.empty() ? default_text
                             : fmt::format("set {} = {}", name, example_text));
    const ParameterEntry *entry = section_.find(name);
    section_.declare(
        {name, entry != nullptr ? entry->value.text() : default_text, text});
    if (entry == nullptr && !default_text.empty())
      return SourceText(default_text, section_.location());
    if (entry != nullptr && !entry->value.empty())
      return entry->value;

    if (entry == nullptr)
      section_.report_missing(name, advice, errors_);
    else
      errors_.error(entry->name_location,
                    fmt::format("`{}` has no value", name), advice);
    return {};
  }

  std::vector<SourceText> SectionReader::list(const std::string &name,
                                              const std::string &default_text,
                                              const unsigned int count,
                                              const std::string &text,
                                              const std::string &example_text)
  {
    std::string examples = example_text;
    for (unsigned int i = 1; i < count; ++i)
      examples += ", " + example_text;
    const auto value = raw(name, default_text, text, examples);
    if (!value)
      return {};
    const std::vector<SourceText> parts = value->split(',');
    if (parts.size() == count)
      return parts;
    errors_.error(value->location(),
                  fmt::format("{} = {} has {} value{}, {} are needed", name,
                              value->text(), parts.size(),
                              parts.size() == 1 ? "" : "s", count),
                  "write one value per direction, with commas in between");
    return {};
  }

  std::string SectionReader::file(const std::string &name,
                                  const std::string &text,
                                  const std::string &example_text)
  {
    namespace fs = std::filesystem;
    const ParameterEntry *entry = section_.find(name);
    fs::path path;
    if (entry != nullptr && !entry->value.empty()) {
      path = (fs::path(entry->value.location().source).parent_path() /
              entry->value.text())
                 .lexically_normal();
      // the first declaration counts
      section_.declare(
          {name, fs::absolute(path).lexically_normal().string(), text});
    }
    raw(name, "", text, example_text);
    return path.string();
  }

  bool SectionReader::optional(const std::string &name, const std::string &text)
  {
    if (has(name))
      return true;
    section_.declare({name, "", text, false});
    return false;
  }

  void SectionReader::refuse(const std::vector<std::string> &names,
                             const std::string &reason)
  {
    for (const std::string &name : names)
      if (const ParameterEntry *entry = section_.find(name)) {
        errors_.error(
            entry->name_location,
            fmt::format("`{}` does not belong here: {}", name, reason),
            "remove this line");
        section_.refuse(name);
      }
  }

  void SectionReader::accept_everything() { section_.accept_everything(); }

  double SectionReader::number_in(const SourceText &value,
                                  const std::string &name,
                                  const std::string &example_text,
                                  const Unit unit, const Range range)
  {
    const std::string advice =
        for_example(example_value(name, example_text, unit));
    const Formula formula =
        compile_formula(value.text(), unit, section_.constants(), false);
    if (formula.error && formula.unit)
      errors_.error(value.location(),
                    fmt::format("{}; `{}` must be {}", formula.error->message,
                                name, nsfd::describe(unit)),
                    advice);
    else if (formula.error)
      errors_.error(value.locate(formula.error->offset, formula.error->length),
                    fmt::format("{} = {}: {}", name, value.text(),
                                formula.error->message),
                    formula.error->advice.empty() ? advice
                                                  : formula.error->advice);
    else if (!contains(range, *formula.constant))
      errors_.error(
          value.location(),
          fmt::format("{} = {} {}", name, value.text(), describe(range)),
          advice);
    else if (const std::string why = strangeness(*formula.constant, unit);
             !why.empty())
      errors_.error(value.location(),
                    fmt::format("{} = {} {}, outside the range of numbers "
                                "that are computed with",
                                name, value.text(), why),
                    advice);
    else
      return *formula.constant;
    return number_inside(range);
  }

  double SectionReader::number(const std::string &name,
                               const std::string &default_text, const Unit unit,
                               const Range range, const std::string &text)
  {
    const auto value =
        raw(name, default_text, text, example_value(name, default_text, unit));
    return value ? number_in(*value, name, default_text, unit, range)
                 : number_inside(range);
  }

  std::vector<double> SectionReader::numbers(const std::string &name,
                                             const std::string &default_text,
                                             const Unit unit, const Range range,
                                             const unsigned int count,
                                             const std::string &text)
  {
    std::vector<double> result(count, number_inside(range));
    const std::vector<SourceText> parts =
        list(name, default_text, count, text, example_value(name, "", unit));
    for (unsigned int i = 0; i < parts.size(); ++i)
      result[i] = number_in(parts[i], name, "", unit, range);
    return result;
  }

  std::vector<double> SectionReader::number_list(const std::string &name,
                                                 const Unit unit,
                                                 const Range range,
                                                 const std::string &text)
  {
    std::vector<double> result;
    if (!optional(name, text))
      return result;
    if (const auto value = raw(name, "", text, example_value(name, "", unit)))
      for (const SourceText &part : value->split(','))
        result.push_back(number_in(part, name, "", unit, range));
    return result;
  }

  std::optional<unsigned int>
  SectionReader::integer_in(const SourceText &value, const std::string &name,
                            const std::string &example_text,
                            const unsigned int lower, const unsigned int upper)
  {
    const unsigned int n_before = errors_.n_errors();
    const double number =
        number_in(value, name, example_text, units::none, Range::any());
    if (errors_.n_errors() > n_before)
      return {};
    std::string problem;
    if (number != std::floor(number))
      problem = "must be a whole number";
    else if (number < lower)
      problem = fmt::format("must be at least {}", lower);
    else if (number > upper)
      problem = fmt::format("must be at most {}", upper);
    if (problem.empty())
      return static_cast<unsigned int>(number);
    errors_.error(value.location(),
                  fmt::format("{} = {} {}", name, value.text(), problem),
                  for_example(example_text.empty() ? std::to_string(lower)
                                                   : example_text));
    return {};
  }

  unsigned int SectionReader::integer(const std::string &name,
                                      const std::string &default_text,
                                      const unsigned int lower,
                                      const unsigned int upper,
                                      const std::string &text)
  {
    const auto value = raw(name, default_text, text);
    if (!value)
      return lower;
    return integer_in(*value, name, default_text, lower, upper).value_or(lower);
  }

  std::vector<unsigned int>
  SectionReader::integers(const std::string &name,
                          const std::string &default_text,
                          const unsigned int lower, const unsigned int count,
                          const std::string &text)
  {
    std::vector<unsigned int> result(count, lower);
    const std::vector<SourceText> parts =
        list(name, default_text, count, text, std::to_string(lower));
    for (unsigned int i = 0; i < parts.size(); ++i)
      result[i] = integer_in(parts[i], name, "", lower,
                             std::numeric_limits<unsigned int>::max())
                      .value_or(lower);
    return result;
  }

  bool SectionReader::boolean(const std::string &name, const bool default_value,
                              const std::string &text)
  {
    const auto value = raw(name, default_value ? "true" : "false", text);
    if (!value)
      return default_value;
    if (value->text() == "true" || value->text() == "yes")
      return true;
    if (value->text() == "false" || value->text() == "no")
      return false;
    errors_.error(
        value->location(),
        fmt::format("{} = {} is neither true nor false", name, value->text()),
        "write true or false");
    return default_value;
  }

  std::string SectionReader::word(const std::string &name,
                                  const std::string &default_text,
                                  const std::string &text)
  {
    if (default_text.empty() && section_.find(name) == nullptr) {
      section_.declare({name, "", text, false});
      return "";
    }
    const auto value = raw(name, default_text, text);
    return value ? collapse_blanks(value->text()) : default_text;
  }

  std::string SectionReader::choice(const std::string &name,
                                    const std::string &default_text,
                                    const std::vector<std::string> &choices,
                                    const std::string &text)
  {
    const auto value = raw(name, default_text, text);
    if (!value)
      return default_text.empty() ? choices.front() : default_text;
    const std::string word = collapse_blanks(value->text());
    if (std::find(choices.begin(), choices.end(), word) != choices.end())
      return word;
    errors_.error(value->location(),
                  fmt::format("{} = {} is not one of: {}", name, word,
                              fmt::join(choices, ", ")),
                  did_you_mean_today(word, choices, FormerWord::Place::value,
                                     section_.kind(), name));
    return default_text.empty() ? choices.front() : default_text;
  }

  Expression SectionReader::expression_in(const SourceText &value,
                                          const std::string &name,
                                          const Unit unit)
  {
    const Formula formula =
        compile_formula(value.text(), unit, section_.constants(), true);
    if (!formula.error) {
      const std::string why =
          formula.constant ? strangeness(*formula.constant, unit) : "";
      if (!why.empty()) {
        errors_.error(value.location(),
                      fmt::format("{} = {} {}, outside the range of numbers "
                                  "that are computed with",
                                  name, value.text(), why),
                      for_example(example_value(name, "", unit)));
        return {};
      }
      set_name(*formula.compiled,
               section_.name().empty() ? name : section_.name() + "/" + name);
      return Expression(formula.compiled);
    }
    if (formula.unit)
      errors_.error(value.location(),
                    fmt::format("{}; `{}` must be {}", formula.error->message,
                                name, nsfd::describe(unit)),
                    for_example(example_value(name, "", unit)));
    else
      errors_.error(value.locate(formula.error->offset, formula.error->length),
                    fmt::format("{}: {}", name, formula.error->message),
                    formula.error->advice);
    return {};
  }

  Expression SectionReader::expression(const std::string &name,
                                       const std::string &default_text,
                                       const Unit unit, const std::string &text)
  {
    const auto value =
        raw(name, default_text, text, example_value(name, default_text, unit));
    return value ? expression_in(*value, name, unit) : Expression();
  }

  namespace
  {
    SourceLocation blame(const ParameterSection &section,
                         const std::string &name)
    {
      const ParameterEntry *entry = section.find(name);
      if (entry == nullptr)
        return section.location();
      return entry->value.empty() ? entry->name_location
                                  : entry->value.location();
    }
  } // namespace

  void SectionReader::error(const std::string &name, const std::string &message,
                            const std::string &advice)
  {
    errors_.error(blame(section_, name), message, advice);
  }

  void SectionReader::warning(const std::string &name,
                              const std::string &message,
                              const std::string &advice)
  {
    errors_.warning(blame(section_, name), message, advice);
  }

  InputErrors &SectionReader::errors() { return errors_; }
} // namespace nsfd
