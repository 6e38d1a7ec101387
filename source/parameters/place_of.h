#pragma once

#include "input_errors.h"

#include <string>

namespace nsfd
{
  /**
   * Where the parameter file @p file has what a message is about that was
   * found after reading: "Boundary: left: no face", "Time/step: too long". The
   * entry if one is named, else the section, else the whole file. Reads the
   * file again: messages are rare, and a run need not carry all places along.
   */
  SourceLocation place_of(const std::string &file, const std::string &message);
} // namespace nsfd
