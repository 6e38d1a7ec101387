#pragma once

#include "nonsmooth/frictional_contact/contact_solver.h"

#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** The registered solvers that take problems whose W is assembled: names and
   * texts, in the order of names. */
  std::vector<std::pair<std::string, std::string>> contact_solvers();

  /** By the registered name, which must be one of contact_solvers(). */
  SolverReport solve_contact_problem(const ContactProblem &problem,
                                     const std::string &solver,
                                     const SolverControl &control,
                                     std::vector<double> &impulse);
} // namespace nsfd
