#pragma once

#include "joined_matrix.h"

#include "linear_algebra/row_sums.h"

#include <vector>

namespace nsfd
{
  /**
   * Nodes at points with springs, apart from all others, with
   *
   *     B = diag(M_hat) + H^T T H,
   *
   * the blocks of M_hat at each node, and what points couple in full.
   */
  template <int dim>
  class PointNodes
  {
  public:
    /** Those at points where blocks T of @p springs are not zero, and the
        pattern of B, unless they are the same points. True if they are others.
        Collective. */
    bool number(const JoinedMatrix<dim> &matrix,
                const std::vector<double> &springs);
    /** The space of the matrix is another one. */
    void clear() { known_.clear(); }
    /** First unknowns of all, among own values of the matrix. */
    const std::vector<std::size_t> &unknowns() const { return unknowns_; }
    /** There is none on any rank. */
    bool none() const { return space_.n_global == 0; }
    /** B, @p diagonal those of M_hat; other points than the numbered ones have
        no springs. Good until the next call. Collective. */
    const SparseRows &rows(const JoinedMatrix<dim> &matrix,
                           const std::vector<double> &diagonal,
                           const std::vector<double> &springs);

  private:
    void set_pattern(const JoinedMatrix<dim> &matrix);

    std::vector<char> known_;           ///< by point
    std::vector<std::size_t> points_;   ///< ascending
    CoarseSpace space_;                 ///< of these nodes
    std::vector<long long> numbers_;    ///< in it, by node of the matrix
    std::vector<std::size_t> places_;   ///< of the nodes in the matrix
    std::vector<std::size_t> unknowns_; ///< own values
    RowSums sums_;
    std::vector<double> values_;
  };
} // namespace nsfd
