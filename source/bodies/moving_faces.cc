#include "moving_faces.h"

#include "core/neighbor_messages.h"
#include "discretization/body_shape.h"
#include "discretization/cells.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    constexpr int tag_of_sides = 72;
  } // namespace

  /**
   * What each side has, complete where it is that of another rank; @p stride
   * values per point.
   */
  template <int dim>
  void MovingFaces<dim>::share(Sides &sides, const unsigned int stride) const
  {
    const auto &neighbors = discretization_.points().neighbors;
    NeighborMessages<double> exchange;
    for (const auto &neighbor : neighbors) {
      auto &message = exchange.messages.emplace_back();
      message.rank = neighbor.rank;
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        const auto own = sides[neighbor.side[j]].begin() +
                         long(std::size_t(neighbor.points[j]) * stride);
        message.out.insert(message.out.end(), own, own + stride);
      }
      message.in.resize(message.out.size());
    }
    exchange.start(all_.mpi(), tag_of_sides);
    exchange.finish();
    for (std::size_t k = 0; k < neighbors.size(); ++k)
      for (std::size_t j = 0; j < neighbors[k].points.size(); ++j)
        std::copy_n(exchange.messages[k].in.data() + j * stride, stride,
                    sides[1u - neighbors[k].side[j]].data() +
                        std::size_t(neighbors[k].points[j]) * stride);
  }

  template <int dim>
  std::vector<double>
  MovingFaces<dim>::jumps(const std::vector<double> &displacement) const
  {
    const Bodies &cells = discretization_.bodies();
    Sides side;
    for (auto &values : side)
      values.assign(discretization_.points().n_points * dim, 0.);
    for (std::size_t b = 0; b < layout_.size(); ++b)
      for (const BodySlot &slot : layout_.slots(b)) {
        const auto &body = cells.classes[cells.class_of[slot.cell]];
        const double *u = displacement.data() + cells.first_dof[slot.cell];
        for (unsigned int d = 0; d < dim; ++d) {
          double value = 0.;
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            value += body.trace(slot.slot * dim + d, j) * u[j];
          side[slot.sign > 0][std::size_t(slot.point) * dim + d] =
              slot.sign * value;
        }
      }
    share(side, dim);
    for (std::size_t k = 0; k < side[1].size(); ++k)
      side[1][k] += side[0][k];
    return side[1];
  }

  /** dim - 1 vectors per point. */
  template <int dim>
  auto MovingFaces<dim>::tangents(const std::vector<double> &places) const
      -> Sides
  {
    const auto &rest = discretization_.points();
    constexpr unsigned int stride = dim * (dim - 1);
    Sides side;
    for (auto &values : side)
      values.assign(rest.n_points * stride, 0.);
    for (std::size_t b = 0; b < layout_.size(); ++b)
      for (const BodySlot &slot : layout_.slots(b)) {
        const unsigned int n =
            discretization_.cells().class_shape(slot.cell).n_nodes;
        const Vector *g = layout_.slot_gradients(
            discretization_.bodies().class_of[slot.cell], slot.slot, n);
        const std::size_t first = discretization_.cells().first_node[slot.cell];
        for (unsigned int a = 1; a < dim; ++a) {
          Vector T;
          for (unsigned int d = 0; d < dim; ++d)
            T[d] = rest.axes(slot.point)[a * dim + d];
          Vector sum;
          for (unsigned int i = 0; i < n; ++i)
            sum += (g[i] * T) * Vector(at_node<dim>(places, first + i));
          for (unsigned int d = 0; d < dim; ++d)
            side[slot.sign > 0]
                [std::size_t(slot.point) * stride + (a - 1) * dim + d] = sum[d];
        }
      }
    share(side, stride);
    return side;
  }

  template <int dim>
  void MovingFaces<dim>::set_frames(const std::vector<double> &places,
                                    ContactPoints<dim> &points) const
  {
    const auto &rest = discretization_.points();
    constexpr unsigned int stride = dim * (dim - 1);
    const Sides side = tangents(places);
    const auto tangent = [&](const std::size_t i, const unsigned int a) {
      Vector result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = side[0][i * stride + a * dim + d] +
                    side[1][i * stride + a * dim + d];
      return result;
    };
    for (std::size_t i = 0; i < rest.n_points; ++i) {
      if (rest.faces[rest.face_of[i]].boundary)
        continue; // rows of a support are x, y, z
      std::array<Vector, dim> frame;
      Vector t = tangent(i, 0);
      t /= t.norm();
      frame[1] = t;
      if constexpr (dim == 2) {
        frame[0][0] = t[1];
        frame[0][1] = -t[0];
      } else {
        Vector n = cross_product_3d(t, tangent(i, 1));
        n /= n.norm();
        frame[0] = n;
        frame[2] = cross_product_3d(n, t);
      }
      points.set_frame(points.mesh_point(i), frame);
    }
  }

  template class MovingFaces<2>;
  template class MovingFaces<3>;
} // namespace nsfd
