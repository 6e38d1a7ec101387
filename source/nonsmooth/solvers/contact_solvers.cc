#include "contact_solvers.h"

#include "nonsmooth/solver.h"

namespace nsfd
{
  // of either dimension: a problem brings its own
  std::vector<std::pair<std::string, std::string>> contact_solvers()
  {
    std::vector<std::pair<std::string, std::string>> solvers;
    for (const auto &[name, entry] : SolverRegistry<2>::instance().entries())
      if (entry.factory()->contact_solver())
        solvers.emplace_back(name, entry.text);
    return solvers;
  }

  SolverReport solve_contact_problem(const ContactProblem &problem,
                                     const std::string &solver,
                                     const SolverControl &control,
                                     std::vector<double> &impulse)
  {
    const auto created = SolverRegistry<2>::instance().create(solver);
    return solve_contact_problem(problem, *created->contact_solver(), solver,
                                 control, impulse);
  }
} // namespace nsfd
