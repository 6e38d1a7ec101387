#pragma once

#include "mesh/min_cut.h"
#include "mesh/path_ratio.h"

#include <string>
#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class Triangulation;
} // namespace dealii

namespace nsfd
{
  struct SceneInput;
  template <int dim>
  class MeshGroups;

  /**
   * The inner faces whose interface block has a cohesive law; all of them, if
   * no block has one. Materials are those of material_indices().
   */
  CrackNetwork crack_network(const SceneInput &input,
                             const dealii::Triangulation<2, 2> &triangulation,
                             const MeshGroups<2> &groups,
                             const std::vector<unsigned int> &materials);

  /** Cells and inner faces in space, and which of the latter may break. */
  CellNetwork cell_network(const SceneInput &input,
                           const dealii::Triangulation<3, 3> &triangulation,
                           const MeshGroups<3> &groups,
                           const std::vector<unsigned int> &materials);
} // namespace nsfd
