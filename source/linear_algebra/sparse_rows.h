#pragma once

#include "ghost_values.h"

#include "spd_solver.h"

namespace nsfd
{
  /** y = A x; @p x holds the own values, then room for the ghosts. */
  void multiply(const SparseRows &A, const GhostValues &exchange, double *x,
                double *y);

  /** By global numbers. */
  struct SparseEntry {
    long long row, column;
    double value;
    bool operator<(const SparseEntry &other) const
    {
      return row != other.row ? row < other.row : column < other.column;
    }
  };

  /**
   * The rows that this rank owns in @p space, from entries of any rows on all
   * ranks, which are summed in the order of the ranks.
   */
  SparseRows sum_at_owners(const Communicator &communicator,
                           const CoarseSpace &space,
                           std::vector<SparseEntry> entries);

  /**
   * P^T A P for the space @p coarse. @p ghost_numbers are the coarse numbers
   * of the ghosts of A. Rows that belong to other ranks are sent there.
   */
  SparseRows coarse_rows(const Communicator &communicator, const SparseRows &A,
                         const CoarseSpace &coarse,
                         const std::vector<long long> &ghost_numbers);
} // namespace nsfd
