#pragma once

#include "formula.h"
#include "formula_words.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

namespace nsfd::formula
{
  /** A part of a formula: what muParser gets, and what it is. */
  struct Part {
    std::string translated;
    Dimension dimension;
    std::size_t begin = 0, end = 0; ///< in the text of the user
    bool is_condition = false;      ///< true or false
  };

  /**
   * The text of a formula, where one is in it, and what stands there:
   * characters, names, numbers with their units.
   */
  class Scanner
  {
  public:
    Scanner(const std::string &text, const Constants &constants)
        : text_(text), constants_(constants)
    {
    }

  protected:
    const std::string &text_;
    const Constants &constants_;
    std::size_t at_ = 0, last_end_ = 0;

    [[noreturn]] void fail(const std::size_t begin, const std::size_t end,
                           const std::string &message,
                           const std::string &advice = "") const
    {
      throw FormulaError{begin, std::max<std::size_t>(1, end - begin), message,
                         advice};
    }

    [[noreturn]] void fail_unexpected() const;

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

    std::string written(const Part &a) const
    {
      return text_.substr(a.begin, a.end - a.begin);
    }

    /** A number and its unit. */
    Part number();

  private:
    UnitScale unit_suffix();
    [[noreturn]] void fail_no_unit(std::size_t begin,
                                   const std::string &word) const;
    std::optional<UnitScale> unit_bracket();
    std::optional<UnitScale> unit_factor();
    int unit_exponent();
  };
} // namespace nsfd::formula
