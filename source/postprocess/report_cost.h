#pragma once

#include "nsfd/records/run_record.h"

namespace nsfd
{
  /** Where time and memory of a run went, as a part of the page. */
  std::string cost_section(const Summary &summary);
} // namespace nsfd
