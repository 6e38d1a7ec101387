#pragma once

#include "named_mesh.h"

#include <array>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * What Neper adds to the format of Gmsh: `$NSets` and `$Fasets` become groups
   * of faces, the two ends of `$Periodicity` the groups `periodic x0`,
   * `periodic x1`, ...; `$ElsetOrientations` and `$ElementOrientations` the
   * data `orientation` of cells, Bunge's angles in degrees, and `$Groups` of
   * elsets the field `group`. @p vertex_of gives the vertex of a node, or one
   * that is not there. A mesh without such sections stays as it is.
   */
  void
  add_neper_sections(std::istream &in, NamedMesh &mesh,
                     const std::function<unsigned int(std::size_t)> &vertex_of,
                     std::vector<std::string> &problems);

  /**
   * Bunge's angles in degrees of an orientation that Neper writes with the
   * descriptor @p name, such as `rodrigues:passive`: see its manual, section
   * "Rotations and Orientations". False if there is no such descriptor or it
   * has another number of values.
   */
  bool bunge_angles(const std::string &name, const std::vector<double> &values,
                    std::array<double, 3> &angles);
} // namespace nsfd
