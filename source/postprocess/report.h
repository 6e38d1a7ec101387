#pragma once

#include "nsfd/records/run_record.h"
#include "records/run_findings.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** All that report.html shows. */
  struct Report {
    std::string title, description;
    RunInfo info;
    Summary summary;
    RunFindings findings;
    std::vector<HistoryRow> history;
    /// driven boundaries, as in the columns of history.csv
    std::vector<std::string> reaction_names;
    std::vector<Snapshot> snapshots; ///< first, some between, last
    std::string parameters;          ///< the complete echo
  };

  /**
   * Writes one page that needs no other file, and next to it every picture as
   * a file of its own (deformed_000.svg, energies.svg, ...). Returns the names
   * of the pictures.
   */
  std::vector<std::string> write_report(const std::string &path,
                                        const Report &report);
} // namespace nsfd
