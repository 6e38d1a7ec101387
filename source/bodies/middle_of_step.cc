#include "middle_of_step.h"

#include "core/neighbor_messages.h"
#include "discretization/body_shape.h"
#include "discretization/cell_geometry.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>

namespace nsfd
{
  using namespace dealii;
  using namespace space;

  namespace
  {
    constexpr int tag_of_ends = 71;
  } // namespace

  template <int dim>
  MiddleOfStep<dim>::MiddleOfStep(const SceneInput &input,
                                  const Discretization<dim> &discretization,
                                  const BodyLayout<dim> &layout,
                                  const Communicator &communicator,
                                  const StepMotion &motion,
                                  ContactPoints<dim> &points, Bodies &bodies)
      : input_(input), discretization_(discretization), layout_(layout),
        all_(communicator), motion_(motion), points_(points), bodies_(bodies)
  {
  }

  template <int dim>
  void MiddleOfStep<dim>::set_nodes()
  {
    const auto &rest = layout_.rest();
    nodes_.resize(rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i)
      nodes_[i] = rest[i] + (motion_.u_old[i] + motion_.u_new[i]) / 2.;
  }

  template <int dim>
  Point<dim> MiddleOfStep<dim>::centre(const std::size_t b) const
  {
    const RigidStep &step = motion_.rigid[std::size_t(layout_[b].rigid)];
    const RigidVelocity v = step.theta_velocity();
    Place result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = step.state().centre[d] - motion_.time_step / 2. * v.centre[d];
    return result;
  }

  template <int dim>
  void MiddleOfStep<dim>::place_rows()
  {
    row_ends_.assign(points_.rows().size(), {});
    for (std::size_t k = 0; k < row_ends_.size(); ++k)
      set_own_ends(k);
    share_ends();
    for (std::size_t k = 0; k < row_ends_.size(); ++k)
      set_row(k);
  }

  template <int dim>
  void MiddleOfStep<dim>::set_own_ends(const std::size_t k)
  {
    using Partner = typename MovingRow<dim>::Partner;
    const MovingRow<dim> &row = points_.rows()[k];
    const auto [body_1, body_2] = points_.bodies_of(k).body;
    RowEnds<dim> &ends = row_ends_[k];
    const auto at = [this](const std::size_t node) {
      return node_place(layout_.own_node(node));
    };
    if (body_2 >= 0) {
      if (row.partner == Partner::pin)
        ends.of_2[0] = pin(std::size_t(body_2), row.pin);
      else if (row.partner == Partner::edge)
        ends.of_2 = {{at(row.edge[0]), at(row.edge[1])}};
      else if (row.node == row.nowhere)
        ends.of_2[0] = centre(std::size_t(body_2));
      else
        ends.of_2[0] = at(row.node);
    }
    if (body_1 >= 0) {
      if (row.partner == Partner::ball)
        ends.of_1[0] = centre(std::size_t(body_1));
      for (unsigned int v = 0; v < row.n_facet; ++v)
        ends.of_1[v] = at(row.facet[v]);
    }
  }

  template <int dim>
  Point<dim> MiddleOfStep<dim>::pin(const std::size_t body,
                                    const unsigned int pin) const
  {
    const MovingBody &moved = layout_[body];
    Vec3 at{};
    for (unsigned int d = 0; d < dim; ++d)
      at[d] = input_.pins[pin].at[d];
    const Vec3 arm =
        motion_.rigid[std::size_t(moved.rigid)].mid_arm(at - moved.centre);
    Place x = centre(body);
    for (unsigned int d = 0; d < dim; ++d)
      x[d] += arm[d];
    return x;
  }

  /** Those of the other body of a row, where it is on another rank. */
  template <int dim>
  void MiddleOfStep<dim>::share_ends()
  {
    NeighborMessages<double> exchange;
    const auto for_places = [](auto &places, const auto &visit) {
      for (Place &place : places)
        for (unsigned int d = 0; d < dim; ++d)
          visit(place[d]);
    };
    for (const auto &[rank, rows] : points_.rows_by_rank()) {
      auto &message = exchange.messages.emplace_back();
      message.rank = rank;
      const auto put = [&](const double x) { message.out.push_back(x); };
      std::size_t n = 0;
      for (const unsigned int k : rows) {
        RowEnds<dim> &ends = row_ends_[k];
        const bool has_2 = points_.bodies_of(k).body[1] >= 0;
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
    for (const auto &entry : points_.rows_by_rank()) {
      const double *x = exchange.messages[m++].in.data();
      const auto take = [&](double &value) { value = *x++; };
      for (const unsigned int k : entry.second)
        if (points_.bodies_of(k).body[1] >= 0)
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
  Point<dim> MiddleOfStep<dim>::in_reference_cell(const unsigned int cell,
                                                  const std::size_t *nodes,
                                                  const double *weights,
                                                  const unsigned int n_nodes,
                                                  const Place &x) const
  {
    const auto &element = *discretization_.cells().element;
    const std::size_t first =
        discretization_.cells().first_node[layout_.own_cell(cell)];
    Place xi;
    for (unsigned int v = 0; v < n_nodes; ++v)
      xi += weights[v] * Vector(element.unit_support_point(
                             unsigned(nodes[v] % layout_.nodes_per_cell())));
    for (unsigned int k = 0; k < 20; ++k) {
      Vector off = x - Place();
      Tensor<2, dim> J;
      for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i) {
        const Vector node = node_place(first + i) - Place();
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
  void MiddleOfStep<dim>::set_row(const std::size_t k)
  {
    using Partner = typename MovingRow<dim>::Partner;
    const MovingRow<dim> &row = points_.rows()[k];
    const std::size_t i = points_.row_point(k);
    const Vector normal =
        row_normal(input_, row, row_ends_[k], motion_.shift_middle);
    const Place x = row_place(row, row_ends_[k], normal);
    auto frame = local_frame<dim>(normal);
    if (row.partner == Partner::pin)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          frame[a][d] = a == d ? 1. : 0.;
    points_.set_position(i, x);
    points_.set_frame(i, frame);
    set_traces(k, x);
  }

  template <int dim>
  void MiddleOfStep<dim>::set_traces(const std::size_t k, const Place &x)
  {
    const MovingRow<dim> &row = points_.rows()[k];
    const auto &bodies = points_.bodies_of(k);
    for (unsigned int side = 0; side < 2; ++side) {
      if (bodies.body[side] < 0)
        continue;
      const auto b = std::size_t(bodies.body[side]);
      const unsigned int slot = bodies.slot[side];
      if (layout_[b].is_rigid())
        set_rigid_trace<dim>(x - centre(b), slot, bodies_.classes[b].trace);
      else if (side == 0)
        set_deformable_trace(b, slot,
                             in_reference_cell(row.facet_cell, row.facet.data(),
                                               row.weights.data(), row.n_facet,
                                               x));
      else if (row.partner == MovingRow<dim>::Partner::edge)
        set_deformable_trace(b, slot,
                             in_reference_cell(row.cell, row.edge.data(),
                                               row.edge_weights.data(), 2, x));
      else
        set_deformable_trace(
            b, slot,
            discretization_.cells().element->unit_support_point(
                unsigned(row.node % layout_.nodes_per_cell())));
    }
  }

  template <int dim>
  void MiddleOfStep<dim>::set_deformable_trace(const std::size_t b,
                                               const unsigned int slot,
                                               const Place &place)
  {
    Block &trace = bodies_.classes[b].trace;
    const auto &element = *discretization_.cells().element;
    for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        trace(slot * dim + d, i * dim + d) = element.shape_value(i, place);
  }

  template class MiddleOfStep<2>;
  template class MiddleOfStep<3>;
} // namespace nsfd
