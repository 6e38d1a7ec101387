#pragma once

#include "gmsh_script.h"

#include "named_mesh.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct GmshRequest {
    std::string file;
    std::string extension; ///< by which Gmsh chooses its reader: ".msh"
    unsigned int dimension = 2;
    bool is_geometry = false; ///< to be meshed, else a mesh
    /// geometries: everywhere, in the unit of the file; 0: as the file says
    double element_size = 0.;
    enum class Shape { as_given, simplices, cubes };
    Shape shape = Shape::as_given; ///< of the cells of a geometry
    /// of CPU that Gmsh may take; meshes get more, by their size
    double seconds = 20.;
  };

  /**
   * What the Gmsh library makes of a file, not yet in order. It works in a
   * process of its own, of limited time and memory, which cannot write files:
   * what crashes or overruns it is a problem as any other. STEP and other CAD
   * files come in millimetres. Elements of higher order keep their corners.
   * Without physical groups every curve, surface or volume is a group, known
   * by its number and, in CAD files, its name.
   */
  NamedMesh read_gmsh(const GmshRequest &request,
                      std::vector<std::string> &problems);

  /**
   * An Exodus file, not yet in order: see read_exodus_here(). Those of HDF5 are
   * read in a process of that kind as well.
   */
  NamedMesh read_exodus(const GmshRequest &request,
                        std::vector<std::string> &problems);

  /** The same of a script that has passed the filter. */
  NamedMesh read_gmsh(const GmshRequest &request, const GmshScript &script,
                      std::vector<std::string> &problems);

  /** Convex or not, without crossings; corners anticlockwise. */
  struct PlaneRegions {
    std::vector<double> x, y;
    std::vector<std::vector<unsigned int>> corners; ///< of every region
    std::vector<std::string> names;                 ///< of every region
    std::string borders; ///< name of the group of faces between regions
  };

  /**
   * Quads of about @p element_size in regions that cover a plane figure, made
   * by Gmsh in at most @p seconds of CPU.
   */
  NamedMesh mesh_regions(const PlaneRegions &regions, double element_size,
                         double seconds, std::vector<std::string> &problems);
} // namespace nsfd
