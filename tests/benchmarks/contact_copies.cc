// Stored contact problems and copies of them, by the cascade: is the answer
// luck of an order or of a digit? Not part of the test suite.
//
//   contact_copies [--details] [--tolerance T] [--attempts N] [--copies N]
//                  [PROBLEM.hdf5 ...]
//
// Without names the problems are those of the folder that the environment
// variable NSFD_CONTACT_PROBLEMS names; without it nothing is done. Of every
// problem with 20 contacts or more eight copies are solved: four with the
// contacts in a random order, two with every entry of q changed by up to 1e-3
// of itself, one with half the friction and one with 1.5 times. Seeds are
// fixed. --copies N takes N of each kind of the first two instead. Times are
// CPU of the solve, once.
#include "../unit/contact_copies.h"
#include "core/stopwatch.h"
#include "nonsmooth/frictional_contact/contact_solver.h"
#include "nonsmooth/frictional_contact/fclib.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace
{
  using namespace nsfd;
  namespace fs = std::filesystem;

  struct Options {
    bool details = false;
    double tolerance = 1e-8;
    unsigned int attempts = 1000; ///< as `nsfd solve`
    unsigned int relabelled = 4, perturbed = 2;
    std::vector<std::string> files;
  };

  /** Of one kind of copies. */
  struct Count {
    unsigned int solved = 0, all = 0;
    double error = 0., seconds = 0.; ///< the worst

    void add(const bool good, const double residual, const double time)
    {
      solved += good;
      ++all;
      error = std::max(error, residual);
      seconds = std::max(seconds, time);
    }
    void add(const Count &other)
    {
      solved += other.solved;
      all += other.all;
      error = std::max(error, other.error);
      seconds = std::max(seconds, other.seconds);
    }
    std::string text() const
    {
      return fmt::format("{:>3}/{:<3} {:.0e} {:>8.1f}", solved, all, error,
                         1e3 * seconds);
    }
  };

  void solve(const std::string &name, const ContactProblem &problem,
             const Options &options, Count &count)
  {
    const AssembledMethod<ContactMethod::automatic> solver;
    SolverControl control;
    control.tolerance = options.tolerance;
    control.attempts = options.attempts;
    std::vector<double> r = problem.guess;
    const double start = cpu_seconds();
    const SolverReport report =
        solve_contact_problem(problem, solver, "auto", control, r);
    const double seconds = cpu_seconds() - start;
    count.add(report.converged, report.residual, seconds);
    if (options.details)
      fmt::print("    {:<14} {:.1e} {:>9.1f} ms {:>7} iterations, {:>4} "
                 "attempts, best {}: {}\n",
                 name, report.residual, 1e3 * seconds, report.iterations,
                 report.attempts, report.best_attempt, report.solver);
  }

  Options read_options(const int argc, char **argv)
  {
    Options options;
    for (int i = 1; i < argc; ++i)
      if (!std::strcmp(argv[i], "--details"))
        options.details = true;
      else if (!std::strcmp(argv[i], "--tolerance") && i + 1 < argc)
        options.tolerance = std::atof(argv[++i]);
      else if (!std::strcmp(argv[i], "--attempts") && i + 1 < argc)
        options.attempts = unsigned(std::atoi(argv[++i]));
      else if (!std::strcmp(argv[i], "--copies") && i + 1 < argc)
        options.relabelled = options.perturbed = unsigned(std::atoi(argv[++i]));
      else
        options.files.emplace_back(argv[i]);
    const char *const folder = std::getenv("NSFD_CONTACT_PROBLEMS");
    if (options.files.empty() && folder)
      for (const auto &entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".hdf5")
          options.files.push_back(entry.path().string());
    std::sort(options.files.begin(), options.files.end());
    return options;
  }
} // namespace

int main(int argc, char **argv)
{
  const Options options = read_options(argc, argv);
  if (options.files.empty()) {
    fmt::print("no problem is named, and NSFD_CONTACT_PROBLEMS names no "
               "folder: nothing is done\n");
    return 0;
  }
  fmt::print("solved, worst error, most ms, tolerance {:.0e}\n{:<37} {:>8}  "
             "{:<22} {:<22} {:<22} {}\n",
             options.tolerance, "problem", "contacts", "as it is", "relabelled",
             "other q", "other friction");
  Count sums[4];
  for (const std::string &file : options.files) {
    const ContactProblem problem = read_fclib(file);
    const std::size_t n = problem.n_contacts();
    if (options.details)
      fmt::print("{}\n", fs::path(file).stem().string());
    Count counts[4];
    solve("as it is", problem, options, counts[0]);
    if (n >= 20) {
      for (unsigned int k = 1; k <= options.relabelled; ++k) {
        contact_copies::Dice dice(k);
        solve("relabelled", contact_copies::relabelled(problem, dice.order(n)),
              options, counts[1]);
      }
      for (unsigned int k = 1; k <= options.perturbed; ++k) {
        contact_copies::Dice dice(1000 + k);
        solve("other q", contact_copies::with_other_q(problem, 1e-3, dice),
              options, counts[2]);
      }
      for (const double factor : {0.5, 1.5})
        solve(fmt::format("friction * {}", factor),
              contact_copies::with_friction(problem, factor), options,
              counts[3]);
    }
    fmt::print("{:<37} {:>8}", fs::path(file).stem().string(), n);
    for (int k = 0; k < 4; ++k) {
      sums[k].add(counts[k]);
      if (counts[k].all)
        fmt::print("  {}", counts[k].text());
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  fmt::print("{:<37} {:>8}", "all", "");
  for (const Count &sum : sums)
    fmt::print("  {}", sum.text());
  fmt::print("\n");
  return 0;
}
