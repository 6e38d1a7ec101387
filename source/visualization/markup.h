#pragma once

#include <string>

namespace nsfd
{
  /** Text as the content or an attribute of HTML and XML. */
  std::string escape_markup(const std::string &text);
} // namespace nsfd
