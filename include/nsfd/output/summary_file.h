#pragma once

#include "nsfd/output/certificate.h"
#include "nsfd/output/fragment_sizes.h"
#include "nsfd/output/run_record.h"

#include <optional>
#include <string>

namespace nsfd
{
  /** What is judged and gathered at the end of a run, as far as there is. */
  struct RunFindings
  {
    std::optional<Certificate> certificate;
    std::optional<FragmentSizes> fragment_sizes;
  };

  /** Writes summary.json; NaN and infinity become null. */
  void write_summary(const std::string &path, const Summary &summary,
                     const RunFindings &findings = {});

  /** What run.json says, without the list of files. */
  std::string describe_run(const RunInfo &info);

  /**
   * Replaces the file at @p path in one go: readers see the old or the new
   * text, never a part of it. Links are replaced, not followed.
   * @throws OutputError with the reason
   */
  void write_file_atomically(const std::string &path, const std::string &text);
} // namespace nsfd
