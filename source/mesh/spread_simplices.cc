#include "spread_simplices.h"

#include "core/bytes_type.h"
#include "level_mesh.h"
#include "mesh_topology.h"

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/grid/reference_cell.h>
#include <deal.II/lac/sparsity_pattern.h>
#include <deal.II/lac/sparsity_tools.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Of the face of a cell without one of its vertices. */
    struct FaceIds {
      unsigned int cell, left_out;
      types::boundary_id boundary;
      types::manifold_id manifold;
      bool at_boundary;

      bool operator<(const FaceIds &other) const
      {
        return std::pair(cell, left_out) <
               std::pair(other.cell, other.left_out);
      }
    };

    /** What a rank holds of a mesh; cells in the order of their ids. */
    template <int dim>
    struct MeshPart {
      static constexpr unsigned int artificial =
          numbers::artificial_subdomain_id;

      std::vector<Point<dim>> vertices;
      std::vector<std::array<unsigned int, dim + 1>> corners;
      std::vector<unsigned int> ids, owners; ///< of the cells
      std::vector<types::material_id> materials;
      std::vector<FaceIds> faces; ///< of the cells here, those that have ids

      template <typename Action>
      void for_all_lists(const Action &action)
      {
        action(vertices);
        action(corners);
        action(ids);
        action(owners);
        action(materials);
        action(faces);
      }
    };

    /** A mesh of one rank, and who gets what of it. */
    template <int dim>
    class MeshParts
    {
    public:
      MeshParts(CoarseMesh<dim> &&mesh, unsigned int n_parts);

      MeshPart<dim> part(unsigned int rank);

    private:
      /// in the order of cell_faces(): each leaves out the vertex of its number
      static constexpr unsigned int n_faces = dim + 1;
      static constexpr unsigned int none = numbers::invalid_unsigned_int;

      void find_neighbors();
      void find_owners(unsigned int n_parts);
      void find_cells_at_vertices();
      std::vector<unsigned int> cells_of_part(unsigned int rank);

      const CoarseMesh<dim> mesh_;
      std::vector<unsigned int> neighbor_; ///< by cell and face
      std::vector<FaceIds> face_ids_;
      std::vector<unsigned int> owner_;
      std::vector<std::size_t> first_of_owner_, first_at_vertex_;
      std::vector<unsigned int> of_owner_, at_vertex_; ///< cells
      std::vector<unsigned int> seen_;  ///< the last part that has a cell
      std::vector<unsigned int> local_; ///< vertices in the part being made
    };

    template <int dim>
    MeshParts<dim>::MeshParts(CoarseMesh<dim> &&mesh,
                              const unsigned int n_parts)
        : mesh_(std::move(mesh)), seen_(mesh_.cells.size(), none),
          local_(mesh_.vertices.size(), none)
    {
      find_neighbors();
      find_owners(n_parts);
      find_cells_at_vertices();
    }

    template <int dim>
    void MeshParts<dim>::find_neighbors()
    {
      neighbor_.assign(mesh_.cells.size() * n_faces, none);
      const auto faces = sorted_faces(mesh_);
      const auto is_same = [&](const std::size_t a, const std::size_t b) {
        return b < faces.size() && faces[a].key == faces[b].key;
      };
      for (std::size_t i = 0; i + 1 < faces.size(); ++i)
        if (is_same(i, i + 1)) {
          if (is_same(i, i + 2))
            throw std::runtime_error("a face belongs to more than two cells");
          neighbor_[faces[i].cell * n_faces + faces[i].number] =
              faces[i + 1].cell;
          neighbor_[faces[i + 1].cell * n_faces + faces[i + 1].number] =
              faces[i].cell;
        }
      const auto &with_ids = [&]() -> const auto &
      {
        if constexpr (dim == 2)
          return mesh_.boundary.boundary_lines;
        else
          return mesh_.boundary.boundary_quads;
      }
      ();
      for (const auto &object : with_ids) {
        const FaceKey key = face_key(object.vertices);
        auto at = std::lower_bound(faces.begin(), faces.end(), key,
                                   [](const CellFace &face, const FaceKey &k) {
                                     return face.key < k;
                                   });
        if (at == faces.end() || at->key != key)
          throw std::runtime_error("a boundary face belongs to no cell");
        for (; at != faces.end() && at->key == key; ++at)
          face_ids_.push_back(
              {at->cell, at->number, object.boundary_id, object.manifold_id,
               neighbor_[at->cell * n_faces + at->number] == none});
      }
      std::sort(face_ids_.begin(), face_ids_.end());
    }

    template <int dim>
    void MeshParts<dim>::find_owners(const unsigned int n_parts)
    {
      const std::size_t n = mesh_.cells.size();
      {
        SparsityPattern graph(n, n, n_faces + 1);
        for (std::size_t k = 0; k < neighbor_.size(); ++k)
          if (neighbor_[k] != none)
            graph.add(k / n_faces, neighbor_[k]);
        graph.compress();
        owner_.resize(n);
        SparsityTools::partition(graph, n_parts, owner_);
      }
      first_of_owner_.assign(n_parts + 1, 0);
      for (const unsigned int owner : owner_)
        ++first_of_owner_[owner + 1];
      std::partial_sum(first_of_owner_.begin(), first_of_owner_.end(),
                       first_of_owner_.begin());
      of_owner_.resize(n);
      auto next = first_of_owner_;
      for (unsigned int c = 0; c < n; ++c)
        of_owner_[next[owner_[c]]++] = c;
    }

    template <int dim>
    void MeshParts<dim>::find_cells_at_vertices()
    {
      first_at_vertex_.assign(mesh_.vertices.size() + 1, 0);
      for (const auto &cell : mesh_.cells)
        for (const unsigned int v : cell.vertices)
          ++first_at_vertex_[v + 1];
      std::partial_sum(first_at_vertex_.begin(), first_at_vertex_.end(),
                       first_at_vertex_.begin());
      at_vertex_.resize(first_at_vertex_.back());
      auto next = first_at_vertex_;
      for (unsigned int c = 0; c < mesh_.cells.size(); ++c)
        for (const unsigned int v : mesh_.cells[c].vertices)
          at_vertex_[next[v]++] = c;
    }

    /** Own ones, ghosts around them, and what is behind the faces of these. */
    template <int dim>
    std::vector<unsigned int>
    MeshParts<dim>::cells_of_part(const unsigned int rank)
    {
      std::vector<unsigned int> cells(
          of_owner_.begin() + long(first_of_owner_[rank]),
          of_owner_.begin() + long(first_of_owner_[rank + 1]));
      const std::size_t n_own = cells.size();
      for (const unsigned int c : cells)
        seen_[c] = rank;
      const auto take = [&](const unsigned int c) {
        if (seen_[c] == rank)
          return;
        seen_[c] = rank;
        cells.push_back(c);
      };
      for (std::size_t i = 0; i < n_own; ++i)
        for (const unsigned int v : mesh_.cells[cells[i]].vertices)
          for (auto k = first_at_vertex_[v]; k < first_at_vertex_[v + 1]; ++k)
            take(at_vertex_[k]);
      const std::size_t n_known = cells.size();
      for (std::size_t i = n_own; i < n_known; ++i)
        for (unsigned int f = 0; f < n_faces; ++f)
          if (const unsigned int c = neighbor_[cells[i] * n_faces + f];
              c != none)
            take(c);
      if (cells.empty()) // every rank knows the shape of the cells
        cells.push_back(0);
      else // the artificial ones are told from the others by their owner
        for (std::size_t i = n_known; i < cells.size(); ++i)
          seen_[cells[i]] = none;
      std::sort(cells.begin(), cells.end());
      return cells;
    }

    template <int dim>
    MeshPart<dim> MeshParts<dim>::part(const unsigned int rank)
    {
      MeshPart<dim> part;
      part.ids = cells_of_part(rank);
      std::vector<unsigned int> vertices;
      for (const unsigned int c : part.ids)
        vertices.insert(vertices.end(), mesh_.cells[c].vertices.begin(),
                        mesh_.cells[c].vertices.end());
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()),
                     vertices.end());
      for (unsigned int v = 0; v < vertices.size(); ++v) {
        local_[vertices[v]] = v;
        part.vertices.push_back(mesh_.vertices[vertices[v]]);
      }
      for (unsigned int i = 0; i < part.ids.size(); ++i) {
        const unsigned int c = part.ids[i];
        const auto &cell = mesh_.cells[c];
        auto &corners = part.corners.emplace_back();
        for (unsigned int v = 0; v < corners.size(); ++v)
          corners[v] = local_[cell.vertices[v]];
        part.owners.push_back(seen_[c] == rank ? owner_[c] : part.artificial);
        part.materials.push_back(cell.material_id);
        for (auto at = std::lower_bound(face_ids_.begin(), face_ids_.end(),
                                        FaceIds{c, 0, 0, 0, false});
             at != face_ids_.end() && at->cell == c; ++at) {
          part.faces.push_back(*at);
          part.faces.back().cell = i;
        }
      }
      return part;
    }

    template <typename T>
    void send(const std::vector<T> &list, const int rank,
              const MPI_Comm communicator)
    {
      static_assert(std::is_trivially_copyable<T>::value ||
                    std::is_same<T, Point<2>>::value ||
                    std::is_same<T, Point<3>>::value);
      const BytesType type(sizeof(T));
      MPI_Send(list.data(), int(list.size()), type, rank, 0, communicator);
    }

    template <typename T>
    void receive(std::vector<T> &list, const MPI_Comm communicator)
    {
      const BytesType type(sizeof(T));
      MPI_Status status;
      MPI_Probe(0, 0, communicator, &status);
      int n = 0;
      MPI_Get_count(&status, type, &n);
      list.resize(n);
      MPI_Recv(list.data(), n, type, 0, 0, communicator, MPI_STATUS_IGNORE);
    }

    /** Of this rank. What rank 0 throws all ranks throw. */
    template <int dim>
    MeshPart<dim> hand_out(CoarseMesh<dim> &&mesh, const MPI_Comm communicator)
    {
      MeshPart<dim> own;
      const bool is_root = Utilities::MPI::this_mpi_process(communicator) == 0;
      const unsigned int n_ranks =
          Utilities::MPI::n_mpi_processes(communicator);
      std::unique_ptr<MeshParts<dim>> parts;
      std::string problem;
      if (is_root)
        try {
          parts = std::make_unique<MeshParts<dim>>(std::move(mesh), n_ranks);
        } catch (const std::exception &exception) {
          problem = level_mesh_message(exception);
        }
      problem = Utilities::MPI::broadcast(communicator, problem, 0);
      if (!problem.empty())
        throw std::runtime_error(problem);
      if (!is_root) {
        own.for_all_lists([&](auto &list) { receive(list, communicator); });
        return own;
      }
      for (unsigned int rank = 1; rank < n_ranks; ++rank)
        parts->part(rank).for_all_lists(
            [&](auto &list) { send(list, int(rank), communicator); });
      return parts->part(0);
    }

    /** The face of a cell, by the vertex that it leaves out. */
    template <int dim>
    std::array<unsigned int, dim + 1> faces_without_vertices()
    {
      const ReferenceCell cell = ReferenceCells::get_simplex<dim>();
      constexpr unsigned int sum = dim * (dim + 1) / 2;
      std::array<unsigned int, dim + 1> result{};
      for (unsigned int f = 0; f <= dim; ++f) {
        unsigned int left_out = sum;
        for (unsigned int v = 0; v < dim; ++v)
          left_out -= cell.face_to_cell_vertices(f, v, 1);
        result[left_out] = f;
      }
      return result;
    }

    template <int dim>
    TriangulationDescription::Description<dim, dim>
    description(const MeshPart<dim> &part, const MPI_Comm communicator)
    {
      TriangulationDescription::Description<dim, dim> result;
      result.comm = communicator;
      result.settings = TriangulationDescription::Settings::default_setting;
      result.smoothing = Triangulation<dim>::none;
      result.coarse_cell_vertices = part.vertices;
      result.coarse_cell_index_to_coarse_cell_id.assign(part.ids.begin(),
                                                        part.ids.end());
      auto &infos = result.cell_infos.emplace_back();
      const auto faces = faces_without_vertices<dim>();
      auto ids = part.faces.begin();
      for (unsigned int c = 0; c < part.ids.size(); ++c) {
        auto &cell = result.coarse_cells.emplace_back(dim + 1);
        std::copy(part.corners[c].begin(), part.corners[c].end(),
                  cell.vertices.begin());
        cell.material_id = part.materials[c];
        TriangulationDescription::CellData<dim> info;
        info.id = CellId(part.ids[c], 0, nullptr).template to_binary<dim>();
        info.subdomain_id = part.owners[c];
        info.level_subdomain_id = numbers::artificial_subdomain_id;
        info.manifold_id = numbers::flat_manifold_id;
        info.manifold_line_ids.fill(numbers::flat_manifold_id);
        info.manifold_quad_ids.fill(numbers::flat_manifold_id);
        for (; ids != part.faces.end() && ids->cell == c; ++ids) {
          const unsigned int f = faces[ids->left_out];
          if constexpr (dim == 2)
            info.manifold_line_ids[f] = ids->manifold;
          else
            info.manifold_quad_ids[f] = ids->manifold;
          if (ids->at_boundary)
            info.boundary_ids.emplace_back(f, ids->boundary);
        }
        if (part.owners[c] != part.artificial)
          infos.push_back(std::move(info));
      }
      return result;
    }
  } // namespace

  template <int dim>
  std::unique_ptr<Triangulation<dim>>
  spread_simplices(CoarseMesh<dim> &&mesh, const MPI_Comm communicator)
  {
    auto result =
        std::make_unique<parallel::fullydistributed::Triangulation<dim>>(
            communicator);
    result->create_triangulation(
        description(hand_out(std::move(mesh), communicator), communicator));
    return result;
  }

  template std::unique_ptr<Triangulation<2>> spread_simplices(CoarseMesh<2> &&,
                                                              MPI_Comm);
  template std::unique_ptr<Triangulation<3>> spread_simplices(CoarseMesh<3> &&,
                                                              MPI_Comm);
} // namespace nsfd
