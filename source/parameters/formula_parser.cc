#include "formula_parser.h"

#include "input_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace nsfd::formula
{
  Part Parser::condition()
  {
    if (++depth_ > deepest)
      fail_too_deep();
    Part result = disjunction();
    if (accept("?")) {
      const Part a = condition();
      if (!accept(":"))
        fail_unexpected();
      const Part b = condition();
      demand_alike(a, b, "chosen from");
      result = {fmt::format("if({},{},{})", result.translated, a.translated,
                            b.translated),
                alike(a.dimension, b.dimension), result.begin, b.end};
    }
    --depth_;
    return result;
  }

  Part Parser::disjunction()
  {
    Part result = conjunction();
    while (accept("||"))
      result = combine(result, "||", conjunction(), pure_number, true);
    return result;
  }

  Part Parser::conjunction()
  {
    Part result = comparison();
    while (accept("&&"))
      result = combine(result, "&&", comparison(), pure_number, true);
    return result;
  }

  Part Parser::comparison()
  {
    const auto accept_comparison = [this]() -> std::string {
      for (const char *token : {"<=", ">=", "==", "!=", "<", ">"})
        if (accept(token))
          return token;
      return "";
    };

    Part left = sum();
    const std::string operation = accept_comparison();
    if (operation.empty())
      return left;
    const Part right = sum();
    demand_alike(left, right, "compared with");
    peek();
    const std::size_t second = at_;
    if (!accept_comparison().empty())
      fail(second, at_, "comparisons cannot be chained",
           "write for example: 0 < x && x < 1");
    return combine(left, operation, right, pure_number, true);
  }

  Part Parser::sum()
  {
    Part result = product();
    for (;;) {
      const char operation = peek();
      if (operation != '+' && operation != '-')
        return result;
      ++at_;
      const Part right = product();
      demand_alike(result, right,
                   operation == '+' ? "added to" : "subtracted from");
      result = combine(result, std::string(1, operation), right,
                       alike(result.dimension, right.dimension));
    }
  }

  Part Parser::product()
  {
    Part result = sign();
    for (;;) {
      const char operation = peek();
      if (operation != '*' && operation != '/')
        return result;
      ++at_;
      const Part right = sign();
      Dimension dimension = right.dimension;
      if (operation == '/')
        dimension.unit = power(dimension.unit, -1);
      result = combine(result, std::string(1, operation), right,
                       times(result.dimension, dimension));
    }
  }

  Part Parser::sign()
  {
    peek();
    const std::size_t begin = at_;
    if (text_.compare(at_, 2, "!=") != 0 && accept("!")) {
      const Part part = factor();
      return {"(" + part.translated + "==0)", pure_number, begin, part.end,
              true};
    }
    unsigned int n_minus = 0;
    while (peek() == '-' || peek() == '+')
      n_minus += text_[at_++] == '-';
    Part part = factor();
    if (n_minus % 2 == 1) {
      part.translated = "(-" + part.translated + ")";
      part.is_condition = false;
    }
    part.begin = begin;
    return part;
  }

  Part Parser::factor()
  {
    const Part base = operand();
    if (!accept("^"))
      return base;
    if (++depth_ > deepest)
      fail_too_deep();
    const Part exponent = sign();
    --depth_;
    return combine(base, "^", exponent, raised(base, exponent));
  }

  Part Parser::operand()
  {
    const char c = peek();
    if (c == '(')
      return bracket();
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.')
      return number();
    if (end_of_name(at_) > at_)
      return name();
    if (c == ')' || c == '\0' || c == ',')
      fail(at_, at_ + 1,
           at_ >= text_.size() ? "the formula ends too early"
                               : fmt::format("a value is missing before "
                                             "`{}`",
                                             c));
    fail_unexpected();
  }

  Part Parser::bracket()
  {
    const std::size_t begin = at_++;
    Part result = condition();
    if (peek() == '\0')
      fail(begin, begin + 1, "this bracket is not closed", "add a `)`");
    if (!accept(")"))
      fail_unexpected();
    result.begin = begin;
    result.end = last_end_;
    return result;
  }

  Part Parser::name()
  {
    const std::size_t begin = at_, end = end_of_name(at_);
    const std::string name = text_.substr(begin, end - begin);
    at_ = last_end_ = end;

    if (const Function *function = find_function(name))
      return call(*function, begin);
    for (const auto &fixed : fixed_names())
      if (name == fixed.first)
        return {fmt::format("{:.17g}", fixed.second), pure_number, begin, end};
    for (const auto &variable : formula_variables())
      if (name == variable.first) {
        if (!with_variables_)
          fail(
              begin, end,
              fmt::format("`{}` cannot stand here: a number is expected", name),
              "write a number, or constants and functions of them");
        uses_variables_ = true;
        (name == "t" ? uses_time_ : uses_position_) = true;
        return {name, {Certainty::natural, variable.second}, begin, end};
      }
    const auto constant = constants_.find(name);
    if (constant != constants_.end()) {
      const Constant &c = constant->second;
      if (c.fields)
        return cell_data(c, begin, end);
      return {fmt::format("({:.17g})", c.value),
              {c.bare    ? Certainty::unknown
               : c.mixed ? Certainty::natural
                         : Certainty::stated,
               c.unit},
              begin,
              end};
    }
    if (name == "nan" || name == "inf" || name == "NaN" || name == "Inf" ||
        name == "infinity")
      fail(begin, end, fmt::format("`{}` is not a finite number", name));

    std::vector<std::string> known = formula_words(with_variables_);
    for (const auto &entry : constants_)
      known.push_back(entry.first);
    std::string otherwise =
        with_variables_ ? "known are x, y, z, t, pi, functions, the entries of "
                          "section Constants and cell data of the mesh"
                        : "a number is expected, or an entry of section "
                          "Constants";
    if (name == "and" || name == "or" || name == "not")
      otherwise = "write && || ! for and, or, not";
    if (find_unit(name))
      fail(begin, end, fmt::format("the unit `{}` has no number", name),
           "a unit stands after its number: 5 " + name + ", 2 1/s");
    fail(begin, end, fmt::format("`{}` is not known", name),
         did_you_mean(name, known, otherwise));
  }

  Part Parser::cell_data(const Constant &data, const std::size_t begin,
                         const std::size_t end)
  {
    const std::string name = text_.substr(begin, end - begin);
    if (!data.refusal.empty())
      fail(begin, end, fmt::format("`{}`: {}", name, data.refusal));
    if (!with_variables_)
      fail(begin, end,
           fmt::format("`{}` cannot stand here: a number is expected, and cell "
                       "data differ from place to place",
                       name),
           "write a number, or constants and functions of them");
    uses_variables_ = uses_position_ = true;
    fields_.source = data.fields;
    auto &used = fields_.used;
    const auto found = std::find(used.begin(), used.end(), data.field);
    const auto number = found - used.begin();
    if (found == used.end())
      used.push_back(data.field);
    return {fmt::format("cell_value_{}", number),
            {Certainty::unknown, units::none},
            begin,
            end};
  }

  Part Parser::call(const Function &function, const std::size_t begin)
  {
    if (peek() != '(')
      fail(begin, last_end_,
           fmt::format("the function `{}` needs its arguments", function.name),
           fmt::format("write for example: {}(...)", function.name));
    const std::size_t open = at_++;
    std::vector<Part> arguments;
    do
      arguments.push_back(condition());
    while (accept(","));
    if (peek() == '\0')
      fail(open, open + 1, "this bracket is not closed", "add a `)`");
    if (!accept(")"))
      fail_unexpected();
    if (arguments.size() < function.least || arguments.size() > function.most)
      fail(begin, at_,
           fmt::format("`{}` takes {} argument{}, here are {}", function.name,
                       function.least, function.least == 1 ? "" : "s",
                       arguments.size()));

    std::string translated = std::string(function.name) + "(";
    for (const Part &argument : arguments)
      translated +=
          (&argument == &arguments.front() ? "" : ",") + argument.translated;
    return {translated + ")", result_of(function, arguments), begin, at_};
  }

  Dimension Parser::result_of(const Function &function,
                              const std::vector<Part> &arguments) const
  {
    const Part &first = arguments.front();
    Dimension result;
    switch (function.rule) {
    case Rule::plain:
      demand_plain(first, fmt::format("the argument of {}", function.name));
      return pure_number;
    case Rule::keeps:
    case Rule::compares:
      result = first.dimension;
      for (const Part &argument : arguments) {
        demand_alike(first, argument, "put together with");
        result = alike(result, argument.dimension);
      }
      return function.rule == Rule::keeps ? result : pure_number;
    case Rule::selects:
      demand_alike(arguments[1], arguments[2], "chosen from");
      return alike(arguments[1].dimension, arguments[2].dimension);
    case Rule::power:
      return raised(first, arguments[1]);
    case Rule::root: {
      const Unit u = first.dimension.unit;
      if (u.kilogram % 2 != 0 || u.metre % 2 != 0 || u.second % 2 != 0)
        return {Certainty::unknown, units::none};
      return {first.dimension.certainty,
              {u.kilogram / 2, u.metre / 2, u.second / 2}};
    }
    case Rule::drops:
      break;
    }
    return pure_number;
  }

  Dimension Parser::raised(const Part &base, const Part &exponent) const
  {
    demand_plain(exponent, "an exponent");
    if (base.dimension.certainty == Certainty::pure)
      return pure_number;
    const std::string digits = written(exponent);
    const bool is_digit = digits.size() == 1 && std::isdigit(digits[0]);
    if (base.dimension.certainty == Certainty::any)
      return {};
    if (base.dimension.certainty == Certainty::unknown || !is_digit)
      return {Certainty::unknown, units::none};
    return {base.dimension.certainty,
            power(base.dimension.unit, digits[0] - '0')};
  }

  void Parser::demand_alike(const Part &a, const Part &b,
                            const std::string &verb) const
  {
    if (conflict(a.dimension, b.dimension))
      fail(a.begin, b.end,
           fmt::format("`{}` is {} and cannot be {} `{}`, which is {}",
                       written(b), describe(b.dimension.unit), verb, written(a),
                       describe(a.dimension.unit)),
           "both must have the same unit");
  }

  void Parser::demand_plain(const Part &a, const std::string &what) const
  {
    if (a.dimension.certainty == Certainty::stated &&
        a.dimension.unit != units::none)
      fail(a.begin, a.end,
           fmt::format("`{}` is {}; {} must be a plain number", written(a),
                       describe(a.dimension.unit), what),
           "divide by a value of the same unit");
  }
} // namespace nsfd::formula
