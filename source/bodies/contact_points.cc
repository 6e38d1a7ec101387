#include "contact_points.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  ContactPoints<dim>::ContactPoints(const Discretization<dim> &discretization,
                                    const BodyLayout<dim> &layout)
      : discretization_(discretization), layout_(layout),
        points_(discretization.points()), n_mesh_points_(points_.n_points),
        n_own_mesh_points_(points_.n_owned), n_mesh_faces_(points_.faces.size())
  {
    const BodyTable &table = discretization.body_table();
    for (auto &face : points_.faces)
      for (unsigned int side = 0; side < 2; ++side) {
        if (!face.boundary)
          face.cells[side] = table.body_of_global(face.cells[side]);
        if (face.bodies[side] >= 0)
          face.bodies[side] =
              int(layout.body_of_cell(unsigned(face.bodies[side])));
      }
  }

  template <int dim>
  void ContactPoints<dim>::set(const std::vector<MovingRow<dim>> &rows,
                               Bodies &bodies)
  {
    std::vector<unsigned int> n_slots;
    for (std::size_t b = 0; b < layout_.size(); ++b)
      n_slots.push_back(unsigned(layout_.slots(b).size()));
    choose(rows, n_slots);
    place_points();
    add_faces();
    set_slots(n_slots, bodies);
    set_neighbors();
  }

  template <int dim>
  void ContactPoints<dim>::set_position(const std::size_t i,
                                        const dealii::Point<dim> &position)
  {
    for (unsigned int d = 0; d < dim; ++d)
      points_.position[i * dim + d] = position[d];
  }

  template <int dim>
  void ContactPoints<dim>::set_frame(const std::size_t i,
                                     const std::array<Vector, dim> &frame)
  {
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int d = 0; d < dim; ++d)
        points_.frames[(i * dim + a) * dim + d] = frame[a][d];
  }

  /** Slots of a body are in the order of the rows of all ranks. */
  template <int dim>
  void ContactPoints<dim>::choose(const std::vector<MovingRow<dim>> &rows,
                                  std::vector<unsigned int> &n_slots)
  {
    const BodyTable &table = discretization_.body_table();
    rows_.clear();
    row_bodies_.clear();
    rows_by_rank_.clear();
    std::vector<MovingRow<dim>> others;
    std::vector<RowBodies> bodies_of_others;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const MovingRow<dim> &row = rows[k];
      const std::array<int, 2> number = {{row.body_1, int(row.body_2)}};
      RowBodies row_bodies;
      for (unsigned int side = 0; side < 2; ++side)
        if (number[side] >= 0) {
          const int b = row_bodies.body[side] =
              layout_.own_body(unsigned(number[side]));
          if (b >= 0)
            row_bodies.slot[side] = n_slots[std::size_t(b)]++;
          else
            row_bodies.other_rank =
                table.bodies[std::size_t(number[side])].rank;
        }
      if (row_bodies.body[0] < 0 && row_bodies.body[1] < 0)
        continue;
      const bool is_own = row_bodies.body[1] >= 0;
      (is_own ? rows_ : others).push_back(row);
      (is_own ? rows_ : others).back().index = k;
      (is_own ? row_bodies_ : bodies_of_others).push_back(row_bodies);
    }
    n_own_rows_ = rows_.size();
    rows_.insert(rows_.end(), others.begin(), others.end());
    row_bodies_.insert(row_bodies_.end(), bodies_of_others.begin(),
                       bodies_of_others.end());
    for (unsigned int k = 0; k < rows_.size(); ++k)
      if (row_bodies_[k].other_rank >= 0)
        rows_by_rank_[row_bodies_[k].other_rank].push_back(k);
    // both ranks know the order of all rows
    for (auto &entry : rows_by_rank_)
      std::sort(entry.second.begin(), entry.second.end(),
                [this](const unsigned int k, const unsigned int l) {
                  return rows_[k].index < rows_[l].index;
                });
  }

  /** Behind those that the rank owns on the mesh. */
  template <int dim>
  void ContactPoints<dim>::place_points()
  {
    const auto &rest = discretization_.points();
    const auto put = [this](const auto &from, auto &to, const unsigned int n) {
      const auto middle = from.begin() + long(n_own_mesh_points_ * n);
      to.assign(from.begin(), middle);
      to.resize(to.size() + rows_.size() * n);
      to.insert(to.end(), middle, from.end());
    };
    points_.n_points = n_mesh_points_ + rows_.size();
    points_.n_owned = n_own_mesh_points_ + n_own_rows_;
    put(rest.position, points_.position, dim);
    put(rest.frames_of_points(), points_.frames, dim * dim);
    points_.frame_of_face = false;
    put(rest.weight, points_.weight, 1);
    put(rest.face_of, points_.face_of, 1);
    for (std::size_t f = 0; f < n_mesh_faces_; ++f)
      points_.faces[f].first = unsigned(mesh_point(rest.faces[f].first));
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      points_.weight[row_point(k)] = rows_[k].weight;
      points_.face_of[row_point(k)] = unsigned(n_mesh_faces_ + k);
    }
  }

  template <int dim>
  void ContactPoints<dim>::add_faces()
  {
    const std::size_t n_nodes =
        layout_.nodes_per_cell() * discretization_.body_table().n_cells();
    points_.faces.resize(n_mesh_faces_);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const MovingRow<dim> &row = rows_[k];
      typename InterfacePoints<dim>::Face face;
      face.first = unsigned(row_point(k));
      face.count = 1;
      // apart from those of the mesh, the same in every run
      face.key = (std::uint64_t(row.partner == MovingRow<dim>::Partner::edge
                                    ? row.edge[0]
                                : row.node == row.nowhere ? n_nodes + row.body_2
                                                          : row.node)
                  << 20) +
                 row.index;
      face.boundary = row.body_1 < 0;
      face.bodies = row_bodies_[k].body;
      face.neighbor_rank = row_bodies_[k].other_rank;
      face.cells = {
          {row.body_1 < 0 ? row.body_2 : std::size_t(row.body_1), row.body_2}};
      points_.faces.push_back(face);
    }
  }

  template <int dim>
  void ContactPoints<dim>::set_slots(const std::vector<unsigned int> &n_slots,
                                     Bodies &bodies) const
  {
    bodies.first_slot.assign(1, 0);
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      BodyClass &body = bodies.classes[b];
      body.n_slots = n_slots[b];
      body.trace = Block(n_slots[b] * dim, body.n_dofs);
      bodies.first_slot.push_back(bodies.first_slot.back() + n_slots[b]);
    }
    bodies.slot_point.assign(bodies.first_slot.back(),
                             unsigned(points_.n_points));
    bodies.slot_sign.assign(bodies.first_slot.back(), 1);
    const auto put = [&](const std::size_t b, const std::size_t slot,
                         const std::size_t point, const int sign) {
      bodies.slot_point[bodies.first_slot[b] + slot] = unsigned(point);
      bodies.slot_sign[bodies.first_slot[b] + slot] =
          static_cast<signed char>(sign);
    };
    for (std::size_t b = 0; b < layout_.size(); ++b)
      for (std::size_t s = 0; s < layout_.slots(b).size(); ++s)
        put(b, s, mesh_point(layout_.slots(b)[s].point),
            layout_.slots(b)[s].sign);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (unsigned int side = 0; side < 2; ++side)
        if (row_bodies_[k].body[side] >= 0)
          put(std::size_t(row_bodies_[k].body[side]), row_bodies_[k].slot[side],
              row_point(k), side == 0 ? -1 : 1);
  }

  /** Points of the mesh, then rows. */
  template <int dim>
  void ContactPoints<dim>::set_neighbors()
  {
    std::map<int, typename InterfacePoints<dim>::Neighbor> by_rank;
    for (const auto &neighbor : discretization_.points().neighbors) {
      auto &entry = by_rank[neighbor.rank];
      entry = neighbor;
      for (unsigned int &point : entry.points)
        point = unsigned(mesh_point(point));
    }
    for (const auto &[rank, rows] : rows_by_rank_) {
      auto &entry = by_rank[rank];
      entry.rank = rank;
      for (const unsigned int k : rows) {
        entry.points.push_back(unsigned(row_point(k)));
        entry.side.push_back(row_bodies_[k].body[1] >= 0 ? 1 : 0);
      }
    }
    points_.neighbors.clear();
    for (auto &entry : by_rank)
      points_.neighbors.push_back(std::move(entry.second));
  }

  template class ContactPoints<2>;
  template class ContactPoints<3>;
} // namespace nsfd
