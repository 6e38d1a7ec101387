#pragma once

#include "nsfd/parameters/expression.h"
#include "quantity.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** What is wrong with a formula, and where in its text. */
  struct FormulaError {
    std::size_t offset = 0, length = 0;
    std::string message, advice;
  };

  /** Cell data that a formula names. */
  struct FormulaFields {
    std::shared_ptr<const PlaceFields> source; ///< null: it names none
    std::vector<std::size_t> used; ///< `cell_value_0`, ... in what is compiled
    bool is_condition = false;     ///< its value is true or false
  };

  /** A compiled formula, or the reason why there is none. */
  struct Formula {
    std::shared_ptr<const Expression::Compiled> compiled;
    std::optional<FormulaError> error;
    /// dimension, if every part of the formula states one
    std::optional<Unit> unit;
    /// dimension of its parts that have one: `2 * 5 um` is likely a length
    std::optional<Unit> likely_unit;
    /// the number, if no x, y, z, t occurs
    std::optional<double> constant;
    bool depends_on_time = false;
  };

  /**
   * Compile a formula: numbers with unit suffixes, + - * / ^, comparisons,
   * && || !, conditions `if(c, a, b)` or `c ? a : b`, the functions of
   * muParser, pi, true, false, constants, and x, y, z, t if
   * @p with_variables, and then cell data of a mesh as well. Dimensions are
   * checked where they are known: numbers with a suffix have one, bare numbers
   * fit everywhere, x, y, z and t may be bare too. The result is compared with
   * @p expected. Never throws.
   */
  Formula compile_formula(const std::string &text, const Unit &expected,
                          const Constants &constants, bool with_variables);

  /** True if @p name means something in every formula: x, pi, sin, ... */
  bool is_formula_word(const std::string &name);

  /** Value of a formula of no variable, finite or not. */
  double evaluate_constant(const Expression::Compiled &formula);

  /** What messages call the formula, such as "Boundary: left/velocity x". */
  void set_name(const Expression::Compiled &formula, const std::string &name);

  /** A constant with a text of its own. */
  std::shared_ptr<const Expression::Compiled>
  compile_constant(double value, const std::string &text);

  /**
   * @p translated is in muParser's own language, without units; @p text is
   * what the user wrote. May throw mu::ParserError.
   */
  std::shared_ptr<const Expression::Compiled>
  compile_translated(const std::string &translated, const std::string &text,
                     bool depends_on_time, bool depends_on_position,
                     const FormulaFields &fields);
} // namespace nsfd
