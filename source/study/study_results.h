#pragma once

#include "case_result.h"
#include "convergence.h"
#include "study_input.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** A case of the best run again to see what limits its error. */
  struct LimitCheck {
    std::string name, reason;       ///< of the case; "tolerance/100", "step/2"
    double before = 0., after = 0.; ///< the error
    bool done = false;

    double change() const { return before > 0. ? after / before - 1. : 0.; }
  };

  /** What was run, and with what. */
  struct StudyResults {
    StudyInput input;
    std::vector<StudyCase> cases;
    std::vector<CaseResult> results; ///< of the cases
    std::vector<LimitCheck> checks;
    std::vector<std::string> warnings;
    std::string command_line, version, git_hash, build_type, compiler, host,
        processor, date;
    unsigned int cores = 0;
  };

  /** Cases that differ along the abscissa only; averaged where asked for. */
  struct StudySeries {
    std::string name; ///< "degree = 2", empty if it is the only one
    std::vector<std::size_t>
        first; ///< first case of each point, coarse to fine
    std::vector<std::vector<std::size_t>> members; ///< all cases of each point
  };

  std::vector<StudySeries> series_of(const StudyResults &study);

  /** Names of the errors to show, the main one first. */
  std::vector<std::string> shown_errors(const StudyResults &study);

  /** What is observed, and the errors: all that is averaged and listed. */
  std::vector<std::string> shown_quantities(const StudyResults &study);

  /** The points of a series that are done. */
  std::vector<StudyPoint> points_of(const StudyResults &study,
                                    const StudySeries &series,
                                    const std::string &error);

  /** Points whose costs are compared: those of a degree, or of a series. */
  struct StudyGroup {
    std::string name;
    std::vector<StudyPoint> points;
    std::vector<std::size_t> cases; ///< first one of each point, done or not
  };
  std::vector<StudyGroup> groups_of(const StudyResults &study,
                                    const std::string &error);

  /** The points of all series. */
  std::vector<StudyPoint> all_points(const StudyResults &study,
                                     const std::string &error);

  /** An order with what was expected of it. */
  struct StudyOrder {
    std::string series, error;
    std::vector<StudyPoint> points;
    OrderFit fit;
    std::optional<double> expected;
    OrderVerdict verdict = OrderVerdict::none;
  };

  /** None without an abscissa. */
  std::vector<StudyOrder> orders_of(const StudyResults &study);

  /** "1/cells", "step", ... */
  std::string size_label(const StudyResults &study);

  /** "4 of 5 orders as expected; ...", or empty if nothing was expected. */
  std::string verdict_text(const StudyResults &study);

  /** What keeps the error from being smaller, as far as it can be told. */
  std::vector<std::string> limits_of(const StudyResults &study);

  /** "degree = 1, cells = 8, 1" */
  std::string setting_of(const StudyResults &study, std::size_t k);

  std::size_t count(const StudyResults &study, CaseResult::Status status);

  /** Convergence tables, costs and limits as text. */
  std::string study_text(const StudyResults &study);

  /** study.csv, study.json. */
  std::string study_csv(const StudyResults &study);
  std::string study_json(const StudyResults &study);

  /** study.html, and each diagram as a file in @p directory. */
  void write_study_page(const StudyResults &study,
                        const std::string &directory);
} // namespace nsfd
