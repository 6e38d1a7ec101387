#include "surface_cells.h"

#include "core/gather.h"
#include "discretization/cells.h"

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

namespace nsfd
{
  using namespace dealii;

  /** A face of a cell, and what it is. */
  template <int dim>
  struct SurfaceCells<dim>::CellFace {
    std::uint64_t key;
    unsigned int cell, face;
  };

  template <int dim>
  SurfaceCells<dim>::SurfaceCells(const Discretization<dim> &discretization,
                                  const BodyLayout<dim> &bodies,
                                  const Communicator &communicator)
      : discretization_(discretization), table_(discretization.body_table()),
        bodies_(bodies), all_(communicator),
        nodes_per_cell_(discretization.cells().element->n_dofs_per_cell())
  {
    gather_faces();
    gather_balls();
    merge_nodes();
    gather_mesh_faces();
    gather_obstacle_faces();
  }

  template <int dim>
  unsigned int SurfaceCells<dim>::cell_of(const unsigned int own_cell) const
  {
    return table_.cell_of_global[discretization_.cells().global_cell[own_cell]];
  }

  /** Classes of the ranks one after the other. */
  template <int dim>
  void SurfaceCells<dim>::gather_faces()
  {
    const Bodies &cells = discretization_.bodies();
    std::vector<std::vector<FaceNodes<dim>>> own;
    for (const auto &body : cells.classes)
      own.push_back(body.bodies.empty()
                        ? std::vector<FaceNodes<dim>>()
                        : face_nodes(*discretization_.cells().element,
                                     discretization_.cells().class_shape(
                                         body.bodies[0])));
    std::size_t before = 0;
    const auto of_ranks = Utilities::MPI::all_gather(all_.mpi(), own);
    for (std::size_t r = 0; r < of_ranks.size(); ++r) {
      if (int(r) == all_.rank())
        before = faces_.size();
      faces_.insert(faces_.end(), of_ranks[r].begin(), of_ranks[r].end());
    }
    struct ClassOf {
      unsigned int cell, number;
    };
    std::vector<ClassOf> classes;
    for (unsigned int c = 0; c < cells.size(); ++c)
      classes.push_back({cell_of(c), unsigned(before + cells.class_of[c])});
    class_of_.resize(table_.n_cells());
    for (const ClassOf &entry : gather_all(all_, classes))
      class_of_[entry.cell] = entry.number;
    first_face_.assign(1, 0);
    for (unsigned int c = 0; c < size(); ++c)
      first_face_.push_back(first_face_.back() + faces(c).size());
  }

  template <int dim>
  void SurfaceCells<dim>::gather_balls()
  {
    struct Ball {
      unsigned int body;
      double radius;
    };
    std::vector<Ball> own;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (bodies_[b].radius > 0.)
        own.push_back({bodies_[b].number, bodies_[b].radius});
    radii_.assign(table_.bodies.size(), 0.);
    for (const Ball &ball : gather_all(all_, own))
      radii_[ball.body] = ball.radius;
  }

  /** Cells of one rigid body have their own nodes at the same places. */
  template <int dim>
  void SurfaceCells<dim>::merge_nodes()
  {
    struct Twin {
      std::size_t node, first;
    };
    const double unit = 1e-9 * discretization_.extent();
    std::map<std::pair<unsigned int, std::array<long long, dim>>, std::size_t>
        first;
    std::vector<Twin> own;
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      const unsigned int b = bodies_.body_of_cell(c);
      if (!bodies_[b].is_rigid())
        continue;
      const auto of_body = discretization_.cells().shape(c);
      const BodyShape<dim> &shape = *of_body;
      const Point<dim> corner = discretization_.cells().corners[c][0];
      for (unsigned int i = 0; i < nodes_per_cell_; ++i) {
        std::array<long long, dim> at;
        for (unsigned int d = 0; d < dim; ++d)
          at[d] = std::llround((corner[d] + shape.nodes[i][d]) / unit);
        const std::size_t node = first_node(cell_of(c)) + i;
        own.push_back(
            {node, first.emplace(std::pair(b, at), node).first->second});
      }
    }
    merged_.resize(n_nodes());
    for (std::size_t i = 0; i < merged_.size(); ++i)
      merged_[i] = unsigned(i);
    for (const Twin &twin : gather_all(all_, own))
      merged_[twin.node] = unsigned(twin.first);
  }

  /** Numbered by their first cells; both cells know the key of their face. */
  template <int dim>
  void SurfaceCells<dim>::gather_mesh_faces()
  {
    const Bodies &cells = discretization_.bodies();
    const auto &points = discretization_.points();
    std::vector<CellFace> between, within;
    for (unsigned int c = 0; c < cells.size(); ++c)
      for (std::size_t s = cells.first_slot[c]; s < cells.first_slot[c + 1];
           ++s) {
        const unsigned int i = cells.slot_point[s];
        if (i < points.n_points &&
            discretization_.origins()[i].kind == PointOrigin::Kind::interface)
          between.push_back({points.faces[points.face_of[i]].key, cell_of(c),
                             discretization_.cells()
                                 .class_shape(c)
                                 .slot_faces[s - cells.first_slot[c]]});
      }
    // several points of one face are next to each other
    const auto is_same = [](const CellFace &a, const CellFace &b) {
      return a.cell == b.cell && a.face == b.face;
    };
    const auto comes_before = [](const CellFace &a, const CellFace &b) {
      return std::tie(a.cell, a.face) < std::tie(b.cell, b.face);
    };
    std::sort(between.begin(), between.end(), comes_before);
    between.erase(std::unique(between.begin(), between.end(), is_same),
                  between.end());
    for (const InnerFace &face : discretization_.inner_faces())
      for (unsigned int side = 0; side < 2; ++side)
        within.push_back({0, cell_of(face.bodies[side]), face.faces[side]});

    kind_of_.assign(first_face_.back(), boundary);
    for (const CellFace &face : gather_all(all_, within))
      kind_of_[first_face_[face.cell] + face.face] = inside;
    auto of_all = gather_all(all_, between);
    std::sort(of_all.begin(), of_all.end(), comes_before);
    std::unordered_map<std::uint64_t, int> number;
    for (const CellFace &face : of_all) {
      const unsigned int b = table_.body_of_cell[face.cell];
      const auto [entry, is_new] =
          number.emplace(face.key, int(mesh_faces_.size()));
      if (is_new)
        mesh_faces_.push_back({b, b});
      else
        mesh_faces_[std::size_t(entry->second)].body_2 = b;
      kind_of_[first_face_[face.cell] + face.face] = entry->second;
    }
    for (const auto &face : points.faces)
      own_mesh_faces_.push_back(face.boundary ? -1 : number.at(face.key));
  }

  template <int dim>
  void SurfaceCells<dim>::gather_obstacle_faces()
  {
    std::vector<ObstacleFace> own = discretization_.obstacle_faces();
    for (ObstacleFace &face : own)
      face.body = cell_of(face.body);
    obstacle_faces_ = gather_all(all_, own);
    std::sort(obstacle_faces_.begin(), obstacle_faces_.end(),
              [](const ObstacleFace &a, const ObstacleFace &b) {
                return std::tie(a.body, a.face, a.obstacle) <
                       std::tie(b.body, b.face, b.obstacle);
              });
  }

  template class SurfaceCells<2>;
  template class SurfaceCells<3>;
} // namespace nsfd
