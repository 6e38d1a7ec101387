#pragma once

#include "core/communicator.h"
#include "core/neighbor_messages.h"

#include <vector>

namespace nsfd
{
  /**
   * Values at unknowns that other ranks own. Ranks own consecutive numbers;
   * `ghosts` are global numbers, ascending. Both exchanges come in two parts
   * with room for work in between; one at a time.
   */
  class GhostValues
  {
  public:
    GhostValues() = default;
    GhostValues(const Communicator &communicator, long long first,
                std::size_t n_own, const std::vector<long long> &ghosts);

    /** Values of the owners. */
    void fetch(const double *own, double *ghosts) const
    {
      start_fetch(own);
      finish_fetch(ghosts);
    }
    void start_fetch(const double *own) const;
    void finish_fetch(double *ghosts) const;

    /** Add what is at the ghosts to the values of their owners. */
    void start_add_back(const double *ghosts) const;
    void finish_add_back(double *own) const;

  private:
    struct Neighbor {
      std::size_t first = 0, count = 0; ///< range of ghosts it owns
      std::vector<int> wanted;          ///< own unknowns it has as ghosts
    };
    MPI_Comm mpi_ = MPI_COMM_SELF;
    std::vector<Neighbor> neighbors_;
    mutable NeighborMessages<double>
        messages_; ///< one per neighbour, with its rank
  };
} // namespace nsfd
