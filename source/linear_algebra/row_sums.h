#pragma once

#include "sparse_rows.h"

namespace nsfd
{
  /**
   * Rows that ranks assemble together, again and again on the same pattern:
   * what a rank adds to rows of others goes to them in one message each.
   */
  class RowSums
  {
  public:
    RowSums() = default;
    /** @p entries as of sum_at_owners(), their values do not matter.
        Collective. */
    RowSums(const Communicator &communicator, const CoarseSpace &space,
            const std::vector<SparseEntry> &entries);

    /** Of @p values in the order of the entries. Collective. */
    const SparseRows &sum(const std::vector<double> &values);

  private:
    void find_places(const Communicator &communicator, const CoarseSpace &space,
                     const std::vector<SparseEntry> &entries);
    long long number(const SparseEntry &entry) const;

    SparseRows matrix_;
    long long first_ = 0;          ///< own entry, among those of all ranks
    std::vector<long long> place_; ///< by value; ghosts follow the own entries
    GhostValues exchange_;
    std::vector<double> ghosts_;
  };
} // namespace nsfd
