#include "mesh_builder.h"

#include "core/mix_bits.h"
#include "deal_ii_message.h"
#include "mesh_topology.h"
#include "mesh_types.h"
#include "named_mesh.h"

#include "nsfd/mesh/body_table.h"

#include <deal.II/distributed/shared_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <set>
#include <sstream>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** What deal.II says of an error, in words of the parameter file. */
    std::string message(const std::exception &exception)
    {
      std::string result = deal_ii_message(exception);
      const std::array<std::pair<std::string, std::string>, 5> shorter = {
          {{"[Double -MAX_DOUBLE...MAX_DOUBLE (inclusive)]", "number"},
           {"[Integer]", "integer"},
           {"[Bool]", "true or false"},
           {" of length 0...4294967295 (inclusive)", ""},
           {" (inclusive)", ""}}};
      for (const auto &[from, to] : shorter)
        for (auto at = result.find(from); at != std::string::npos;
             at = result.find(from))
          result.replace(at, from.size(), to);
      return result;
    }

    /**
     * The active cells of a mesh without hanging nodes. Manifold ids of faces
     * are groups, or the curved boundaries of a generator.
     */
    template <int dim>
    CoarseMesh<dim> active_level(const Triangulation<dim> &triangulation,
                                 const bool with_manifold_ids = false)
    {
      CoarseMesh<dim> mesh;
      std::vector<unsigned int> number(triangulation.n_vertices(),
                                       numbers::invalid_unsigned_int);
      for (const auto &cell : triangulation.active_cell_iterators()) {
        auto &data = mesh.cells.emplace_back(cell->n_vertices());
        data.material_id = cell->material_id();
        for (const unsigned int v : cell->vertex_indices()) {
          unsigned int &n = number[cell->vertex_index(v)];
          if (n == numbers::invalid_unsigned_int) {
            n = mesh.vertices.size();
            mesh.vertices.push_back(cell->vertex(v));
          }
          data.vertices[v] = n;
        }
        for (const unsigned int f : cell->face_indices()) {
          const auto face = cell->face(f);
          const bool in_group =
              with_manifold_ids &&
              face->manifold_id() != numbers::flat_manifold_id;
          if (!in_group && (!face->at_boundary() || face->boundary_id() == 0))
            continue;
          CellData<dim - 1> part(face->n_vertices());
          for (const unsigned int v : face->vertex_indices())
            part.vertices[v] = number[face->vertex_index(v)];
          part.boundary_id = face->boundary_id();
          if (in_group) {
            // from the first of its two cells
            if (!face->at_boundary() && cell->neighbor(f) < cell)
              continue;
            part.manifold_id = face->manifold_id();
          }
          if constexpr (dim == 2)
            mesh.boundary.boundary_lines.push_back(part);
          else
            mesh.boundary.boundary_quads.push_back(part);
        }
      }
      return mesh;
    }

    /** Refined along the generator's own curved boundaries, then straight. */
    template <int dim>
    CoarseMesh<dim> generated_mesh(const MeshInput &input,
                                   const unsigned int refinements,
                                   std::vector<std::string> &problems)
    {
      try {
        Triangulation<dim> triangulation;
        GridGenerator::generate_from_name_and_arguments(
            triangulation, input.type, input.generator_arguments);
        if (triangulation.n_active_cells() == 0) {
          problems.push_back(fmt::format("the generator `{}` makes no mesh in "
                                         "{} dimensions",
                                         input.type, dim));
          return {};
        }
        if (triangulation.n_active_cells() *
                std::ldexp(1., dim * int(refinements)) >
            5e8) {
          problems.push_back("too many cells; reduce `refinements`");
          return {};
        }
        triangulation.refine_global(refinements);
        if (triangulation.has_hanging_nodes() ||
            triangulation.is_mixed_mesh()) {
          problems.push_back(fmt::format("the generator `{}` makes a mesh with "
                                         "hanging nodes or mixed cells",
                                         input.type));
          return {};
        }
        return active_level(triangulation);
      } catch (const std::exception &exception) {
        problems.push_back(fmt::format(
            "the generator `{}` does not accept `{}`: {}", input.type,
            input.generator_arguments, message(exception)));
        return {};
      }
    }

    /**
     * deal.II stores every line once; quads and hexes that share a line must
     * agree on its direction. True for lattices, not for any merged mesh.
     */
    template <int dim>
    bool lines_agree(const std::vector<CellData<dim>> &cells)
    {
      std::vector<std::pair<unsigned int, unsigned int>> lines;
      for (const auto &cell : cells)
        for (unsigned int v = 0; v < cell.vertices.size(); ++v)
          for (unsigned int d = 0; d < dim; ++d)
            if (!(v >> d & 1u))
              lines.emplace_back(cell.vertices[v], cell.vertices[v | 1u << d]);
      std::sort(lines.begin(), lines.end());
      return std::none_of(lines.begin(), lines.end(), [&](const auto &line) {
        return line.first < line.second &&
               std::binary_search(lines.begin(), lines.end(),
                                  std::pair(line.second, line.first));
      });
    }

    /** deal.II wants to know which of the faces with an id are inside. */
    template <int dim>
    void mark_inner_faces(CoarseMesh<dim> &mesh)
    {
      const auto mark = [&](auto &objects) {
        if (objects.empty())
          return;
        std::set<FaceKey> inner;
        for_each_face(sorted_faces(mesh),
                      [&](const CellFace &face, const std::size_t n) {
                        if (n > 1)
                          inner.insert(face.key);
                      });
        for (auto &object : objects)
          if (inner.count(face_key(object.vertices)) != 0)
            object.boundary_id = numbers::internal_face_boundary_id;
      };
      if constexpr (dim == 2)
        mark(mesh.boundary.boundary_lines);
      else
        mark(mesh.boundary.boundary_quads);
    }

    /** The cells may be put into another order of their corners. */
    template <int dim>
    void fill(CoarseMesh<dim> &mesh, Triangulation<dim> &triangulation)
    {
      if (mesh.cells[0].vertices.size() != dim + 1 && !lines_agree(mesh.cells))
        GridTools::consistently_order_cells(mesh.cells);
      mark_inner_faces(mesh);
      triangulation.create_triangulation(mesh.vertices, mesh.cells,
                                         mesh.boundary);
    }

    template <int dim>
    bool has_simplices(const CoarseMesh<dim> &mesh)
    {
      return std::any_of(
          mesh.cells.begin(), mesh.cells.end(),
          [](const auto &cell) { return cell.vertices.size() != 1u << dim; });
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
        problems.push_back("the mesh cannot be refined: " + message(exception));
        return {};
      }
    }

    template <int dim>
    CoarseMesh<dim> one_mesh(const MeshInput &input,
                             const unsigned int refinements,
                             std::vector<std::string> &problems)
    {
      const MeshType *type = find_mesh_type(input.type);
      CoarseMesh<dim> mesh;
      if (!(input.distortion >= 0.))
        problems.push_back(fmt::format("`distortion` ({:g}) must not be "
                                       "negative",
                                       input.distortion));
      else if (type == nullptr || type->kind == MeshType::Kind::bodies) {
        std::vector<std::string> names;
        for (const MeshType &known : mesh_types())
          names.push_back(known.name);
        problems.push_back(fmt::format(
            "there is no mesh type `{}`{}; there are {}", input.type,
            type == nullptr ? "" : " for one body", fmt::join(names, ", ")));
      } else if (type->dimension != 0 && type->dimension != dim)
        problems.push_back(fmt::format("`{}` is a mesh of {} dimensions, the "
                                       "scene has {}",
                                       input.type, type->dimension, dim));
      else if (type->kind == MeshType::Kind::generator)
        mesh = generated_mesh<dim>(input, refinements, problems);
      else if (type->kind == MeshType::Kind::named)
        mesh = named_mesh<dim>(input, refinements, problems);
      else
        mesh = lattice_mesh<dim>(input, refinements, problems);
      // a mesh of one shape without simplices has been split, or need not be
      if (problems.empty() && input.split_simplices && has_simplices(mesh))
        mesh = split_at_midpoints(mesh);
      if (problems.empty() && input.distortion > 0.)
        distort(mesh, input.distortion, input.seed);
      return mesh;
    }

    template <int dim>
    CoarseMesh<dim> mesh_of_bodies(const SceneInput &input,
                                   std::vector<std::string> &problems)
    {
      if (input.bodies.empty()) {
        problems.push_back("a mesh of type `bodies` needs `Body:` sections");
        return {};
      }
      std::vector<CoarseMesh<dim>> meshes;
      std::set<std::string> names;
      for (const BodyInput &body : input.bodies) {
        std::vector<std::string> of_body;
        meshes.push_back(one_mesh<dim>(
            body.mesh, body.mesh.refinements + input.mesh.refinements,
            of_body));
        if (of_body.empty() && meshes.back().cells.empty())
          of_body.push_back("the mesh has no cell");
        if (!names.insert(body.name).second)
          of_body.push_back("there are two bodies of this name");
        if (body.separation != 0.)
          of_body.push_back("`separation` is not available for this mesh");
        for (const std::string &problem : of_body)
          problems.push_back("Body: " + body.name + ": " + problem);
      }
      if (!problems.empty())
        return {};
      CoarseMesh<dim> mesh =
          merge_bodies(input.bodies, meshes, !input.contacts.empty(), problems);
      if (problems.empty() && input.mesh.distortion > 0.)
        distort(mesh, input.mesh.distortion, input.mesh.seed);
      return mesh;
    }

    /** Every rank has read the file, or made the mesh of its geometry. */
    template <int dim>
    bool is_same_on_all_ranks(const CoarseMesh<dim> &mesh,
                              const MPI_Comm communicator)
    {
      std::uint64_t hash = 0;
      const auto add = [&](const std::uint64_t bits) {
        hash = mixed(hash + bits);
      };
      for (const auto &p : mesh.vertices)
        for (unsigned int d = 0; d < dim; ++d) {
          std::uint64_t bits;
          std::memcpy(&bits, &p[d], sizeof bits);
          add(bits);
        }
      for (const auto &cell : mesh.cells) {
        add(cell.material_id);
        for (const unsigned int v : cell.vertices)
          add(v);
      }
      std::array<std::uint64_t, 2> ends = {{hash, ~hash}};
      MPI_Allreduce(MPI_IN_PLACE, ends.data(), 2, MPI_UINT64_T, MPI_MIN,
                    communicator);
      return ends[0] == hash && ends[1] == ~hash;
    }

    /** Every rank knows all cells; whole bodies belong to one. */
    template <int dim>
    std::unique_ptr<Triangulation<dim>> by_bodies(const SceneInput &input,
                                                  const MPI_Comm communicator)
    {
      using Shared = parallel::shared::Triangulation<dim>;
      auto result = std::make_unique<Shared>(communicator, Shared::none, false,
                                             Shared::partition_custom_signal);
      const auto partition = [&input, mesh = result.get(), communicator]() {
        partition_by_bodies<dim>(
            input, *mesh, int(Utilities::MPI::n_mpi_processes(communicator)));
      };
      result->signals.create.connect(partition);
      result->signals.post_refinement.connect(partition);
      return result;
    }

    template <int dim>
    std::unique_ptr<Triangulation<dim>> make(CoarseMesh<dim> &mesh,
                                             const SceneInput &input,
                                             const MPI_Comm communicator)
    {
      std::unique_ptr<Triangulation<dim>> result;
      if (input.large_motion)
        result = by_bodies<dim>(input, communicator);
      else if (mesh.cells[0].vertices.size() == dim + 1)
        result = std::make_unique<parallel::shared::Triangulation<dim>>(
            communicator, Triangulation<dim>::none, true,
            parallel::shared::Triangulation<dim>::partition_metis);
      else
        result = std::make_unique<parallel::distributed::Triangulation<dim>>(
            communicator);
      fill(mesh, *result);
      return result;
    }
  } // namespace

  template <int dim>
  std::unique_ptr<Triangulation<dim>>
  build_mesh(const SceneInput &input, const MPI_Comm communicator,
             std::vector<std::string> &problems)
  {
    const MeshInput &mesh_input = input.mesh;
    // the cells of a mesh that will change are those of level 0
    const bool by_p4est =
        (mesh_input.type == "rectangle" || mesh_input.type == "brick") &&
        mesh_input.distortion == 0. && !input.adaptivity;
    std::vector<std::string> found;
    CoarseMesh<dim> mesh =
        mesh_input.type == "bodies"
            ? mesh_of_bodies<dim>(input, found)
            : one_mesh<dim>(mesh_input, by_p4est ? 0 : mesh_input.refinements,
                            found);
    if (found.empty())
      check(mesh, found);
    if (mesh_input.named) {
      const int differs = !is_same_on_all_ranks(mesh, communicator);
      int any = differs;
      MPI_Allreduce(&differs, &any, 1, MPI_INT, MPI_MAX, communicator);
      if (any != 0)
        found.push_back("the ranks have made different meshes; let Gmsh write "
                        "a .msh and name that file");
    }
    std::unique_ptr<Triangulation<dim>> result;
    if (found.empty())
      try {
        result = make(mesh, input, communicator);
        if (by_p4est)
          result->refine_global(mesh_input.refinements);
      } catch (const std::exception &exception) {
        result.reset();
        found.push_back("the mesh cannot be used: " + message(exception));
      }
    for (const std::string &problem : found)
      problems.push_back((problem.rfind("Body: ", 0) == 0 ? "" : "Mesh: ") +
                         problem);
    return result;
  }

  template std::unique_ptr<Triangulation<2>>
  build_mesh(const SceneInput &, MPI_Comm, std::vector<std::string> &);
  template std::unique_ptr<Triangulation<3>>
  build_mesh(const SceneInput &, MPI_Comm, std::vector<std::string> &);
} // namespace nsfd
