#pragma once

#include "nsfd/output/run_record.h"

#include <string>

namespace nsfd
{
  /** Writes summary.json; NaN and infinity become null. */
  void write_summary(const std::string &path, const Summary &summary);

  /** Writes run.json. */
  void write_run_info(const std::string &path, const RunInfo &info);

  /**
   * Replaces the file at @p path in one go: readers see the old or the new
   * text, never a part of it. Throws std::runtime_error with the reason.
   */
  void write_file_atomically(const std::string &path, const std::string &text);
} // namespace nsfd
