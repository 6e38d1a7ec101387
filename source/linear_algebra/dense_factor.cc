#include "dense_factor.h"

#include "lapack.h"

#include <utility>

namespace nsfd
{
  bool DenseFactor::factorise(std::vector<double> &&matrix, const int n,
                              const bool symmetric)
  {
    n_ = n;
    values_ = std::move(matrix);
    pivots_.clear();
    int info = 0;
    if (n > 0 && symmetric)
      dpotrf_("L", &n, values_.data(), &n, &info);
    else if (n > 0) {
      pivots_.resize(std::size_t(n));
      dgetrf_(&n, &n, values_.data(), &n, pivots_.data(), &info);
    }
    if (info != 0)
      clear();
    return info == 0;
  }

  void DenseFactor::solve(double *x) const
  {
    constexpr int one = 1;
    if (n_ == 0)
      return;
    if (pivots_.empty()) {
      dtrsv_("L", "N", "N", &n_, values_.data(), &n_, x, &one);
      dtrsv_("L", "T", "N", &n_, values_.data(), &n_, x, &one);
      return;
    }
    int info = 0;
    dgetrs_("N", &n_, &one, values_.data(), &n_, pivots_.data(), x, &n_, &info);
  }
} // namespace nsfd
