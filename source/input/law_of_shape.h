#pragma once

#include <string>

namespace nsfd
{
  /** Laws go by the names of their authors; other programs name their shapes:
      what to write for @p name, empty if it is none of them. */
  std::string law_of_shape(const std::string &name);
} // namespace nsfd
