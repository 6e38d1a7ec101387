#include "study_numbers.h"

#include "parameters/former_words.h"
#include "parameters/quantity.h"
#include "study_input.h"

#include <fmt/format.h>
#include <muParser.h>

#include <cctype>
#include <cmath>
#include <cstdlib>

namespace nsfd
{
  std::optional<double> number_of_value(const std::string &value)
  {
    const std::string text = value.substr(0, value.find(','));
    char *end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || !std::isfinite(number))
      return {};
    const std::string digits = text.substr(0, std::size_t(end - text.c_str()));
    std::string unit(end);
    const std::size_t begin = unit.find_first_not_of(' ');
    if (begin == std::string::npos)
      return number;
    unit = unit.substr(begin, unit.find_last_not_of(' ') - begin + 1);
    if (current_unit(unit) == "courant")
      return number;
    const auto scale = find_unit(unit);
    if (!scale)
      return {};
    return scaled_number(digits, *scale);
  }

  std::string formula_name(const std::string &name)
  {
    std::string result;
    for (const char c : name)
      result += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return result;
  }

  std::optional<double> evaluate(const std::string &formula,
                                 const std::map<std::string, double> &numbers,
                                 std::string &problem)
  {
    problem.clear();
    try {
      mu::Parser parser;
      for (const auto &[name, value] : numbers)
        if (!name.empty() &&
            !std::isdigit(static_cast<unsigned char>(name.front())))
          parser.DefineConst(name, value);
      parser.SetExpr(formula);
      const double value = parser.Eval();
      if (std::isfinite(value))
        return value;
      problem = fmt::format("`{}` is not a finite number", formula);
    } catch (const mu::Parser::exception_type &error) {
      std::string names;
      for (const auto &[name, value] : numbers)
        names += (names.empty() ? "" : ", ") + name;
      problem = fmt::format("`{}`: {} (known are {})", formula, error.GetMsg(),
                            names.empty() ? "no names" : names);
    }
    return {};
  }
} // namespace nsfd
