#pragma once

#include "quantity.h"

#include <string>
#include <utility>
#include <vector>

namespace nsfd::formula
{
  /** What is known about the dimension of a part of a formula. */
  struct Dimension {
    enum class Certainty {
      pure,    ///< a mere factor by its nature: pi, sin(...), x < y
      any,     ///< a bare number: fits everywhere
      unknown, ///< bare numbers times x, y, z, t: fits everywhere as well
      natural, ///< x, y, z, t, which may be in bare units as well
      stated   ///< from unit suffixes
    };
    Certainty certainty = Certainty::any;
    Unit unit;
  };

  const Dimension pure_number = {Dimension::Certainty::pure, units::none};
  using Certainty = Dimension::Certainty;

  /** True if the two cannot be added or compared. */
  bool conflict(const Dimension &a, const Dimension &b);

  /** Of a sum: the surer of the two decides, in `5 um + 3` the 3 is in m. */
  Dimension alike(const Dimension &a, const Dimension &b);

  /** Of a product. */
  Dimension times(const Dimension &a, const Dimension &b);

  enum class Rule {
    plain,    ///< plain numbers only: sin, exp
    keeps,    ///< all arguments alike, and so is the result: abs, max
    compares, ///< all arguments alike, the result is plain: atan2
    root,     ///< half of the exponents
    power,    ///< the second argument is the exponent
    drops,    ///< any argument, the result is plain: sign
    selects   ///< if(condition, a, b)
  };

  struct Function {
    const char *name;
    unsigned int least, most; ///< number of arguments
    Rule rule;
  };

  /** Null if there is no such function. */
  const Function *find_function(const std::string &name);

  /** Numbers with a name, in every formula: pi, true, false. */
  const std::vector<std::pair<std::string, double>> &fixed_names();

  /** x, y, z, t with their natural units. */
  const std::vector<std::pair<std::string, Unit>> &formula_variables();

  /** All names that mean something in every formula. */
  std::vector<std::string> formula_words(bool with_variables);
} // namespace nsfd::formula
