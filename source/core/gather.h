#pragma once

#include "bytes_type.h"

#include "communicator.h"

#include <mpi.h>

#include <numeric>
#include <type_traits>
#include <vector>

namespace nsfd
{
  /** The entries of all ranks on rank 0, rank by rank. Collective. */
  template <typename T>
  std::vector<T> gather(const Communicator &communicator,
                        const std::vector<T> &own, std::vector<int> &n_per_rank)
  {
    static_assert(std::is_trivially_copyable<T>::value);
    const int n = int(own.size());
    n_per_rank.assign(communicator.size(), 0);
    MPI_Gather(&n, 1, MPI_INT, n_per_rank.data(), 1, MPI_INT, 0,
               communicator.mpi());
    std::vector<int> first(n_per_rank.size(), 0);
    std::partial_sum(n_per_rank.begin(), n_per_rank.end() - 1,
                     first.begin() + 1);
    std::vector<T> all(communicator.is_root() ? first.back() + n_per_rank.back()
                                              : 0);
    const BytesType type(sizeof(T));
    MPI_Gatherv(own.data(), n, type, all.data(), n_per_rank.data(),
                first.data(), type, 0, communicator.mpi());
    return all;
  }

  template <typename T>
  std::vector<T> gather(const Communicator &communicator,
                        const std::vector<T> &own)
  {
    std::vector<int> n_per_rank;
    return gather(communicator, own, n_per_rank);
  }

  /** Entries on rank 0, so many for each rank, to their ranks. Collective. */
  template <typename T>
  std::vector<T> scatter(const Communicator &communicator,
                         const std::vector<T> &all,
                         const std::vector<int> &n_per_rank)
  {
    static_assert(std::is_trivially_copyable<T>::value);
    int n = 0;
    MPI_Scatter(n_per_rank.data(), 1, MPI_INT, &n, 1, MPI_INT, 0,
                communicator.mpi());
    std::vector<int> first(communicator.size(), 0);
    if (communicator.is_root())
      std::partial_sum(n_per_rank.begin(), n_per_rank.end() - 1,
                       first.begin() + 1);
    std::vector<T> own(n);
    const BytesType type(sizeof(T));
    MPI_Scatterv(all.data(), n_per_rank.data(), first.data(), type, own.data(),
                 n, type, 0, communicator.mpi());
    return own;
  }

  /** What gather() returns, on all ranks. Collective. */
  template <typename T>
  std::vector<T> gather_all(const Communicator &communicator,
                            const std::vector<T> &own)
  {
    static_assert(std::is_trivially_copyable<T>::value);
    if (communicator.size() == 1)
      return own;
    std::vector<int> n_per_rank(communicator.size());
    const int n = int(own.size());
    MPI_Allgather(&n, 1, MPI_INT, n_per_rank.data(), 1, MPI_INT,
                  communicator.mpi());
    std::vector<int> first(n_per_rank.size(), 0);
    std::partial_sum(n_per_rank.begin(), n_per_rank.end() - 1,
                     first.begin() + 1);
    std::vector<T> all(first.back() + n_per_rank.back());
    const BytesType type(sizeof(T));
    MPI_Allgatherv(own.data(), n, type, all.data(), n_per_rank.data(),
                   first.data(), type, communicator.mpi());
    return all;
  }
} // namespace nsfd
