#include "parameter_changes.h"

#include "parameters/former_words.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

namespace nsfd
{
  namespace
  {
    using Entries = std::vector<std::pair<std::string, std::string>>;

    std::string trimmed(const std::string &text)
    {
      const auto begin = text.find_first_not_of(" \t\r");
      if (begin == std::string::npos)
        return "";
      return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
    }

    /**
     * Names with their sections, and values without comments, in today's
     * words: an older program may have written them.
     */
    Entries entries(const std::string &echo)
    {
      Entries result;
      std::vector<std::string> sections;
      std::istringstream lines(echo);
      std::string line;
      while (std::getline(lines, line)) {
        line = trimmed(line.substr(0, line.find('#')));
        if (line.compare(0, 11, "subsection ") == 0)
          sections.push_back(trimmed(line.substr(11)));
        else if (line == "end" && !sections.empty())
          sections.pop_back();
        else if (line.compare(0, 4, "set ") == 0) {
          const auto equals = line.find('=');
          std::string name = trimmed(line.substr(4, equals - 4)), value, path;
          if (equals != std::string::npos)
            value = trimmed(line.substr(equals + 1));
          for (const std::string &section : sections)
            path += section + '/';
          renew_words(path.substr(0, path.find_first_of(":/")), name, value);
          result.emplace_back(path + name, value);
        }
      }
      return result;
    }
  } // namespace

  std::string ParameterChange::text() const
  {
    return name + ": " + (then.empty() ? "not set" : then) + ", now " +
           (now.empty() ? "not set" : now);
  }

  bool ParameterChange::allowed() const
  {
    // plug-ins themselves are compared, not where they are named
    static const std::vector<std::string> free = {"plug-ins",
                                                  "Time/end",
                                                  "Time/end at rest",
                                                  "Time/step",
                                                  "Time/dynamic step",
                                                  "Time/maximum bisections",
                                                  "Time/largest overshoot",
                                                  "Time/integration tolerance",
                                                  "Time/equilibrium tolerance",
                                                  "Time/at solution jump"};
    // the load time is one of its own there
    const std::string path = "arc length";
    if (name == "Time/at solution jump" && (then == path || now == path))
      return false;
    return is_in("Solver") || is_in("Output") ||
           std::find(free.begin(), free.end(), name) != free.end();
  }

  std::vector<ParameterChange> parameter_changes(const std::string &then,
                                                 const std::string &now)
  {
    const Entries old_entries = entries(then), new_entries = entries(now);
    const std::map<std::string, std::string> old_values(old_entries.begin(),
                                                        old_entries.end()),
        new_values(new_entries.begin(), new_entries.end());
    std::vector<ParameterChange> changes;
    for (const auto &[name, value] : new_entries) {
      const auto before = old_values.find(name);
      if (before == old_values.end())
        changes.push_back({name, "", value});
      else if (before->second != value)
        changes.push_back({name, before->second, value});
    }
    for (const auto &[name, value] : old_entries)
      if (new_values.count(name) == 0)
        changes.push_back({name, value, ""});
    return changes;
  }
} // namespace nsfd
