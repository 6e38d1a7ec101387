#pragma once

#include "contact_problem.h"
#include "nonsmooth/solver_report.h"

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Solves problems of contact and friction alone, whose W is assembled:
   * impulses in (a guess, or zeros) and out. No printing, no throwing; the
   * report tells, in the measure of natural_map_error().
   */
  class ContactSolver
  {
  public:
    virtual ~ContactSolver() = default;
    virtual SolverReport
    solve_assembled(const ContactProblem &problem, const SolverControl &control,
                    std::vector<double> &impulse) const = 0;
  };

  /** What this folder offers for them. */
  enum class ContactMethod {
    automatic,      ///< a cascade of the others, each while it promises to pay
    gauss_seidel,   ///< sweeps of exact local solves
    newton,         ///< semismooth, on the impulses, near minimum-norm steps
    proximal,       ///< proximal point around Newton's method
    interior_point, ///< primal-dual, the friction law in it
    admm,           ///< alternating directions with balanced penalty
    projected_gradient ///< accelerated, with restarts
  };

  /** For solvers that need nothing else to be one. */
  template <ContactMethod method>
  class AssembledMethod : public ContactSolver
  {
  public:
    SolverReport solve_assembled(const ContactProblem &problem,
                                 const SolverControl &control,
                                 std::vector<double> &impulse) const override;
  };

  /**
   * As solver.solve_assembled(), from @p impulse if that has the size of q,
   * else from zero, and nothing is done where nothing is to do. The residual of
   * the report is computed afresh from the problem as it is stored.
   */
  SolverReport solve_contact_problem(const ContactProblem &problem,
                                     const ContactSolver &solver,
                                     const std::string &name,
                                     const SolverControl &control,
                                     std::vector<double> &impulse);
} // namespace nsfd
