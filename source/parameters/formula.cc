#include "formula.h"

#include "formula_parser.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  bool is_formula_word(const std::string &name)
  {
    const std::vector<std::string> words = formula::formula_words(true);
    return std::find(words.begin(), words.end(), name) != words.end();
  }

  Formula compile_formula(const std::string &text, const Unit &expected,
                          const Constants &constants, const bool with_variables)
  {
    Formula result;
    // what is written out for muParser grows with the square of the length
    constexpr std::size_t longest = 10000;
    if (text.size() > longest) {
      result.error = FormulaError{
          0, text.size(),
          fmt::format("this formula has {} bytes, more than {}", text.size(),
                      longest),
          "name parts of it in section Constants, or give a table in a file"};
      return result;
    }
    try {
      formula::Parser parser(text, constants, with_variables);
      const formula::Part part = parser.parse();
      if (part.dimension.certainty == formula::Certainty::stated) {
        result.unit = part.dimension.unit;
        if (part.dimension.unit != expected) {
          result.error = FormulaError{
              0, text.size(),
              fmt::format("`{}` is {}", text, describe(part.dimension.unit)),
              ""};
          return result;
        }
      } else if (part.dimension.certainty == formula::Certainty::natural)
        result.likely_unit = part.dimension.unit;
      result.depends_on_time = parser.uses_time();
      result.compiled =
          compile_translated(part.translated, text, parser.uses_time(),
                             parser.uses_position(), parser.fields(part));
      if (!parser.uses_variables()) {
        const double value = evaluate_constant(*result.compiled);
        if (!std::isfinite(value))
          throw FormulaError{0, text.size(),
                             fmt::format("`{}` is not a finite number", text),
                             ""};
        result.constant = value;
        result.compiled = compile_constant(value, text);
      }
    } catch (const FormulaError &error) {
      result.error = error;
    } catch (const mu::ParserError &error) {
      result.error = FormulaError{
          0, text.size(), fmt::format("`{}`: {}", text, error.GetMsg()), ""};
    }
    if (result.error)
      result.compiled.reset();
    return result;
  }
} // namespace nsfd
