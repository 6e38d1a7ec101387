#include "mesh_entries.h"

#include "nsfd/parameters/section_reader.h"
#include "nsfd/scene/mesh_input.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"
#include "parameters/quantity.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>

namespace nsfd
{
  namespace
  {
    const std::map<std::string, MeshFormat> formats = {
        {"gmsh", MeshFormat::gmsh_mesh}, {"geo", MeshFormat::gmsh_geometry},
        {"cad", MeshFormat::cad},        {"abaqus", MeshFormat::abaqus},
        {"ucd", MeshFormat::ucd},        {"vtk", MeshFormat::vtk},
        {"vtu", MeshFormat::vtu},        {"exodus", MeshFormat::exodus}};

    MeshFormat read_format(SectionReader &reader, const std::string &file,
                           const bool exists)
    {
      std::vector<std::string> names = {"auto"};
      for (const auto &[name, format] : formats)
        names.push_back(name);
      const std::string name = reader.choice(
          "format", "auto", names,
          "auto (by the name of the file), gmsh, geo (script of Gmsh), cad "
          "(STEP, IGES, BREP), abaqus, ucd, vtk, vtu, exodus");
      const auto found = formats.find(name);
      if (found != formats.end())
        return found->second;
      const auto guessed = guess_format(file);
      if (!guessed && exists)
        reader.error("file",
                     fmt::format("`{}`: no mesh is read from a file of this "
                                 "name",
                                 file),
                     fmt::format("its name must end in one of {}, or `format` "
                                 "must say what it is",
                                 listed_mesh_extensions()));
      return guessed.value_or(MeshFormat::gmsh_mesh);
    }

    /** `mm`, or a number of scene units. */
    double read_unit(SectionReader &reader)
    {
      const std::string text = "of the coordinates in the file: m, mm, um, ... "
                               "or a number";
      const auto raw = reader.raw("length unit", "m", text);
      if (!raw)
        return 1.;
      const std::string word = collapse_blanks(raw->text());
      if (const auto unit = find_unit(word)) {
        if (unit->unit == units::length)
          return *scaled_number("1", *unit);
        reader.error("length unit",
                     fmt::format("length unit = {} is no length", word),
                     "write for example: mm");
        return 1.;
      }
      return reader.number_in(*raw, "length unit", "mm", units::length,
                              Range::positive());
    }

    bool can_be_opened(SectionReader &reader, const std::string &file)
    {
      if (file.empty())
        return false;
      if (std::filesystem::is_directory(file)) {
        reader.error("file", fmt::format("`{}` is a folder", file),
                     "write the name of a mesh in it");
        return false;
      }
      if (std::filesystem::exists(file) &&
          !std::filesystem::is_regular_file(file)) {
        reader.error("file", fmt::format("`{}` is no ordinary file", file),
                     "write the name of a mesh");
        return false;
      }
      if (!std::ifstream(file)) {
        reader.error(
            "file", fmt::format("there is no file `{}`", file),
            "paths are relative to the folder of the parameter file, those of "
            "--set and --vary to where the program runs");
        return false;
      }
      return true;
    }
  } // namespace

  bool read_split(SectionReader &reader)
  {
    return reader.boolean("split simplices", false,
                          "cut triangles into three quads, tetrahedra into "
                          "four hexes: opens every degree");
  }

  /** What runs away ends by it; what is large may ask for more. */
  double read_meshing_time(SectionReader &reader)
  {
    constexpr double one_day = 86400.;
    return reader.number("meshing time", "20", units::none,
                         {0., one_day, true, false},
                         "s of CPU that Gmsh or HDF5 may take");
  }

  bool read_file_entries(SectionReader &reader, MeshFileRequest &request)
  {
    request.file = reader.file("file", "mesh or geometry", "plate.msh");
    const bool exists = can_be_opened(reader, request.file);
    request.format = read_format(reader, request.file, exists);
    if (request.format == MeshFormat::cad)
      reader.refuse({"length unit"}, "CAD files name their own unit");
    else
      request.unit = read_unit(reader);
    return exists;
  }

  void store_named_mesh(SectionReader &reader, const std::string &entry,
                        NamedMesh &&named,
                        const std::vector<std::string> &problems,
                        MeshInput &mesh)
  {
    for (const std::string &problem : problems)
      reader.error(entry, problem);
    if (problems.empty())
      mesh.named = std::make_shared<NamedMesh>(std::move(named));
  }
} // namespace nsfd
