#include "row_geometry.h"

#include "obstacle_geometry.h"

#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Tensor<1, dim> facet_normal(const MovingRow<dim> &row,
                                const RowEnds<dim> &ends)
    {
      Tensor<1, dim> n;
      if constexpr (dim == 2) {
        const Tensor<1, dim> edge = ends.of_1[1] - ends.of_1[0];
        n[0] = edge[1];
        n[1] = -edge[0];
      } else {
        const auto &x = ends.of_1;
        if (row.n_facet == 3)
          n = cross_product_3d(Tensor<1, dim>(x[1] - x[0]),
                               Tensor<1, dim>(x[2] - x[0]));
        else {
          // of the bilinear surface where they meet: along one that is warped
          // nothing slides across its mean normal
          const double s = row.weights[1] + row.weights[2],
                       t = row.weights[2] + row.weights[3];
          n = cross_product_3d((1. - t) * (x[1] - x[0]) + t * (x[2] - x[3]),
                               (1. - s) * (x[3] - x[0]) + s * (x[2] - x[1]));
        }
      }
      return n / n.norm();
    }

    /** Of a ball at an edge or a corner: across what it touches there. */
    template <int dim>
    Tensor<1, dim> ball_normal(const MovingRow<dim> &row,
                               const RowEnds<dim> &ends)
    {
      const Tensor<1, dim> n = facet_normal(row, ends);
      std::vector<unsigned int> touched;
      for (unsigned int v = 0; v < row.n_facet; ++v)
        if (row.weights[v] > 1e-9)
          touched.push_back(v);
      if (touched.size() >= dim)
        return n;
      Tensor<1, dim> away = ends.of_2[0] - ends.of_1[touched[0]];
      if (touched.size() == 2) {
        Tensor<1, dim> edge = ends.of_1[touched[1]] - ends.of_1[touched[0]];
        edge /= edge.norm();
        away -= (away * edge) * edge;
      }
      return away.norm() > 0. ? away / away.norm() : n;
    }
  } // namespace

  template <int dim>
  Tensor<1, dim> row_normal(const SceneInput &input, const MovingRow<dim> &row,
                            const RowEnds<dim> &ends,
                            const std::vector<double> &shifts)
  {
    using Partner = typename MovingRow<dim>::Partner;
    Tensor<1, dim> n;
    switch (row.partner) {
    case Partner::pin:
      n[0] = 1.;
      return n;
    case Partner::obstacle:
      return ObstacleGeometry<dim>(input.obstacles[row.obstacle],
                                   shifts.empty() ? nullptr
                                                  : &shifts[3 * row.obstacle])
          .normal(ends.of_2[0]);
    case Partner::ball:
      n = ends.of_2[0] - ends.of_1[0];
      return n / n.norm();
    case Partner::edge:
      if constexpr (dim == 3)
        n = cross_product_3d(Tensor<1, dim>(ends.of_2[1] - ends.of_2[0]),
                             Tensor<1, dim>(ends.of_1[1] - ends.of_1[0]));
      return n / n.norm();
    case Partner::facet:
      break;
    }
    return row.node == row.nowhere ? ball_normal(row, ends)
                                   : facet_normal(row, ends);
  }

  template <int dim>
  Point<dim> row_place(const MovingRow<dim> &row, const RowEnds<dim> &ends,
                       const Tensor<1, dim> &normal)
  {
    using Partner = typename MovingRow<dim>::Partner;
    if (row.partner == Partner::edge)
      return ends.of_2[0] + row.edge_weights[1] * (ends.of_2[1] - ends.of_2[0]);
    // of a node and of a pin there is no radius
    return ends.of_2[0] - row.radius * normal;
  }

#define INSTANTIATE(dim)                                                       \
  template Tensor<1, dim> row_normal(                                          \
      const SceneInput &, const MovingRow<dim> &, const RowEnds<dim> &,        \
      const std::vector<double> &);                                            \
  template Point<dim> row_place(const MovingRow<dim> &, const RowEnds<dim> &,  \
                                const Tensor<1, dim> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
