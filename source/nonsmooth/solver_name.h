#pragma once

#include <string>

namespace nsfd
{
  /** What SolverInput::method names: `auto` is @p automatic. */
  inline std::string solver_name(const std::string &method,
                                 const char *automatic)
  {
    return method == "auto" ? automatic : method;
  }
} // namespace nsfd
