#pragma once

#include "formula.h"
#include "formula_words.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <vector>

namespace nsfd::formula
{
  /** A part of a formula: what muParser gets, and what it is. */
  struct Part {
    std::string translated;
    Dimension dimension;
    std::size_t begin = 0, end = 0; ///< in the text of the user
  };

  /**
   * Recursive descent over the text. Every operation is written out with
   * brackets, so that nothing hangs on muParser's own order of operations,
   * and every error knows its column. Errors leave by an exception of our
   * own, which compile_formula() catches.
   */
  class Parser
  {
  public:
    Parser(const std::string &text, const Constants &constants,
           const bool with_variables)
        : text_(text), constants_(constants), with_variables_(with_variables)
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

  private:
    const std::string &text_;
    const Constants &constants_;
    const bool with_variables_;
    std::size_t at_ = 0, last_end_ = 0;
    unsigned int depth_ = 0;
    bool uses_variables_ = false, uses_time_ = false, uses_position_ = false;

    [[noreturn]] void fail(const std::size_t begin, const std::size_t end,
                           const std::string &message,
                           const std::string &advice = "") const
    {
      throw FormulaError{begin, std::max<std::size_t>(1, end - begin), message,
                         advice};
    }

    [[noreturn]] void fail_unexpected() const;

    /// brackets in brackets, conditions in conditions, powers of powers
    static constexpr unsigned int deepest = 200;
    [[noreturn]] void fail_too_deep() const
    {
      fail(at_, at_ + 1,
           "the formula is nested more than 200 times, too deeply",
           "name inner parts in section Constants");
    }

    // --- characters

    char peek()
    {
      while (at_ < text_.size() &&
             std::isspace(static_cast<unsigned char>(text_[at_])))
        ++at_;
      return at_ < text_.size() ? text_[at_] : '\0';
    }

    bool accept(const std::string &token)
    {
      peek();
      if (text_.compare(at_, token.size(), token) != 0)
        return false;
      at_ += token.size();
      last_end_ = at_;
      return true;
    }

    /** The end of the name that begins at @p begin; micro is a letter. */
    std::size_t end_of_name(std::size_t begin) const
    {
      const auto is_letter = [](const char c) {
        return std::isalpha(static_cast<unsigned char>(c)) || c == '_' ||
               (c & 0x80) != 0;
      };
      if (begin >= text_.size() || !is_letter(text_[begin]))
        return begin;
      while (begin < text_.size() &&
             (is_letter(text_[begin]) ||
              std::isdigit(static_cast<unsigned char>(text_[begin]))))
        ++begin;
      return begin;
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
    Part number();
    Part name();
    Part call(const Function &function, std::size_t begin);

    UnitScale unit_suffix();
    [[noreturn]] void fail_no_unit(std::size_t begin,
                                   const std::string &word) const;
    std::optional<UnitScale> unit_factor();
    int unit_exponent();

    // --- combining

    Part combine(const Part &a, const std::string &operation, const Part &b,
                 const Dimension &dimension) const
    {
      return {"(" + a.translated + operation + b.translated + ")", dimension,
              a.begin, b.end};
    }

    void demand_alike(const Part &a, const Part &b,
                      const std::string &verb) const;
    void demand_plain(const Part &a, const std::string &what) const;
    std::string written(const Part &a) const
    {
      return text_.substr(a.begin, a.end - a.begin);
    }
    Dimension result_of(const Function &function,
                        const std::vector<Part> &arguments) const;
    Dimension raised(const Part &base, const Part &exponent) const;
  };
} // namespace nsfd::formula
