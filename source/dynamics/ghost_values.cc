#include "ghost_values.h"

#include <algorithm>

namespace nsfd
{
  GhostValues::GhostValues(const Communicator &communicator,
                           const long long first,
                           const std::size_t n_own,
                           const std::vector<long long> &ghosts)
    : mpi_(communicator.mpi())
  {
    const int n = communicator.size();
    if (n == 1)
      return;
    std::vector<long long> ends(n);
    const long long end = first + static_cast<long long>(n_own);
    MPI_Allgather(&end, 1, MPI_LONG_LONG, ends.data(), 1, MPI_LONG_LONG, mpi_);
    std::vector<int> asked(n, 0), wanted(n), from(n + 1, 0), to(n + 1, 0);
    for (const long long g : ghosts)
      ++asked[std::upper_bound(ends.begin(), ends.end(), g) - ends.begin()];
    MPI_Alltoall(asked.data(), 1, MPI_INT, wanted.data(), 1, MPI_INT, mpi_);
    for (int r = 0; r < n; ++r) {
      from[r + 1] = from[r] + asked[r];
      to[r + 1] = to[r] + wanted[r];
    }
    std::vector<long long> numbers(to[n]);
    MPI_Alltoallv(ghosts.data(), asked.data(), from.data(), MPI_LONG_LONG,
                  numbers.data(), wanted.data(), to.data(), MPI_LONG_LONG,
                  mpi_);
    for (int r = 0; r < n; ++r) {
      if (asked[r] == 0 && wanted[r] == 0)
        continue;
      Neighbor neighbor;
      neighbor.rank = r;
      neighbor.first = from[r];
      neighbor.count = asked[r];
      for (int k = to[r]; k < to[r + 1]; ++k)
        neighbor.wanted.push_back(int(numbers[k] - first));
      neighbors_.push_back(std::move(neighbor));
      buffers_.emplace_back(wanted[r]);
    }
    requests_.resize(2 * neighbors_.size());
  }

  void GhostValues::fetch(const double *own, double *ghosts) const
  {
    const std::size_t n = neighbors_.size();
    for (std::size_t k = 0; k < n; ++k)
      MPI_Irecv(ghosts + neighbors_[k].first, int(neighbors_[k].count),
                MPI_DOUBLE, neighbors_[k].rank, 21, mpi_, &requests_[k]);
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t j = 0; j < neighbors_[k].wanted.size(); ++j)
        buffers_[k][j] = own[neighbors_[k].wanted[j]];
      MPI_Isend(buffers_[k].data(), int(buffers_[k].size()), MPI_DOUBLE,
                neighbors_[k].rank, 21, mpi_, &requests_[n + k]);
    }
    MPI_Waitall(int(2 * n), requests_.data(), MPI_STATUSES_IGNORE);
  }

  void GhostValues::add_back(const double *ghosts, double *own) const
  {
    const std::size_t n = neighbors_.size();
    for (std::size_t k = 0; k < n; ++k) {
      MPI_Irecv(buffers_[k].data(), int(buffers_[k].size()), MPI_DOUBLE,
                neighbors_[k].rank, 22, mpi_, &requests_[k]);
      MPI_Isend(ghosts + neighbors_[k].first, int(neighbors_[k].count),
                MPI_DOUBLE, neighbors_[k].rank, 22, mpi_, &requests_[n + k]);
    }
    MPI_Waitall(int(2 * n), requests_.data(), MPI_STATUSES_IGNORE);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < neighbors_[k].wanted.size(); ++j)
        own[neighbors_[k].wanted[j]] += buffers_[k][j];
  }
} // namespace nsfd
