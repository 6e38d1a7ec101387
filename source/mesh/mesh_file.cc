#include "mesh_file.h"

#include "gmsh_reader.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace nsfd
{
  namespace
  {
    std::string extension(const std::string &file)
    {
      std::string result = std::filesystem::path(file).extension().string();
      std::transform(result.begin(), result.end(), result.begin(),
                     [](const unsigned char c) { return std::tolower(c); });
      return result;
    }

    /** Abaqus decks and UCD meshes share their extension. */
    bool begins_with_star(const std::string &file)
    {
      std::ifstream in(file);
      std::string line;
      while (std::getline(in, line)) {
        const auto first = line.find_first_not_of(" \t\r");
        if (first != std::string::npos && line[first] != '#')
          return line[first] == '*';
      }
      return false;
    }

    GmshRequest gmsh_request(const MeshFileRequest &request, const double unit)
    {
      GmshRequest result;
      result.file = request.file;
      result.dimension = request.dimension;
      result.is_geometry = request.format != MeshFormat::gmsh_mesh;
      result.element_size = request.element_size / unit;
      result.shape = GmshRequest::Shape(int(request.shape));
      return result;
    }
  } // namespace

  MeshFormat guess_format(const std::string &file)
  {
    const std::string end = extension(file);
    const auto is = [&](const std::initializer_list<const char *> ends) {
      return std::find(ends.begin(), ends.end(), end) != ends.end();
    };
    if (is({".geo", ".geo_unrolled", ".opt"}))
      return MeshFormat::gmsh_geometry;
    if (is({".step", ".stp", ".iges", ".igs", ".brep"}))
      return MeshFormat::cad;
    if (is({".vtk"}))
      return MeshFormat::vtk;
    if (is({".vtu"}))
      return MeshFormat::vtu;
    if (is({".ucd"}))
      return MeshFormat::ucd;
    if (is({".inp"}))
      return begins_with_star(file) ? MeshFormat::abaqus : MeshFormat::ucd;
    return MeshFormat::gmsh_mesh;
  }

  std::string name_of(const MeshFormat format)
  {
    switch (format) {
    case MeshFormat::gmsh_mesh:
      return "Gmsh mesh";
    case MeshFormat::gmsh_geometry:
      return "Gmsh geometry";
    case MeshFormat::cad:
      return "CAD file";
    case MeshFormat::abaqus:
      return "Abaqus mesh";
    case MeshFormat::ucd:
      return "UCD mesh";
    case MeshFormat::vtk:
    case MeshFormat::vtu:
      return "VTK mesh";
    }
    return "";
  }

  namespace
  {
    /** Gmsh would take anything else for one of its scripts, and run it. */
    bool is_gmsh_mesh(const std::string &file)
    {
      std::ifstream in(file);
      char first = 0;
      in >> first;
      return first == '$';
    }
  } // namespace

  NamedMesh read_mesh_file(const MeshFileRequest &request,
                           std::vector<std::string> &problems)
  {
    if (request.format == MeshFormat::gmsh_mesh &&
        extension(request.file) == ".msh" && !is_gmsh_mesh(request.file)) {
      problems.push_back("this is no mesh of Gmsh: it does not begin with "
                         "$MeshFormat");
      return {};
    }
    // CAD files are read in millimetres, whatever their own unit
    const double unit =
        request.format == MeshFormat::cad ? 1e-3 : request.unit;
    NamedMesh mesh;
    switch (request.format) {
    case MeshFormat::abaqus:
      mesh = read_abaqus(request.file, request.dimension, problems);
      break;
    case MeshFormat::ucd:
      mesh = read_ucd(request.file, request.dimension, problems);
      break;
    case MeshFormat::vtk:
      mesh = read_vtk(request.file, request.dimension, problems);
      break;
    case MeshFormat::vtu:
      mesh = read_by_deal_ii(request.file, request.dimension, problems);
      break;
    default:
      mesh = read_gmsh(gmsh_request(request, unit), problems);
    }
    if (problems.empty())
      put_in_order(mesh, unit, request.merge_vertices, problems);
    return mesh;
  }
} // namespace nsfd
