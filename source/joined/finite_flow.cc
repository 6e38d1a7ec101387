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

    /** The largest eigenvalue of sum_i g_i g_i^T. */
    template <int dim>
    double largest_square(const std::vector<double> &gradients)
    {
      Mat3 A{};
      for (std::size_t i = 0; i < gradients.size(); i += dim)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            A[c][d] += gradients[i + c] * gradients[i + d];
      const Vec3 values = Spectrum(entries(A)).values();
      return std::max({values[0], values[1], values[2]});
    }
  } // namespace

  /** The volume before the motion and now. */
  template <int dim>
  std::array<double, 2>
  FiniteForces<dim>::set_flowing_cell(const std::size_t cell, double *f)
  {
    const Tables &here = tables(cell);
    const unsigned int n = here.n_nodes, n_q = unsigned(here.JxW.size());
    const std::size_t n_cells = stored_.size();
    const auto gradients = [&](const unsigned int q) {
      return &here.gradients[std::size_t(q) * n * dim];
    };
    double volume = 0., now = 0.;
    for (unsigned int q = 0; q < n_q; ++q) {
      const double J = jacobian<dim>(deformation(cell, gradients(q)).data());
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
      const double J = jacobian<dim>(F.data()), s = share_of<dim>(theta, J);
      const Matrix F_mean = times<dim>(s, F);
      typename CellHistories<dim>::Stress at;
      if (!histories_.set_point(
              cell, q, here.n_same,
              symmetric_product<dim>(F_mean.data(), F_mean.data()), at)) {
        inverted_ = int(cell);
        return {volume, now};
      }
      stored_[cell] += JxW * at.energy;
      taken_[cell] += JxW * at.plastic;
      taken_[n_cells + cell] += JxW * at.viscous;
      Matrix P = times<dim>(s, finite::first_piola<dim>(F_mean, at.S));
      peaks_[cell] = std::max(peaks_[cell], finite::square<dim>(P));
      const double p = finite::product<dim>(P, F) / dim;
      mean += JxW * p;
      const Matrix C = finite::cofactors<dim>(F);
      for (unsigned int k = 0; k < dim * dim; ++k)
        P[k] -= p / J * C[k];
      finite::subtract_forces<dim>(P, JxW, gradients(q), n, f);
    }
    for (unsigned int q = 0; q < n_q; ++q) {
      const Matrix C = finite::cofactors<dim>(deformation(cell, gradients(q)));
      finite::subtract_forces<dim>(C, here.JxW[q] * (mean / now), gradients(q),
                                   n, f);
    }
    return {volume, now};
  }

  /** Of small strain, of any material; deformation() is 1 + H. */
  template <int dim>
  std::array<double, 2>
  FiniteForces<dim>::set_small_cell(const std::size_t cell, double *f)
  {
    const Tables &here = tables(cell);
    const unsigned int n = here.n_nodes, n_q = unsigned(here.JxW.size());
    const std::size_t n_cells = stored_.size();
    const auto gradients = [&](const unsigned int q) {
      return &here.gradients[std::size_t(q) * n * dim];
    };
    double volume = 0., now = 0.;
    taken_[cell] = taken_[n_cells + cell] = 0.;
    for (unsigned int q = 0; q < n_q; ++q) {
      volume += here.JxW[q];
      now += here.JxW[q] *
             (1. + finite::trace<dim>(deformation(cell, gradients(q))) - dim);
    }
    dilatations_[cell] = now / volume - 1.;
    const double *mean = here.one_dilatation ? &dilatations_[cell] : nullptr;
    double tension = 0.; // sigma:1 / dim, J
    for (unsigned int q = 0; q < n_q; ++q) {
      const double JxW = here.JxW[q];
      SmallStrain<dim> at;
      if (!set_small_strain(
              discretization_, histories_, cell, q, here.n_same,
              small_gradient<dim>(deformation(cell, gradients(q)), mean), at)) {
        inverted_ = int(cell);
        break;
      }
      stored_[cell] += JxW * at.energy;
      taken_[cell] += JxW * at.plastic;
      taken_[n_cells + cell] += JxW * at.viscous;
      peaks_[cell] = std::max(peaks_[cell], finite::square<dim>(at.sigma));
      if (mean) {
        const double p = finite::trace<dim>(at.sigma) / dim;
        tension += JxW * p;
        for (unsigned int c = 0; c < dim; ++c)
          at.sigma[c * dim + c] -= p;
      }
      finite::subtract_forces<dim>(at.sigma, JxW, gradients(q), n, f);
    }
    for (unsigned int q = 0; q < n_q && mean; ++q)
      finite::subtract_forces<dim>(finite::unit<dim>(),
                                   here.JxW[q] * (tension / volume),
                                   gradients(q), n, f);
    return {volume, now};
  }

  /** P where F is, beside point @p q. */
  template <int dim>
  auto FiniteForces<dim>::flowing_stress(const std::size_t cell,
                                         const unsigned int q,
                                         const Matrix &F) const -> Matrix
  {
    const double J = jacobian<dim>(F.data());
    if (!(J > 0.))
      return {};
    const double s = share_of<dim>(dilatations_[cell], J);
    const Matrix F_mean = times<dim>(s, F);
    Voigt<dim> S;
    if (!histories_.beside(
            cell, q, symmetric_product<dim>(F_mean.data(), F_mean.data()), S))
      return {};
    return times<dim>(s, finite::first_piola<dim>(F_mean, S));
  }

  /**
   * Hencky's moduli are those of small strain in the place of now, up to the
   * stress; what changes are the gradients there, F^-T g.
   */
  template <int dim>
  double FiniteForces<dim>::flowing_stiffening(const std::size_t cell) const
  {
    const Tables &here = tables(cell);
    const unsigned int n = here.n_nodes;
    double most = 1.;
    for (std::size_t q = 0; q < here.JxW.size(); ++q) {
      const double *g = &here.gradients[q * n * dim];
      const Matrix F = deformation(cell, g), C = finite::cofactors<dim>(F);
      const double J = jacobian<dim>(F.data());
      std::vector<double> rest(g, g + n * dim), now;
      for (unsigned int i = 0; i < n; ++i)
        for (const double x : finite::multiply<dim>(C, g + i * dim))
          now.push_back(x / J);
      const double stress = std::sqrt(peaks_[cell] * finite::square<dim>(F)) /
                            histories_.of(cell)->modulus();
      most = std::max(most, largest_square<dim>(now) /
                                largest_square<dim>(rest) * (1. + 2. * stress));
    }
    return most;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::array<double, 2> FiniteForces<dim>::set_flowing_cell(          \
      std::size_t, double *);                                                  \
  template std::array<double, 2> FiniteForces<dim>::set_small_cell(            \
      std::size_t, double *);                                                  \
  template FiniteForces<dim>::Matrix FiniteForces<dim>::flowing_stress(        \
      std::size_t, unsigned int, const Matrix &) const;                        \
  template double FiniteForces<dim>::flowing_stiffening(std::size_t) const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
