#include "body_inverses.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Cholesky in place, lower triangle, row-major; inverse pivots. */
    void factorise(double *L, const std::size_t n)
    {
      for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t i = j; i < n; ++i) {
          double value = L[i * n + j];
          for (std::size_t k = 0; k < j; ++k)
            value -= L[i * n + k] * L[j * n + k];
          if (i > j)
            L[i * n + j] = value * L[j * n + j];
          else // what round-off takes from a stiff block stays positive
            L[j * n + j] =
                1. / std::sqrt(std::max(value, 1e-14 * std::abs(L[j * n + j])));
        }
      }
    }

    /** (L L^T)^{-1} in place; @p work holds n^2 entries. */
    void invert(double *L, const std::size_t n, double *work)
    {
      std::fill_n(work, n * n, 0.);
      for (std::size_t c = 0; c < n; ++c) {
        double *x = work + c * n; // column c of L^{-1}
        for (std::size_t i = c; i < n; ++i) {
          double value = i == c ? 1. : 0.;
          for (std::size_t k = c; k < i; ++k)
            value -= L[i * n + k] * x[k];
          x[i] = value * L[i * n + i];
        }
      }
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          double value = 0.;
          for (std::size_t k = i; k < n; ++k)
            value += work[i * n + k] * work[j * n + k];
          L[i * n + j] = L[j * n + i] = value;
        }
    }
  } // namespace

  void BodyInverses::prepare(const SparseRows &matrix)
  {
    const std::size_t n_bodies = first_dof_.size() - 1;
    if (offset_.empty()) {
      offset_.assign(1, 0);
      std::size_t largest = 0;
      for (std::size_t b = 0; b < n_bodies; ++b) {
        const std::size_t n = first_dof_[b + 1] - first_dof_[b];
        offset_.push_back(offset_.back() + n * n);
        largest = std::max(largest, n);
      }
      inverses_.resize(offset_.back());
      work_.resize(largest * largest);
    }
    for (std::size_t b = 0; b < n_bodies; ++b) {
      const int first = int(first_dof_[b]), end = int(first_dof_[b + 1]);
      const std::size_t n = std::size_t(end - first);
      double *block = inverses_.data() + offset_[b];
      std::fill_n(block, n * n, 0.);
      for (int i = first; i < end; ++i)
        for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k)
          if (matrix.column[k] >= first && matrix.column[k] < end)
            block[std::size_t(i - first) * n +
                  std::size_t(matrix.column[k] - first)] = matrix.value[k];
      factorise(block, n);
      invert(block, n, work_.data());
    }
  }

  void BodyInverses::apply(const double *r, double *z) const
  {
    for (std::size_t b = 0; b + 1 < first_dof_.size(); ++b) {
      const std::size_t first = first_dof_[b], n = first_dof_[b + 1] - first;
      const double *block = inverses_.data() + offset_[b];
      double *out = z + first;
      const double *in = r + first;
      std::fill_n(out, n, 0.);
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i)
          out[i] += block[j * n + i] * in[j];
    }
  }
} // namespace nsfd
