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
    vtu,
    exodus
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
    std::string group_data; ///< VTK: cell data that number groups; may be empty
    double seconds = 20.;   ///< of CPU that Gmsh may take
  };

  /** The mesh of a file, in order. Everything that is wrong is a sentence. */
  NamedMesh read_mesh_file(const MeshFileRequest &request,
                           std::vector<std::string> &problems);

  /**
   * Parts and instances of an Abaqus input deck, at their places. Sets of
   * elements, surfaces and sets of nodes become groups. Not yet in order.
   */
  NamedMesh read_abaqus(const std::string &file, unsigned int dimension,
                        std::vector<std::string> &problems);

  /** UCD of AVS, not yet in order: groups are the numbers of materials. */
  NamedMesh read_ucd(const std::string &file, unsigned int dimension,
                     std::vector<std::string> &problems);

  /**
   * VTK's legacy and XML formats, not yet in order. Groups are whole numbers of
   * cell data; all numbers of cell data are fields.
   */
  NamedMesh read_vtk(const MeshFileRequest &request,
                     std::vector<std::string> &problems);
} // namespace nsfd
