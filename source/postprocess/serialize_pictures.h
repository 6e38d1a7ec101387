#pragma once

#include "nsfd/records/run_record.h"

#include <vector>

namespace nsfd
{
  class Archive;

  /** The pictures of the report so far; on the first rank. Collective. */
  void serialize(std::vector<Snapshot> &snapshots, Archive &archive);
} // namespace nsfd
