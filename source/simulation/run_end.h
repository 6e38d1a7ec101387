#pragma once

#include "nsfd/records/run_record.h"
#include "records/certificate.h"

#include <string>

namespace nsfd
{
  /**
   * The last lines of a run: certificate, energies, errors, where its files
   * are, and what it cost; all of the profile if @p verbose. Lines have at most
   * 80 columns but for names of folders and the profile.
   */
  std::string run_end_text(const Summary &summary,
                           const Certificate &certificate, double broken_area,
                           const std::string &page, bool verbose);
} // namespace nsfd
