#pragma once

#include "nsfd/records/run_record.h"
#include "records/certificate.h"

#include <string>

namespace nsfd
{
  /**
   * The last lines of a run: certificate, what happened with its energies and
   * errors, if @p verbose what it cost, and a sentence on its @p files. Lines
   * have at most 80 columns but for names of folders and the profile.
   */
  std::string run_end_text(const Summary &summary,
                           const Certificate &certificate, double broken_area,
                           const std::string &files, bool verbose);
} // namespace nsfd
