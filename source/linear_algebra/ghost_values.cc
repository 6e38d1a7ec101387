#include "ghost_values.h"

#include <algorithm>

namespace nsfd
{
  GhostValues::GhostValues(const Communicator &communicator,
                           const long long first, const std::size_t n_own,
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
      neighbor.first = from[r];
      neighbor.count = asked[r];
      for (int k = to[r]; k < to[r + 1]; ++k)
        neighbor.wanted.push_back(int(numbers[k] - first));
      messages_.messages.emplace_back().rank = r;
      neighbors_.push_back(std::move(neighbor));
    }
  }

  void GhostValues::start_fetch(const double *own) const
  {
    start(1, [own](const std::size_t k, double *value) { *value = own[k]; });
  }

  void GhostValues::finish_fetch(double *ghosts) const
  {
    messages_.finish();
    for (std::size_t k = 0; k < neighbors_.size(); ++k)
      std::copy(messages_.messages[k].in.begin(),
                messages_.messages[k].in.end(), ghosts + neighbors_[k].first);
  }

  void GhostValues::start_add_back(const double *ghosts) const
  {
    for (std::size_t k = 0; k < neighbors_.size(); ++k) {
      const Neighbor &neighbor = neighbors_[k];
      auto &message = messages_.messages[k];
      message.in.resize(neighbor.wanted.size());
      message.out.assign(ghosts + neighbor.first,
                         ghosts + neighbor.first + neighbor.count);
    }
    messages_.start(mpi_, 22);
  }

  void GhostValues::finish_add_back(double *own) const
  {
    messages_.finish();
    for (std::size_t k = 0; k < neighbors_.size(); ++k)
      for (std::size_t j = 0; j < neighbors_[k].wanted.size(); ++j)
        own[neighbors_[k].wanted[j]] += messages_.messages[k].in[j];
  }
} // namespace nsfd
