#include "interface_quadrature.h"

#include "nsfd/scene/scene_input.h"

#include <deal.II/base/quadrature_lib.h>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  Quadrature<dim - 1> interface_quadrature(const DiscretizationInput &input,
                                           const bool triangle)
  {
    if constexpr (dim == 3)
      if (triangle) {
        // the reader lets 2 points per direction through: one per vertex
        if (input.interface_quadrature == "gauss lobatto")
          return Quadrature<2>(
              {Point<2>(0., 0.), Point<2>(1., 0.), Point<2>(0., 1.)},
              {1. / 6., 1. / 6., 1. / 6.});
        // deal.II 9.4.1 has no rule of degree 2 that looks the same from
        // both sides of a face
        if (input.interface_points == 2)
          return Quadrature<2>({Point<2>(1. / 6., 1. / 6.),
                                Point<2>(2. / 3., 1. / 6.),
                                Point<2>(1. / 6., 2. / 3.)},
                               {1. / 6., 1. / 6., 1. / 6.});
        return QGaussSimplex<2>(input.interface_points);
      }
    (void)triangle;
    if (input.interface_quadrature == "gauss lobatto")
      return Quadrature<dim - 1>(QGaussLobatto<1>(input.interface_points));
    if (input.interface_quadrature == "quarter points")
      return Quadrature<dim - 1>(
          Quadrature<1>({Point<1>(0.25), Point<1>(0.75)}, {0.5, 0.5}));
    return QGauss<dim - 1>(input.interface_points);
  }

  template Quadrature<1> interface_quadrature<2>(const DiscretizationInput &,
                                                 bool);
  template Quadrature<2> interface_quadrature<3>(const DiscretizationInput &,
                                                 bool);
} // namespace nsfd
