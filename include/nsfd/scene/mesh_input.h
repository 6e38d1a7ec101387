#pragma once

#include "nsfd/scene/where_input.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  struct NamedMesh; // see mesh/named_mesh.h

  struct MeshInput {
    /// rectangle, brick, notched plate, crossed triangles, diagonal triangles,
    /// tetrahedra, bodies (from `Body:` blocks), file, voronoi, or a deal.II
    /// generator's name
    std::string type = "rectangle";
    std::vector<double> lower, upper; ///< dim entries
    std::vector<unsigned int> cells;  ///< per direction, dim entries
    unsigned int refinements = 0;
    double distortion = 0.; ///< share of the cell size, interior vertices
    unsigned int seed = 1;
    unsigned int grains = 0; ///< around random places; 0: none are made
    /// notched plate: a slot of `notch_width` (0: none removed, use a
    /// pre-crack) from the left side to `notch_length` at height `notch_height`
    double notch_length = 0., notch_width = 0., notch_height = 0.;
    std::string generator_arguments; ///< "a : b : c" as deal.II takes them
    /// file, voronoi: in the units of the scene
    std::shared_ptr<const NamedMesh> named;
    /// triangles into three quads, tetrahedra into four hexes, at the midpoints
    bool split_simplices = false;
    /// triangles into six triangles, at midpoints and centroid
    bool split_barycentric = false;
  };

  /** One of several bodies in a mesh of type `bodies`. */
  struct BodyInput {
    std::string name;
    MeshInput mesh;
    double separation = 0.;
  };

  struct DiscretizationInput {
    unsigned int degree = 1;
    bool lumped_mass = false;
    std::string interface_quadrature =
        "gauss"; ///< gauss | gauss lobatto | quarter points
    unsigned int interface_points = 2; ///< per direction of a face
  };
} // namespace nsfd
