#pragma once

#include "nsfd/input/read_law.h"
#include "nsfd/input/section_reader.h"

namespace nsfd
{
  /** Section `Bar` of `nsfd law`; the laws have been read. */
  void read_bar(SectionReader &reader, LawInput &input);
} // namespace nsfd
