#pragma once

#include "named_mesh.h"
#include "nsfd/mesh/coarse_mesh.h"
#include "nsfd/scene/mesh_input.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** Brings its own cells and groups: MeshInput::named. */
  class NamedMeshType : public MeshType
  {
  public:
    bool is_for_bodies() const override { return false; }
    bool has_simplices(const MeshInput &mesh) const override;
    double n_cells(const MeshInput &mesh, unsigned int) const override;

  private:
    void make(const MeshInput &input, unsigned int refinements,
              std::vector<std::string> &problems,
              CoarseMesh<2> &mesh) const override;
    void make(const MeshInput &input, unsigned int refinements,
              std::vector<std::string> &problems,
              CoarseMesh<3> &mesh) const override;
  };
} // namespace nsfd
