#pragma once

#include "partial_cholesky.h"

#include "core/communicator.h"

#include <vector>

namespace nsfd
{
  /**
   * A matrix whose unknowns are eliminated in two parts. Rows that are coupled
   * to those of a later rank, and rows that are asked for, are common; every
   * rank eliminates the rest of its own by itself,
   *
   *     A = | A_ii A_ic |      S = A_cc - sum over ranks of A_ci A_ii^-1 A_ic,
   *         | A_ci A_cc |
   *
   * and all ranks know S, so that none waits for another one's factor. A
   * solution takes one exchange.
   */
  class Dissection
  {
  public:
    explicit Dissection(const Communicator &communicator);

    /**
     * Of the pattern of @p matrix. @p asked, by own row, or empty: further rows
     * that are to be common. False, on all ranks: out of memory. Collective.
     */
    bool analyse(const SparseRows &matrix, const std::vector<char> &asked = {});
    /** There has been an analysis. */
    bool is_ready() const { return !shares_.empty(); }
    void clear() { shares_.clear(); }
    /** S of these values. False, on all ranks: not positive definite, or out of
        memory. Collective. */
    bool eliminate(const SparseRows &matrix);

    /** What the elimination on a rank says of the common unknowns. */
    struct Share {
      std::vector<int> boundary; ///< those it is coupled to, ascending
      int first = 0, count = 0;  ///< those it owns
      std::vector<int> entries;  ///< pairs row, column <= row: of its own rows
    };
    /** Of all ranks. */
    const std::vector<Share> &shares() const { return shares_; }
    int n_common() const { return n_common_; }
    /** By own row and ghost of the matrix: number of what is common, or -1. */
    const std::vector<int> &number() const { return number_; }

    /** @p add (row, column, value) of terms of S, column <= row, in the order
        of the ranks. */
    template <typename Add>
    void for_terms(const Add &add) const
    {
      const double *value = terms_.data();
      for (const Share &share : shares_) {
        const auto &boundary = share.boundary;
        for (std::size_t r = 0; r < boundary.size(); ++r)
          for (std::size_t c = 0; c <= r; ++c)
            add(boundary[r], boundary[c], *value++);
        for (std::size_t e = 0; e < share.entries.size(); e += 2)
          add(share.entries[e], share.entries[e + 1], *value++);
      }
    }
    /** S is known to its user: no memory for its terms from now on. */
    void forget_terms() { terms_ = std::vector<double>(); }

    /** Where a vector has the unknowns; by default as the matrix. */
    struct Places {
      std::vector<int> inner; ///< by inner unknown
      /// of common ones that vectors of this rank have: which, and the place
      std::vector<std::pair<int, int>> own;
    };
    /** Collective. */
    void set_places(Places places);

    /** @p right side for S of @p b. Collective. */
    void forward(const double *b, std::vector<double> &right);
    /** After forward(): all of @p x from @p common, the solution with S. */
    void backward(const std::vector<double> &common, double *x);

    /** Entries of the factor of A_ii on this rank, 8 bytes each. */
    double n_entries() const { return inner_.n_entries(); }

  private:
    void find_common(const SparseRows &matrix, const std::vector<char> &asked);
    void split(const SparseRows &matrix);
    void gather_shares();

    const Communicator &communicator_;
    PartialCholesky inner_;
    int n_inner_ = 0, n_common_ = 0;
    std::vector<int> number_;
    Share own_;
    std::vector<Share> shares_;
    SparseRows inner_matrix_;
    /// by entry of it, and of own rows in S: place among those of the matrix
    std::vector<int> inner_source_, common_source_;
    std::vector<double> terms_; ///< of S, rank by rank
    Places places_;
    std::vector<int> all_own_; ///< common unknowns that ranks have, by rank
    struct {
      std::vector<int> counts, offsets;
    } values_, sums_; ///< of messages, by rank: of S, of right sides
    std::vector<double> x_;
  };
} // namespace nsfd
