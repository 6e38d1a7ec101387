#include "formula_scanner.h"

#include "input_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace nsfd::formula
{
  void Scanner::fail_unexpected() const
  {
    if (at_ >= text_.size())
      fail(text_.size(), text_.size() + 1, "the formula ends too early",
           "something is missing at its end");
    const char c = text_[at_];
    const std::size_t name_end = end_of_name(at_);
    const std::string token =
        text_.substr(at_, std::max<std::size_t>(1, name_end - at_));
    std::string advice = "an operator is missing before it, or it is one "
                         "too many";
    if (c == '=')
      advice = "write == to compare";
    else if (c == '&' || token == "and")
      advice = "write && for `and`";
    else if (c == '|' || token == "or")
      advice = "write || for `or`";
    else if (c == ',')
      advice = "one value is expected here; decimals are written with a "
               "point";
    fail(at_, at_ + token.size(),
         fmt::format("`{}` is not expected here", token), advice);
  }

  Part Scanner::number()
  {
    const std::size_t begin = at_;
    const auto skip_digits = [this] {
      const std::size_t first = at_;
      while (at_ < text_.size() &&
             std::isdigit(static_cast<unsigned char>(text_[at_])))
        ++at_;
      return at_ - first;
    };
    std::size_t n_digits = skip_digits();
    if (at_ < text_.size() && text_[at_] == '.') {
      ++at_;
      n_digits += skip_digits();
    }
    if (n_digits == 0)
      fail(begin, at_, "`.` is not a number");
    const std::size_t mantissa_end = at_;
    if (at_ < text_.size() && (text_[at_] == 'e' || text_[at_] == 'E')) {
      ++at_;
      if (at_ < text_.size() && (text_[at_] == '+' || text_[at_] == '-'))
        ++at_;
      if (skip_digits() == 0)
        at_ = mantissa_end; // not an exponent: a name follows
    }
    const std::string digits = text_.substr(begin, at_ - begin);
    const std::size_t digits_end = at_;

    const UnitScale scale = unit_suffix();
    const std::size_t end = last_end_ = std::max(last_end_, digits_end);
    const std::optional<double> value = scaled_number(digits, scale);
    if (!value)
      fail(begin, end,
           fmt::format("`{}` is too large or too small for a number",
                       text_.substr(begin, end - begin)));
    Dimension dimension;
    if (end > digits_end)
      dimension = {Certainty::stated, scale.unit};
    return {fmt::format("{:.17g}", *value), dimension, begin, end};
  }

  void Scanner::fail_no_unit(const std::size_t begin,
                             const std::string &word) const
  {
    const std::size_t end = begin + word.size();
    if (constants_.count(word) != 0 || is_formula_word(word))
      fail(begin, end, fmt::format("an operator is missing before `{}`", word),
           "write for example: 2 * " + word);
    fail(begin, end, fmt::format("`{}` is not a unit", word),
         did_you_mean(
             word, unit_symbols(),
             "units are m, s, g, Pa, N, J, Hz, min, h with the "
             "prefixes f p n u m c k M G T, and their products: J/m^2"));
  }

  /** What follows a number: `J/m^2`, `J/(kg K)`, `1/s`, or nothing. */
  UnitScale Scanner::unit_suffix()
  {
    peek();
    // the unit `1/s` after its number
    const bool is_inverse = text_.compare(at_, 2, "1/") == 0;
    if (is_inverse)
      ++at_;
    else if (end_of_name(at_) == at_)
      return {};

    UnitScale result;
    bool is_complete = !is_inverse;
    if (!is_inverse) {
      const std::size_t begin = at_;
      const auto first = unit_factor();
      if (!first) {
        const std::string word =
            text_.substr(begin, end_of_name(begin) - begin);
        if (word == "and" || word == "or")
          fail_unexpected();
        fail_no_unit(begin, word);
      }
      result = *first;
    }

    for (;;) {
      const std::size_t before = at_;
      const char operation = peek();
      if (operation != '*' && operation != '/') {
        at_ = before;
        return result;
      }
      ++at_;
      const auto next =
          operation == '/' && peek() == '(' ? unit_bracket() : unit_factor();
      if (!next && !is_complete)
        fail(before, before + 1, "a unit is missing after `1/`");
      if (!next) {
        at_ = before;
        return result;
      }
      is_complete = true;
      result = result * (operation == '/' ? power(*next, -1) : *next);
    }
  }

  /** `(kg K)`, `(m^2*K)` after a `/`; nothing is consumed if anything but units
      stands in the bracket. */
  std::optional<UnitScale> Scanner::unit_bracket()
  {
    const std::size_t before = at_, end = last_end_;
    accept("(");
    UnitScale product;
    for (;;) {
      peek();
      if (constants_.count(text_.substr(at_, end_of_name(at_) - at_)) != 0)
        break;
      const auto next = unit_factor();
      if (!next)
        break;
      product = product * *next;
      if (accept(")"))
        return product;
      accept("*");
    }
    at_ = before;
    last_end_ = end;
    return {};
  }

  /** `um^2`; nothing is consumed if no unit stands here. */
  std::optional<UnitScale> Scanner::unit_factor()
  {
    const std::size_t before = at_;
    peek();
    const std::size_t begin = at_, end = end_of_name(begin);
    const std::string symbol = text_.substr(begin, end - begin);
    const auto unit = find_unit(symbol);
    at_ = end;
    if (!unit || peek() == '(') { // min( is a function
      at_ = before;
      return {};
    }
    at_ = end;
    if (constants_.count(symbol) != 0)
      fail(begin, end,
           fmt::format("`{}` is a unit and one of the constants", symbol),
           "give the constant another name, or put the number before it "
           "in brackets");
    last_end_ = end;
    return power(*unit, unit_exponent());
  }

  /** `^-2` after a unit; 1 if there is none. */
  int Scanner::unit_exponent()
  {
    const std::size_t before = at_;
    if (peek() != '^') {
      at_ = before;
      return 1;
    }
    ++at_;
    const bool negative = peek() == '-';
    if (negative)
      ++at_;
    if (!std::isdigit(static_cast<unsigned char>(peek())))
      fail(before, at_ + 1, "the exponent of a unit must be a whole number",
           "write for example: kg/m^3");
    const int digit = text_[at_++] - '0';
    const bool goes_on =
        at_ < text_.size() &&
        (std::isdigit(static_cast<unsigned char>(text_[at_])) ||
         text_[at_] == '.');
    if (goes_on)
      fail(before, at_ + 1,
           "the exponent of a unit must be a whole number "
           "of one digit");
    last_end_ = at_;
    return negative ? -digit : digit;
  }
} // namespace nsfd::formula
