#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** What `nsfd law` was asked for. */
  struct LawCommand {
    std::string file;                   ///< or the name of a law
    std::vector<std::string> overrides; ///< Section/name=value
    bool check = false, quiet = false, force = false;
    bool contract = false; ///< try what every law must keep, drive nothing
  };

  /**
   * `nsfd law`: read, drive, write the curve and its pictures, print a table.
   * Serial. @return the exit code
   */
  int run_law(const LawCommand &command);
} // namespace nsfd
