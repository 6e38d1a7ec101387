#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** A mesh that the entry `type` of a section Mesh or Body may name. */
  struct MeshType {
    enum class Kind {
      box,       ///< fills the box between two corners
      bodies,    ///< the meshes of all blocks `Body: name`
      generator, ///< of deal.II, by its name there
      named      ///< brings its own cells and groups: MeshInput::named
    };

    std::string name, text;
    Kind kind;
    unsigned int dimension = 0;       ///< 0: two and three
    unsigned int cells_per_brick = 1; ///< boxes: of the lattice `cells`
    bool simplices = false;
  };

  /** Our own types, then the generators. */
  const std::vector<MeshType> &mesh_types();

  /** Null if there is no such type. */
  const MeshType *find_mesh_type(const std::string &name);
} // namespace nsfd
