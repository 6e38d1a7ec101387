#include "dense_lu.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nsfd
{
  void DenseLU::reinit(const int n)
  {
    n_ = n;
    a_.assign(std::size_t(n) * n, 0.);
    pivot_.resize(n);
  }

  bool DenseLU::factorise()
  {
    begin_.assign(n_, 0);
    end_.assign(n_, n_);
    for (int i = 0; i < n_; ++i) {
      const double *a = row(i);
      while (end_[i] > i + 1 && a[end_[i] - 1] == 0.)
        --end_[i];
      while (begin_[i] < i && a[begin_[i]] == 0.)
        ++begin_[i];
    }
    for (int k = 0; k < n_; ++k) {
      int p = k;
      for (int i = k + 1; i < n_; ++i)
        if (begin_[i] <= k && std::abs(row(i)[k]) > std::abs(row(p)[k]))
          p = i;
      pivot_[k] = p;
      double *mine = row(k), *other = row(p);
      if (p != k) {
        std::swap_ranges(mine, mine + n_, other);
        std::swap(begin_[k], begin_[p]);
        std::swap(end_[k], end_[p]);
        end_[k] = std::max(end_[k], k + 1);
      }
      if (!(std::abs(mine[k]) > 0.))
        return false;
      mine[k] = 1. / mine[k];
      for (int i = k + 1; i < n_; ++i) {
        if (begin_[i] > k)
          continue;
        double *below = row(i);
        const double factor = below[k] *= mine[k];
        if (factor == 0.)
          continue;
        end_[i] = std::max(end_[i], end_[k]);
        for (int j = k + 1; j < end_[k]; ++j)
          below[j] -= factor * mine[j];
      }
    }
    return true;
  }

  void DenseLU::solve(double *x) const
  {
    for (int k = 0; k < n_; ++k)
      if (pivot_[k] != k)
        std::swap(x[k], x[pivot_[k]]);
    for (int i = 1; i < n_; ++i) {
      const double *a = row(i);
      double sum = x[i];
      for (int j = std::min(begin_[i], i); j < i; ++j)
        sum -= a[j] * x[j];
      x[i] = sum;
    }
    for (int i = n_ - 1; i >= 0; --i) {
      const double *a = row(i);
      double sum = x[i];
      for (int j = i + 1; j < end_[i]; ++j)
        sum -= a[j] * x[j];
      x[i] = sum * a[i];
    }
  }
} // namespace nsfd
