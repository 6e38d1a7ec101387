#include "check_cells.h"
#include "level_mesh.h"
#include "mesh_entries.h"
#include "mesh_file.h"
#include "named_mesh.h"
#include "voronoi.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"
#include "parameters/quantity.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    const std::map<std::string, MeshFormat> formats = {
        {"gmsh", MeshFormat::gmsh_mesh}, {"geo", MeshFormat::gmsh_geometry},
        {"cad", MeshFormat::cad},        {"abaqus", MeshFormat::abaqus},
        {"ucd", MeshFormat::ucd},        {"vtk", MeshFormat::vtk},
        {"vtu", MeshFormat::vtu}};

    MeshFormat read_format(SectionReader &reader, const std::string &file,
                           const bool exists)
    {
      std::vector<std::string> names = {"auto"};
      for (const auto &[name, format] : formats)
        names.push_back(name);
      const std::string name = reader.choice(
          "format", "auto", names,
          "auto (by the name of the file), gmsh, geo (script of Gmsh), cad "
          "(STEP, IGES, BREP), abaqus, ucd, vtk, vtu");
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
        reader.error("file", fmt::format("there is no file `{}`", file),
                     "paths are relative to the folder of the parameter file");
        return false;
      }
      return true;
    }

    /** What runs away ends by it; what is large may ask for more. */
    double read_meshing_time(SectionReader &reader)
    {
      constexpr double one_day = 86400.;
      return reader.number("meshing time", "20", units::none,
                           {0., one_day, true, false},
                           "s of CPU that Gmsh may take");
    }

    double read_element_size(SectionReader &reader, const bool is_geometry)
    {
      if (!is_geometry) {
        reader.refuse({"element size", "cell shape"},
                      "the file brings its own cells");
        return 0.;
      }
      if (!reader.optional("element size",
                           "m, everywhere; without it as the geometry says"))
        return 0.;
      return reader.number("element size", "", units::length, Range::positive(),
                           "m, everywhere; without it as the geometry says");
    }

    MeshFileRequest::Shape read_shape(SectionReader &reader,
                                      const unsigned int dimension)
    {
      using Shape = MeshFileRequest::Shape;
      const std::string cubes = dimension == 2 ? "quads" : "hexes",
                        simplices = dimension == 2 ? "triangles" : "tetrahedra";
      const std::string word = reader.choice(
          "cell shape", "as given", {"as given", cubes, simplices},
          fmt::format("as given (by the geometry), {} or {}", cubes,
                      simplices));
      return word == cubes       ? Shape::cubes
             : word == simplices ? Shape::simplices
                                 : Shape::as_given;
    }

    /** What degree and law of the other sections rely on. */
    void check_shapes(SectionReader &reader, const NamedMesh &named,
                      const bool split)
    {
      if (split || !mixed_shapes(named))
        return;
      const bool has_prisms = named.dimension == 3;
      reader.error("file",
                   fmt::format("the mesh has cells of different shapes: {}",
                               count_of_shapes(named)),
                   has_prisms
                       ? "add: set split simplices = true, which cuts all of "
                         "them into hexes; or mesh with one shape"
                       : "add: set split simplices = true, which cuts all of "
                         "them into quads; or mesh with one shape");
    }

    void store(SectionReader &reader, const std::string &entry,
               NamedMesh &&named, const std::vector<std::string> &problems,
               MeshInput &mesh)
    {
      for (const std::string &problem : problems)
        reader.error(entry, problem);
      if (problems.empty())
        mesh.named = std::make_shared<NamedMesh>(std::move(named));
    }

    void read_mesh_from_file(SectionReader &reader,
                             const unsigned int dimension, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      MeshFileRequest request;
      request.dimension = dimension;
      request.file = reader.file("file", "mesh or geometry", "plate.msh");
      const bool exists = can_be_opened(reader, request.file);
      request.format = read_format(reader, request.file, exists);
      if (request.format == MeshFormat::cad)
        reader.refuse({"length unit"}, "CAD files name their own unit");
      else
        request.unit = read_unit(reader);
      const bool is_geometry = request.format == MeshFormat::cad ||
                               request.format == MeshFormat::gmsh_geometry;
      request.element_size = read_element_size(reader, is_geometry);
      if (is_geometry)
        request.shape = read_shape(reader, dimension);
      request.seconds = read_meshing_time(reader);
      request.merge_vertices = reader.boolean(
          "merge vertices", false, "join vertices that are at one place");
      mesh.split_simplices = read_split(reader);
      if (!exists || reader.errors().n_errors() > n_before)
        return;
      std::vector<std::string> problems;
      NamedMesh named = read_mesh_file(request, problems);
      for (std::string &problem : problems)
        problem.insert(0, fmt::format("`{}`: ", request.file));
      if (problems.empty())
        check_shapes(reader, named, mesh.split_simplices);
      store(reader, "file", std::move(named), problems, mesh);
    }

    void read_voronoi(SectionReader &reader, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      mesh.lower = reader.numbers("lower corner", "0, 0", units::length,
                                  Range::any(), 2, "m");
      mesh.upper = reader.numbers("upper corner", "", units::length,
                                  Range::any(), 2, "m");
      VoronoiRequest request;
      constexpr unsigned int most_grains = 100000;
      request.grains =
          reader.integer("grains", "", 1, most_grains, "number of them");
      request.seed = reader.integer("seed", "1", 0,
                                    std::numeric_limits<unsigned int>::max(),
                                    "of the grains and the distortion");
      request.relaxation =
          reader.integer("relaxation", "5", 0, 1000,
                         "steps of Lloyd: more of them make more equal grains");
      request.element_size = reader.number("element size", "", units::length,
                                           Range::positive(), "m");
      request.seconds = read_meshing_time(reader);
      if (reader.errors().n_errors() > n_before)
        return;
      double n_cells = 1.;
      for (unsigned int d = 0; d < 2; ++d) {
        request.lower[d] = mesh.lower[d];
        request.upper[d] = mesh.upper[d];
        n_cells *= (mesh.upper[d] - mesh.lower[d]) / request.element_size;
        if (!(mesh.upper[d] > mesh.lower[d]))
          return reader.error(
              "upper corner",
              fmt::format(
                  "upper corner: {} = {:g} must be greater than {:g} of "
                  "the lower corner",
                  "xy"[d], mesh.upper[d], mesh.lower[d]),
              "exchange the two corners");
      }
      constexpr double most_cells = 2e6; // in seconds, not in minutes
      if (n_cells > most_cells)
        return reader.error(
            "element size",
            fmt::format("the mesh would have {:.2g} cells", n_cells),
            "write a larger element size");
      std::vector<std::string> problems;
      NamedMesh named = voronoi_mesh(request, problems);
      if (problems.empty())
        put_in_order(named, 1., false, problems);
      store(reader, "element size", std::move(named), problems, mesh);
    }

    template <int dim>
    CoarseMesh<dim> named_mesh(const MeshInput &input,
                               const unsigned int refinements,
                               std::vector<std::string> &problems)
    {
      if (!input.named || input.named->dimension != dim) {
        problems.push_back(fmt::format("no mesh of {} dimensions was read for "
                                       "the type `{}`",
                                       dim, input.type));
        return {};
      }
      CoarseMesh<dim> mesh = coarse_mesh<dim>(*input.named);
      if (mesh.cells.size() * std::ldexp(1., dim * int(refinements)) > 5e8) {
        problems.push_back("too many cells; reduce `refinements`");
        return {};
      }
      if (refinements == 0)
        return mesh;
      // the split comes first: it knows all shapes
      if (input.split_simplices && has_simplices(mesh))
        mesh = split_at_midpoints(mesh);
      check(mesh, problems);
      if (!problems.empty())
        return {};
      try {
        Triangulation<dim> triangulation;
        fill(mesh, triangulation);
        triangulation.refine_global(refinements);
        return active_level(triangulation, true);
      } catch (const std::exception &exception) {
        problems.push_back("the mesh cannot be refined: " +
                           level_mesh_message(exception));
        return {};
      }
    }

    /** Brings its own cells and groups: MeshInput::named. */
    class NamedMeshType : public MeshType
    {
    public:
      bool is_for_bodies() const override { return false; }
      bool has_simplices(const MeshInput &mesh) const override
      {
        return mesh.named && all_simplices(*mesh.named);
      }
      double n_cells(const MeshInput &mesh, unsigned int) const override
      {
        return mesh.named ? double(mesh.named->cells.size()) : 1.;
      }

    private:
      void make(const MeshInput &input, const unsigned int refinements,
                std::vector<std::string> &problems,
                CoarseMesh<2> &mesh) const override
      {
        mesh = named_mesh<2>(input, refinements, problems);
      }
      void make(const MeshInput &input, const unsigned int refinements,
                std::vector<std::string> &problems,
                CoarseMesh<3> &mesh) const override
      {
        mesh = named_mesh<3>(input, refinements, problems);
      }
    };

    class FileMesh final : public NamedMeshType
    {
    public:
      explicit FileMesh(const std::string &) {}
      unsigned int place() const override { return 7; }
      void read(SectionReader &reader, const unsigned int dimension,
                MeshInput &mesh) const override
      {
        read_mesh_from_file(reader, dimension, mesh);
      }
    };

    class VoronoiMesh final : public NamedMeshType
    {
    public:
      explicit VoronoiMesh(const std::string &) {}
      unsigned int place() const override { return 8; }
      unsigned int dimension() const override { return 2; }
      void read(SectionReader &reader, unsigned int,
                MeshInput &mesh) const override
      {
        read_voronoi(reader, mesh);
      }
    };

    NSFD_REGISTER(MeshTypeRegistry, FileMesh, "file",
                  "a mesh or geometry file: Gmsh, STEP, Abaqus, UCD, VTK");
    NSFD_REGISTER(MeshTypeRegistry, VoronoiMesh, "voronoi",
                  "quadrilaterals in the grains of a polycrystal");
  } // namespace

  bool read_split(SectionReader &reader)
  {
    return reader.boolean("split simplices", false,
                          "cut triangles into three quads, tetrahedra into "
                          "four hexes: opens every degree");
  }
} // namespace nsfd
