#pragma once

#include "ghost_values.h"
#include "spd_solver.h"

namespace nsfd
{
  /**
   * Unknowns of a space that follow others, x_h = sum C_hi x_i, as nodes do
   * that hang on the face of a larger cell. What solves among the others sees
   * C^T A C and C^T b in place of A and b.
   */
  class TiedUnknowns
  {
  public:
    TiedUnknowns() = default;
    /** Collective. */
    TiedUnknowns(const Communicator &communicator, const CoarseSpace &space);

    /** Alike on all ranks. */
    bool any() const { return space_ && !space_->ties.empty(); }

    /** C^T A C; what follows has the diagonal of A. Collective. */
    SparseRows fold(const SparseRows &A);
    /** C^T b of own values, 0 at what follows. Collective. */
    void fold(double *b) const;
    /** C x: what follows is set. Collective. */
    void follow(double *x) const;

  private:
    struct Share {
      int master; ///< own, then ghosts
      double weight;
    };

    /** On one rank: where an entry of A goes. */
    struct Plan {
      std::vector<int> start, column;  ///< of A, for which it holds
      std::vector<std::size_t> first;  ///< of its parts, by entry of A
      std::vector<std::size_t> target; ///< among the entries of the result
      std::vector<double> weight;
      SparseRows result; ///< without values
    };
    /** An entry of A is in @p row and @p column with this weight. */
    struct Part {
      long long row, column;
      double weight;
    };

    template <typename Take>
    void for_all_parts(const SparseRows &A, const Take &take) const;
    void make_plan(const SparseRows &A);

    const Communicator *communicator_ = nullptr;
    const CoarseSpace *space_ = nullptr;
    std::vector<int> tied_;          ///< own ones
    std::vector<std::size_t> first_; ///< of their shares, and the end
    std::vector<Share> shares_;
    GhostValues exchange_;
    std::size_t n_ghosts_ = 0;
    Plan plan_;
  };
} // namespace nsfd
