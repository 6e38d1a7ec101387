#include "time_scheme.h"

#include "step_entry.h"

#include "nsfd/parameters/section_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace nsfd
{
  void TimeScheme::read_steps(SectionReader &reader, SceneInput &scene) const
  {
    // half a crossing is beyond the stable step of many meshes
    if (traits().explicit_forces)
      read_step(reader, "step", scene.time, "auto");
    else
      read_step(reader, "step", scene.time);
    check_step(reader, scene);
  }

  std::vector<std::string> time_scheme_names()
  {
    const auto &registry = TimeSchemeRegistry::instance();
    std::vector<std::pair<unsigned int, std::string>> schemes;
    for (const std::string &name : registry.names())
      schemes.emplace_back(registry.create(name)->place(), name);
    std::sort(schemes.begin(), schemes.end());
    std::vector<std::string> names;
    for (const auto &scheme : schemes)
      names.push_back(scheme.second);
    return names;
  }

  std::unique_ptr<const TimeScheme> find_time_scheme(const std::string &name)
  {
    const auto &registry = TimeSchemeRegistry::instance();
    return registry.knows(name) ? registry.create(name) : nullptr;
  }

  void refuse_other_entries(SectionReader &reader, const std::string &name)
  {
    std::map<std::string, std::vector<std::string>> owners;
    for (const std::string &other : time_scheme_names())
      for (const std::string &entry : find_time_scheme(other)->entries())
        owners[entry].push_back(other);
    for (const auto &[entry, schemes] : owners)
      if (std::find(schemes.begin(), schemes.end(), name) == schemes.end())
        reader.refuse({entry}, schemes.size() == 1
                                   ? "it belongs to scheme = " + schemes.front()
                                   : fmt::format("scheme = {} has none", name));
  }
} // namespace nsfd
