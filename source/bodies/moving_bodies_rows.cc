#include "moving_bodies.h"

#include "discretization/body_shape.h"

#include "discretization/cell_geometry.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>

// MovingBodies: the contacts of a step, as points and in the bodies.

namespace nsfd
{
  using namespace dealii;
  using namespace space;

  namespace
  {
    constexpr int tag_of_ends = 71;
  } // namespace

  template <int dim>
  void MovingBodies<dim>::set_rows(const std::vector<MovingRow<dim>> &rows)
  {
    std::vector<unsigned int> n_slots;
    for (const auto &slots : slots_)
      n_slots.push_back(unsigned(slots.size()));
    choose_rows(rows, n_slots);
    place_points();
    add_row_faces();
    set_slots(n_slots);
    set_neighbors();
  }

  /** Slots of a body are in the order of the rows of all ranks. */
  template <int dim>
  void MovingBodies<dim>::choose_rows(const std::vector<MovingRow<dim>> &rows,
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
              local_body_[std::size_t(number[side])];
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
    row_ends_.assign(rows_.size(), {});
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
  void MovingBodies<dim>::place_points()
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
    put(rest.frame, points_.frame, dim * dim);
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
  void MovingBodies<dim>::add_row_faces()
  {
    const std::size_t n_nodes =
        nodes_per_cell_ * discretization_.body_table().n_cells();
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
  void MovingBodies<dim>::set_slots(const std::vector<unsigned int> &n_slots)
  {
    bodies_.first_slot.assign(1, 0);
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      BodyClass &body = bodies_.classes[b];
      body.n_slots = n_slots[b];
      body.trace = Block(n_slots[b] * dim, body.n_dofs);
      bodies_.first_slot.push_back(bodies_.first_slot.back() + n_slots[b]);
    }
    bodies_.slot_point.assign(bodies_.first_slot.back(),
                              unsigned(points_.n_points));
    bodies_.slot_sign.assign(bodies_.first_slot.back(), 1);
    const auto put = [this](const std::size_t b, const std::size_t slot,
                            const std::size_t point, const int sign) {
      bodies_.slot_point[bodies_.first_slot[b] + slot] = unsigned(point);
      bodies_.slot_sign[bodies_.first_slot[b] + slot] =
          static_cast<signed char>(sign);
    };
    for (std::size_t b = 0; b < movers_.size(); ++b)
      for (std::size_t s = 0; s < slots_[b].size(); ++s)
        put(b, s, mesh_point(slots_[b][s].point), slots_[b][s].sign);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (unsigned int side = 0; side < 2; ++side)
        if (row_bodies_[k].body[side] >= 0)
          put(std::size_t(row_bodies_[k].body[side]), row_bodies_[k].slot[side],
              row_point(k), side == 0 ? -1 : 1);
  }

  /** Points of the mesh, then rows. */
  template <int dim>
  void MovingBodies<dim>::set_neighbors()
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

  /** Places, frames and traces at the middle of the step. */
  template <int dim>
  void MovingBodies<dim>::place_rows()
  {
    for (std::size_t k = 0; k < rows_.size(); ++k)
      set_own_ends(k);
    share_ends();
    for (std::size_t k = 0; k < rows_.size(); ++k)
      set_row(k);
  }

  template <int dim>
  void MovingBodies<dim>::set_own_ends(const std::size_t k)
  {
    using Partner = typename MovingRow<dim>::Partner;
    const MovingRow<dim> &row = rows_[k];
    const auto [body_1, body_2] = row_bodies_[k].body;
    RowEnds<dim> &ends = row_ends_[k];
    const auto at = [this](const std::size_t node) {
      return middle(own_node(node));
    };
    if (body_2 >= 0) {
      if (row.partner == Partner::pin)
        ends.of_2[0] = middle_of_pin(std::size_t(body_2), row.pin);
      else if (row.partner == Partner::edge)
        ends.of_2 = {{at(row.edge[0]), at(row.edge[1])}};
      else if (row.node == row.nowhere)
        ends.of_2[0] = middle_centre(std::size_t(body_2));
      else
        ends.of_2[0] = at(row.node);
    }
    if (body_1 >= 0) {
      if (row.partner == Partner::ball)
        ends.of_1[0] = middle_centre(std::size_t(body_1));
      for (unsigned int v = 0; v < row.n_facet; ++v)
        ends.of_1[v] = at(row.facet[v]);
    }
  }

  template <int dim>
  Point<dim> MovingBodies<dim>::middle_of_pin(const std::size_t body,
                                              const unsigned int pin) const
  {
    const Mover &mover = movers_[body];
    Vec3 at{};
    for (unsigned int d = 0; d < dim; ++d)
      at[d] = input_.pins[pin].at[d];
    const Vec3 arm =
        rigid_[std::size_t(mover.rigid)].mid_arm(at - mover.centre);
    Place x = middle_centre(body);
    for (unsigned int d = 0; d < dim; ++d)
      x[d] += arm[d];
    return x;
  }

  /** Those of the other body of a row, where it is on another rank. */
  template <int dim>
  void MovingBodies<dim>::share_ends()
  {
    NeighborMessages<double> exchange;
    const auto for_places = [](auto &places, const auto &visit) {
      for (Place &place : places)
        for (unsigned int d = 0; d < dim; ++d)
          visit(place[d]);
    };
    for (const auto &[rank, rows] : rows_by_rank_) {
      auto &message = exchange.messages.emplace_back();
      message.rank = rank;
      const auto put = [&](const double x) { message.out.push_back(x); };
      std::size_t n = 0;
      for (const unsigned int k : rows) {
        RowEnds<dim> &ends = row_ends_[k];
        const bool has_2 = row_bodies_[k].body[1] >= 0;
        if (has_2)
          for_places(ends.of_2, put);
        else
          for_places(ends.of_1, put);
        n += dim * (has_2 ? ends.of_1.size() : ends.of_2.size());
      }
      message.in.resize(n);
    }
    exchange.start(all_.mpi(), tag_of_ends);
    exchange.finish();
    std::size_t m = 0;
    for (const auto &entry : rows_by_rank_) {
      const double *x = exchange.messages[m++].in.data();
      const auto take = [&](double &value) { value = *x++; };
      for (const unsigned int k : entry.second)
        if (row_bodies_[k].body[1] >= 0)
          for_places(row_ends_[k].of_1, take);
        else
          for_places(row_ends_[k].of_2, take);
    }
  }

  /**
   * The place of a body that is at x at the middle of the step; a little
   * outside of its cell too, so that both bodies feel the impulse there.
   */
  template <int dim>
  Point<dim> MovingBodies<dim>::in_reference_cell(const unsigned int cell,
                                                  const std::size_t *nodes,
                                                  const double *weights,
                                                  const unsigned int n_nodes,
                                                  const Place &x) const
  {
    const auto &element = discretization_.element();
    const std::size_t first = discretization_.first_node(local_cell_[cell]);
    Place xi;
    for (unsigned int v = 0; v < n_nodes; ++v)
      xi += weights[v] * Vector(element.unit_support_point(
                             unsigned(nodes[v] % nodes_per_cell_)));
    for (unsigned int k = 0; k < 20; ++k) {
      Vector off = x - Place();
      Tensor<2, dim> J;
      for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i) {
        const Vector node = middle(first + i) - Place();
        off -= element.shape_value(i, xi) * node;
        J += outer_product(node, element.shape_grad(i, xi));
      }
      const Vector change = invert(J) * off;
      xi += change;
      if (!(change.norm() > 1e-14))
        break;
    }
    return xi;
  }

  template <int dim>
  void MovingBodies<dim>::set_row(const std::size_t k)
  {
    using Partner = typename MovingRow<dim>::Partner;
    const MovingRow<dim> &row = rows_[k];
    const std::size_t i = row_point(k);
    const Vector normal = row_normal(input_, row, row_ends_[k], shift_middle_);
    const Place x = row_place(row, row_ends_[k], normal);
    auto frame = local_frame<dim>(normal);
    if (row.partner == Partner::pin)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          frame[a][d] = a == d ? 1. : 0.;
    for (unsigned int a = 0; a < dim; ++a) {
      points_.position[i * dim + a] = x[a];
      for (unsigned int d = 0; d < dim; ++d)
        points_.frame[(i * dim + a) * dim + d] = frame[a][d];
    }
    for (unsigned int side = 0; side < 2; ++side) {
      if (row_bodies_[k].body[side] < 0)
        continue;
      const auto b = std::size_t(row_bodies_[k].body[side]);
      const unsigned int slot = row_bodies_[k].slot[side];
      if (is_rigid(b))
        rigid_trace(b, slot, x - middle_centre(b));
      else if (side == 0)
        deformable_trace(b, slot,
                         in_reference_cell(row.facet_cell, row.facet.data(),
                                           row.weights.data(), row.n_facet, x));
      else if (row.partner == Partner::edge)
        deformable_trace(b, slot,
                         in_reference_cell(row.cell, row.edge.data(),
                                           row.edge_weights.data(), 2, x));
      else
        deformable_trace(b, slot,
                         discretization_.element().unit_support_point(
                             unsigned(row.node % nodes_per_cell_)));
    }
  }

  template <int dim>
  void MovingBodies<dim>::deformable_trace(const std::size_t b,
                                           const unsigned int slot,
                                           const Place &place)
  {
    Block &trace = bodies_.classes[b].trace;
    const auto &element = discretization_.element();
    for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        trace(slot * dim + d, i * dim + d) = element.shape_value(i, place);
  }
#define INSTANTIATE(dim)                                                       \
  template void MovingBodies<dim>::set_rows(                                   \
      const std::vector<MovingRow<dim>> &);                                    \
  template void MovingBodies<dim>::place_rows()

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
