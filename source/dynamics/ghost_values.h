#pragma once

#include "nsfd/base/communicator.h"

#include <vector>

namespace nsfd
{
  /**
   * Values at unknowns that other ranks own. Ranks own consecutive numbers;
   * `ghosts` are global numbers, ascending.
   */
  class GhostValues
  {
  public:
    GhostValues() = default;
    GhostValues(const Communicator &communicator,
                long long first,
                std::size_t n_own,
                const std::vector<long long> &ghosts);

    /** Values of the owners. */
    void fetch(const double *own, double *ghosts) const;
    /** Add what is at the ghosts to the values of their owners. */
    void add_back(const double *ghosts, double *own) const;

    struct Neighbor
    {
      int rank = 0;
      std::size_t first = 0, count = 0; ///< range of ghosts it owns
      std::vector<int> wanted;          ///< own unknowns it has as ghosts
    };
    const std::vector<Neighbor> &neighbors() const { return neighbors_; }

  private:
    MPI_Comm mpi_ = MPI_COMM_SELF;
    std::vector<Neighbor> neighbors_;
    mutable std::vector<std::vector<double>> buffers_;
    mutable std::vector<MPI_Request> requests_;
  };
} // namespace nsfd
