#include "core/exit_code.h"
#include "core/output_folder.h"
#include "core/stopwatch.h"
#include "nonsmooth/frictional_contact/fclib.h"
#include "nonsmooth/solvers/contact_solvers.h"
#include "solve_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <ostream>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    struct Result {
      SolverReport report;
      std::vector<double> impulse;
      double seconds = 0.;
      unsigned int runs = 0;
    };

    /** CPU time of the solve alone; a short one is repeated, and the fastest
     * counts. All runs do the same. */
    Result solve(const ContactProblem &problem, const SolveCommand &command)
    {
      SolverControl control;
      control.tolerance = command.tolerance;
      control.attempts = command.attempts;
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
        result.impulse = std::move(impulse);
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
      if (report.attempts > 1)
        line("attempts", fmt::format("{}; the answer is of number {}",
                                     report.attempts, report.best_attempt));
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
                           "hand-overs  residual     CPU time attempts\n",
                           "problem", width, "solver");
      }
      void row(const std::string &name, const ContactProblem &problem,
               const Result &result) const
      {
        const SolverReport &report = result.report;
        out << fmt::format(
            "{:<{}}  {} {:>8}  {:<14} {:>10} {:>7} {:>10}  {:.2e} {:>12} "
            "{:>8}{}\n",
            name, width, problem.dimension, problem.n_contacts(), report.solver,
            report.iterations, report.factorisations, report.switches.size(),
            report.residual, milliseconds(result.seconds), report.attempts,
            report.converged ? "" : "  NOT SOLVED");
      }
    };

    std::string stem_of(const std::string &file)
    {
      return fs::path(file).stem().string();
    }

    /** Where the answers go: files of the same names in one folder, and none of
     * them over a file. */
    class Answers
    {
    public:
      explicit Answers(const SolveCommand &command) : folder_(command.folder) {}

      /** What would be in the way of writing them, before any work; empty:
       * nothing. The folder is there then. */
      std::string obstacle(const std::vector<std::string> &files) const
      {
        if (folder_.empty())
          return "";
        std::map<std::string, std::string> first;
        for (const std::string &file : files) {
          const auto [other, is_new] =
              first.emplace(target(file).string(), file);
          if (!is_new)
            return fmt::format("--write: {} and {} would be one file",
                               other->second, file);
          if (is_there(target(file)))
            return already_there(file);
        }
        std::error_code error;
        fs::create_directories(folder_, error);
        if (!fs::is_directory(folder_))
          return fmt::format("--write: {} cannot be a folder{}", folder_,
                             error ? ": " + error.message() : "");
        return "";
      }

      /** Sizes of vectors are those of the problem for the readers of FCLIB: it
       * goes along. @throws OutputError */
      void write(const std::string &file, ContactProblem problem,
                 const std::vector<double> &impulse) const
      {
        if (folder_.empty())
          return;
        if (is_there(target(file)))
          throw OutputError(already_there(file));
        problem.solution = impulse;
        try {
          write_fclib(target(file).string(), problem);
        } catch (const BadContactFile &error) {
          throw OutputError(error.what());
        }
      }

    private:
      fs::path target(const std::string &file) const
      {
        return fs::path(folder_) / fs::path(file).filename();
      }
      /** Links that lead nowhere, too. */
      static bool is_there(const fs::path &path)
      {
        std::error_code error;
        return fs::symlink_status(path, error).type() !=
               fs::file_type::not_found;
      }
      std::string already_there(const std::string &file) const
      {
        return fmt::format("--write: {} is there already, and no file is "
                           "replaced",
                           target(file).string());
      }

      std::string folder_;
    };

    /** All files at once: what is wrong with them is said before any work. */
    std::vector<ContactProblem> read_all(const SolveCommand &command,
                                         std::ostream &err, bool &bad)
    {
      std::vector<ContactProblem> problems;
      for (ReadProblem &answer : read_fclib(command.files)) {
        if (!answer.error.empty())
          err << "nsfd solve: " << answer.error << "\n";
        bad |= !answer.error.empty();
        problems.push_back(std::move(answer.problem));
      }
      return problems;
    }
  } // namespace

  int run_solve(const SolveCommand &command, std::ostream &out,
                std::ostream &err)
  {
    bool bad = false;
    const std::vector<ContactProblem> problems = read_all(command, err, bad);
    const Answers answers(command);
    const std::string obstacle = bad ? "" : answers.obstacle(command.files);
    if (!obstacle.empty())
      err << "nsfd solve: " << obstacle << "\n";
    if (bad || !obstacle.empty())
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
      answers.write(command.files[i], problems[i], result.impulse);
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
