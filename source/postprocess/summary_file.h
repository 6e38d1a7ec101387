#pragma once

#include "nsfd/records/run_record.h"
#include "records/run_findings.h"

#include <string>

namespace nsfd
{
  /** Writes summary.json; NaN and infinity become null. */
  void write_summary(const std::string &path, const Summary &summary,
                     const RunFindings &findings = {});

  /** What run.json says, without the list of files. */
  std::string describe_run(const RunInfo &info);
} // namespace nsfd
