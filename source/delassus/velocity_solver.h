#pragma once

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * A step from rest, which is known by the motion v of the nodes and not by
   * v_free + M_hat^-1 H^T P: what nothing but impulses holds floats by
   * (h/transit time)^2 times what it does in the end, and the digits of that
   * would be lost in the difference.
   */
  class StepFromRest
  {
  public:
    virtual ~StepFromRest() = default;

    /**
     * A step of h, until finish() or the next reinit() of the bodies.
     * @p momentum is h F by unknown of the bodies, @p impulse what acts besides
     * (of pressure in cracks) or empty, and @p displacement is q at the start.
     * Collective.
     */
    virtual void start(double h, const std::vector<double> &momentum,
                       const std::vector<double> &impulse,
                       const std::vector<double> &displacement) = 0;
    /** The present step is such a one. */
    virtual bool is_on() const = 0;
    virtual void cancel() = 0;
    /**
     * The Newton step from v under @p P, which need not balance yet:
     *
     *     (M_hat + H^T T H) dv = p - M_hat v + H^T (P + c),
     *
     * p the momentum of F - K q; the rest as for
     * VelocitySolver::solve_linearised(). Iterations leave @p tolerance of the
     * right-hand side. Collective.
     */
    virtual bool solve(const std::vector<double> &T, bool symmetric,
                       const std::vector<double> &P,
                       const std::vector<double> &c, double tolerance,
                       std::vector<double> &dP, std::vector<double> &dU) = 0;
    /** v += @p length dv, of the last Newton step; U = H v. Collective. */
    virtual void move(double length, std::vector<double> &U) = 0;
    /** v by own node, to come back to. */
    virtual const std::vector<double> &motion() const = 0;
    virtual void set_motion(const std::vector<double> &v) = 0;
    /** v by unknown of the bodies, and p + H^T P - (M_hat - M) v with all of a
        node at one of its unknowns. Collective. */
    virtual void finish(const std::vector<double> &P,
                        std::vector<double> &velocity,
                        std::vector<double> &left) = 0;
  };

  /** What a DelassusOperator of bodies that share nodes can do as well. */
  class VelocitySolver
  {
  public:
    virtual ~VelocitySolver() = default;

    /**
     * A Newton step in the velocities of the bodies:
     *
     *     (M_hat + H^T T H) dv = H^T c,   dU = H dv,   dP = c - T dU,
     *
     * T a block of dim x dim per point, row by row, @p symmetric or not. What
     * is left of the momentum is at most @p share of |H^T r|, r the @p defect
     * of the impulses; without one, round-off or what iterations leave. False
     * where the matrix is known not to be positive definite, or iterations do
     * not solve it. Collective.
     */
    virtual bool solve_linearised(const std::vector<double> &T, bool symmetric,
                                  const std::vector<double> &c,
                                  std::vector<double> &dP,
                                  std::vector<double> &dU,
                                  const std::vector<double> *defect = nullptr,
                                  double share = 0.) = 0;

    StepFromRest &from_rest() { return *from_rest_; }

  protected:
    std::unique_ptr<StepFromRest> from_rest_;
  };
} // namespace nsfd
