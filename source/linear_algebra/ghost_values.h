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

    /**
     * Values of the owners, @p width of them at each: @p pack (own unknown,
     * values) is called for all that other ranks want, @p unpack (number of the
     * ghost, values) for all ghosts.
     */
    template <typename Pack>
    void start(const unsigned int width, const Pack &pack) const
    {
      for (std::size_t k = 0; k < neighbors_.size(); ++k) {
        const Neighbor &neighbor = neighbors_[k];
        auto &message = messages_.messages[k];
        message.in.resize(neighbor.count * width);
        message.out.resize(neighbor.wanted.size() * width);
        for (std::size_t j = 0; j < neighbor.wanted.size(); ++j)
          pack(std::size_t(neighbor.wanted[j]), message.out.data() + j * width);
      }
      messages_.start(mpi_, 21);
    }
    template <typename Unpack>
    void finish(const unsigned int width, const Unpack &unpack) const
    {
      messages_.finish();
      for (std::size_t k = 0; k < neighbors_.size(); ++k)
        for (std::size_t j = 0; j < neighbors_[k].count; ++j)
          unpack(neighbors_[k].first + j,
                 messages_.messages[k].in.data() + j * width);
    }

    /** One value each. */
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
