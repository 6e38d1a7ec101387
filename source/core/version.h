#pragma once

#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** What this program was built from. */
  struct Version {
    std::string number, git_hash, build_type;
    std::string interface; ///< what plug-ins must have been built against
  };
  Version version();

  /** Names and versions of the libraries in use. */
  std::vector<std::pair<std::string, std::string>> library_versions();
} // namespace nsfd
