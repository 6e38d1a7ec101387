#include "block_lu.h"

#include "contact_kernels.h"
#include "linear_algebra/small_matrix.h"

#include <suitesparse/amd.h>

#include <algorithm>
#include <cmath>

namespace nsfd::stored
{
  template <int d>
  BlockLU<d>::BlockLU(const BlockProblem<d> &problem) : problem_(problem)
  {
    order();
    find_pattern();
    lower_.resize(std::size_t(stride) * lower_index_.size());
    upper_.resize(lower_.size());
    inverse_.resize(std::size_t(area) * problem.n);
    row_.assign(std::size_t(stride) * problem.n, 0.);
    permuted_.assign(std::size_t(row_stride<d>) * problem.n, 0.);
    trivial_.assign(problem.n, 0);
  }

  template <int d>
  void BlockLU<d>::order()
  {
    const int n = problem_.n;
    to_old_.resize(n);
    to_new_.resize(n);
    if (amd_order(n, problem_.start.data(), problem_.column.data(),
                  to_old_.data(), nullptr, nullptr) < 0)
      for (int i = 0; i < n; ++i)
        to_old_[i] = i;
    for (int i = 0; i < n; ++i)
      to_new_[to_old_[i]] = i;
  }

  /** The pattern of L for the pattern of W + W', row by row: the nodes of the
   * elimination tree between the entries of a row and the row itself. */
  template <int d>
  void BlockLU<d>::find_pattern()
  {
    const int n = problem_.n;
    std::vector<std::vector<int>> neighbour(n);
    for (int i = 0; i < n; ++i)
      for (int k = problem_.start[i]; k < problem_.start[i + 1]; ++k) {
        const int a = to_new_[i], b = to_new_[problem_.column[k]];
        if (a != b)
          neighbour[std::max(a, b)].push_back(std::min(a, b));
      }
    std::vector<int> parent(n, -1), mark(n, -1), count(n, 0);
    lower_start_.assign(1, 0);
    for (int i = 0; i < n; ++i) {
      mark[i] = i;
      for (int k : neighbour[i])
        for (; mark[k] != i; k = parent[k]) {
          mark[k] = i;
          lower_index_.push_back(k);
          ++count[k];
          if (parent[k] == -1) {
            parent[k] = i;
            break;
          }
        }
      std::sort(lower_index_.begin() + lower_start_[i], lower_index_.end());
      lower_start_.push_back(int(lower_index_.size()));
    }
    upper_start_.assign(n + 1, 0);
    for (int i = 0; i < n; ++i)
      upper_start_[i + 1] = upper_start_[i] + count[i];
    upper_index_.resize(lower_index_.size());
    std::vector<int> next(upper_start_.begin(), upper_start_.end() - 1);
    for (int i = 0; i < n; ++i)
      for (int k = lower_start_[i]; k < lower_start_[i + 1]; ++k)
        upper_index_[next[lower_index_[k]]++] = i;
  }

  template <int d>
  bool BlockLU<d>::factor(const double *A, const double *B)
  {
    bool regular = true;
    double *const row = row_.data();
    double plain[area];
    for (int i = 0; i < problem_.n; ++i) {
      const int old = to_old_[i];
      const double *const b = B + std::size_t(area) * old;
      trivial_[i] = is_zero<d>(b);
      if (trivial_[i]) {
        regular &= invert<d>(A + std::size_t(area) * old, inverse(i));
        continue;
      }
      for (int k = problem_.start[old]; k < problem_.start[old + 1]; ++k) {
        multiply<d>(b, &problem_.block[std::size_t(area) * k], plain);
        if (problem_.column[k] == old)
          add<d>(A + std::size_t(area) * old, plain);
        pad(plain, row + std::size_t(stride) * to_new_[problem_.column[k]]);
      }

      for (int l = lower_start_[i]; l < lower_start_[i + 1]; ++l) {
        const int k = lower_index_[l];
        double *const entry = row + std::size_t(stride) * k;
        double *const factor = lower_.data() + std::size_t(stride) * l;
        if (is_zero_block(entry)) {
          std::fill(factor, factor + stride, 0.);
          continue;
        }
        double before[area];
        unpad(entry, before);
        multiply<d>(before, inverse(k), plain);
        pad(plain, factor);
        std::fill(entry, entry + stride, 0.);
        if (!trivial_[k])
          eliminate<d>(factor,
                       upper_.data() + std::size_t(stride) * upper_start_[k],
                       upper_index_.data() + upper_start_[k],
                       upper_start_[k + 1] - upper_start_[k], row);
      }
      double *const pivot = row + std::size_t(stride) * i;
      unpad(pivot, plain);
      regular &= invert<d>(plain, inverse(i));
      std::fill(pivot, pivot + stride, 0.);
      for (int m = upper_start_[i]; m < upper_start_[i + 1]; ++m) {
        double *const entry = row + std::size_t(stride) * upper_index_[m];
        std::copy(entry, entry + stride,
                  upper_.data() + std::size_t(stride) * m);
        std::fill(entry, entry + stride, 0.);
      }
    }
    return regular;
  }

  template <int d>
  void BlockLU<d>::solve(double *x)
  {
    constexpr int width = row_stride<d>;
    const int n = problem_.n;
    double *const y = permuted_.data();
    for (int i = 0; i < n; ++i) {
      double *const sum = y + width * i;
      std::copy(x + d * to_old_[i], x + d * (to_old_[i] + 1), sum);
      if (!trivial_[i])
        substitute<d>(lower_.data() + std::size_t(stride) * lower_start_[i], y,
                      lower_index_.data() + lower_start_[i],
                      lower_start_[i + 1] - lower_start_[i], sum);
    }
    for (int i = n - 1; i >= 0; --i) {
      double sum[d];
      std::copy(y + width * i, y + width * i + d, sum);
      if (!trivial_[i])
        substitute<d>(upper_.data() + std::size_t(stride) * upper_start_[i], y,
                      upper_index_.data() + upper_start_[i],
                      upper_start_[i + 1] - upper_start_[i], sum);
      multiply_vector<d>(inverse(i), sum, y + width * i);
      std::copy(y + width * i, y + width * i + d, x + d * to_old_[i]);
    }
  }

  template <int d>
  double BlockLU<d>::work() const
  {
    double sum = double(problem_.column.size());
    for (int k = 0; k < problem_.n; ++k) {
      const double length = upper_start_[k + 1] - upper_start_[k];
      sum += length * (length + 1.);
    }
    return sum;
  }

  template class BlockLU<2>;
  template class BlockLU<3>;
} // namespace nsfd::stored
