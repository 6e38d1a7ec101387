#pragma once

#include "nsfd/parameters/section_reader.h"

#include <string>

namespace nsfd
{
  /**
   * An expression of x, y, z that is read once, before the first step; time in
   * it is an error.
   */
  Expression read_initial_expression(SectionReader &reader,
                                     const std::string &name,
                                     const std::string &default_text, Unit unit,
                                     const std::string &text);
} // namespace nsfd
