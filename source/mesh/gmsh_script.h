#pragma once

#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A script of Gmsh (.geo) that has passed the filter: nothing in it runs a
   * command, writes or reads a file. The language of these scripts can do all
   * of that, so only words that describe geometry and meshing pass.
   */
  struct GmshScript {
    std::string name; ///< of the script itself, one of `files`
    /// without comments, line by line as they were; also what is included
    std::map<std::string, std::string> files;
  };

  /**
   * The script @p file and what it includes from its folder. Everything that
   * may not stand in it goes into @p problems, a sentence with its line each.
   */
  GmshScript read_gmsh_script(const std::string &file,
                              std::vector<std::string> &problems);

  /**
   * One file of a script without its comments; @p where names it after "line
   * 3" in @p problems. The files that it includes are added to @p includes.
   */
  std::string filter_gmsh_script(const std::string &text,
                                 const std::string &where,
                                 std::vector<std::string> &includes,
                                 std::vector<std::string> &problems);
} // namespace nsfd
