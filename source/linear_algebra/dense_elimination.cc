#include "dense_elimination.h"

#include "lapack.h"

#include <algorithm>
#include <utility>

namespace nsfd
{
  namespace
  {
    constexpr double one = 1., minus_one = -1.;
    constexpr int next = 1;
  } // namespace

  bool DenseElimination::eliminate(std::vector<double> &&matrix,
                                   const std::vector<char> &kept,
                                   std::vector<double> &left)
  {
    const std::size_t n = kept.size();
    kept_.clear();
    gone_.clear();
    for (std::size_t i = 0; i < n; ++i)
      (kept[i] ? kept_ : gone_).push_back(int(i));
    const auto entry = [&](const int i, const int j) {
      return matrix[std::size_t(std::min(i, j)) * n +
                    std::size_t(std::max(i, j))];
    };
    const int n_kept = int(kept_.size()), n_gone = int(gone_.size());
    L_.clear();
    Y_.clear();
    if (n_gone == 0) {
      left = std::move(matrix);
      return true;
    }
    left.assign(kept_.size() * kept_.size(), 0.);
    for (std::size_t c = 0; c < kept_.size(); ++c)
      for (std::size_t r = c; r < kept_.size(); ++r)
        left[c * kept_.size() + r] = entry(kept_[r], kept_[c]);
    for (const int c : gone_)
      for (const int r : gone_)
        L_.push_back(entry(r, c));
    for (const int c : kept_)
      for (const int r : gone_)
        Y_.push_back(entry(r, c));
    int info = 0;
    dpotrf_("L", &n_gone, L_.data(), &n_gone, &info);
    if (info != 0)
      return false;
    if (n_kept == 0)
      return true;
    dtrsm_("L", "L", "N", "N", &n_gone, &n_kept, &one, L_.data(), &n_gone,
           Y_.data(), &n_gone);
    dsyrk_("L", "T", &n_kept, &n_gone, &minus_one, Y_.data(), &n_gone, &one,
           left.data(), &n_kept);
    return true;
  }

  void DenseElimination::forward(const std::vector<double> &right,
                                 std::vector<double> &kept)
  {
    kept.clear();
    part_.clear();
    for (const int i : kept_)
      kept.push_back(right[std::size_t(i)]);
    for (const int i : gone_)
      part_.push_back(right[std::size_t(i)]);
    const int n_kept = int(kept_.size()), n_gone = int(gone_.size());
    if (n_gone == 0)
      return;
    dtrsv_("L", "N", "N", &n_gone, L_.data(), &n_gone, part_.data(), &next);
    if (n_kept > 0)
      dgemv_("T", &n_gone, &n_kept, &minus_one, Y_.data(), &n_gone,
             part_.data(), &next, &one, kept.data(), &next);
  }

  void DenseElimination::backward(const std::vector<double> &kept,
                                  std::vector<double> &solution) const
  {
    const int n_kept = int(kept_.size()), n_gone = int(gone_.size());
    std::vector<double> x = part_;
    if (n_gone > 0 && n_kept > 0)
      dgemv_("N", &n_gone, &n_kept, &minus_one, Y_.data(), &n_gone, kept.data(),
             &next, &one, x.data(), &next);
    if (n_gone > 0)
      dtrsv_("L", "T", "N", &n_gone, L_.data(), &n_gone, x.data(), &next);
    solution.resize(kept_.size() + gone_.size());
    for (std::size_t k = 0; k < kept_.size(); ++k)
      solution[std::size_t(kept_[k])] = kept[k];
    for (std::size_t k = 0; k < gone_.size(); ++k)
      solution[std::size_t(gone_[k])] = x[k];
  }
} // namespace nsfd
