#include "mesh_file.h"

#include "gmsh_reader.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>

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

    struct KnownExtension {
      const char *text; ///< in lower case
      MeshFormat format;
    };

    /// Gmsh takes a file of any other extension for one of its scripts
    const KnownExtension extensions[] = {
        {".msh", MeshFormat::gmsh_mesh},
        {".geo", MeshFormat::gmsh_geometry},
        {".geo_unrolled", MeshFormat::gmsh_geometry},
        {".step", MeshFormat::cad},
        {".stp", MeshFormat::cad},
        {".iges", MeshFormat::cad},
        {".igs", MeshFormat::cad},
        {".brep", MeshFormat::cad},
        {".inp", MeshFormat::abaqus},
        {".ucd", MeshFormat::ucd},
        {".vtk", MeshFormat::vtk},
        {".vtu", MeshFormat::vtu},
        {".e", MeshFormat::exodus},
        {".exo", MeshFormat::exodus},
        {".exii", MeshFormat::exodus},
        {".ex2", MeshFormat::exodus},
        {".g", MeshFormat::exodus},
        {".gen", MeshFormat::exodus},
        {".unv", MeshFormat::gmsh_mesh},
        {".mesh", MeshFormat::gmsh_mesh},
        {".bdf", MeshFormat::gmsh_mesh},
        {".nas", MeshFormat::gmsh_mesh}};

    const KnownExtension *find_extension(const std::string &file)
    {
      const std::string end = extension(file);
      const auto found =
          std::find_if(std::begin(extensions), std::end(extensions),
                       [&](const auto &known) { return end == known.text; });
      return found == std::end(extensions) ? nullptr : &*found;
    }

    GmshRequest gmsh_request(const MeshFileRequest &request, const double unit)
    {
      GmshRequest result;
      result.file = request.file;
      result.dimension = request.dimension;
      result.is_geometry = request.format != MeshFormat::gmsh_mesh;
      result.element_size = request.element_size / unit;
      result.shape = GmshRequest::Shape(int(request.shape));
      result.seconds = request.seconds;
      return result;
    }
  } // namespace

  std::optional<MeshFormat> guess_format(const std::string &file)
  {
    const KnownExtension *known = find_extension(file);
    if (known == nullptr)
      return {};
    if (known->format == MeshFormat::abaqus && !begins_with_star(file))
      return MeshFormat::ucd;
    return known->format;
  }

  std::string listed_mesh_extensions()
  {
    std::string list;
    for (const KnownExtension &known : extensions)
      list += (list.empty() ? "" : ", ") + std::string(known.text);
    return list;
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
    case MeshFormat::exodus:
      return "Exodus mesh";
    }
    return "";
  }

  namespace
  {
    /** Gmsh would take anything else for one of its scripts, and run it. */
    bool is_gmsh_mesh(const std::string &file)
    {
      std::ifstream in(file);
      std::string line;
      std::getline(in, line);
      for (const char *head : {"$MeshFormat", "$Comments", "$NOD"})
        if (line.compare(0, std::string(head).size(), head) == 0)
          return true;
      return false;
    }

    NamedMesh read_by_gmsh(const MeshFileRequest &request, const double unit,
                           std::vector<std::string> &problems)
    {
      GmshRequest job = gmsh_request(request, unit);
      if (request.format == MeshFormat::gmsh_geometry) {
        const GmshScript script = read_gmsh_script(request.file, problems);
        return problems.empty() ? read_gmsh(job, script, problems)
                                : NamedMesh();
      }
      const KnownExtension *known = find_extension(request.file);
      const bool fits = known != nullptr && known->format == request.format;
      if (request.format == MeshFormat::cad && !fits) {
        problems.push_back("the name of a CAD file must end in .step, .stp, "
                           ".iges, .igs or .brep");
        return {};
      }
      job.extension = fits ? known->text : ".msh";
      if (job.extension == ".msh" && !is_gmsh_mesh(request.file)) {
        problems.push_back("this is no mesh of Gmsh: it does not begin with "
                           "$MeshFormat");
        return {};
      }
      return read_gmsh(job, problems);
    }
  } // namespace

  NamedMesh read_mesh_file(const MeshFileRequest &request,
                           std::vector<std::string> &problems)
  {
    // CAD files are read in millimetres, whatever their own unit
    const double unit = request.format == MeshFormat::cad ? 1e-3 : request.unit;
    NamedMesh mesh;
    switch (request.format) {
    case MeshFormat::abaqus:
      mesh = read_abaqus(request.file, request.dimension, problems);
      break;
    case MeshFormat::ucd:
      mesh = read_ucd(request.file, request.dimension, problems);
      break;
    case MeshFormat::vtk:
    case MeshFormat::vtu:
      mesh = read_vtk(request, problems);
      break;
    case MeshFormat::exodus:
      mesh = read_exodus(gmsh_request(request, unit), problems);
      break;
    default:
      mesh = read_by_gmsh(request, unit, problems);
    }
    if (problems.empty())
      put_in_order(mesh, unit, request.merge_vertices, problems);
    return mesh;
  }
} // namespace nsfd
