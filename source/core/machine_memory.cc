#include "machine_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;
    constexpr double unlimited = std::numeric_limits<double>::infinity();

    /** The number in a file; none if there is none, such as `max`. */
    std::optional<double> number_in(const fs::path &file)
    {
      std::ifstream stream(file);
      double value = 0.;
      if (stream >> value)
        return value;
      return {};
    }

    /** The number after @p key in a file of lines `key value`, or 0. */
    double value_of(const fs::path &file, const std::string &key)
    {
      std::ifstream stream(file);
      for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string word;
        double value = 0.;
        if (words >> word >> value && word == key)
          return value;
      }
      return 0.;
    }

    /** What one control group leaves. */
    double left_by(const fs::path &group, const char *limit_file,
                   const char *usage_file, const char *cache_key)
    {
      const auto limit = number_in(group / limit_file);
      const auto usage = number_in(group / usage_file);
      if (!limit || !usage)
        return unlimited;
      const double cache = value_of(group / "memory.stat", cache_key);
      return std::max(0., *limit - std::max(0., *usage - cache));
    }

    /** The group of the process and those around it. */
    double left_by_groups(const fs::path &root, const std::string &path,
                          const char *limit_file, const char *usage_file,
                          const char *cache_key)
    {
      double left = unlimited;
      // in a container, the path may be that of the machine outside it
      fs::path group =
          (root / fs::path(path).relative_path()).lexically_normal();
      for (;;) {
        left =
            std::min(left, left_by(group, limit_file, usage_file, cache_key));
        if (group == root || !group.has_relative_path() ||
            group.string().size() <= root.string().size())
          break;
        group = group.parent_path();
      }
      return std::min(left, left_by(root, limit_file, usage_file, cache_key));
    }

    double left_by_control_groups()
    {
      double left = unlimited;
      std::ifstream stream("/proc/self/cgroup");
      // `0::/path` of version 2, `5:memory:/path` of version 1
      for (std::string line; std::getline(stream, line);) {
        const std::size_t first = line.find(':');
        const std::size_t second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos)
          continue;
        const std::string controllers =
            "," + line.substr(first + 1, second - first - 1) + ",";
        const std::string path = line.substr(second + 1);
        if (controllers == ",,")
          left = std::min(left,
                          left_by_groups("/sys/fs/cgroup", path, "memory.max",
                                         "memory.current", "inactive_file"));
        else if (controllers.find(",memory,") != std::string::npos)
          left = std::min(left, left_by_groups("/sys/fs/cgroup/memory", path,
                                               "memory.limit_in_bytes",
                                               "memory.usage_in_bytes",
                                               "total_inactive_file"));
      }
      return left;
    }

    double left_of_address_space()
    {
      rlimit limit{};
      if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return unlimited;
      const auto pages = number_in("/proc/self/statm");
      return std::max(0.,
                      double(limit.rlim_cur) -
                          pages.value_or(0.) * double(sysconf(_SC_PAGESIZE)));
    }
  } // namespace

  double available_memory()
  {
    constexpr double kilobyte = 1024.;
    const double machine =
        kilobyte * value_of("/proc/meminfo", "MemAvailable:");
    return std::min({machine > 0. ? machine : unlimited,
                     left_by_control_groups(), left_of_address_space()});
  }
} // namespace nsfd
