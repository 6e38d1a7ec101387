#include "nsfd/parameters/expression.h"

#include "bad_values.h"
#include "formula.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace nsfd
{
  /**
   * A number, a function, or a parser with its variables. muParser keeps its
   * byte code and stack inside, hence `mutable`: evaluation is not for several
   * threads.
   */
  struct Expression::Compiled {
    std::string text;
    double constant = 0.;
    bool depends_on_time = false, depends_on_position = false;
    mutable std::unique_ptr<mu::Parser> parser; ///< null: not a formula
    Function function;                          ///< empty: not one either
    mutable std::string name; ///< empty: no formula of the input
    mutable double x = 0., y = 0., z = 0., t = 0.;
    FormulaFields fields; ///< cell data of the place
    mutable std::vector<double> cell_values;
    mutable std::vector<std::size_t> cells;

    double of_cells() const;
  };

  /**
   * In one cell it is the value of the formula there. Where cells meet, as on a
   * face, it is the mean of their values; a condition holds if it holds in all
   * of them. Not a number outside of the mesh, nor a condition where one of
   * its data is none: it would be false without a word.
   */
  double Expression::Compiled::of_cells() const
  {
    fields.source->find(x, y, z, cells);
    double sum = 0.;
    bool holds = true, is_known = !cells.empty();
    for (const std::size_t cell : cells) {
      for (std::size_t k = 0; k < fields.used.size(); ++k) {
        cell_values[k] = fields.source->value(fields.used[k], cell);
        if (fields.is_condition && std::isnan(cell_values[k]))
          is_known = false;
      }
      const double value = parser->Eval();
      sum += value;
      holds = holds && value != 0.;
    }
    if (!is_known)
      return std::numeric_limits<double>::quiet_NaN();
    return fields.is_condition ? double(holds) : sum / double(cells.size());
  }

  namespace
  {
    double select(const double condition, const double a, const double b)
    {
      return condition != 0. ? a : b;
    }

    double heaviside(const double x) { return x < 0. ? 0. : 1.; }

    /**
     * A number in [0, 1) that looks random and depends on the arguments alone,
     * on every machine and number of ranks: a hash of their bits (finaliser of
     * splitmix64, Steele, Lea and Flood 2014). For whole numbers such as a
     * seed and the indices of a face: arguments a rounding error apart give
     * unlike results.
     */
    double random(const double *arguments, const int count)
    {
      std::uint64_t hash = 0;
      for (int k = 0; k < count; ++k) {
        const double value = arguments[k] + 0.; // no -0
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        std::uint64_t z = (hash ^ bits) + 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        hash = z ^ (z >> 31);
      }
      return double(hash >> 11) * 0x1p-53;
    }

    /** Of this rank, one for each formula. */
    struct BadValue {
      const Expression::Compiled *formula;
      std::string text;
    };

    std::vector<BadValue> &bad_values()
    {
      static std::vector<BadValue> values;
      return values;
    }

    void note_bad_value(const Expression::Compiled &formula, const double value,
                        const std::array<double, 4> &at)
    {
      constexpr std::size_t most = 20;
      std::vector<BadValue> &known = bad_values();
      const bool is_known =
          std::any_of(known.begin(), known.end(), [&](const BadValue &bad) {
            return bad.formula == &formula;
          });
      if (is_known || known.size() == most)
        return;
      known.push_back(
          {&formula,
           fmt::format("{} = {} is {} at ({:.6g}, {:.6g}, {:.6g}), t = {:.6g}",
                       formula.name, formula.text,
                       std::isnan(value) ? "not a number"
                       : value > 0.      ? "infinite"
                                         : "minus infinite",
                       at[0], at[1], at[2], at[3])});
    }

    /** Functions that muParser does not bring along. */
    void add_functions(mu::Parser &parser)
    {
      parser.DefineFun("if", select);
      parser.DefineFun("heaviside", heaviside);
      parser.DefineFun("pow",
                       static_cast<double (*)(double, double)>(std::pow));
      parser.DefineFun("mod",
                       static_cast<double (*)(double, double)>(std::fmod));
      parser.DefineFun("floor", static_cast<double (*)(double)>(std::floor));
      parser.DefineFun("ceil", static_cast<double (*)(double)>(std::ceil));
      parser.DefineFun("erf", static_cast<double (*)(double)>(std::erf));
      parser.DefineFun("erfc", static_cast<double (*)(double)>(std::erfc));
      parser.DefineFun("random", random);
    }
  } // namespace

  std::shared_ptr<const Expression::Compiled>
  compile_constant(const double value, const std::string &text)
  {
    auto compiled = std::make_shared<Expression::Compiled>();
    compiled->text = text;
    compiled->constant = value;
    return compiled;
  }

  std::shared_ptr<const Expression::Compiled>
  compile_translated(const std::string &translated, const std::string &text,
                     const bool depends_on_time, const bool depends_on_position,
                     const FormulaFields &fields)
  {
    auto compiled = std::make_shared<Expression::Compiled>();
    compiled->text = text;
    compiled->depends_on_time = depends_on_time;
    compiled->depends_on_position = depends_on_position;
    compiled->parser = std::make_unique<mu::Parser>();
    mu::Parser &parser = *compiled->parser;
    add_functions(parser);
    parser.DefineVar("x", &compiled->x);
    parser.DefineVar("y", &compiled->y);
    parser.DefineVar("z", &compiled->z);
    parser.DefineVar("t", &compiled->t);
    compiled->fields = fields;
    compiled->cell_values.assign(fields.used.size(), 0.4);
    for (std::size_t k = 0; k < fields.used.size(); ++k)
      parser.DefineVar(fmt::format("cell_value_{}", k),
                       &compiled->cell_values[k]);
    // constants are folded already; the other rewrites gain little
    parser.EnableOptimizer(false);
    parser.SetExpr(translated);

    // the byte code is built by the first evaluation: let it fail here
    compiled->x = 0.1;
    compiled->y = 0.2;
    compiled->z = 0.3;
    parser.Eval();
    return compiled;
  }

  Expression::Expression() : Expression(0.) {}

  Expression::Expression(const double constant)
      : compiled_(compile_constant(constant, fmt::format("{}", constant)))
  {
  }

  Expression::Expression(std::shared_ptr<const Compiled> compiled)
      : compiled_(std::move(compiled))
  {
  }

  Expression::Expression(Function function, const std::string &text,
                         const bool depends_on_time)
  {
    auto compiled = std::make_shared<Compiled>();
    compiled->text = text;
    compiled->depends_on_time = depends_on_time;
    compiled->depends_on_position = true;
    compiled->function = std::move(function);
    compiled_ = std::move(compiled);
  }

  double Expression::operator()(const double x, const double y, const double z,
                                const double t) const
  {
    if (compiled_->function)
      return compiled_->function(x, y, z, t);
    if (!compiled_->parser)
      return compiled_->constant;
    compiled_->x = x;
    compiled_->y = y;
    compiled_->z = z;
    compiled_->t = t;
    const double value = compiled_->fields.source ? compiled_->of_cells()
                                                  : compiled_->parser->Eval();
    if (!std::isfinite(value) && !compiled_->name.empty())
      note_bad_value(*compiled_, value, {{x, y, z, t}});
    return value;
  }

  double evaluate_constant(const Expression::Compiled &formula)
  {
    return formula.parser ? formula.parser->Eval() : formula.constant;
  }

  void set_name(const Expression::Compiled &formula, const std::string &name)
  {
    formula.name = name;
  }

  std::vector<std::string> take_bad_values()
  {
    std::vector<std::string> texts;
    for (const BadValue &bad : bad_values())
      texts.push_back(bad.text);
    bad_values().clear();
    return texts;
  }

  bool has_bad_values() { return !bad_values().empty(); }

  bool Expression::depends_on_time() const
  {
    return compiled_->depends_on_time;
  }

  bool Expression::depends_on_position() const
  {
    return compiled_->depends_on_position;
  }

  bool Expression::is_constant() const
  {
    return !compiled_->parser && !compiled_->function;
  }

  bool Expression::is_zero() const
  {
    return is_constant() && compiled_->constant == 0.;
  }

  const std::string &Expression::text() const { return compiled_->text; }
} // namespace nsfd
