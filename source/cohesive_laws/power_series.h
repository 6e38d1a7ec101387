#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * A smooth function on [0, 1] as a Chebyshev series, hence with its
   * derivative. Coefficients at round-off are dropped: polynomials stay
   * polynomials.
   */
  class Series
  {
  public:
    Series() = default;

    /** @throws std::runtime_error if the function is not smooth. */
    template <typename Function>
    static Series of(const Function &f)
    {
      const unsigned int n = 64;
      std::vector<double> value(n), c(n, 0.);
      double size = 0.;
      for (unsigned int j = 0; j < n; ++j) {
        value[j] = f(0.5 * (1. + std::cos(M_PI * (j + 0.5) / n)));
        if (!std::isfinite(value[j]))
          throw std::runtime_error("is not finite between 0 and 1");
        size = std::max(size, std::abs(value[j]));
      }
      for (unsigned int k = 0; k < n; ++k)
        for (unsigned int j = 0; j < n; ++j)
          c[k] += (k == 0 ? 1. : 2.) / n * value[j] *
                  std::cos(M_PI * k * (j + 0.5) / n);
      for (unsigned int k = n - n / 4; k < n; ++k)
        if (std::abs(c[k]) > 1e-10 * size)
          throw std::runtime_error("is not smooth between 0 and 1");
      while (c.size() > 1 && std::abs(c.back()) <= 1e-13 * size)
        c.pop_back();
      return Series(c);
    }

    double operator()(const double x) const
    {
      const double s = 2. * x - 1.;
      double b1 = 0., b2 = 0.;
      for (std::size_t k = c_.size(); k-- > 1;) {
        const double b = c_[k] + 2. * s * b1 - b2;
        b2 = b1;
        b1 = b;
      }
      return c_[0] + s * b1 - b2;
    }

    Series derivative() const
    {
      const std::size_t n = c_.size();
      std::vector<double> d(n + 1, 0.);
      for (std::size_t k = n - 1; k > 0; --k)
        d[k - 1] = (k + 1 < n ? d[k + 1] : 0.) + 4. * double(k) * c_[k];
      d[0] /= 2.;
      d.resize(std::max<std::size_t>(1, n - 1));
      return Series(d);
    }

  private:
    explicit Series(std::vector<double> c) : c_(std::move(c)) {}
    std::vector<double> c_{0.};
  };

  /**
   * A function of x on [0, 1] that begins at 0 like a power of x, x^k s(x)
   * with a smooth s: accurate relative to itself next to 0.
   */
  class PowerSeries
  {
  public:
    PowerSeries() = default;

    template <typename Function>
    static PowerSeries of(const Function &f)
    {
      PowerSeries result;
      const double ratio = f(1e-7) / f(1e-8);
      if (!(ratio > 0.) || !std::isfinite(ratio))
        throw std::runtime_error("does not begin like a power");
      const double power = std::log10(ratio);
      result.power_ = std::abs(power - std::round(power)) < 1e-5
                          ? std::round(power)
                          : std::round(power * 1e4) / 1e4;
      result.s_ = Series::of(
          [&](const double x) { return f(x) / std::pow(x, result.power_); });
      result.ds_ = result.s_.derivative();
      result.dds_ = result.ds_.derivative();
      return result;
    }

    double value(const double x) const { return std::pow(x, power_) * s_(x); }
    double first(const double x) const
    {
      return term(x, 1.) * s_(x) + std::pow(x, power_) * ds_(x);
    }
    double second(const double x) const
    {
      return term(x, 2.) * s_(x) + 2. * term(x, 1.) * ds_(x) +
             std::pow(x, power_) * dds_(x);
    }

  private:
    double power_ = 1.;
    Series s_, ds_, dds_;

    /** d^n (x^k) / dx^n, n = 1 or 2; 0 where a factor vanishes. */
    double term(const double x, const double n) const
    {
      const double factor = n == 1. ? power_ : power_ * (power_ - 1.);
      return factor == 0. ? 0. : factor * std::pow(x, power_ - n);
    }
  };
} // namespace nsfd
