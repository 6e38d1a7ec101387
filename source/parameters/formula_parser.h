#pragma once

#include "formula_scanner.h"

#include <string>
#include <vector>

namespace nsfd::formula
{
  /**
   * Recursive descent over the text. Every operation is written out with
   * brackets, so that nothing hangs on muParser's own order of operations,
   * and every error knows its column. Errors leave by an exception of our
   * own, which compile_formula() catches.
   */
  class Parser : private Scanner
  {
  public:
    Parser(const std::string &text, const Constants &constants,
           const bool with_variables)
        : Scanner(text, constants), with_variables_(with_variables)
    {
    }

    Part parse()
    {
      Part part = condition();
      if (peek() != '\0')
        fail_unexpected();
      return part;
    }

    bool uses_variables() const { return uses_variables_; }
    bool uses_time() const { return uses_time_; }
    bool uses_position() const { return uses_position_; }
    /** Cell data that occurred in the formula, whose whole is @p part. */
    FormulaFields fields(const Part &part) const
    {
      FormulaFields result = fields_;
      result.is_condition = part.is_condition;
      return result;
    }

  private:
    const bool with_variables_;
    unsigned int depth_ = 0;
    bool uses_variables_ = false, uses_time_ = false, uses_position_ = false;
    FormulaFields fields_;

    /// brackets in brackets, conditions in conditions, powers of powers
    static constexpr unsigned int deepest = 200;
    [[noreturn]] void fail_too_deep() const
    {
      fail(at_, at_ + 1,
           "the formula is nested more than 200 times, too deeply",
           "name inner parts in section Constants");
    }

    // --- grammar, weakest binding first

    Part condition();
    Part disjunction();
    Part conjunction();
    Part comparison();
    Part sum();
    Part product();
    Part sign();
    Part factor();
    Part operand();
    Part bracket();
    Part name();
    Part call(const Function &function, std::size_t begin);
    Part cell_data(const Constant &data, std::size_t begin, std::size_t end);

    // --- combining

    Part combine(const Part &a, const std::string &operation, const Part &b,
                 const Dimension &dimension,
                 const bool is_condition = false) const
    {
      return {"(" + a.translated + operation + b.translated + ")", dimension,
              a.begin, b.end, is_condition};
    }

    void demand_alike(const Part &a, const Part &b,
                      const std::string &verb) const;
    void demand_plain(const Part &a, const std::string &what) const;
    Dimension result_of(const Function &function,
                        const std::vector<Part> &arguments) const;
    Dimension raised(const Part &base, const Part &exponent) const;
  };
} // namespace nsfd::formula
