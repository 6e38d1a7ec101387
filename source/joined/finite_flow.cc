#include "finite_algebra.h"
#include "finite_forces.h"
#include "small_strain.h"

#include "discretization/cells.h"
#include "materials/matrix_log.h"
#include "materials/strain.h"

#include <algorithm>
#include <cmath>

// Forces of cells whose materials have a history, and of those beside them in
// small motions.

namespace nsfd
{
  namespace
  {
    /** (theta/J)^(1/dim): what F is multiplied with. */
    template <int dim>
    double share_of(const double theta, const double J)
    {
      return dim == 2 ? std::sqrt(theta / J) : std::cbrt(theta / J);
    }

    template <int dim>
    std::array<double, dim * dim> times(const double s,
                                        std::array<double, dim * dim> A)
    {
      for (double &a : A)
        a *= s;
      return A;
    }

    /** The largest eigenvalue of sum_i g_i g_i^T, and of rings what the hoops
        add beside it. */
    template <int dim, int sdim>
    std::array<double, 2> largest_squares(const std::vector<double> &gradients)
    {
      Mat3 A{};
      double hoops = 0.;
      for (std::size_t i = 0; i < gradients.size(); i += sdim) {
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            A[c][d] += gradients[i + c] * gradients[i + d];
        if (sdim > dim)
          hoops += gradients[i + sdim - 1] * gradients[i + sdim - 1];
      }
      const Vec3 values = Spectrum(entries(A)).values();
      return {{std::max({values[0], values[1], values[2]}), hoops}};
    }
  } // namespace

  /** The volume before the motion and now. */
  template <int dim, int sdim>
  std::array<double, 2>
  FiniteForces<dim, sdim>::set_flowing_cell(const std::size_t cell, double *f)
  {
    const FiniteTables &here = tables(cell);
    const unsigned int n = here.n_nodes, n_q = unsigned(here.JxW.size());
    const std::size_t n_cells = stored_.size();
    const auto gradients = [&](const unsigned int q) {
      return &here.gradients[std::size_t(q) * n * sdim];
    };
    double volume = 0., now = 0.;
    for (unsigned int q = 0; q < n_q; ++q) {
      const double J = jacobian<sdim>(deformation(cell, gradients(q)).data());
      if (!(J > 0.)) {
        inverted_ = int(cell);
        return {volume, now};
      }
      volume += here.JxW[q];
      now += here.JxW[q] * J;
    }
    const double theta = dilatations_[cell] = now / volume;
    taken_[cell] = taken_[n_cells + cell] = 0.;
    double mean = 0.; // of P:F / dim, J
    for (unsigned int q = 0; q < n_q; ++q) {
      const double JxW = here.JxW[q];
      const Matrix F = deformation(cell, gradients(q));
      const double J = jacobian<sdim>(F.data()), s = share_of<sdim>(theta, J);
      const Matrix F_mean = times<sdim>(s, F);
      typename CellHistories<dim, sdim>::Stress at;
      if (!histories_.set_point(
              cell, q, here.n_same,
              symmetric_product<sdim>(F_mean.data(), F_mean.data()), at)) {
        inverted_ = int(cell);
        return {volume, now};
      }
      stored_[cell] += JxW * at.energy;
      taken_[cell] += JxW * at.plastic;
      taken_[n_cells + cell] += JxW * at.viscous;
      Matrix P = times<sdim>(s, finite::first_piola<sdim>(F_mean, at.S));
      peaks_[cell] = std::max(peaks_[cell], finite::square<sdim>(P));
      const double p = finite::product<sdim>(P, F) / sdim;
      mean += JxW * p;
      const Matrix C = finite::cofactors<sdim>(F);
      for (unsigned int k = 0; k < sdim * sdim; ++k)
        P[k] -= p / J * C[k];
      finite::subtract_forces<dim, sdim>(P, JxW, gradients(q), n, f);
    }
    for (unsigned int q = 0; q < n_q; ++q) {
      const Matrix C = finite::cofactors<sdim>(deformation(cell, gradients(q)));
      finite::subtract_forces<dim, sdim>(C, here.JxW[q] * (mean / now),
                                         gradients(q), n, f);
    }
    return {volume, now};
  }

  /** Of small strain, of any material; deformation() is 1 + H. */
  template <int dim, int sdim>
  std::array<double, 2>
  FiniteForces<dim, sdim>::set_small_cell(const std::size_t cell, double *f)
  {
    const FiniteTables &here = tables(cell);
    const unsigned int n = here.n_nodes, n_q = unsigned(here.JxW.size());
    const std::size_t n_cells = stored_.size();
    const auto gradients = [&](const unsigned int q) {
      return &here.gradients[std::size_t(q) * n * sdim];
    };
    double volume = 0., now = 0.;
    taken_[cell] = taken_[n_cells + cell] = 0.;
    for (unsigned int q = 0; q < n_q; ++q) {
      volume += here.JxW[q];
      now += here.JxW[q] *
             (1. + finite::trace<sdim>(deformation(cell, gradients(q))) - sdim);
    }
    dilatations_[cell] = now / volume - 1.;
    const double *mean = here.one_dilatation ? &dilatations_[cell] : nullptr;
    double tension = 0.; // sigma:1 / sdim, J
    for (unsigned int q = 0; q < n_q; ++q) {
      const double JxW = here.JxW[q];
      SmallStrain<sdim> at;
      if (!set_small_strain(
              discretization_, histories_, cell, q, here.n_same,
              small_gradient<sdim>(deformation(cell, gradients(q)), mean),
              at)) {
        inverted_ = int(cell);
        break;
      }
      stored_[cell] += JxW * at.energy;
      taken_[cell] += JxW * at.plastic;
      taken_[n_cells + cell] += JxW * at.viscous;
      peaks_[cell] = std::max(peaks_[cell], finite::square<sdim>(at.sigma));
      if (mean) {
        const double p = finite::trace<sdim>(at.sigma) / sdim;
        tension += JxW * p;
        for (unsigned int c = 0; c < sdim; ++c)
          at.sigma[c * sdim + c] -= p;
      }
      finite::subtract_forces<dim, sdim>(at.sigma, JxW, gradients(q), n, f);
    }
    for (unsigned int q = 0; q < n_q && mean; ++q)
      finite::subtract_forces<dim, sdim>(finite::unit<sdim>(),
                                         here.JxW[q] * (tension / volume),
                                         gradients(q), n, f);
    return {volume, now};
  }

  /** P where F is, beside point @p q. */
  template <int dim, int sdim>
  auto FiniteForces<dim, sdim>::flowing_stress(const std::size_t cell,
                                               const unsigned int q,
                                               const Matrix &F) const -> Matrix
  {
    const double J = jacobian<sdim>(F.data());
    if (!(J > 0.))
      return {};
    const double s = share_of<sdim>(dilatations_[cell], J);
    const Matrix F_mean = times<sdim>(s, F);
    Voigt<sdim> S;
    if (!histories_.beside(
            cell, q, symmetric_product<sdim>(F_mean.data(), F_mean.data()), S))
      return {};
    return times<sdim>(s, finite::first_piola<sdim>(F_mean, S));
  }

  /**
   * Hencky's moduli are those of small strain in the place of now, up to the
   * stress; what changes are the gradients there, F^-T g.
   */
  template <int dim, int sdim>
  double
  FiniteForces<dim, sdim>::flowing_stiffening(const std::size_t cell) const
  {
    const FiniteTables &here = tables(cell);
    const unsigned int n = here.n_nodes;
    double most = 1.;
    for (std::size_t q = 0; q < here.JxW.size(); ++q) {
      const double *g = &here.gradients[q * n * sdim];
      const Matrix F = deformation(cell, g), C = finite::cofactors<sdim>(F);
      const double J = jacobian<sdim>(F.data());
      std::vector<double> rest(g, g + n * sdim), now;
      for (unsigned int i = 0; i < n; ++i)
        for (const double x : finite::multiply<sdim>(C, g + i * sdim))
          now.push_back(x / J);
      const double stress = std::sqrt(peaks_[cell] * finite::square<sdim>(F)) /
                            histories_.of(cell)->modulus();
      const auto squares = largest_squares<dim, sdim>(now),
                 at_rest = largest_squares<dim, sdim>(rest);
      double ratio = squares[0] / at_rest[0];
      if (at_rest[1] > 0.)
        ratio = std::max(ratio, squares[1] / at_rest[1]);
      most = std::max(most, ratio * (1. + 2. * stress));
    }
    return most;
  }

#define NSFD_INSTANTIATE(dim, sdim)                                            \
  template std::array<double, 2> FiniteForces<dim, sdim>::set_flowing_cell(    \
      std::size_t, double *);                                                  \
  template std::array<double, 2> FiniteForces<dim, sdim>::set_small_cell(      \
      std::size_t, double *);                                                  \
  template FiniteForces<dim, sdim>::Matrix                                     \
  FiniteForces<dim, sdim>::flowing_stress(std::size_t, unsigned int,           \
                                          const Matrix &) const;               \
  template double FiniteForces<dim, sdim>::flowing_stiffening(std::size_t) const
  NSFD_INSTANTIATE(2, 2);
  NSFD_INSTANTIATE(2, 3);
  NSFD_INSTANTIATE(3, 3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
