#pragma once

#include <functional>
#include <memory>
#include <string>

namespace nsfd
{
  /**
   * A scalar function of position and time, as written in a parameter file:
   * `abs(x - 5 um) < 1 nm`, `2 m/s * sin(3 * t)`. Numbers may carry unit
   * suffixes; names of the section `Constants` may be used. Conditions are
   * true where the value is not zero. Immutable once built, so that copies
   * share the compiled formula. One thread per rank evaluates it.
   */
  class Expression
  {
  public:
    /** The constant 0. */
    Expression();

    /** A constant, in SI units or the bare units of the scene. */
    Expression(double constant);

    using Function = std::function<double(double, double, double, double)>;

    /** A function of x, y, z, t, such as a part of an exact solution. */
    Expression(Function function, const std::string &text,
               bool depends_on_time);

    /** Value at (x, y, z) and time t; z is 0 in two dimensions. */
    double operator()(double x, double y, double z, double t = 0.) const;

    /** Value at the point @p p of `dim` coordinates. */
    template <typename Point>
    double at(const Point &p, double t = 0.) const
    {
      return (*this)(p[0], p[1], Point::dimension > 2 ? p[2] : 0., t);
    }

    bool depends_on_time() const;

    /** Of a formula: x, y or z occurs. */
    bool depends_on_position() const;
    bool is_constant() const;

    /** True if it is the constant 0. */
    bool is_zero() const;

    /** The text as the user wrote it (units included). */
    const std::string &text() const;

    struct Compiled;

    /** Used by the reader that compiles a formula. */
    explicit Expression(std::shared_ptr<const Compiled> compiled);

  private:
    std::shared_ptr<const Compiled> compiled_;
  };
} // namespace nsfd
