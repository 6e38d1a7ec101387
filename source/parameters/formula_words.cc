#include "formula_words.h"

#include <algorithm>

namespace nsfd::formula
{
  namespace
  {
    constexpr unsigned int many = 1000;
    const Function functions[] = {
        {"sin", 1, 1, Rule::plain},       {"cos", 1, 1, Rule::plain},
        {"tan", 1, 1, Rule::plain},       {"asin", 1, 1, Rule::plain},
        {"acos", 1, 1, Rule::plain},      {"atan", 1, 1, Rule::plain},
        {"sinh", 1, 1, Rule::plain},      {"cosh", 1, 1, Rule::plain},
        {"tanh", 1, 1, Rule::plain},      {"asinh", 1, 1, Rule::plain},
        {"acosh", 1, 1, Rule::plain},     {"atanh", 1, 1, Rule::plain},
        {"exp", 1, 1, Rule::plain},       {"ln", 1, 1, Rule::plain},
        {"log", 1, 1, Rule::plain},       {"log2", 1, 1, Rule::plain},
        {"log10", 1, 1, Rule::plain},     {"erf", 1, 1, Rule::plain},
        {"erfc", 1, 1, Rule::plain},      {"floor", 1, 1, Rule::plain},
        {"ceil", 1, 1, Rule::plain},      {"rint", 1, 1, Rule::plain},
        {"atan2", 2, 2, Rule::compares},  {"abs", 1, 1, Rule::keeps},
        {"min", 1, many, Rule::keeps},    {"max", 1, many, Rule::keeps},
        {"sum", 1, many, Rule::keeps},    {"avg", 1, many, Rule::keeps},
        {"mod", 2, 2, Rule::keeps},       {"sqrt", 1, 1, Rule::root},
        {"pow", 2, 2, Rule::power},       {"sign", 1, 1, Rule::drops},
        {"heaviside", 1, 1, Rule::drops}, {"if", 3, 3, Rule::selects},
        {"random", 1, many, Rule::drops},
    };
  } // namespace

  bool conflict(const Dimension &a, const Dimension &b)
  {
    const auto fits_everywhere = [](const Dimension &d) {
      return d.certainty == Certainty::pure || d.certainty == Certainty::any ||
             d.certainty == Certainty::unknown;
    };
    if (fits_everywhere(a) || fits_everywhere(b))
      return false;
    return a.unit != b.unit && (a.certainty == Certainty::stated ||
                                b.certainty == Certainty::stated);
  }

  Dimension alike(const Dimension &a, const Dimension &b)
  {
    if (a.certainty == Certainty::natural &&
        b.certainty == Certainty::natural && a.unit != b.unit)
      return {Certainty::unknown, units::none};
    return a.certainty < b.certainty ? b : a;
  }

  Dimension times(const Dimension &a, const Dimension &b)
  {
    if (a.certainty == Certainty::pure || b.certainty == Certainty::pure)
      return {a.certainty == Certainty::pure ? b.certainty : a.certainty,
              a.unit * b.unit};
    if (a.certainty == Certainty::unknown || b.certainty == Certainty::unknown)
      return {Certainty::unknown, units::none};
    // `2 * 5 um` is a length, but the 2 may be in metres per second
    if (a.certainty == Certainty::any || b.certainty == Certainty::any) {
      const Dimension &other = a.certainty == Certainty::any ? b : a;
      if (other.certainty == Certainty::any)
        return {};
      if (other.certainty == Certainty::natural)
        return {Certainty::unknown, units::none};
      return {Certainty::natural, other.unit};
    }
    return {std::min(a.certainty, b.certainty), a.unit * b.unit};
  }

  const Function *find_function(const std::string &name)
  {
    for (const Function &function : functions)
      if (name == function.name)
        return &function;
    return nullptr;
  }

  const std::vector<std::pair<std::string, double>> &fixed_names()
  {
    static const std::vector<std::pair<std::string, double>> names = {
        {"pi", 3.14159265358979323846}, {"true", 1.}, {"false", 0.}};
    return names;
  }

  const std::vector<std::pair<std::string, Unit>> &formula_variables()
  {
    static const std::vector<std::pair<std::string, Unit>> variables = {
        {"x", units::length},
        {"y", units::length},
        {"z", units::length},
        {"t", units::time}};
    return variables;
  }

  std::vector<std::string> formula_words(const bool with_variables)
  {
    std::vector<std::string> result;
    if (with_variables)
      for (const auto &variable : formula_variables())
        result.push_back(variable.first);
    for (const auto &fixed : fixed_names())
      result.push_back(fixed.first);
    for (const Function &function : functions)
      result.push_back(function.name);
    return result;
  }
} // namespace nsfd::formula
