#include "dissected_factor.h"

#include "ghost_values.h"

#include <algorithm>
#include <iterator>
#include <new>

namespace nsfd
{
  namespace
  {
    /** Of all ranks, one after the other. */
    template <typename T>
    std::vector<T> gather(const MPI_Comm mpi, const MPI_Datatype type,
                          const std::vector<T> &own,
                          const std::vector<int> &counts,
                          const std::vector<int> &offsets)
    {
      std::vector<T> all(std::size_t(offsets.back() + counts.back()));
      MPI_Allgatherv(own.data(), int(own.size()), type, all.data(),
                     counts.data(), offsets.data(), type, mpi);
      return all;
    }

    std::vector<int> offsets_of(const std::vector<int> &counts)
    {
      std::vector<int> offsets(counts.size(), 0);
      for (std::size_t r = 1; r < counts.size(); ++r)
        offsets[r] = offsets[r - 1] + counts[r - 1];
      return offsets;
    }
  } // namespace

  DissectedFactor::DissectedFactor(const Communicator &communicator)
      : communicator_(communicator), alone_(MPI_COMM_SELF), common_(alone_)
  {
  }

  /** Numbers of what is common, in the order of the rows of all ranks. */
  void DissectedFactor::find_common(const SparseRows &matrix)
  {
    const int n = matrix.n_rows();
    const std::size_t n_all = std::size_t(n) + matrix.ghosts.size();
    std::vector<char> common(std::size_t(n), 0);
    own_ = Share();
    for (int i = 0; i < n; ++i)
      for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k)
        if (matrix.column[k] >= n &&
            matrix.ghosts[matrix.column[k] - n] > matrix.first_row)
          common[i] = 1;
    own_.count = int(std::count(common.begin(), common.end(), 1));
    std::vector<int> counts(communicator_.size());
    MPI_Allgather(&own_.count, 1, MPI_INT, counts.data(), 1, MPI_INT,
                  communicator_.mpi());
    const auto firsts = offsets_of(counts);
    own_.first = firsts[communicator_.rank()];
    n_common_ = firsts.back() + counts.back();
    std::vector<double> values(n_all, -1.); // below 2^53
    for (int i = 0, k = own_.first; i < n; ++i)
      if (common[i])
        values[i] = k++;
    GhostValues(communicator_, matrix.first_row, std::size_t(n), matrix.ghosts)
        .fetch(values.data(), values.data() + n);
    number_.assign(values.begin(), values.end());
    n_inner_ = n - own_.count;
  }

  /** The matrix of what is eliminated here, and what is common of it. */
  void DissectedFactor::split(const SparseRows &matrix)
  {
    const int n = matrix.n_rows();
    place_.assign(std::size_t(n), -1);
    for (int i = 0, k = 0; i < n; ++i)
      if (number_[i] < 0)
        place_[i] = k++;
    inner_source_.clear();
    common_source_.clear();
    inner_matrix_ = SparseRows();
    inner_matrix_.start.assign(1, 0);
    for (int i = 0; i < n; ++i) {
      for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
        const int number = number_[matrix.column[k]];
        if (place_[i] >= 0) {
          inner_source_.push_back(k);
          if (number >= 0)
            own_.boundary.push_back(number);
        } else if (number >= 0 && number <= number_[i]) {
          common_source_.push_back(k);
          own_.entries.insert(own_.entries.end(), {number_[i], number});
        }
      }
      if (place_[i] >= 0)
        inner_matrix_.start.push_back(int(inner_source_.size()));
    }
    auto &boundary = own_.boundary;
    std::sort(boundary.begin(), boundary.end());
    boundary.erase(std::unique(boundary.begin(), boundary.end()),
                   boundary.end());
    for (const int k : inner_source_) {
      const int column = matrix.column[k], number = number_[column];
      inner_matrix_.column.push_back(
          number < 0 ? place_[column]
                     : n_inner_ + int(std::lower_bound(boundary.begin(),
                                                       boundary.end(), number) -
                                      boundary.begin()));
    }
    inner_matrix_.value.resize(inner_source_.size());
  }

  void DissectedFactor::gather_shares()
  {
    const int n_ranks = communicator_.size();
    const MPI_Comm mpi = communicator_.mpi();
    const int mine[4] = {own_.first, own_.count, int(own_.boundary.size()),
                         int(own_.entries.size())};
    std::vector<int> sizes(4 * std::size_t(n_ranks));
    MPI_Allgather(mine, 4, MPI_INT, sizes.data(), 4, MPI_INT, mpi);
    std::vector<int> boundary, entries;
    values_.counts.clear();
    sums_.counts.clear();
    for (int r = 0; r < n_ranks; ++r) {
      const int count = sizes[4 * r + 1], m = sizes[4 * r + 2];
      boundary.push_back(m);
      entries.push_back(sizes[4 * r + 3]);
      values_.counts.push_back(m * (m + 1) / 2 + entries.back() / 2);
      sums_.counts.push_back(m + count);
    }
    values_.offsets = offsets_of(values_.counts);
    sums_.offsets = offsets_of(sums_.counts);
    const auto first_boundary = offsets_of(boundary),
               first_entry = offsets_of(entries);
    const auto all_boundary =
        gather(mpi, MPI_INT, own_.boundary, boundary, first_boundary);
    const auto all_entries =
        gather(mpi, MPI_INT, own_.entries, entries, first_entry);
    shares_.assign(std::size_t(n_ranks), Share());
    for (int r = 0; r < n_ranks; ++r) {
      Share &share = shares_[r];
      share.first = sizes[4 * r];
      share.count = sizes[4 * r + 1];
      const auto b = all_boundary.begin() + first_boundary[r];
      share.boundary.assign(b, b + boundary[r]);
      const auto e = all_entries.begin() + first_entry[r];
      share.entries.assign(e, e + entries[r]);
    }
  }

  /** Lower triangle, by rows. */
  void DissectedFactor::set_common_pattern()
  {
    std::vector<std::vector<int>> rows(static_cast<std::size_t>(n_common_));
    std::vector<int> both;
    for (const Share &share : shares_)
      for (std::size_t k = 0; k < share.entries.size(); k += 2)
        rows[share.entries[k]].push_back(share.entries[k + 1]);
    for (auto &row : rows)
      std::sort(row.begin(), row.end());
    for (const Share &share : shares_)
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

  /** What this rank has to say of the common matrix, as sum() reads it. */
  std::vector<double> DissectedFactor::eliminate(const SparseRows &matrix,
                                                 bool &failed)
  {
    for (std::size_t k = 0; k < inner_source_.size(); ++k)
      inner_matrix_.value[k] = matrix.value[inner_source_[k]];
    std::vector<double> left, result;
    try {
      failed = failed || !inner_.factorise(inner_matrix_, left);
    } catch (const std::bad_alloc &) {
      failed = true;
    }
    const std::size_t m = own_.boundary.size();
    left.resize(m * m, 0.);
    result.reserve(std::size_t(values_.counts[communicator_.rank()]));
    for (std::size_t r = 0; r < m; ++r)
      for (std::size_t c = 0; c <= r; ++c)
        result.push_back(left[c * m + r]);
    for (const int k : common_source_)
      result.push_back(matrix.value[k]);
    return result;
  }

  /** Of all ranks, in their order. */
  void DissectedFactor::sum(const std::vector<double> &values)
  {
    auto &A = common_matrix_;
    std::fill(A.value.begin(), A.value.end(), 0.);
    const double *value = values.data();
    for (const Share &share : shares_) {
      for (std::size_t r = 0; r < share.boundary.size(); ++r) {
        int k = A.start[share.boundary[r]];
        for (std::size_t c = 0; c <= r; ++c) {
          while (A.column[k] < share.boundary[c])
            ++k;
          A.value[k] += *value++;
        }
      }
      for (std::size_t e = 0; e < share.entries.size(); e += 2) {
        const int row = share.entries[e];
        const auto first = A.column.begin() + A.start[row],
                   end = A.column.begin() + A.start[row + 1];
        A.value[std::lower_bound(first, end, share.entries[e + 1]) -
                A.column.begin()] += *value++;
      }
    }
  }

  bool DissectedFactor::try_factorise(const SparseRows &matrix,
                                      const bool new_pattern)
  {
    bool failed = false;
    const bool changed = new_pattern || shares_.empty();
    if (changed) {
      find_common(matrix);
      split(matrix);
      gather_shares();
      try {
        set_common_pattern();
        inner_.analyse(inner_matrix_, int(own_.boundary.size()));
      } catch (const std::bad_alloc &) {
        failed = true;
      }
      if (communicator_.any(failed)) {
        shares_.clear();
        return false;
      }
    }
    const auto mine = eliminate(matrix, failed);
    sum(gather(communicator_.mpi(), MPI_DOUBLE, mine, values_.counts,
               values_.offsets));
    if (n_common_ > 0 && !common_.try_factorise(common_matrix_, changed))
      failed = true;
    return !communicator_.any(failed);
  }

  void DissectedFactor::solve(const double *b, double *x)
  {
    const std::size_t n = place_.size();
    x_.assign(std::size_t(n_inner_) + own_.boundary.size(), 0.);
    for (std::size_t i = 0; i < n; ++i)
      if (place_[i] >= 0)
        x_[place_[i]] = b[i];
    inner_.forward(x_);
    std::vector<double> mine(x_.begin() + n_inner_, x_.end());
    for (std::size_t i = 0; i < n; ++i)
      if (place_[i] < 0)
        mine.push_back(b[i]);
    const auto all = gather(communicator_.mpi(), MPI_DOUBLE, mine, sums_.counts,
                            sums_.offsets);
    right_.assign(std::size_t(n_common_), 0.);
    solution_.resize(right_.size());
    const double *value = all.data();
    for (const Share &share : shares_) {
      for (const int k : share.boundary)
        right_[k] += *value++;
      for (int k = share.first; k < share.first + share.count; ++k)
        right_[k] += *value++;
    }
    if (n_common_ > 0)
      common_.solve(right_.data(), solution_.data());
    for (std::size_t k = 0; k < own_.boundary.size(); ++k)
      x_[std::size_t(n_inner_) + k] = solution_[own_.boundary[k]];
    inner_.backward(x_);
    for (std::size_t i = 0; i < n; ++i)
      x[i] = place_[i] >= 0 ? x_[place_[i]] : solution_[number_[i]];
  }

  double DissectedFactor::n_entries() const
  {
    return inner_.n_entries() + common_.n_entries();
  }
} // namespace nsfd
