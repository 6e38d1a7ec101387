#include "core/exit_code.h"
#include "core/stopwatch.h"
#include "nonsmooth/frictional_contact/fclib.h"
#include "nonsmooth/solvers/contact_solvers.h"
#include "solve_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <ostream>

namespace nsfd
{
  namespace
  {
    struct Result {
      SolverReport report;
      double seconds = 0.;
      unsigned int runs = 0;
    };

    /** CPU time of the solve alone; a short one is repeated, and the fastest
     * counts. All runs do the same. */
    Result solve(const ContactProblem &problem, const SolveCommand &command)
    {
      SolverControl control;
      control.tolerance = command.tolerance;
      Result result;
      double total = 0.;
      for (unsigned int k = 0; k < 20 && (k == 0 || total < 0.1); ++k) {
        std::vector<double> impulse = problem.guess;
        const double start = cpu_seconds();
        result.report =
            solve_contact_problem(problem, command.solver, control, impulse);
        const double seconds = cpu_seconds() - start;
        result.seconds = k == 0 ? seconds : std::min(seconds, result.seconds);
        total += seconds;
        ++result.runs;
      }
      return result;
    }

    std::string milliseconds(const double seconds)
    {
      return fmt::format("{:.3f} ms", 1e3 * seconds);
    }

    void print_one(std::ostream &out, const std::string &file,
                   const ContactProblem &problem, const SolveCommand &command,
                   const Result &result)
    {
      const SolverReport &report = result.report;
      const auto line = [&](const char *name, const std::string &text) {
        out << fmt::format("{:<14} {}\n", name, text);
      };
      line("problem", file);
      if (!problem.title.empty())
        line("title", problem.title);
      line("size", fmt::format("{} contacts in {}D, {} entries in W",
                               problem.n_contacts(), problem.dimension,
                               problem.value.size()));
      line("solver", report.solver);
      for (const std::string &hand_over : report.switches)
        line("hand-over", hand_over);
      line("iterations",
           fmt::format("{} ({} products with W, {} factorisations)",
                       report.iterations, report.products,
                       report.factorisations));
      line("residual", fmt::format("{:.2e}, {} {:.0e}", report.residual,
                                   report.converged ? "solved to" : "NOT below",
                                   command.tolerance));
      line("penetration",
           fmt::format("{:.2e} of the largest |q|", report.penetration));
      line("CPU time",
           milliseconds(result.seconds) +
               (result.runs > 1
                    ? fmt::format(", the least of {} runs", result.runs)
                    : ""));
    }

    struct ProblemTable {
      std::ostream &out;
      int width;

      void header() const
      {
        out << fmt::format("{:<{}}  d contacts  {:<14} iterations factors "
                           "hand-overs  residual     CPU time\n",
                           "problem", width, "solver");
      }
      void row(const std::string &name, const ContactProblem &problem,
               const Result &result) const
      {
        const SolverReport &report = result.report;
        out << fmt::format(
            "{:<{}}  {} {:>8}  {:<14} {:>10} {:>7} {:>10}  {:.2e} {:>12}{}\n",
            name, width, problem.dimension, problem.n_contacts(), report.solver,
            report.iterations, report.factorisations, report.switches.size(),
            report.residual, milliseconds(result.seconds),
            report.converged ? "" : "  NOT SOLVED");
      }
    };

    std::string stem_of(const std::string &file)
    {
      return std::filesystem::path(file).stem().string();
    }

    /** All files at once: what is wrong with them is said before any work. */
    std::vector<ContactProblem> read_all(const SolveCommand &command,
                                         std::ostream &err, bool &bad)
    {
      std::vector<ContactProblem> problems;
      for (const std::string &file : command.files)
        try {
          problems.push_back(read_fclib(file));
        } catch (const BadContactFile &error) {
          err << "nsfd solve: " << error.what() << "\n";
          bad = true;
        }
      return problems;
    }
  } // namespace

  int run_solve(const SolveCommand &command, std::ostream &out,
                std::ostream &err)
  {
    bool bad = false;
    const std::vector<ContactProblem> problems = read_all(command, err, bad);
    if (bad)
      return exit_code::bad_input;

    ProblemTable table{out, 7};
    for (const std::string &file : command.files)
      table.width = std::max(table.width, int(stem_of(file).size()));
    const bool several = problems.size() > 1, quiet = command.quiet;
    if (several && !quiet)
      table.header();
    std::size_t unsolved = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
      const Result result = solve(problems[i], command);
      unsolved += !result.report.converged;
      if (quiet)
        continue;
      if (several)
        table.row(stem_of(command.files[i]), problems[i], result);
      else
        print_one(out, command.files[i], problems[i], command, result);
      out.flush();
    }
    if (several && !quiet)
      out << fmt::format("{} of {} solved to {:.0e}\n",
                         problems.size() - unsolved, problems.size(),
                         command.tolerance);
    return unsolved ? exit_code::step_failed : exit_code::done;
  }
} // namespace nsfd
