#pragma once

#include "joined_matrix.h"
#include "node_clusters.h"

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
   *     B = diag(M_hat) + H^T T H.
   *
   * Points at nodes couple the nodes of one vertex alone: B is a small dense
   * matrix per vertex, which is inverted anew where springs have changed. What
   * couples more, or nodes of several ranks, has one factor. The condition of
   * B^-1 (M_hat + H^T T H) is not greater than that of diag(M_hat)^-1 M_hat,
   * whatever the springs.
   */
  template <int dim>
  class NodeJacobi
  {
  public:
    explicit NodeJacobi(const Communicator &communicator)
        : communicator_(communicator)
    {
    }

    /** The step or the space of the matrix is another one. */
    void clear() { placed_ = false; }
    /** Nodes that points couple, where they are few. Collective where the step
        or the space is another one. */
    const NodeClusters &vertices(const JoinedMatrix<dim> &matrix);
    /** The diagonal of M_hat at unknown @p c of own node @p k, of those. */
    double diagonal(const std::size_t k, const unsigned int c) const
    {
      return diagonal_[(k * size_ + c) * size_ + c];
    }
    /**
     * Of the step that is set in @p matrix; @p springs are null, or positive
     * semidefinite, or not symmetric (@p general: on one rank alone). False: B
     * has no factor. Collective.
     */
    bool prepare(const JoinedMatrix<dim> &matrix,
                 const std::vector<double> *springs, bool general = false);
    /** There are small dense matrices alone, on all ranks. */
    bool is_by_vertex() const { return placed_ && by_vertex_; }
    /** z = B^-1 r of own values. Collective. */
    void apply(const std::vector<double> &r, std::vector<double> &z);

  private:
    void set_diagonal(const JoinedMatrix<dim> &matrix);
    void place(const JoinedMatrix<dim> &matrix);
    void cluster(const JoinedMatrix<dim> &matrix);
    template <unsigned int size>
    void apply_inverses(const double *r, double *z) const;
    NodeClusters clusters_of(const JoinedMatrix<dim> &matrix);
    bool invert_clusters(const JoinedMatrix<dim> &matrix,
                         const std::vector<double> &springs, bool general);
    bool factorise(const JoinedMatrix<dim> &matrix,
                   const std::vector<double> &springs, bool general);

    const Communicator &communicator_;
    bool placed_ = false;    ///< all below is of the present step and space
    bool clustered_ = false; ///< there are clusters_, and by_vertex_ is known
    bool by_vertex_ = false;
    unsigned int size_ = 1; ///< of a block
    /// blocks of own nodes, row by row, and their inverses
    std::vector<double> diagonal_, inverse_;
    NodeClusters clusters_;
    std::vector<double> springs_; ///< of which there are inverses, or none
    bool of_general_ = false;     ///< springs_ need not be symmetric
    std::vector<std::size_t> stiffened_; ///< first unknowns, own values
    std::unique_ptr<Cholesky> factor_;   ///< of them, or null
    std::unique_ptr<SparseLU> general_;  ///< the same
    SparseRows rows_;                    ///< of the latter
    std::vector<double> b_, x_;
  };
} // namespace nsfd
