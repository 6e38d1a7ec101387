#include "small_meshes.h"

namespace small_meshes::test_sums
{
  // --- kernels

  TEST(BlockKernels, OneColumnAndEightAreTheSameBits)
  {
    for (unsigned int rows = 1; rows <= 40; ++rows)
      for (const unsigned int cols : {1u, 2u, 7u, 8u, 13u, 32u}) {
        Block A(rows, cols);
        Vector numbers = random_vector(std::size_t(rows) * cols, rows * cols);
        for (unsigned int r = 0; r < rows; ++r)
          for (unsigned int c = 0; c < cols; ++c)
            A(r, c) = numbers[r * cols + c] * std::pow(10., int(r + c) % 9 - 4);
        const Vector X = random_vector(std::size_t(cols) * lanes, 3 * rows);
        Vector Y(std::size_t(padded(rows)) * lanes);
        multiply_lanes(A.values.data(), rows, cols, X.data(), Y.data());
        for (unsigned int l = 0; l < lanes; ++l) {
          Vector x(cols), y(padded(rows));
          for (unsigned int c = 0; c < cols; ++c)
            x[c] = X[c * lanes + l];
          multiply_one(A.values.data(), rows, cols, x.data(), y.data());
          for (unsigned int r = 0; r < rows; ++r) {
            ASSERT_EQ(y[r], Y[r * lanes + l]);
            double plain = 0., size = 0.;
            for (unsigned int c = 0; c < cols; ++c) {
              plain += A(r, c) * x[c];
              size += std::abs(A(r, c) * x[c]);
            }
            ASSERT_NEAR(y[r], plain, 1e-15 * cols * size);
          }
        }
      }
  }

  TEST(BlockKernels, FactorAndGram)
  {
    // A = B^T B + 1, then L L^T = A and gram(L^{-1}) = A^{-1}
    const unsigned int n = 19;
    Block B(n, n);
    const Vector numbers = random_vector(n * n, 4);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        B(i, j) = numbers[i * n + j];
    Block A = gram(B);
    for (unsigned int i = 0; i < n; ++i)
      A(i, i) += 1.;
    Block one(n, n);
    for (unsigned int i = 0; i < n; ++i)
      one(i, i) = 1.;
    const Block L = cholesky(A), inverse = gram(forward_solve(L, one)),
                LLt = product(L, L.transposed()), AA = product(A, inverse);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j) {
        EXPECT_EQ(inverse(i, j), inverse(j, i));
        EXPECT_NEAR(LLt(i, j), A(i, j), 1e-13 * n);
        EXPECT_NEAR(AA(i, j), one(i, j), 1e-12)
            << "condition below 1e3, entries of A below 20";
      }
    A(7, 7) = -1.;
    EXPECT_THROW(cholesky(A), std::runtime_error);
  }

  // --- sums

  /** Terms of very different sizes and both signs. */
  Vector wild_terms(const std::size_t n, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1., 1.), exponent(-12., 3.);
    Vector x(n);
    for (double &value : x)
      value = number(random) * std::pow(10., exponent(random));
    return x;
  }

  /** The part of the terms that this rank holds if dealt out one by one. */
  Vector dealt(const Communicator &communicator, const Vector &terms,
               const unsigned int offset = 0)
  {
    Vector mine;
    for (std::size_t i = 0; i < terms.size(); ++i)
      if (int((i + offset) % communicator.size()) == communicator.rank())
        mine.push_back(terms[i]);
    return mine;
  }

  TEST(Communicator, SumsDoNotDependOnTheOrder)
  {
    const Communicator alone(MPI_COMM_SELF), world(MPI_COMM_WORLD);
    std::mt19937 random(9);
    for (const std::size_t n : {1u, 7u, 8u, 9u, 1000u, 4321u}) {
      Vector terms = wild_terms(n, unsigned(n));
      const double sum = alone.sum(terms);
      // accurate: 2^-50 of n times the largest term is what may be dropped
      long double exact = 0.;
      for (const double term : terms)
        exact += term;
      EXPECT_NEAR(sum, double(exact), std::ldexp(n * largest(terms), -50));
      for (unsigned int k = 0; k < 20; ++k) {
        std::shuffle(terms.begin(), terms.end(), random);
        ASSERT_EQ(alone.sum(terms), sum) << "order, n = " << n;
        ASSERT_EQ(world.sum(dealt(world, terms, k)), sum) << "ranks";
      }
      // zeros are no terms
      terms.resize(n + 100, 0.);
      std::shuffle(terms.begin(), terms.end(), random);
      EXPECT_EQ(alone.sum(terms), sum);
      // neither is another row
      Vector rows(terms);
      const Vector other = wild_terms(terms.size(), 5);
      rows.insert(rows.end(), other.begin(), other.end());
      const Vector sums = alone.sums(rows.data(), 2, terms.size());
      EXPECT_EQ(sums[0], sum);
      EXPECT_EQ(sums[1], alone.sum(other));
    }
  }

  TEST(Communicator, DotIsASumOfProducts)
  {
    const Communicator alone(MPI_COMM_SELF);
    const Vector a = wild_terms(501, 1), b = wild_terms(501, 2);
    Vector products(500);
    for (std::size_t i = 0; i < products.size(); ++i)
      products[i] = a[i] * b[i];
    EXPECT_EQ(alone.dot(a.data(), b.data(), 500), alone.sum(products));
  }

  TEST(Communicator, CancellingSumsAreExact)
  {
    // pairs that cancel leave what lies within 2^-50 of the largest term
    const Communicator alone(MPI_COMM_SELF), world(MPI_COMM_WORLD);
    std::mt19937 random(10);
    for (const double rest : {0., 1., -std::ldexp(3., -10)}) {
      Vector terms;
      for (const double x : random_vector(3000, 6)) {
        const double large = std::ldexp(x, 40);
        terms.push_back(large);
        terms.push_back(-large);
      }
      terms.push_back(rest);
      for (unsigned int k = 0; k < 10; ++k) {
        std::shuffle(terms.begin(), terms.end(), random);
        EXPECT_EQ(alone.sum(terms), rest);
        EXPECT_EQ(world.sum(dealt(world, terms, k)), rest);
      }
      // a plain sum fails here, or this test would show nothing
      if (rest == 0.) {
        EXPECT_NE(std::accumulate(terms.begin(), terms.end(), 0.), rest);
      }
    }
  }

  TEST(Communicator, SumsOfNothingAndOfNonsense)
  {
    const Communicator alone(MPI_COMM_SELF);
    EXPECT_EQ(alone.sum(Vector()), 0.);
    EXPECT_EQ(alone.sum(Vector(10, 0.)), 0.);
    // an infinite or undefined term must not get lost
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()})
      for (const std::size_t place : {0u, 5u, 9u, 16u}) {
        Vector terms(17, 1.);
        terms[place] = bad;
        EXPECT_FALSE(std::isfinite(alone.sum(terms)));
      }
    // extreme but finite
    EXPECT_EQ(alone.sum(Vector{1e-300, 2e-300}), 3e-300);
  }
} // namespace small_meshes::test_sums
