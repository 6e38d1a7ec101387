#include "nsfd/materials/hyperelastic.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    template <int dim>
    constexpr unsigned int n_entries = dim *(dim + 1) / 2;

    template <int dim>
    Voigt<dim> identity()
    {
      Voigt<dim> I{};
      for (unsigned int c = 0; c < dim; ++c)
        I[c] = 1.;
      return I;
    }

    template <int dim>
    double trace(const Voigt<dim> &A)
    {
      double sum = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        sum += A[c];
      return sum;
    }

    template <int dim>
    Voigt<dim> combine(const double a, const Voigt<dim> &A, const double b,
                       const Voigt<dim> &B)
    {
      Voigt<dim> sum;
      for (unsigned int i = 0; i < n_entries<dim>; ++i)
        sum[i] = a * A[i] + b * B[i];
      return sum;
    }

    /** block += s A B^T. */
    template <int dim>
    void add_dyad(const double s, const Voigt<dim> &A, const Voigt<dim> &B,
                  VoigtBlock<dim> &block)
    {
      for (unsigned int i = 0; i < n_entries<dim>; ++i)
        for (unsigned int j = 0; j < n_entries<dim>; ++j)
          block[i * n_entries<dim> + j] += s * A[i] * B[j];
    }

    /** block += s 1, where 1:A = A for every symmetric A. */
    template <int dim>
    void add_identity(const double s, VoigtBlock<dim> &block)
    {
      for (unsigned int i = 0; i < n_entries<dim>; ++i)
        block[i * n_entries<dim> + i] += s / voigt_weight<dim>(i);
    }

    /** d det A / dA. */
    Voigt<2> cofactor(const Voigt<2> &A) { return {A[1], A[0], -A[2]}; }

    Voigt<3> cofactor(const Voigt<3> &A)
    {
      return {A[1] * A[2] - A[5] * A[5], A[0] * A[2] - A[4] * A[4],
              A[0] * A[1] - A[3] * A[3], A[4] * A[5] - A[3] * A[2],
              A[3] * A[5] - A[4] * A[1], A[3] * A[4] - A[0] * A[5]};
    }

    /** block += s d cofactor(A) / dA; linear in A in space. */
    void add_cofactor_slope(const double s, const Voigt<2> &,
                            VoigtBlock<2> &block)
    {
      block[0 * 3 + 1] += s;
      block[1 * 3 + 0] += s;
      block[2 * 3 + 2] -= s / 2.;
    }

    void add_cofactor_slope(const double s, const Voigt<3> &A,
                            VoigtBlock<3> &block)
    {
      const auto add = [&](const unsigned int i, const unsigned int j,
                           const double value) {
        block[i * 6 + j] += s * value;
        if (i != j)
          block[j * 6 + i] += s * value;
      };
      add(0, 1, A[2]);
      add(0, 2, A[1]);
      add(1, 2, A[0]);
      add(0, 5, -A[5]);
      add(1, 4, -A[4]);
      add(2, 3, -A[3]);
      add(3, 3, -A[2] / 2.);
      add(4, 4, -A[1] / 2.);
      add(5, 5, -A[0] / 2.);
      add(3, 4, A[5] / 2.);
      add(3, 5, A[4] / 2.);
      add(4, 5, A[3] / 2.);
    }

    /** D with det C1 - det C0 = D:(C1 - C0): the mean of cofactors between. */
    Voigt<2> mean_cofactor(const Voigt<2> &C0, const Voigt<2> &C1)
    {
      return cofactor(combine<2>(0.5, C0, 0.5, C1));
    }

    // of cofactors that are quadratic on the way, by Simpson's rule
    Voigt<3> mean_cofactor(const Voigt<3> &C0, const Voigt<3> &C1)
    {
      const Voigt<3> ends =
          combine<3>(1. / 6., cofactor(C0), 1. / 6., cofactor(C1));
      return combine<3>(1., ends, 4. / 6.,
                        cofactor(combine<3>(0.5, C0, 0.5, C1)));
    }

    /** block += s dD/dC1. */
    void add_mean_cofactor_slope(const double s, const Voigt<2> &C0,
                                 const Voigt<2> &, VoigtBlock<2> &block)
    {
      add_cofactor_slope(s / 2., C0, block);
    }

    // of the middle, half of which is C1, four times and of C1 once
    void add_mean_cofactor_slope(const double s, const Voigt<3> &C0,
                                 const Voigt<3> &C1, VoigtBlock<3> &block)
    {
      add_cofactor_slope(s, combine<3>(1. / 6., C0, 1. / 3., C1), block);
    }

    /** The principal minors of second order, summed. */
    double second_invariant(const Voigt<2> &A) { return determinant(A); }

    double second_invariant(const Voigt<3> &A) { return trace<3>(cofactor(A)); }

    /** Where atanh is summed as its series, to round-off. */
    constexpr double small_atanh = 0.1;
    constexpr unsigned int n_terms = 9;

    /** atanh(z) / z - 1 for small z. */
    double atanh_series(const double z)
    {
      double sum = 0.;
      for (unsigned int k = n_terms; k >= 1; --k)
        sum = (sum + 1. / (2. * k + 1.)) * z * z;
      return sum;
    }

    /** y - log(1 + y), also for small y: log(1 + y) = 2 atanh(z). */
    double log_defect(const double y)
    {
      const double z = y / (2. + y); // y - 2 z = y z
      return std::abs(z) > small_atanh ? y - std::log1p(y)
                                       : y * z - 2. * z * atanh_series(z);
    }

    /** atanh(z) / z and its derivative. */
    struct AtanhSecant {
      double value, slope;
    };

    AtanhSecant atanh_secant(const double z)
    {
      if (std::abs(z) > small_atanh) {
        const double value = std::atanh(z) / z;
        return {value, (1. / (1. - z * z) - value) / z};
      }
      double slope = 0.;
      for (unsigned int k = n_terms; k >= 1; --k)
        slope = slope * z * z + 2. * k / (2. * k + 1.);
      return {1. + atanh_series(z), slope * z};
    }

    template <int dim>
    class SaintVenantKirchhoff : public Hyperelastic<dim>
    {
    public:
      SaintVenantKirchhoff(const double lambda, const double mu)
          : lambda_(lambda), mu_(mu)
      {
      }

      double energy(const Voigt<dim> &C) const override
      {
        if (!(determinant(C) > 0.))
          return std::numeric_limits<double>::infinity();
        const Voigt<dim> E = strain(C);
        const double tr = trace<dim>(E);
        return lambda_ / 2. * tr * tr + mu_ * contract<dim>(E, E);
      }

      bool stress(const Voigt<dim> &C, Voigt<dim> &S,
                  VoigtBlock<dim> *tangent) const override
      {
        if (!(determinant(C) > 0.))
          return false;
        S = of_strain(strain(C));
        if (tangent)
          set_tangent(1., *tangent);
        return true;
      }

      bool average_stress(const Voigt<dim> &C0, const Voigt<dim> &C1,
                          Voigt<dim> &S,
                          VoigtBlock<dim> *tangent) const override
      {
        if (!(determinant(C0) > 0. && determinant(C1) > 0.))
          return false;
        S = of_strain(combine<dim>(0.5, strain(C0), 0.5, strain(C1)));
        if (tangent)
          set_tangent(0.5, *tangent);
        return true;
      }

      double modulus() const override { return lambda_ + 2. * mu_; }

    private:
      static Voigt<dim> strain(const Voigt<dim> &C)
      {
        return combine<dim>(0.5, C, -0.5, identity<dim>());
      }

      Voigt<dim> of_strain(const Voigt<dim> &E) const
      {
        return combine<dim>(lambda_ * trace<dim>(E), identity<dim>(), 2. * mu_,
                            E);
      }

      void set_tangent(const double share, VoigtBlock<dim> &tangent) const
      {
        tangent.fill(0.);
        add_dyad<dim>(share * lambda_ / 2., identity<dim>(), identity<dim>(),
                      tangent);
        add_identity<dim>(share * mu_, tangent);
      }

      double lambda_, mu_;
    };

    /**
     * W = mu/2 (tr C - dim) + g(det C), g(d) = -mu/2 ln d + lambda/8 (ln d)^2.
     */
    template <int dim>
    class NeoHooke : public Hyperelastic<dim>
    {
    public:
      NeoHooke(const double lambda, const double mu) : lambda_(lambda), mu_(mu)
      {
      }

      // With X = C - 1 the first term is mu/2 (y - ln(1 + y)) plus
      // mu/2 (tr X - y), where y = det C - 1: nothing cancels at small strain.
      double energy(const Voigt<dim> &C) const override
      {
        if (!(determinant(C) > 0.))
          return std::numeric_limits<double>::infinity();
        const Voigt<dim> X = combine<dim>(1., C, -1., identity<dim>());
        double excess = second_invariant(X);
        if (dim == 3)
          excess += determinant(X);
        const double y = trace<dim>(X) + excess, log_det = std::log1p(y);
        return mu_ / 2. * (log_defect(y) - excess) +
               lambda_ / 8. * log_det * log_det;
      }

      bool stress(const Voigt<dim> &C, Voigt<dim> &S,
                  VoigtBlock<dim> *tangent) const override
      {
        const double d = determinant(C);
        if (!(d > 0.))
          return false;
        const Voigt<dim> cof = cofactor(C);
        const double log_slope = -mu_ / 2. + lambda_ / 4. * std::log(d);
        S = combine<dim>(mu_, identity<dim>(), 2. * log_slope / d, cof);
        if (tangent) {
          tangent->fill(0.);
          add_dyad<dim>(2. * (lambda_ / 4. - log_slope) / (d * d), cof, cof,
                        *tangent);
          add_cofactor_slope(2. * log_slope / d, C, *tangent);
        }
        return true;
      }

      // mu 1 + 2 k D with the secant slopes k of g and D of det. That of ln,
      // s = (ln d1 - ln d0) / (d1 - d0), is the one of atanh at
      // z = (d1 - d0) / (d1 + d0) over the mean of d0 and d1.
      bool average_stress(const Voigt<dim> &C0, const Voigt<dim> &C1,
                          Voigt<dim> &S,
                          VoigtBlock<dim> *tangent) const override
      {
        const double d0 = determinant(C0), d1 = determinant(C1);
        if (!(d0 > 0. && d1 > 0.))
          return false;
        const Voigt<dim> D = mean_cofactor(C0, C1);
        const double mean = (d0 + d1) / 2.;
        const AtanhSecant f = atanh_secant((d1 - d0) / (d0 + d1));
        const double s = f.value / mean;
        const double weight =
            -mu_ / 2. + lambda_ / 8. * (std::log(d0) + std::log(d1));
        S = combine<dim>(mu_, identity<dim>(), 2. * s * weight, D);
        if (tangent) {
          const double s_slope =
              (f.slope * d0 / mean - f.value) / (2. * mean * mean);
          const double slope = s_slope * weight + s * lambda_ / (8. * d1);
          tangent->fill(0.);
          add_dyad<dim>(2. * slope, D, cofactor(C1), *tangent);
          add_mean_cofactor_slope(2. * s * weight, C0, C1, *tangent);
        }
        return true;
      }

      double modulus() const override { return lambda_ + 2. * mu_; }

    private:
      double lambda_, mu_;
    };
  } // namespace

  template <int dim>
  double contract(const Voigt<dim> &A, const Voigt<dim> &B)
  {
    double sum = 0.;
    for (unsigned int i = 0; i < n_entries<dim>; ++i)
      sum += voigt_weight<dim>(i) * A[i] * B[i];
    return sum;
  }

  double determinant(const Voigt<2> &A) { return A[0] * A[1] - A[2] * A[2]; }

  double determinant(const Voigt<3> &A)
  {
    return A[0] * (A[1] * A[2] - A[5] * A[5]) -
           A[3] * (A[3] * A[2] - A[4] * A[5]) +
           A[4] * (A[3] * A[5] - A[1] * A[4]);
  }

  template <int dim>
  bool step_stress(const Hyperelastic<dim> &material, const Voigt<dim> &C0,
                   const Voigt<dim> &C1, const double theta,
                   const bool with_tangent, StepStress<dim> &result)
  {
    result.dissipated = 0.;
    if (!material.average_stress(C0, C1, result.S,
                                 with_tangent ? &result.tangent : nullptr))
      return false;
    const double share = theta - 0.5;
    if (share == 0.)
      return true;
    Voigt<dim> S0, S1;
    VoigtBlock<dim> tangent;
    if (!material.stress(C0, S0) ||
        !material.stress(C1, S1, with_tangent ? &tangent : nullptr))
      return false;
    const Voigt<dim> change = combine<dim>(share, S1, -share, S0);
    result.S = combine<dim>(1., result.S, 1., change);
    result.dissipated = contract<dim>(change, combine<dim>(0.5, C1, -0.5, C0));
    if (with_tangent)
      for (unsigned int i = 0; i < tangent.size(); ++i)
        result.tangent[i] += share * tangent[i];
    return true;
  }

  template <int dim>
  std::unique_ptr<const Hyperelastic<dim>>
  make_saint_venant_kirchhoff(const double young, const double poisson,
                              const bool plane_stress)
  {
    const double mu = young / (2. * (1. + poisson));
    if (!plane_stress)
      return std::make_unique<SaintVenantKirchhoff<dim>>(
          2. * mu * poisson / (1. - 2. * poisson), mu);
    if (dim != 2)
      throw std::invalid_argument("plane stress is for the plane");
    // 2 lambda mu / (lambda + 2 mu), also where lambda is infinite
    return std::make_unique<SaintVenantKirchhoff<dim>>(
        2. * mu * poisson / (1. - poisson), mu);
  }

  template <int dim>
  std::unique_ptr<const Hyperelastic<dim>> make_neo_hooke(const double young,
                                                          const double poisson)
  {
    const double mu = young / (2. * (1. + poisson));
    return std::make_unique<NeoHooke<dim>>(
        2. * mu * poisson / (1. - 2. * poisson), mu);
  }

#define INSTANTIATE(dim)                                                       \
  template double contract<dim>(const Voigt<dim> &, const Voigt<dim> &);       \
  template bool step_stress<dim>(const Hyperelastic<dim> &,                    \
                                 const Voigt<dim> &, const Voigt<dim> &,       \
                                 double, bool, StepStress<dim> &);             \
  template std::unique_ptr<const Hyperelastic<dim>>                            \
  make_saint_venant_kirchhoff<dim>(double, double, bool);                      \
  template std::unique_ptr<const Hyperelastic<dim>> make_neo_hooke<dim>(       \
      double, double)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
