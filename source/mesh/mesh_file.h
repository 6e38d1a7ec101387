#pragma once

#include "named_mesh.h"

#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  enum class MeshFormat {
    gmsh_mesh,     ///< .msh, and other meshes that Gmsh reads
    gmsh_geometry, ///< a script: .geo
    cad,           ///< STEP, IGES, BREP: names its own unit
    abaqus,
    ucd,
    vtk,
    vtu
  };

  /**
   * By the name of the file, `.inp` by its first line; none if its extension
   * is not listed.
   */
  std::optional<MeshFormat> guess_format(const std::string &file);

  /** ".msh, .geo, ..." */
  std::string listed_mesh_extensions();

  /** Shown, with the text of `format`, to who writes something else. */
  std::string name_of(MeshFormat format);

  struct MeshFileRequest {
    std::string file;
    MeshFormat format = MeshFormat::gmsh_mesh;
    unsigned int dimension = 2;
    double unit = 1.;         ///< of the lengths in the file, scene units
    double element_size = 0.; ///< scene units; 0: as the file says
    enum class Shape { as_given, simplices, cubes };
    Shape shape = Shape::as_given;
    bool merge_vertices = false;
    double seconds = 20.; ///< of CPU that Gmsh may take
  };

  /** The mesh of a file, in order. Everything that is wrong is a sentence. */
  NamedMesh read_mesh_file(const MeshFileRequest &request,
                           std::vector<std::string> &problems);

  /**
   * `*NODE`, `*ELEMENT`, `*ELSET`, `*SURFACE` of an Abaqus input deck: element
   * sets and surfaces become groups. Not yet in order.
   */
  NamedMesh read_abaqus(const std::string &file, unsigned int dimension,
                        std::vector<std::string> &problems);

  /** UCD of AVS, not yet in order: groups are the numbers of materials. */
  NamedMesh read_ucd(const std::string &file, unsigned int dimension,
                     std::vector<std::string> &problems);

  /** Legacy VTK, ASCII, not yet in order: groups are its `MaterialID`. */
  NamedMesh read_vtk(const std::string &file, unsigned int dimension,
                     std::vector<std::string> &problems);

  /** VTU that deal.II has written, not yet in order: groups have numbers. */
  NamedMesh read_by_deal_ii(const std::string &file, unsigned int dimension,
                            std::vector<std::string> &problems);
} // namespace nsfd
