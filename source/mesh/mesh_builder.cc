#include "mesh_builder.h"

#include "core/mix_bits.h"
#include "level_mesh.h"

#include "body_table.h"
#include "named_mesh.h"
#include "nearest_grains.h"
#include "spread_simplices.h"

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/shared_tria.h>
#include <deal.II/distributed/tria.h>

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
    template <int dim>
    CoarseMesh<dim> one_mesh(const MeshInput &input,
                             const unsigned int refinements,
                             std::vector<std::string> &problems)
    {
      const auto type = find_mesh_type(input.type);
      CoarseMesh<dim> mesh;
      if (!(input.distortion >= 0.))
        problems.push_back(fmt::format("`distortion` ({:g}) must not be "
                                       "negative",
                                       input.distortion));
      else if (!type || !type->is_one_mesh())
        problems.push_back(fmt::format(
            "there is no mesh type `{}`{}; there are {}", input.type,
            type ? " for one body" : "", fmt::join(mesh_type_names(), ", ")));
      else if (type->dimension() != 0 && type->dimension() != dim)
        problems.push_back(fmt::format("`{}` is a mesh of {} dimensions, the "
                                       "scene has {}",
                                       input.type, type->dimension(), dim));
      else
        mesh = type->build<dim>(input, refinements, problems);
      if (problems.empty() && input.grains > 0 && !input.named)
        add_grains(mesh, input.grains, input.seed);
      if (problems.empty() && input.distortion > 0.)
        distort(mesh, input.distortion, input.seed);
      // a mesh of one shape without simplices has been split, or need not be
      if (problems.empty() && input.split_simplices && has_simplices(mesh))
        mesh = split_at_midpoints(mesh);
      if (problems.empty() && input.split_barycentric)
        mesh = split_at_centroids(mesh, type->is_cut_straight());
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
    bool is_same_on_all_ranks(const NamedMesh &mesh,
                              const MPI_Comm communicator)
    {
      std::uint64_t hash = 0;
      const auto add = [&](const auto &numbers) {
        for (const auto number : numbers) {
          std::uint64_t bits = 0;
          std::memcpy(&bits, &number, sizeof number);
          hash = mixed(hash + bits);
        }
      };
      add(mesh.coordinates);
      for (const auto *elements : {&mesh.cells, &mesh.faces}) {
        add(elements->vertices);
        add(elements->set);
      }
      std::array<std::uint64_t, 2> ends = {{hash, ~hash}};
      MPI_Allreduce(MPI_IN_PLACE, ends.data(), 2, MPI_UINT64_T, MPI_MIN,
                    communicator);
      return ends[0] == hash && ends[1] == ~hash;
    }

    /** All cells are triangles or tetrahedra; those of bodies in contact are
        on all ranks. */
    bool can_be_spread(const SceneInput &input)
    {
      const auto has_simplices = [](const MeshInput &mesh) {
        const auto type = find_mesh_type(mesh.type);
        return !mesh.split_simplices && type && type->has_simplices(mesh);
      };
      return !input.has_body_table() &&
             (input.mesh.type == "bodies"
                  ? std::all_of(input.bodies.begin(), input.bodies.end(),
                                [&](const BodyInput &body) {
                                  return has_simplices(body.mesh);
                                })
                  : has_simplices(input.mesh));
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
      if (input.has_body_table())
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
        mesh_input.distortion == 0. && mesh_input.grains == 0 &&
        !input.adaptivity;
    const bool is_spread = Utilities::MPI::n_mpi_processes(communicator) > 1 &&
                           can_be_spread(input);
    std::vector<std::string> found;
    CoarseMesh<dim> mesh;
    if (!is_spread || Utilities::MPI::this_mpi_process(communicator) == 0) {
      mesh = mesh_input.type == "bodies"
                 ? mesh_of_bodies<dim>(input, found)
                 : one_mesh<dim>(mesh_input,
                                 by_p4est ? 0 : mesh_input.refinements, found);
      if (found.empty())
        check(mesh, found);
    }
    if (is_spread)
      found = Utilities::MPI::broadcast(communicator, found, 0);
    if (mesh_input.named) {
      const int differs =
          !is_same_on_all_ranks(*mesh_input.named, communicator);
      int any = differs;
      MPI_Allreduce(&differs, &any, 1, MPI_INT, MPI_MAX, communicator);
      if (any != 0)
        found.push_back("the ranks have made different meshes; let Gmsh write "
                        "a .msh and name that file");
    }
    std::unique_ptr<Triangulation<dim>> result;
    if (found.empty())
      try {
        result = is_spread ? spread_simplices(std::move(mesh), communicator)
                           : make(mesh, input, communicator);
        if (by_p4est)
          result->refine_global(mesh_input.refinements);
      } catch (const std::exception &exception) {
        result.reset();
        found.push_back("the mesh cannot be used: " +
                        level_mesh_message(exception));
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
