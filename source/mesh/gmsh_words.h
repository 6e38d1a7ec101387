#pragma once

#include <string>

namespace nsfd
{
  /** What the filter of scripts knows of a word of Gmsh's language. */
  enum class GmshWord {
    free,    ///< no word of the language: a name that the script gives
    allowed, ///< geometry, meshing, arithmetic
    refused  ///< everything else that Gmsh 4.8 knows
  };

  GmshWord classify_gmsh_word(const std::string &word);

  /** What a refused word does: "runs a command". */
  std::string deed_of_gmsh_word(const std::string &word);

  /** `Threshold` in Field[1] = Threshold; those that read nothing. */
  bool is_gmsh_field(const std::string &type);
  /** `DistMin` in Field[1].DistMin. */
  bool is_gmsh_field_option(const std::string &option);

  /** `Mesh.Algorithm`; not those that name files or commands. */
  bool is_gmsh_option(const std::string &category, const std::string &option);

  /** `Label` in DefineConstant[ n = {1, Label "number"} ]. */
  bool is_gmsh_attribute(const std::string &word);
} // namespace nsfd
