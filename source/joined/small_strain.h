#pragma once

#include "cell_histories.h"
#include "finite_algebra.h"

namespace nsfd
{
  /** What small strain does at a point of the quadrature of a cell. */
  template <int sdim>
  struct SmallStrain {
    finite::Matrix<sdim> sigma{};      ///< Pa
    double energy = 0.;                ///< J per volume
    double plastic = 0., viscous = 0.; ///< of the step, J per volume
  };

  /** H of F = 1 + H; with @p dilatation in place of its own, if that is given:
      H + (dilatation - tr H)/dim 1. */
  template <int dim>
  finite::Matrix<dim> small_gradient(finite::Matrix<dim> F,
                                     const double *dilatation)
  {
    for (unsigned int c = 0; c < dim; ++c)
      F[c * dim + c] -= 1.;
    const double more =
        dilatation ? (*dilatation - finite::trace<dim>(F)) / dim : 0.;
    for (unsigned int c = 0; c < dim && dilatation; ++c)
      F[c * dim + c] += more;
    return F;
  }

  /**
   * Of point @p q at the gradient @p H of the displacement, [component]
   * [direction], of a ring with its strain along the hoops: by what the point
   * keeps, which moves on, or by Hooke's law.
   * @p n_same points behind it keep the same. False where numbers are not
   * finite.
   */
  template <int dim, int sdim>
  bool set_small_strain(const Discretization<dim> &discretization,
                        CellHistories<dim, sdim> &histories, std::size_t cell,
                        unsigned int q, unsigned int n_same,
                        const finite::Matrix<sdim> &H,
                        SmallStrain<sdim> &result);

  /** The stress at slot @p slot of the cell, next to point @p q. */
  template <int dim, int sdim>
  finite::Matrix<sdim>
  small_stress_beside(const Discretization<dim> &discretization,
                      const CellHistories<dim, sdim> &histories,
                      std::size_t cell, unsigned int q, unsigned int slot,
                      const finite::Matrix<sdim> &H);
} // namespace nsfd
