#pragma once

#include "point_nodes.h"

#include "linear_algebra/cholesky.h"
#include "linear_algebra/multigrid.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * Preconditions A = M_hat + H^T T H of bodies that share nodes by a V-cycle V
   * of smoothed aggregation of
   *
   *     A_c = M_hat + H^T T_c H,
   *
   * T_c the tangents without what they have beyond the stiffness of the nodes:
   * two nodes that a point holds together move as one against their
   * neighbours, which the smoothers of a hierarchy do not see. With B of
   * PointNodes, of T and of T_c,
   *
   *     P = B^-1 B_c,   z = P V P^T r + E B^-1 E^T r.
   *
   * P takes away the jumps that T does not allow, at little energy, so that
   * the condition does not depend on T; E B^-1 E^T answers for what is left of
   * them. An old hierarchy serves other tangents, as far as what has changed
   * is local. Chebyshev polynomials smooth on the finest level, with products
   * body by body, which read less than a matrix.
   */
  template <int dim>
  class TangentMultigrid
  {
  public:
    using Vector = std::vector<double>;

    explicit TangentMultigrid(const Communicator &communicator);

    /** A hierarchy for these @p springs, T, symmetric ones; false: B has no
        factor. Collective. */
    bool prepare(JoinedMatrix<dim> &matrix, const Vector &springs);
    /** The same with the hierarchy that there is. */
    bool adjust(const JoinedMatrix<dim> &matrix, const Vector &springs);
    /** y = A x of own values. Collective. */
    void multiply(const Vector &x, Vector &y);
    /** Of own values. Collective. */
    void apply(const Vector &r, Vector &z);

  private:
    void invert_diagonal(const JoinedMatrix<dim> &matrix);
    void find_largest_eigenvalue();
    void scale(const Vector &r, Vector &z) const;
    void smooth(Vector &residual, Vector &x);
    void cycle(const Vector &r, Vector &z);
    void limit(const JoinedMatrix<dim> &matrix, Vector &springs);
    /** H^T T H at the nodes of points. */
    struct Springs {
      SparseRows rows;
      GhostValues exchange;
    };
    void set_springs(const JoinedMatrix<dim> &matrix, const Vector &springs,
                     Springs &result);
    void add_springs(const Springs &springs, const Vector &x, Vector &y);
    void multiply_limited(Vector &x);
    void multiply_cycle(const Vector &x, Vector &y);

    const Communicator &communicator_;
    Multigrid coarser_;
    const JoinedMatrix<dim> *matrix_ = nullptr; ///< of the hierarchy
    Vector inverse_;      ///< of the blocks of A_c at own nodes
    double largest_ = 0.; ///< eigenvalue of A_c with these
    Vector change_, product_, residual_;
    Vector diagonal_; ///< blocks of M_hat at own nodes
    Vector limited_;  ///< T_c of the hierarchy
    PointNodes<dim> nodes_;
    Springs of_limited_, present_;
    std::unique_ptr<Cholesky> factor_; ///< of B, or null: there are no nodes
    Vector part_, forces_, local_, right_;
  };
} // namespace nsfd
