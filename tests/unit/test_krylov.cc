#include "linear_algebra/gmres.h"

#include "core/communicator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace nsfd
{
  namespace
  {
    using Vector = std::vector<double>;

    double plain_dot(const Vector &a, const Vector &b)
    {
      return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
    }

    void copy(const Vector &in, Vector &out) { out = in; }

    /** -x_{k-1} (1 + wind) + 2 x_k - x_{k+1} (1 - wind), ends held. */
    struct Line {
      double wind = 0.;

      void operator()(const Vector &x, Vector &y) const
      {
        y.resize(x.size());
        for (std::size_t k = 0; k < x.size(); ++k)
          y[k] = 2. * x[k] - (k > 0 ? (1. + wind) * x[k - 1] : 0.) -
                 (k + 1 < x.size() ? (1. - wind) * x[k + 1] : 0.);
      }
    };

    Vector some_values(const std::size_t n)
    {
      Vector x(n);
      for (std::size_t k = 0; k < n; ++k)
        x[k] = std::sin(1. + 7. * double(k));
      return x;
    }

    double distance(const Vector &a, const Vector &b)
    {
      double largest = 0.;
      for (std::size_t k = 0; k < a.size(); ++k)
        largest = std::max(largest, std::abs(a[k] - b[k]));
      return largest;
    }
  } // namespace

  // Steps from a residual to the solution: as many as there are eigenvalues.
  TEST(Krylov, ConjugateGradientsEndAfterOneStepPerEigenvalue)
  {
    const Vector diagonal{2., 3., 2., 3., 2., 7.}, exact = some_values(6);
    const auto product = [&](const Vector &x, Vector &y) {
      for (std::size_t k = 0; k < 6; ++k)
        y[k] = diagonal[k] * x[k];
    };
    krylov::CgVectors v{Vector(6), {}, {}, Vector(6)};
    product(exact, v.r);
    Vector x(6, 0.);
    const auto outcome = krylov::conjugate_gradients(product, copy, plain_dot,
                                                     {1e-13, 100}, v, x);
    EXPECT_EQ(outcome.iterations, 3u);
    EXPECT_TRUE(outcome.converged);
    EXPECT_LT(distance(x, exact), 1e-14);
  }

  TEST(Krylov, ConjugateGradientsGoOnFromAStartAndStopWhenAsked)
  {
    const Vector exact = some_values(40);
    Vector b, x = exact;
    Line()(exact, b);
    x[7] += 1.;
    krylov::CgVectors v;
    Line()(x, v.r);
    for (std::size_t k = 0; k < 40; ++k)
      v.r[k] = b[k] - v.r[k];
    const auto half = [](const Vector &r, Vector &z) {
      z = r;
      for (double &value : z)
        value /= 2.;
    };
    EXPECT_FALSE(
        krylov::conjugate_gradients(Line(), half, plain_dot, {1e-12, 3}, v, x)
            .converged);
    const auto outcome = krylov::conjugate_gradients(
        Line(), half, plain_dot, [&] { return plain_dot(v.r, v.r) < 1e-24; },
        {0., 1000}, v, x);
    EXPECT_TRUE(outcome.converged);
    EXPECT_LT(outcome.iterations, 60u);
    EXPECT_LT(distance(x, exact), 1e-9);
  }

  TEST(Krylov, ConjugateGradientsLeaveAnIndefiniteMatrix)
  {
    const auto product = [](const Vector &x, Vector &y) {
      y = {x[0], -2. * x[1]};
    };
    krylov::CgVectors v{{1., 1.}, {}, {}, {}};
    Vector x(2, 0.);
    const auto outcome = krylov::conjugate_gradients(product, copy, plain_dot,
                                                     {1e-10, 100}, v, x);
    EXPECT_FALSE(outcome.converged);
    EXPECT_EQ(outcome.iterations, 0u);
    EXPECT_EQ(x, Vector(2, 0.));
  }

  // Sums that do not depend on the order of their terms: the same unknowns in
  // another order give the same bits.
  TEST(Krylov, OrderedSumsMakeTheIterationsIndependentOfTheOrder)
  {
    const Communicator communicator(MPI_COMM_SELF);
    const std::size_t n = 257;
    Vector diagonal(n);
    for (std::size_t k = 0; k < n; ++k)
      diagonal[k] = 1. + double(k * k % 101);
    const Vector b = some_values(n);
    std::vector<std::size_t> order(n);
    for (std::size_t k = 0; k < n; ++k)
      order[k] = k * 100 % n;
    const auto solve = [&](const bool permuted, const bool ordered,
                           const bool by_gmres) {
      const auto at = [&](const std::size_t k) {
        return permuted ? order[k] : k;
      };
      const auto product = [&](const Vector &x, Vector &y) {
        y.resize(n);
        for (std::size_t k = 0; k < n; ++k)
          y[k] = diagonal[at(k)] * x[k];
      };
      const auto dot = [&](const Vector &x, const Vector &y) {
        return ordered ? communicator.dot(x.data(), y.data(), n)
                       : plain_dot(x, y);
      };
      krylov::CgVectors v;
      v.r.resize(n);
      for (std::size_t k = 0; k < n; ++k)
        v.r[k] = b[at(k)];
      Vector x(n, 0.);
      if (by_gmres) {
        x = v.r;
        krylov::gmres(product, copy, dot, {0., 10}, {}, x);
      } else
        krylov::conjugate_gradients(product, copy, dot, {0., 10}, v, x);
      Vector result(n);
      for (std::size_t k = 0; k < n; ++k)
        result[at(k)] = x[k];
      return result;
    };
    for (const bool by_gmres : {false, true}) {
      EXPECT_EQ(solve(false, true, by_gmres), solve(true, true, by_gmres));
      EXPECT_NE(solve(false, false, by_gmres), solve(true, false, by_gmres));
    }
  }

  TEST(Krylov, GmresSolvesAnUnsymmetricSystem)
  {
    const std::size_t n = 60;
    const Vector exact = some_values(n);
    for (const double wind : {0., 0.9, 3.})
      for (const bool flexible : {false, true})
        for (const unsigned int passes : {1u, 2u}) {
          Vector x;
          Line{wind}(exact, x);
          const auto outcome = krylov::gmres(
              Line{wind}, copy, plain_dot, {1e-12, 100}, {flexible, passes}, x);
          EXPECT_TRUE(outcome.converged) << wind;
          EXPECT_LE(outcome.iterations, n) << wind;
          EXPECT_LT(distance(x, exact), 1e-7) << wind;
        }
  }

  // A preconditioner that is another one every time: only what was multiplied
  // by A may come into the solution.
  TEST(Krylov, FlexibleGmresAllowsThePreconditionerToChange)
  {
    const std::size_t n = 30;
    const Vector exact = some_values(n);
    const auto solve = [&](const bool flexible) {
      unsigned int calls = 0;
      const auto precondition = [&](const Vector &in, Vector &out) {
        out = in;
        for (std::size_t k = 0; k < n; ++k)
          out[k] *= 1. + 0.5 * std::sin(double(k + 5 * calls));
        ++calls;
      };
      Vector x;
      Line{0.3}(exact, x);
      krylov::gmres(Line{0.3}, precondition, plain_dot, {1e-12, n},
                    {flexible, 2}, x);
      return distance(x, exact);
    };
    EXPECT_LT(solve(true), 1e-8);
    EXPECT_GT(solve(false), 1e-2);
  }

  TEST(Krylov, GmresOfNothingIsNothingAndOfNoNumberEnds)
  {
    Vector x(5, 0.);
    EXPECT_EQ(
        krylov::gmres(Line(), copy, plain_dot, {1e-10, 9}, {}, x).iterations,
        0u);
    EXPECT_EQ(x, Vector(5, 0.));
    const auto broken = [](const Vector &in, Vector &out) {
      out.assign(in.size(), std::numeric_limits<double>::quiet_NaN());
    };
    x.assign(5, 1.);
    const auto outcome =
        krylov::gmres(broken, copy, plain_dot, {1e-10, 9}, {}, x);
    EXPECT_FALSE(outcome.converged);
    EXPECT_EQ(outcome.iterations, 0u);
    EXPECT_EQ(x, Vector(5, 0.));
  }

  // A row 1e16 times as stiff as the others, whose part of the right-hand side
  // is as large: the plain norm ends at its round-off, that of the
  // preconditioner goes on to what the others ask for.
  TEST(Krylov, GmresInTheNormOfThePreconditionerSeesPastStiffRows)
  {
    const std::size_t n = 40, stiff = 7;
    const double stiffness = 1e16;
    const auto product = [&](const Vector &x, Vector &y) {
      Line{0.}(x, y);
      y[stiff] += stiffness * x[stiff];
      y[20] -= 1.5 * x[20]; // softens: indefinite
    };
    const auto precondition = [&](const Vector &r, Vector &z) {
      z = r;
      for (std::size_t k = 0; k < n; ++k)
        z[k] /= k == stiff ? stiffness : 2.;
    };
    struct Sums {
      double operator()(const Vector &a, const Vector &b) const
      {
        return plain_dot(a, b);
      }
      Vector operator()(const Vector &a, const std::vector<Vector> &v,
                        const unsigned int count) const
      {
        Vector all;
        for (unsigned int j = 0; j < count; ++j)
          all.push_back(plain_dot(a, v[j]));
        all.push_back(plain_dot(a, a));
        return all;
      }
    };
    Vector b(n, 1.), x, rest;
    b[stiff] = stiffness;
    const auto left = [&] {
      product(x, rest);
      double sum = 0.;
      for (std::size_t k = 0; k < n; ++k)
        if (k != stiff)
          sum += (b[k] - rest[k]) * (b[k] - rest[k]);
      return std::sqrt(sum);
    };
    x = b;
    const auto outcome = krylov::gmres_preconditioned(
        product, precondition, Sums(), {1e-13, 2 * n}, x);
    EXPECT_TRUE(outcome.converged);
    EXPECT_LE(outcome.iterations, n + 1);
    // its start is sqrt(stiffness) in that norm
    EXPECT_LT(left(), 1e-13 * 2. * std::sqrt(stiffness));
    x = b;
    krylov::gmres(product, precondition, Sums(), {1e-15, 2 * n}, {true, 2}, x);
    EXPECT_GT(left(), 1e-3);
  }

  TEST(Krylov, GmresInTheNormOfAPreconditionerThatIsNotPositiveEnds)
  {
    const auto negative = [](const Vector &in, Vector &out) {
      out = in;
      for (double &value : out)
        value = -value;
    };
    const auto sums = [](const Vector &a, const auto &b, auto... n) {
      if constexpr (sizeof...(n) == 0)
        return plain_dot(a, b);
      else
        return Vector{plain_dot(a, b[0]), plain_dot(a, a)};
    };
    Vector x(5, 1.);
    const auto outcome =
        krylov::gmres_preconditioned(Line(), negative, sums, {1e-10, 9}, x);
    EXPECT_FALSE(outcome.converged);
    EXPECT_EQ(outcome.iterations, 0u);
    EXPECT_EQ(x, Vector(5, 0.));
  }
} // namespace nsfd
