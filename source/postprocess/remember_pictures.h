#pragma once

#include "nsfd/records/run_record.h"

#include <vector>

namespace nsfd
{
  class Archive;

  /** The pictures of the report so far; on the first rank. Collective. */
  void remember(std::vector<Snapshot> &snapshots, Archive &archive);
} // namespace nsfd
