#pragma once

#include "nsfd/parameters/section_reader.h"
#include "read_law.h"

namespace nsfd
{
  /**
   * Section `Path` of `nsfd law`: where the points of all curves go, and how.
   * The laws have been read; curves without one (an error) get no points.
   */
  void read_law_path(SectionReader &reader, LawInput &input);
} // namespace nsfd
