#include "save_problem.h"

#include "nonsmooth/frictional_contact/fclib.h"
#include "nonsmooth/solvers/condense.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <filesystem>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    fs::path free_name(const fs::path &folder, const unsigned int step)
    {
      fs::path file = folder / fmt::format("step_{:04}.hdf5", step);
      for (unsigned int k = 2; fs::exists(file); ++k)
        file = folder / fmt::format("step_{:04}_{}.hdf5", step, k);
      return file;
    }
  } // namespace

  template <int dim>
  void save_problem(const SceneInput &input, const OneStepProblem<dim> &problem,
                    const DelassusOperator<dim> &delassus,
                    const LawEvaluation<dim> &evaluation,
                    const SolverReport &report, const unsigned int step,
                    const double time)
  {
    const std::string &which = input.solver.save_problems;
    const bool hard = !report.converged || !report.switches.empty();
    if (which == "none" || (which == "hard" && !hard))
      return;
    ContactProblem contact =
        condense_contacts<dim>(problem, delassus, evaluation);
    if (contact.n_contacts() == 0)
      return;
    if (!report.converged)
      contact.solution.clear();
    contact.title =
        fmt::format("{}, step {}", fs::path(input.file).stem().string(), step);
    contact.description = fmt::format(
        "contacts of the step of {:.6g} s from t = {:.6g} s; other points are "
        "eliminated at their secants",
        problem.time_step, time);
    contact.math_info =
        fmt::format("{} by the run: residual {:.2e}, {} Newton steps, {} "
                    "sweeps, {} hand-overs",
                    report.converged ? "solved" : "not solved", report.residual,
                    report.newton, report.sweeps, report.switches.size());
    const fs::path folder = fs::path(input.output.directory) / "problems";
    fs::create_directories(folder);
    write_fclib(free_name(folder, step).string(), contact);
  }

  template void save_problem<2>(const SceneInput &, const OneStepProblem<2> &,
                                const DelassusOperator<2> &,
                                const LawEvaluation<2> &, const SolverReport &,
                                unsigned int, double);
  template void save_problem<3>(const SceneInput &, const OneStepProblem<3> &,
                                const DelassusOperator<3> &,
                                const LawEvaluation<3> &, const SolverReport &,
                                unsigned int, double);
} // namespace nsfd
