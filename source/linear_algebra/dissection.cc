#include "dissection.h"

#include "ghost_values.h"

#include <algorithm>
#include <iterator>
#include <new>
#include <utility>

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

  Dissection::Dissection(const Communicator &communicator)
      : communicator_(communicator)
  {
  }

  /** Numbers of what is common, in the order of the rows of all ranks. */
  void Dissection::find_common(const SparseRows &matrix,
                               const std::vector<char> &asked)
  {
    const int n = matrix.n_rows();
    const std::size_t n_all = std::size_t(n) + matrix.ghosts.size();
    std::vector<char> common(std::size_t(n), 0);
    for (std::size_t i = 0; i < asked.size(); ++i)
      common[i] = asked[i] != 0;
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
  void Dissection::split(const SparseRows &matrix)
  {
    const int n = matrix.n_rows();
    std::vector<int> place(std::size_t(n), -1);
    places_ = Places();
    for (int i = 0; i < n; ++i)
      if (number_[i] < 0) {
        place[i] = int(places_.inner.size());
        places_.inner.push_back(i);
      } else
        places_.own.emplace_back(number_[i], i);
    inner_source_.clear();
    common_source_.clear();
    inner_matrix_ = SparseRows();
    inner_matrix_.start.assign(1, 0);
    for (int i = 0; i < n; ++i) {
      for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
        const int number = number_[matrix.column[k]];
        if (place[i] >= 0) {
          inner_source_.push_back(k);
          if (number >= 0)
            own_.boundary.push_back(number);
        } else if (number >= 0 && number <= number_[i]) {
          common_source_.push_back(k);
          own_.entries.insert(own_.entries.end(), {number_[i], number});
        }
      }
      if (place[i] >= 0)
        inner_matrix_.start.push_back(int(inner_source_.size()));
    }
    auto &boundary = own_.boundary;
    std::sort(boundary.begin(), boundary.end());
    boundary.erase(std::unique(boundary.begin(), boundary.end()),
                   boundary.end());
    for (const int k : inner_source_) {
      const int column = matrix.column[k], number = number_[column];
      inner_matrix_.column.push_back(
          number < 0 ? place[column]
                     : n_inner_ + int(std::lower_bound(boundary.begin(),
                                                       boundary.end(), number) -
                                      boundary.begin()));
    }
  }

  void Dissection::gather_shares()
  {
    const int n_ranks = communicator_.size();
    const MPI_Comm mpi = communicator_.mpi();
    const int mine[4] = {own_.first, own_.count, int(own_.boundary.size()),
                         int(own_.entries.size())};
    std::vector<int> sizes(4 * std::size_t(n_ranks));
    MPI_Allgather(mine, 4, MPI_INT, sizes.data(), 4, MPI_INT, mpi);
    std::vector<int> boundary, entries;
    values_.counts.clear();
    for (int r = 0; r < n_ranks; ++r) {
      const int m = sizes[4 * r + 2];
      boundary.push_back(m);
      entries.push_back(sizes[4 * r + 3]);
      values_.counts.push_back(m * (m + 1) / 2 + entries.back() / 2);
    }
    values_.offsets = offsets_of(values_.counts);
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

  bool Dissection::analyse(const SparseRows &matrix,
                           const std::vector<char> &asked)
  {
    bool failed = false;
    find_common(matrix, asked);
    split(matrix);
    gather_shares();
    try {
      inner_.analyse(inner_matrix_, int(own_.boundary.size()));
    } catch (const std::bad_alloc &) {
      failed = true;
    }
    if (communicator_.any(failed)) {
      shares_.clear();
      return false;
    }
    set_places(Places(places_));
    return true;
  }

  bool Dissection::eliminate(const SparseRows &matrix)
  {
    const std::size_t m = own_.boundary.size();
    std::vector<double> mine;
    bool failed = false;
    try {
      auto &values = inner_matrix_.value;
      for (const int k : inner_source_)
        values.push_back(matrix.value[k]);
      std::vector<double> left;
      failed = !inner_.factorise(inner_matrix_, left);
      values = std::vector<double>();
      left.resize(m * m, 0.);
      mine.reserve(std::size_t(values_.counts[communicator_.rank()]));
      for (std::size_t r = 0; r < m; ++r)
        for (std::size_t c = 0; c <= r; ++c)
          mine.push_back(left[c * m + r]);
    } catch (const std::bad_alloc &) {
      failed = true;
    }
    if (communicator_.any(failed))
      return false;
    for (const int k : common_source_)
      mine.push_back(matrix.value[k]);
    terms_ = communicator_.size() == 1
                 ? std::move(mine)
                 : gather(communicator_.mpi(), MPI_DOUBLE, mine, values_.counts,
                          values_.offsets);
    return true;
  }

  void Dissection::set_places(Places places)
  {
    places_ = std::move(places);
    std::vector<int> own;
    for (const auto &[k, place] : places_.own)
      own.push_back(k);
    const int mine = int(own.size());
    std::vector<int> counts(communicator_.size());
    MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT,
                  communicator_.mpi());
    all_own_ =
        gather(communicator_.mpi(), MPI_INT, own, counts, offsets_of(counts));
    sums_.counts.clear();
    for (std::size_t r = 0; r < counts.size(); ++r)
      sums_.counts.push_back(int(shares_[r].boundary.size()) + counts[r]);
    sums_.offsets = offsets_of(sums_.counts);
  }

  void Dissection::forward(const double *b, std::vector<double> &right)
  {
    x_.assign(std::size_t(n_inner_) + own_.boundary.size(), 0.);
    for (int k = 0; k < n_inner_; ++k)
      x_[std::size_t(k)] = b[places_.inner[std::size_t(k)]];
    inner_.forward(x_);
    std::vector<double> mine(x_.begin() + n_inner_, x_.end());
    for (const auto &[k, place] : places_.own)
      mine.push_back(b[place]);
    const auto all = gather(communicator_.mpi(), MPI_DOUBLE, mine, sums_.counts,
                            sums_.offsets);
    right.assign(std::size_t(n_common_), 0.);
    const double *value = all.data();
    const int *owned = all_own_.data();
    for (std::size_t r = 0; r < shares_.size(); ++r) {
      const auto &boundary = shares_[r].boundary;
      for (const int k : boundary)
        right[std::size_t(k)] += *value++;
      const std::size_t count = std::size_t(sums_.counts[r]) - boundary.size();
      for (std::size_t k = 0; k < count; ++k)
        right[std::size_t(*owned++)] += *value++;
    }
  }

  void Dissection::backward(const std::vector<double> &common, double *x)
  {
    for (std::size_t k = 0; k < own_.boundary.size(); ++k)
      x_[std::size_t(n_inner_) + k] = common[std::size_t(own_.boundary[k])];
    inner_.backward(x_);
    for (int k = 0; k < n_inner_; ++k)
      x[places_.inner[std::size_t(k)]] = x_[std::size_t(k)];
    for (const auto &[k, place] : places_.own)
      x[place] = common[std::size_t(k)];
  }
} // namespace nsfd
