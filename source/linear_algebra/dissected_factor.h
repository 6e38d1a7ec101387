#pragma once

#include "cholesky.h"
#include "partial_cholesky.h"

#include <vector>

namespace nsfd
{
  /**
   * Cholesky's factor of a matrix whose rows lie on several ranks. Rows that
   * are coupled to those of a later rank are common: of joined cells the nodes
   * between ranks, which belong to the first of them. Every rank eliminates
   * the rest of its own by itself; what that leaves for the common ones is
   * summed and factored on every rank, so that none waits for another one's
   * factor. A solution takes one exchange.
   */
  class DissectedFactor
  {
  public:
    explicit DissectedFactor(const Communicator &communicator);

    /** False, on all ranks: not positive definite, or too large. */
    bool try_factorise(const SparseRows &matrix, bool new_pattern);
    void solve(const double *b, double *x);

    /** Of this rank and of what is common, 8 bytes each. */
    double n_entries() const;

  private:
    /** What the elimination on a rank says of the common unknowns. */
    struct Share {
      std::vector<int> boundary; ///< those it is coupled to, ascending
      int first = 0, count = 0;  ///< those it owns
      std::vector<int> entries;  ///< pairs row, column <= row: of its own rows
    };

    void find_common(const SparseRows &matrix);
    void split(const SparseRows &matrix);
    void gather_shares();
    void set_common_pattern();
    std::vector<double> eliminate(const SparseRows &matrix, bool &failed);
    void sum(const std::vector<double> &values);

    const Communicator &communicator_;
    const Communicator alone_;
    PartialCholesky inner_;
    Cholesky common_;
    int n_inner_ = 0, n_common_ = 0;
    /// by own row and ghost: number of what is common, or -1
    std::vector<int> number_;
    std::vector<int> place_; ///< by own row: among the inner ones, or -1
    Share own_;
    std::vector<Share> shares_; ///< of all ranks
    SparseRows inner_matrix_, common_matrix_;
    /// by entry of these: place among those of the matrix
    std::vector<int> inner_source_, common_source_;
    struct {
      std::vector<int> counts, offsets;
    } values_, sums_; ///< of messages, by rank: of factors, of solutions
    std::vector<double> x_, right_, solution_;
  };
} // namespace nsfd
