#include "row_sums.h"

#include <algorithm>
#include <utility>

namespace nsfd
{
  RowSums::RowSums(const Communicator &communicator, const CoarseSpace &space,
                   const std::vector<SparseEntry> &entries)
      : matrix_(sum_at_owners(communicator, space, entries))
  {
    const auto n = static_cast<long long>(matrix_.value.size());
    long long end = 0;
    MPI_Scan(&n, &end, 1, MPI_LONG_LONG, MPI_SUM, communicator.mpi());
    first_ = end - n;
    find_places(communicator, space, entries);
  }

  /** Of an own entry, among those of all ranks. */
  long long RowSums::number(const SparseEntry &entry) const
  {
    const int n = matrix_.n_rows();
    const long long i = entry.row - matrix_.first_row,
                    j = entry.column - matrix_.first_row;
    const int column =
        j >= 0 && j < n
            ? int(j)
            : n + int(std::lower_bound(matrix_.ghosts.begin(),
                                       matrix_.ghosts.end(), entry.column) -
                      matrix_.ghosts.begin());
    const auto first = matrix_.column.begin() + matrix_.start[i],
               end = matrix_.column.begin() + matrix_.start[i + 1];
    return first_ +
           (std::lower_bound(first, end, column) - matrix_.column.begin());
  }

  /** Owners are asked for the numbers of what is not here. */
  void RowSums::find_places(const Communicator &communicator,
                            const CoarseSpace &space,
                            const std::vector<SparseEntry> &entries)
  {
    const int n_ranks = communicator.size();
    const MPI_Comm mpi = communicator.mpi();
    const long long end = space.first + space.n_own;
    std::vector<long long> ends(n_ranks);
    MPI_Allgather(&end, 1, MPI_LONG_LONG, ends.data(), 1, MPI_LONG_LONG, mpi);
    // by owner, as entries ascend by row
    std::vector<std::pair<SparseEntry, std::size_t>> remote;
    place_.resize(entries.size());
    for (std::size_t k = 0; k < entries.size(); ++k)
      if (entries[k].row < space.first || entries[k].row >= end)
        remote.emplace_back(entries[k], k);
      else
        place_[k] = number(entries[k]) - first_;
    std::sort(remote.begin(), remote.end());
    std::vector<int> asked(n_ranks, 0), wanted(n_ranks), from(n_ranks, 0),
        to(n_ranks, 0);
    std::vector<long long> questions;
    for (const auto &[entry, k] : remote) {
      asked[std::upper_bound(ends.begin(), ends.end(), entry.row) -
            ends.begin()] += 2;
      questions.insert(questions.end(), {entry.row, entry.column});
    }
    MPI_Alltoall(asked.data(), 1, MPI_INT, wanted.data(), 1, MPI_INT, mpi);
    for (int r = 1; r < n_ranks; ++r) {
      from[r] = from[r - 1] + asked[r - 1];
      to[r] = to[r - 1] + wanted[r - 1];
    }
    std::vector<long long> arrived(std::size_t(to.back() + wanted.back())),
        answers(arrived.size() / 2), numbers(remote.size());
    MPI_Alltoallv(questions.data(), asked.data(), from.data(), MPI_LONG_LONG,
                  arrived.data(), wanted.data(), to.data(), MPI_LONG_LONG, mpi);
    for (std::size_t k = 0; k < answers.size(); ++k)
      answers[k] = number({arrived[2 * k], arrived[2 * k + 1], 0.});
    for (auto *counts : {&asked, &wanted, &from, &to})
      for (int &count : *counts)
        count /= 2;
    MPI_Alltoallv(answers.data(), wanted.data(), to.data(), MPI_LONG_LONG,
                  numbers.data(), asked.data(), from.data(), MPI_LONG_LONG,
                  mpi);
    auto ghosts = numbers;
    std::sort(ghosts.begin(), ghosts.end());
    ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
    const auto n = static_cast<long long>(matrix_.value.size());
    for (std::size_t k = 0; k < remote.size(); ++k)
      place_[remote[k].second] =
          n + (std::lower_bound(ghosts.begin(), ghosts.end(), numbers[k]) -
               ghosts.begin());
    exchange_ = GhostValues(communicator, first_, std::size_t(n), ghosts);
    ghosts_.resize(ghosts.size());
  }

  const SparseRows &RowSums::sum(const std::vector<double> &values)
  {
    const auto n = static_cast<long long>(matrix_.value.size());
    std::fill(matrix_.value.begin(), matrix_.value.end(), 0.);
    std::fill(ghosts_.begin(), ghosts_.end(), 0.);
    for (std::size_t k = 0; k < place_.size(); ++k)
      (place_[k] < n ? matrix_.value[place_[k]] : ghosts_[place_[k] - n]) +=
          values[k];
    exchange_.start_add_back(ghosts_.data());
    exchange_.finish_add_back(matrix_.value.data());
    return matrix_;
  }
} // namespace nsfd
