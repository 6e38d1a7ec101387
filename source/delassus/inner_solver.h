#pragma once

#include <vector>

namespace nsfd
{
  /** A Newton system of the point laws; vectors have an entry per component. */
  struct InnerSystem {
    const std::vector<double> &D; ///< >= 0; negative: takes no part
    double tolerance = 0.;  ///< relative, in the norm of the preconditioner
    unsigned int limit = 0; ///< of iterations
    // of the unsymmetric system
    const std::vector<double> *jacobian = nullptr; ///< J, row-major by point
    const std::vector<double> *majorant = nullptr; ///< R
    double shift = 0.;
  };

  /**
   * Newton systems in single precision, for steps that need a few digits only:
   * what a Delassus operator may offer where W is applied so often that it
   * matters.
   */
  class InnerSolver
  {
  public:
    virtual ~InnerSolver() = default;

    /**
     * x of (W + D) x = r on the components with D >= 0, zero elsewhere, by
     * conjugate gradients; where J is given, of
     * (I - J (W + shift R - R)) x = r by GMRES. Returns the iterations.
     */
    virtual unsigned int solve_inner(const InnerSystem &system,
                                     const std::vector<double> &r,
                                     std::vector<double> &x) = 0;
  };
} // namespace nsfd
