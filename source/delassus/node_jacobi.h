#pragma once

#include "joined_matrix.h"

#include "linear_algebra/cholesky.h"
#include "linear_algebra/sparse_lu.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * The preconditioner of M_hat + H^T T H in short steps: blocks of M_hat on
   * its diagonal, node by node, and H^T T H in full,
   *
   *     B = diag(M_hat) + H^T T H,
   *
   * which has a small factor, of the nodes at points with springs alone. The
   * condition of B^-1 (M_hat + H^T T H) is not greater than that of
   * diag(M_hat)^-1 M_hat, whatever the springs.
   */
  template <int dim>
  class NodeJacobi
  {
  public:
    explicit NodeJacobi(const Communicator &communicator)
        : communicator_(communicator)
    {
    }

    /**
     * Of the step that is set in @p matrix; @p springs are null, or positive
     * semidefinite, or not symmetric (@p general: on one rank alone). False: B
     * has no factor. Collective.
     */
    bool prepare(const JoinedMatrix<dim> &matrix, const double *springs,
                 bool general = false);
    /** z = B^-1 r of own values. Collective. */
    void apply(const std::vector<double> &r, std::vector<double> &z);

  private:
    void set_diagonal(const JoinedMatrix<dim> &matrix);
    std::vector<long long> number_stiffened(const JoinedMatrix<dim> &matrix,
                                            const double *springs,
                                            CoarseSpace &space);
    bool factorise(const JoinedMatrix<dim> &matrix, const double *springs,
                   bool general);

    const Communicator &communicator_;
    std::vector<double> inverse_; ///< of the blocks of own nodes, row by row
    unsigned int size_ = 1;       ///< of a block
    std::vector<std::size_t> stiffened_; ///< first unknowns, own values
    std::unique_ptr<Cholesky> factor_;   ///< of them, or null
    std::unique_ptr<SparseLU> general_;  ///< the same
    SparseRows rows_;                    ///< of the latter
    std::vector<double> b_, x_;
  };
} // namespace nsfd
