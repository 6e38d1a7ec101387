#pragma once

#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  /** What came of a case. Energies and times in SI, counts per run. */
  struct CaseResult {
    enum class Status {
      not_run,
      done,
      failed,    ///< a step could not be solved
      bad_input, ///< found out only when it was built
      broken,    ///< an internal error, or it crashed
      stopped    ///< on request
    };
    Status status = Status::not_run;
    std::string failure; ///< why it is not done
    int exit_code = -1;
    bool taken_over = false; ///< of an earlier study, not run now

    double dofs = 0., cells = 0., steps = 0.;
    double newton = 0., krylov = 0., applications = 0.; ///< per step
    double block_factorisations = 0., global_factorisations = 0.;
    double balance_residual = 0., residual = 0.; ///< largest of all steps
    /// lost by the time discretization, over all energy there was at the end
    double numerical_dissipation = 0.;
    double peak_memory_mb = 0.; ///< mean of the repeats
    /// of several ranks, per rank and step, at most
    double messages = 0., message_bytes = 0., collectives = 0.;
    double waiting = 0.; ///< share of the time of the first rank
    double copy_gain = 0., product_gain = 0.; ///< of the machine; 0: not known
    std::map<std::string, double> errors;

    /// CPU seconds of each repeat
    std::vector<double> setup, solve, wall;
    bool reproducible = true; ///< all repeats gave the same errors
  };

  bool is_done(const CaseResult &result);
  /** Of the CPU seconds of its repeats. */
  double setup_median(const CaseResult &result);
  double solve_median(const CaseResult &result);
  /** (largest - smallest) / median of the solve times; 0 for one. */
  double solve_spread(const CaseResult &result);

  /** "done", "failed", ... */
  const char *name_of(CaseResult::Status status);

  double median(std::vector<double> values);

  /**
   * What the summary.json of a run says, added to @p result as a further
   * repeat. False if there is no such file, or it is not one.
   */
  bool add_summary(const std::string &file, CaseResult &result);

  /** case.json: what a study must know of a case to take it over. */
  struct CaseStamp {
    std::string version, git_hash;
    unsigned int ranks = 1;
    std::string plug_ins = {}; ///< with their checksums
  };
  void write_case(const std::string &file, const CaseStamp &stamp,
                  const CaseResult &result);

  /**
   * The result in a case.json if it is done, was made by the same program on as
   * many ranks, and has at least as many repeats; else false.
   */
  bool read_case(const std::string &file, const CaseStamp &stamp,
                 unsigned int repeats, CaseResult &result);
} // namespace nsfd
