#pragma once

#include "run_folder.h"

#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** One entry of parameters.prm that is not the same in all runs. */
  struct ComparedParameter {
    std::string section, name;
    std::vector<std::string> values; ///< per run; empty: not set
  };

  /** A number of summary.json, per run. */
  struct ComparedNumber {
    std::string name; ///< energy/kinetic
    std::vector<std::optional<double>> values;
    /// |difference| to the first run over `scale`; 0 for the first one, NaN
    /// where one of them has no finite number
    std::vector<double> differences;
    double scale = 0.;   ///< for energies the largest one of all runs
    bool result = false; ///< the tolerance is for it
  };

  /** A column of history.csv of one run against that of the first. */
  struct ComparedCurve {
    std::string name;
    std::size_t run = 1;
    /// of the difference at common times, over `scale`
    double largest = 0., time = 0., mean = 0.;
    double scale = 0.;
    bool result = false;
  };

  struct Comparison {
    std::vector<RunFolder> runs;
    std::vector<ComparedParameter> parameters;
    unsigned int n_parameters = 0; ///< of the first run
    std::vector<ComparedNumber> numbers;
    std::vector<ComparedCurve> curves;
    /// the ends of the time that all runs have
    double begin = 0., end = 0.;

    /** The largest difference of any result, and whose it is. */
    struct Largest {
      double difference = 0.;
      std::string name;
    };
    Largest largest() const;
  };

  /**
   * The first run against the others. Results are energies, dissipated lines
   * and work (relative to the largest energy of all runs), reactions (to the
   * largest of them), broken area, number of fragments and the final time; not
   * the ways to them: steps, iterations, residuals, costs. A number that is
   * there for some runs only, or not finite, differs by NaN; as a result that
   * is beyond every tolerance.
   */
  Comparison compare_runs(std::vector<RunFolder> runs);

  /**
   * A column at any time of its run, linear between its steps: the values of
   * @p y over @p x at the times @p at.
   */
  std::vector<double> interpolated(const std::vector<double> &x,
                                   const std::vector<double> &y,
                                   const std::vector<double> &at);

  /** A, B, C, ... */
  std::string letter(std::size_t run);

  /** As tables on a terminal. */
  std::string comparison_text(const Comparison &comparison);

  std::string comparison_json(const Comparison &comparison,
                              std::optional<double> tolerance);

  /** compare.html, and each diagram as a file, in @p directory. */
  void write_comparison_page(const Comparison &comparison,
                             const std::string &directory);
} // namespace nsfd
