#pragma once

#include "nsfd/parameters/section_reader.h"
#include "read_law.h"

namespace nsfd
{
  /** Section `Bar` of `nsfd law`; the laws have been read. */
  void read_bar(SectionReader &reader, LawInput &input);
} // namespace nsfd
