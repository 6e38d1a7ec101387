#include "nonsmooth/solvers/lemke.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace test_lemke
{
  using Vector = std::vector<double>;

  /** Largest violation of Signorini's and Coulomb's laws, in units of |q|. */
  double violation(const Vector &W, const Vector &q, const Vector &mu,
                   const Vector &r)
  {
    const std::size_t n = q.size();
    double worst = 0.;
    for (std::size_t i = 0; i < mu.size(); ++i) {
      double u[2] = {q[2 * i], q[2 * i + 1]};
      for (std::size_t c = 0; c < 2; ++c)
        for (std::size_t j = 0; j < n; ++j)
          u[c] += W[(2 * i + c) * n + j] * r[j];
      const double r_N = r[2 * i], r_T = r[2 * i + 1];
      worst = std::max({worst, -u[0], -r_N, std::abs(r_T) - mu[i] * r_N,
                        std::abs(std::min(u[0], r_N)),
                        std::abs(u[1] * r_T + mu[i] * r_N * std::abs(u[1]))});
    }
    return worst;
  }

  // One contact: open, stick and slide by hand. W = I, mu = 1/2.
  TEST(Lemke, OneContact)
  {
    Vector r;
    ASSERT_TRUE(nsfd::solve_by_lemke({1, 0, 0, 1}, {1, 3}, {0.5}, 1, r));
    EXPECT_EQ(r, Vector({0., 0.}));
    ASSERT_TRUE(nsfd::solve_by_lemke({1, 0, 0, 1}, {-2, 0.5}, {0.5}, 1, r));
    EXPECT_NEAR(r[0], 2., 1e-14);
    EXPECT_NEAR(r[1], -0.5, 1e-14);
    ASSERT_TRUE(nsfd::solve_by_lemke({1, 0, 0, 1}, {-2, 3.}, {0.5}, 1, r));
    EXPECT_NEAR(r[0], 2., 1e-14);
    EXPECT_NEAR(r[1], -1., 1e-14);
  }

  // Two contacts of the same point twice: W is singular, the sum is given.
  TEST(Lemke, DependentRows)
  {
    const Vector W{1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1},
        q{-2, 3, -2, 3};
    Vector r;
    ASSERT_TRUE(nsfd::solve_by_lemke(W, q, {0.5, 0.5}, 1, r));
    EXPECT_NEAR(r[0] + r[2], 2., 1e-13);
    EXPECT_NEAR(r[1] + r[3], -1., 1e-13);
    EXPECT_LE(violation(W, q, {0.5, 0.5}, r), 1e-13);
  }

  // Thirty contacts on ten unknowns: W = A A^T has rank 10 of 60. Velocities
  // q = A v leave solutions; the laws hold to round-off.
  TEST(Lemke, RandomRankDeficient)
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> value(-1., 1.);
    const std::size_t m = 30, n = 2 * m, rank = 10;
    unsigned int solved = 0;
    for (int trial = 0; trial < 10; ++trial) {
      Vector A(n * rank), v(rank), q(n, 0.), W(n * n, 0.), mu(m, 0.3), r;
      for (double &x : A)
        x = value(random);
      for (double &x : v)
        x = value(random);
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < rank; ++k)
          q[i] += A[i * rank + k] * v[k];
        for (std::size_t j = 0; j < n; ++j)
          for (std::size_t k = 0; k < rank; ++k)
            W[i * n + j] += A[i * rank + k] * A[j * rank + k];
      }
      if (!nsfd::solve_by_lemke(W, q, mu, 1, r))
        continue;
      ++solved;
      EXPECT_LE(violation(W, q, mu, r), 1e-9) << trial;
    }
    EXPECT_GE(solved, 8u);
  }
} // namespace test_lemke
