#pragma once

namespace nsfd
{
  class SectionReader;

  /** Entry `split simplices`. */
  bool read_split(SectionReader &reader);
} // namespace nsfd
