#pragma once

#include "observed.h"
#include "variation.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  class InputErrors;

  /** Quantities of summary.json, all cases, over one of them. */
  struct StudyDiagram {
    std::string abscissa;
    std::vector<std::string> ordinates;
  };

  /** What a study is, checked and typed: section `Study` and what varies. */
  struct StudyInput {
    std::string file; ///< of the scene, as named
    std::string title, description;
    std::vector<Variation> variations;
    std::string directory; ///< of all its results

    unsigned int repeats = 5; ///< of each case, at least
    unsigned int ranks = 1;   ///< of each case, where they do not vary
    unsigned int jobs = 1;    ///< cases at a time; 0: one per core
    bool outputs = false;     ///< fields and reports of the cases as well
    bool limit_checks = true; ///< best cases again, tighter and with half steps

    std::vector<std::string> errors;        ///< to show; empty: all there are
    std::vector<ObservedQuantity> observed; ///< beside errors, and like them
    int abscissa = -1; ///< variation along which orders are taken, -1: none
    int average = -1;  ///< variation whose errors are averaged, -1: none
    int compare = -1;  ///< variation whose costs are compared, -1: each series
    std::string size;  ///< formula: what errors are a power of
    std::map<std::string, std::string> expected_orders; ///< error to formula
    double order_tolerance = 0.15;
    std::vector<double> targets;        ///< errors at which costs are compared
    std::vector<StudyDiagram> diagrams; ///< beside those of errors

    std::string echo; ///< the sections of the study, complete
  };

  /** A combination with all that the study knows about it before it is run. */
  struct StudyCase {
    Combination combination;
    std::string scene; ///< complete parameter file, ready to run
    /// what formulas may name: degree, cells, ..., and what varies
    std::map<std::string, double> numbers;
    unsigned int ranks = 1;
    double tolerance = 0.; ///< of the solver
    std::string half_step; ///< value of Time/step; empty if it has no half
  };

  /** True if the file, or an option of --set, makes it a study. */
  bool is_study(const std::string &file, const std::vector<std::string> &set);

  /**
   * Read sections `Study` and `Vary: ...` of a file, and the variations of the
   * command line (@p vary). What is wrong goes into @p errors, and the result
   * is null.
   */
  std::unique_ptr<StudyInput> read_study(const std::string &file,
                                         const std::vector<std::string> &set,
                                         const std::vector<std::string> &vary,
                                         InputErrors &errors);

  /**
   * Read and check the scenes of all combinations; everything that is wrong in
   * any of them goes into @p errors, once. @p set is what the option --set
   * gives.
   */
  std::vector<StudyCase> read_cases(const StudyInput &study,
                                    const std::vector<std::string> &set,
                                    InputErrors &errors);

  /** The scene of @p original with the assignments @p more, in folder @p name.
   */
  StudyCase derived_case(const StudyInput &study, const StudyCase &original,
                         const std::string &name,
                         const std::vector<std::string> &set,
                         const std::vector<std::string> &more,
                         InputErrors &errors);

  /**
   * Value of a formula of the named numbers. Empty, with a @p problem, if it
   * has none.
   */
  std::optional<double> evaluate(const std::string &formula,
                                 const std::map<std::string, double> &numbers,
                                 std::string &problem);
} // namespace nsfd
