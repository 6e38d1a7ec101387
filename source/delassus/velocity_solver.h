#pragma once

#include <vector>

namespace nsfd
{
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
  };
} // namespace nsfd
