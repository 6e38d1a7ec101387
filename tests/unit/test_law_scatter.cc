#include "law_formulas.h"

namespace law_formulas::test_law_scatter
{
  const ScatterOf both[] = {ScatterOf::strength, ScatterOf::toughness};

  TEST(Scatter, SameNumberDespiteRoundOff)
  {
    // grid and Gauss points, computed with different round-off
    const double gauss = 0.5 - std::sqrt(1. / 12.);
    for (const ScatterOf what : both) {
      for (const unsigned int n : {10u, 24u, 37u, 64u, 100u})
        for (unsigned int i = 0; i < n; ++i) {
          const std::array<double, 3> x{double(i) / n, (i + gauss) / n, 0.};
          const double value = scatter_number(what, 7, x);
          for (const double change : {-4e-16, 4e-16})
            EXPECT_EQ(
                scatter_number(what, 7,
                               {x[0] * (1. + change), x[1] + change, change}),
                value);
        }
      EXPECT_EQ(scatter_number(what, 7, {0., 0.5, 0.}),
                scatter_number(what, 7, {-0., 0.5, -0.}));
    }
  }

  TEST(Scatter, UniformAndIndependent)
  {
    const unsigned int n = 200;
    for (const ScatterOf what : both) {
      const ScatterOf other = what == ScatterOf::strength ? ScatterOf::toughness
                                                          : ScatterOf::strength;
      double sum = 0., square = 0., neighbours = 0., seeds = 0., others = 0.;
      double smallest = 2., largest = 0.;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j) {
          // in [-1, 1)
          const auto r = [&](const ScatterOf which, const unsigned int seed,
                             const double x, const double y) {
            return 2. * scatter_number(which, seed, {x / n, y / n, 0.25}) - 1.;
          };
          const double value = r(what, 1, i, j);
          smallest = std::min(smallest, value);
          largest = std::max(largest, value);
          sum += value;
          square += value * value;
          neighbours += value * (r(what, 1, i + 1, j) + r(what, 1, j, i));
          seeds += value * r(what, 2, i, j);
          others += value * r(other, 1, i, j);
        }
      const double count = n * n, deviation = 5. / std::sqrt(count);
      EXPECT_NEAR(sum / count, 0., deviation / std::sqrt(3.));
      EXPECT_NEAR(square / count, 1. / 3., 0.3 * deviation);
      EXPECT_NEAR(seeds / count, 0., deviation / 3.);
      EXPECT_NEAR(others / count, 0., deviation / 3.);
      // the diagonal i = j pairs a point with itself
      EXPECT_NEAR(neighbours / count, 1. / (3. * n), 2. * deviation / 3.);
      EXPECT_GE(smallest, -1.);
      EXPECT_LT(smallest, -0.999);
      EXPECT_LT(largest, 1.);
      EXPECT_GT(largest, 0.999);
    }
  }

  /** Largest distance of an empirical distribution from the exact one. */
  template <typename Distribution>
  double distance(std::vector<double> values, const Distribution &exact)
  {
    std::sort(values.begin(), values.end());
    const double n = values.size();
    double result = 0.;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double chance = exact(values[i]);
      result = std::max({result, chance - i / n, (i + 1.) / n - chance});
    }
    return result;
  }

  TEST(Scatter, FollowsItsDistribution)
  {
    // Kolmogorov and Smirnov: the distance exceeds 1.95 / sqrt(n) with a
    // chance of 1e-3; the numbers are fixed, so that this passes always or
    // never
    const unsigned int n = 100;
    std::vector<double> chances;
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        chances.push_back(scatter_number(ScatterOf::strength, 3,
                                         {double(i) / n, double(j) / n, 0.5}));
    const double bound = 1.95 / std::sqrt(double(chances.size()));
    const auto factors = [&](const Scatter &scatter) {
      std::vector<double> result;
      for (const double chance : chances)
        result.push_back(scatter.factor(chance));
      return result;
    };
    EXPECT_LT(distance(factors({Scatter::Kind::uniform, 0.2}),
                       [](const double x) { return (x - 0.8) / 0.4; }),
              bound);
    for (const double m : {1., 2., 5., 20.}) {
      const auto values = factors({Scatter::Kind::weibull, m});
      EXPECT_LT(distance(values,
                         [&](const double x) {
                           const double mean = std::tgamma(1. + 1. / m);
                           return 1. - std::exp(-std::pow(x * mean, m));
                         }),
                bound)
          << "modulus " << m;
      double sum = 0.;
      for (const double value : values)
        sum += value;
      // four deviations of a mean; a factor deviates by 1.3 / m or less
      EXPECT_NEAR(sum / values.size(), 1., 5. / (m * n)) << "modulus " << m;
    }
  }

  TEST(Scatter, FactorsOfTheExtremes)
  {
    EXPECT_EQ(Scatter{}.factor(0.3), 1.);
    EXPECT_EQ((Scatter{Scatter::Kind::uniform, 0.}.factor(0.3)), 1.);
    EXPECT_DOUBLE_EQ((Scatter{Scatter::Kind::uniform, 0.2}.factor(0.)), 0.8);
    for (const double m : {1., 3., 50.}) {
      const Scatter weibull{Scatter::Kind::weibull, m};
      // the median, ln(2)^(1/m) over the mean Gamma(1 + 1/m)
      EXPECT_DOUBLE_EQ(weibull.factor(0.5), std::pow(std::log(2.), 1. / m) /
                                                std::tgamma(1. + 1. / m));
      EXPECT_GT(weibull.factor(0.), 0.);
      EXPECT_GT(weibull.factor(0x1p-53), weibull.factor(0.));
      EXPECT_TRUE(std::isfinite(weibull.factor(1. - 0x1p-53)));
    }
  }
} // namespace law_formulas::test_law_scatter
