#pragma once

#include "node_clusters.h"

#include <array>
#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * A step that is known by the motion of the nodes,
   *
   *     U = U_0 + H w,   M_hat w = p + H^T P,
   *
   * and not by v_free + M_hat^-1 H^T P: each Newton step solves one system and
   * not two, what iterations have left is made good by the next one, and in
   * statics no digits are lost in the difference of the two terms, of which
   * each floats by (h/transit time)^2 times what it does in the end.
   */
  class NodeMotion
  {
  public:
    virtual ~NodeMotion() = default;

    /// what is enough of balance() at the start of a step, whose Newton steps
    /// make good what is left
    static constexpr double rough = 1e-3;

    /** What iterations may leave of the momenta: the larger one. */
    struct Accuracy {
      double tolerance;                  ///< of |p| + |H^T P|
      double share;                      ///< of |p - M_hat w + H^T (P + r)|
      const std::vector<double> &defect; ///< r, by which P is wrong; not c,
                                         ///< which is far more where T is stiff
    };

    /**
     * At w = 0, until cancel() or the next reinit() of the bodies. @p momentum
     * is M_hat (v_free - v_0) by unknown of the bodies or empty, @p impulse
     * what acts besides (of pressure in cracks) or empty, @p start is U_0 by
     * point. Tolerances are of no less than @p floor, which what has been
     * unloaded no longer shows, N s. Collective.
     */
    virtual void start(const std::vector<double> &momentum,
                       const std::vector<double> &impulse,
                       const std::vector<double> &start, double floor = 0.) = 0;
    virtual bool is_on() const = 0;
    /** The largest h^2 theta^2 K_ii / M_ii of the bodies. Collective. */
    virtual double stiffness_over_mass() = 0;
    /** Solutions that need not be exact are cheaper, as iterations are. */
    virtual bool saves_by_rough_solutions() const = 0;
    virtual void cancel() = 0;
    /**
     * w without any compliance of points, M_hat w = p + H^T P, to @p tolerance
     * of |p| + |H^T P|. Collective.
     */
    virtual void balance(const std::vector<double> &P, double tolerance) = 0;
    /**
     * The Newton step from w under the impulses P of the last move:
     *
     *     (M_hat + H^T T H) dw = p - M_hat w + H^T (P + c),   dU = H dw,
     *     dP = c - T dU,
     *
     * T a block of dim x dim per point, row by row, @p symmetric or not. False
     * where the matrix is known not to be positive definite, or iterations do
     * not solve it. Collective.
     */
    virtual bool solve(const std::vector<double> &T, bool symmetric,
                       const std::vector<double> &c, const Accuracy &accuracy,
                       std::vector<double> &dP, std::vector<double> &dU) = 0;
    /** The tangents T that there is a factor for, or empty. */
    virtual const std::vector<double> &factored() const = 0;
    /** w += @p length dw, of the last Newton step, under @p P from now on; U.
        Collective. */
    virtual void move(double length, const std::vector<double> &P,
                      std::vector<double> &U) = 0;
    /** w by own node, to come back to. */
    virtual const std::vector<double> &motion() const = 0;
    virtual void set_motion(const std::vector<double> &w,
                            const std::vector<double> &P,
                            std::vector<double> &U) = 0;
    /** |p - M_hat w + H^T P| over |p| + |H^T P|. */
    virtual double imbalance() const = 0;
    /** It is at most @p tolerance, or all that a full step can do for that has
        been done. */
    virtual bool balances(double tolerance) const = 0;
    /** @p velocity += w by unknown of the bodies. Collective. */
    virtual void add_to(std::vector<double> &velocity) const = 0;
    /** p + H^T P - (M_hat - M) w by unknown of the bodies, with all of a node
        at one of its unknowns. Collective. */
    virtual std::vector<double> left_over() const = 0;
  };

  /**
   * Of a NodeMotion whose points see the nodes of one vertex alone: these, with
   * M_hat by its diagonal, while all others stay.
   */
  template <int dim>
  class VertexMotion
  {
  public:
    using Vector = std::array<double, dim>;

    virtual ~VertexMotion() = default;
    /** Nodes and points of the vertices. Collective where the space of the
        nodes has changed. */
    virtual const NodeClusters &vertices() = 0;
    /** Unknowns of a node: own values k n to (k + 1) n - 1 of node k. */
    virtual unsigned int unknowns_per_node() const = 0;
    /** Node k follows others, or others follow it: it is not to be moved by
        itself. Since the last call of vertices(). */
    virtual bool is_tied(int k) const = 0;
    /** Of a node: the inverse of the diagonal of M_hat, 1/kg, and that times
        what is left of its momentum, m/s; 0 beyond its unknowns. */
    virtual void node(int k, Vector &inverse_mass, Vector &velocity) const = 0;
    /** What is seen at a point: nodes, and B of U = sum B v, dim x dim. */
    virtual void
    sight(std::size_t point, std::vector<int> &nodes,
          std::vector<std::array<double, std::size_t(dim) * dim>> &B) const = 0;
  };

  /** What a DelassusOperator of bodies that share nodes can do as well. */
  class VelocitySolver
  {
  public:
    virtual ~VelocitySolver() = default;

    /**
     * dU = H dv and dP = c - T dU of
     *
     *     (M_hat + H^T T H) dv = H^T c,
     *
     * T a block of dim x dim per point, row by row, symmetric. Iterations leave
     * @p tolerance of the right-hand side. False where the matrix is known not
     * to be positive definite, or iterations do not solve it. Collective.
     */
    virtual bool solve_linearised(const std::vector<double> &T,
                                  const std::vector<double> &c,
                                  double tolerance, std::vector<double> &dP,
                                  std::vector<double> &dU) = 0;

    NodeMotion &motion() { return *motion_; }

  protected:
    std::unique_ptr<NodeMotion> motion_;
  };
} // namespace nsfd
