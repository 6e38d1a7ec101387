#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** An entry of a parameter file that is not what it was. */
  struct ParameterChange {
    std::string name;      ///< Section/entry
    std::string then, now; ///< empty: it was or is not there

    /** `Time/end: 10 ns, now 20 ns` */
    std::string text() const;

    /**
     * What was computed so far means the same: the end of the run, its steps,
     * solvers and files.
     */
    bool allowed() const;
    bool is_in(const std::string &section) const
    {
      return name.compare(0, section.size() + 1, section + '/') == 0;
    }
  };

  /** Between two complete echoes, SceneInput::echo, in their order. */
  std::vector<ParameterChange> parameter_changes(const std::string &then,
                                                 const std::string &now);
} // namespace nsfd
