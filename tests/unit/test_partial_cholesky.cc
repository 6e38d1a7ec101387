#include "linear_algebra/partial_cholesky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

// A factor of a part of a matrix against Gauss elimination of all of it.

namespace nsfd
{
  namespace
  {
    using Vector = std::vector<double>;

    struct Grid {
      int n_x, n_y;
      std::vector<int> order; ///< of the nodes: the boundary last
      int n_boundary;

      int size() const { return n_x * n_y; }

      /** Springs of different stiffness to the neighbours and to the ground. */
      Vector dense(const double ground) const
      {
        const int n = size();
        Vector A(std::size_t(n * n), 0.);
        std::vector<int> place(std::size_t(n), 0);
        for (int k = 0; k < n; ++k)
          place[order[k]] = k;
        const auto join = [&](const int a, const int b) {
          const double k = 1. + 0.3 * std::sin(double(a + 7 * b));
          const int i = place[a], j = place[b];
          A[i * n + i] += k;
          A[j * n + j] += k;
          A[i * n + j] -= k;
          A[j * n + i] -= k;
        };
        for (int y = 0; y < n_y; ++y)
          for (int x = 0; x < n_x; ++x) {
            const int i = y * n_x + x;
            A[place[i] * (n + 1)] += ground;
            if (x + 1 < n_x)
              join(i, i + 1);
            if (y + 1 < n_y)
              join(i, i + n_x);
          }
        return A;
      }
    };

    /** Those whose nodes @p last are the boundary. */
    Grid grid(const int n_x, const int n_y, const std::vector<int> &last)
    {
      Grid result{n_x, n_y, {}, int(last.size())};
      for (int i = 0; i < n_x * n_y; ++i)
        if (std::find(last.begin(), last.end(), i) == last.end())
          result.order.push_back(i);
      result.order.insert(result.order.end(), last.begin(), last.end());
      return result;
    }

    SparseRows inner_rows(const Vector &A, const int n, const int n_inner)
    {
      SparseRows rows;
      rows.start.assign(1, 0);
      for (int i = 0; i < n_inner; ++i) {
        for (int j = 0; j < n; ++j)
          if (A[i * n + j] != 0.) {
            rows.column.push_back(j);
            rows.value.push_back(A[i * n + j]);
          }
        rows.start.push_back(int(rows.column.size()));
      }
      return rows;
    }

    void check(const Grid &grid)
    {
      const int n = grid.size(), m = grid.n_boundary, n_inner = n - m;
      Vector A = grid.dense(0.1);
      PartialCholesky factor;
      factor.analyse(inner_rows(A, n, n_inner), m);
      Vector left;
      // the second time with other values
      ASSERT_TRUE(
          factor.factorise(inner_rows(grid.dense(2.), n, n_inner), left));
      left.clear();
      ASSERT_TRUE(factor.factorise(inner_rows(A, n, n_inner), left));
      Vector x(std::size_t(n), 0.), b(std::size_t(n), 0.);
      for (int i = 0; i < n; ++i)
        x[i] = std::cos(3. * i);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          b[i] += A[i * n + j] * x[j];
      Vector work(b.begin(), b.begin() + n_inner);
      work.resize(std::size_t(n), 0.);
      factor.forward(work);
      // what is left of the boundary: S x_b = A_bb x_b + left x_b
      for (int i = 0; i < m; ++i) {
        double sum = 0.;
        for (int j = 0; j < m; ++j)
          sum += (A[(n_inner + i) * n + n_inner + j] +
                  left[std::min(i, j) * m + std::max(i, j)]) *
                 x[n_inner + j];
        EXPECT_NEAR(sum, b[n_inner + i] + work[n_inner + i], 1e-12);
      }
      for (int i = 0; i < m; ++i)
        work[n_inner + i] = x[n_inner + i];
      factor.backward(work);
      for (int i = 0; i < n_inner; ++i)
        EXPECT_NEAR(work[i], x[i], 1e-12);
    }
  } // namespace

  TEST(PartialCholesky, LeavesTheComplementOfWhatIsEliminated)
  {
    check(grid(9, 7, {}));
    check(grid(9, 7, {54, 55, 56, 57, 58, 59, 60, 61, 62}));
    // a boundary that cuts the rest in three, and one of single nodes
    check(grid(9, 7, {3, 12, 21, 30, 39, 48, 57, 6, 15, 24, 33, 42, 51, 60}));
    check(grid(9, 7, {0, 31, 62}));
    check(grid(2, 2, {0, 1, 2, 3}));
  }

  TEST(PartialCholesky, RefusesWhatIsNotPositiveDefinite)
  {
    const Grid g = grid(5, 4, {0, 1});
    PartialCholesky factor;
    factor.analyse(inner_rows(g.dense(1.), 20, 18), 2);
    Vector left;
    EXPECT_FALSE(factor.factorise(inner_rows(g.dense(-3.), 20, 18), left));
  }
} // namespace nsfd
