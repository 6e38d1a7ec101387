#include "dissected_factor.h"

#include <algorithm>
#include <iterator>
#include <new>

namespace nsfd
{
  DissectedFactor::DissectedFactor(const Communicator &communicator)
      : communicator_(communicator), alone_(MPI_COMM_SELF),
        dissection_(communicator), common_(alone_)
  {
  }

  /** Lower triangle, by rows. */
  void DissectedFactor::set_common_pattern()
  {
    std::vector<std::vector<int>> rows(
        static_cast<std::size_t>(dissection_.n_common()));
    std::vector<int> both;
    for (const Dissection::Share &share : dissection_.shares())
      for (std::size_t k = 0; k < share.entries.size(); k += 2)
        rows[share.entries[k]].push_back(share.entries[k + 1]);
    for (auto &row : rows)
      std::sort(row.begin(), row.end());
    for (const Dissection::Share &share : dissection_.shares())
      for (std::size_t k = 0; k < share.boundary.size(); ++k) {
        auto &row = rows[share.boundary[k]];
        both.clear();
        std::set_union(row.begin(), row.end(), share.boundary.begin(),
                       share.boundary.begin() + long(k) + 1,
                       std::back_inserter(both));
        row.assign(both.begin(), both.end());
      }
    common_matrix_ = SparseRows();
    common_matrix_.start.assign(1, 0);
    for (const auto &row : rows) {
      common_matrix_.column.insert(common_matrix_.column.end(), row.begin(),
                                   row.end());
      common_matrix_.start.push_back(int(common_matrix_.column.size()));
    }
    common_matrix_.value.resize(common_matrix_.column.size());
  }

  void DissectedFactor::sum()
  {
    auto &A = common_matrix_;
    std::fill(A.value.begin(), A.value.end(), 0.);
    int row = -1, k = 0;
    dissection_.for_terms([&](const int r, const int c, const double value) {
      // columns of a row ascend but where another share begins
      if (r != row || k == A.start[r + 1] || A.column[k] > c) {
        row = r;
        k = A.start[r];
      }
      while (A.column[k] < c)
        ++k;
      A.value[k] += value;
    });
    dissection_.forget_terms();
  }

  bool DissectedFactor::try_factorise(const SparseRows &matrix,
                                      const bool new_pattern)
  {
    bool failed = false;
    const bool changed = new_pattern || !dissection_.is_ready();
    if (changed) {
      if (!dissection_.analyse(matrix))
        return false;
      try {
        set_common_pattern();
      } catch (const std::bad_alloc &) {
        failed = true;
      }
      if (communicator_.any(failed)) {
        dissection_.clear();
        return false;
      }
    }
    if (!dissection_.eliminate(matrix))
      return false;
    sum();
    failed = dissection_.n_common() > 0 &&
             !common_.try_factorise(common_matrix_, changed);
    return !communicator_.any(failed);
  }

  void DissectedFactor::solve(const double *b, double *x)
  {
    dissection_.forward(b, right_);
    solution_.resize(right_.size());
    if (!right_.empty())
      common_.solve(right_.data(), solution_.data());
    dissection_.backward(solution_, x);
  }

  double DissectedFactor::n_entries() const
  {
    return dissection_.n_entries() + common_.n_entries();
  }
} // namespace nsfd
