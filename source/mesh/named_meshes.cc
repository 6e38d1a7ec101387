#include "check_cells.h"
#include "level_mesh.h"
#include "mesh_entries.h"
#include "mesh_file.h"
#include "named_mesh_type.h"
#include "voronoi.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
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

    std::string read_group_data(SectionReader &reader, const MeshFormat format)
    {
      const std::string name = "group data",
                        text = "VTK: the cell data whose whole numbers are "
                               "groups; without it those that programs use";
      if (format != MeshFormat::vtk && format != MeshFormat::vtu) {
        reader.refuse({name}, "only files of VTK number their groups by cell "
                              "data");
        return "";
      }
      return reader.optional(name, text)
                 ? collapse_blanks(reader.word(name, "", text))
                 : "";
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

    void read_mesh_from_file(SectionReader &reader,
                             const unsigned int dimension, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      MeshFileRequest request;
      request.dimension = dimension;
      const bool exists = read_file_entries(reader, request);
      const bool is_geometry = request.format == MeshFormat::cad ||
                               request.format == MeshFormat::gmsh_geometry;
      request.element_size = read_element_size(reader, is_geometry);
      if (is_geometry)
        request.shape = read_shape(reader, dimension);
      request.group_data = read_group_data(reader, request.format);
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
      sort_by_data(named);
      if (problems.empty())
        check_shapes(reader, named, mesh.split_simplices);
      store_named_mesh(reader, "file", std::move(named), problems, mesh);
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
      store_named_mesh(reader, "element size", std::move(named), problems,
                       mesh);
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

  } // namespace

  bool NamedMeshType::has_simplices(const MeshInput &mesh) const
  {
    return mesh.named && all_simplices(*mesh.named);
  }

  double NamedMeshType::n_cells(const MeshInput &mesh, unsigned int) const
  {
    return mesh.named ? double(mesh.named->cells.size()) : 1.;
  }

  void NamedMeshType::make(const MeshInput &input,
                           const unsigned int refinements,
                           std::vector<std::string> &problems,
                           CoarseMesh<2> &mesh) const
  {
    mesh = named_mesh<2>(input, refinements, problems);
  }

  void NamedMeshType::make(const MeshInput &input,
                           const unsigned int refinements,
                           std::vector<std::string> &problems,
                           CoarseMesh<3> &mesh) const
  {
    mesh = named_mesh<3>(input, refinements, problems);
  }

  namespace
  {
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
                  "a mesh or geometry file: Gmsh, Neper, STEP, Abaqus, Exodus, "
                  "UCD, VTK");
    NSFD_REGISTER(MeshTypeRegistry, VoronoiMesh, "voronoi",
                  "quadrilaterals in the grains of a polycrystal");
  } // namespace
} // namespace nsfd
