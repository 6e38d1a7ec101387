#pragma once

#include "study_results.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** A case among those that differ from it in the number of ranks only. */
  struct RankRow {
    std::string setting;
    unsigned int ranks = 1;
    double unknowns = 0., seconds_per_step = 0.;
    double gain = 0.; ///< time of the fewest ranks over this one
    /// what the machine gives a copy and a small dense product; 0: not known
    double copy_gain = 0., product_gain = 0.;
    /// per rank and step, at most
    double messages = 0., message_bytes = 0., collectives = 0.;
    double waiting = 0.; ///< share of the time, on the first rank

    /** Of what the machine gives at best. */
    double share() const;
  };

  /** Empty where the number of ranks does not vary. */
  std::vector<RankRow> rank_rows(const StudyResults &study);

  /** Names of the columns, and the cells of a row. */
  std::vector<std::string> rank_head();
  std::vector<std::string> rank_cells(const RankRow &row);

  /** As a table of text, or empty. */
  std::string rank_text(const StudyResults &study);
} // namespace nsfd
