#pragma once

#include "named_mesh.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** Nodes that a file puts together under a name. */
  struct NodeSet {
    std::string name;
    std::vector<unsigned int> vertices;
  };

  /**
   * Sets of nodes become groups of faces: of those on the boundary whose
   * corners are all in the set or, where there are none, of those between two
   * cells. A set of no whole face is left out, and so is one that has the name
   * of a group of cells; a note names the former. The mesh is not yet in order.
   */
  void add_node_sets(NamedMesh &mesh, const std::vector<NodeSet> &sets);

  /** Of the group of this dimension and name; made if there is none. */
  unsigned int find_or_add_group(NamedMesh &mesh, unsigned int dimension,
                                 const std::string &name);
} // namespace nsfd
