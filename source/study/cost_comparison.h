#pragma once

#include "study_results.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** What an error costs in one series, or in all together. */
  struct CostRow {
    std::string error;  ///< its name
    double target = 0.; ///< its value
    std::string series; ///< "all": the lower envelope of everything
    CostOfError cost;
    double best = 0.; ///< smallest error of the series
  };

  /**
   * The main error at the targets of the study, and at the smallest error of
   * the first series: what do the others need for it?
   */
  std::vector<CostRow> cost_rows(const StudyResults &study);

  /** The same as lines of text; empty if there is no error. */
  std::string cost_table(const StudyResults &study);

  /** "1.2", "< 0.3", "not reached (best 2.1e-03)" */
  std::string cost_text(const CostRow &row);

  /** "order 2.01 over 5 points, expected 2.00: as expected" */
  std::string order_line(const StudyOrder &order);
} // namespace nsfd
