#pragma once

#include "contact_problem.h"
#include "nsfd/core/registry.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** How far a stored problem has to be solved, and at what cost at most. */
  struct ContactControl {
    double tolerance = 1e-8; ///< of natural_map_error()
    /// sweeps, or products with W; 0: what the solver thinks reasonable
    unsigned int maximum_iterations = 0;
  };

  /** What a solve has cost and how far it came. */
  struct ContactReport {
    bool solved = false;
    double error = 0.; ///< natural_map_error() of the result
    /// largest -u_N / max |q|. The error is relative to |r| as well: where no r
    /// is a solution it can be made small by large r, and only this tells.
    double penetration = 0.;
    std::string solver;          ///< the one that finished
    unsigned int iterations = 0; ///< of all solvers that took part
    unsigned int products = 0;   ///< with W, sweeps included
    unsigned int factorisations = 0;
    std::vector<std::string> switches; ///< hand-overs, with the error at each
  };

  /**
   * Solves a stored problem: impulses in (a guess, or zeros) and out. No
   * printing, no throwing; the report tells, in the measure of
   * natural_map_error().
   */
  class ContactSolver
  {
  public:
    virtual ~ContactSolver() = default;
    virtual ContactReport solve(const ContactProblem &problem,
                                const ContactControl &control,
                                std::vector<double> &impulse) const = 0;
  };

  using ContactSolverRegistry = Registry<ContactSolver>;

  /** By the registered name; r starts at @p impulse if that has the size of q,
   * else at zero. The error of the report is computed afresh from the problem
   * as it is stored. */
  ContactReport solve_contact_problem(const ContactProblem &problem,
                                      const std::string &solver,
                                      const ContactControl &control,
                                      std::vector<double> &impulse);
} // namespace nsfd
