#pragma once

#include "isotropic_hardening.h"

#include "nsfd/materials/hyperelastic.h"

namespace nsfd
{
  struct PlasticInput; // see scene/scene_input.h

  /**
   * Flow on the surface of von Mises between two elastic strains, in space
   * also for problems of the plane. Hooke's law; hardening by R(p) of the
   * surface and by X = 2/3 H_k alpha of its middle, where alpha is the sum of
   * all plastic strains (Prager); dp/dt = r ((q - yield - R) / (eta r))^n
   * where there is viscosity, q = |dev sigma - X|_eq.
   *
   * The step is that of backward Euler: the stress at the end is never outside
   * the surface, and exact on proportional paths of any length. The stress of
   * the step, sigma*, is the mean of the ends and a part along C N, the normal
   * of the surface at the end, for which
   *
   *   sigma*:d eps = d(stored energy) + plastic + viscous + numerical
   *
   * holds to round-off, plastic and viscous never negative; numerical is zero
   * for theta = 1/2, but for saturating hardening with viscosity, where it is
   * of third order. See doc/materials.md.
   */
  class J2Flow
  {
  public:
    using Strain = Voigt<3>; ///< entries of the matrix, not doubled
    using Tangent = VoigtBlock<3>;

    /** @p plane_stress: strains and stresses are those of the plane, alpha_33
        is that of constant volume. Moduli in Pa. */
    J2Flow(double young, double poisson, bool plane_stress,
           const PlasticInput &plastic);

    /** What the material keeps besides its elastic strain. */
    struct InternalVariables {
      Strain alpha{};         ///< sum of plastic strains
      double equivalent = 0.; ///< p
    };

    struct Step {
      Strain stress;           ///< sigma*
      Tangent tangent;         ///< d sigma* / d trial, if asked for
      Strain plastic_strain{}; ///< of the step; its trace vanishes
      double flow = 0.;        ///< increase of p
      /// J per volume
      double plastic = 0., viscous = 0., numerical = 0.;
      double added = 0.; ///< work of the part of sigma* along C N
    };

    /**
     * From the elastic strain @p start to @p trial, which the end would have
     * without flow. False where numbers are not finite.
     */
    bool step(const Strain &start, const Strain &trial,
              const InternalVariables &variables, double time_step,
              double theta, bool with_tangent, Step &result) const;

    Strain stress(const Strain &elastic) const;
    /** Of elastic strain and hardening, J per volume. */
    double energy(const Strain &elastic,
                  const InternalVariables &variables) const;
    /** Tangent without flow, for theta. */
    Tangent elastic_tangent(double theta) const;
    double modulus() const { return lambda_ + 2. * mu_; }
    bool plane_stress() const { return plane_stress_; }

  private:
    struct Parts;
    struct Surface;

    Parts split(const Strain &A) const;
    Strain join(const Parts &parts) const;
    Strain times_modulus(const Strain &strain) const;
    Strain middle(const Strain &alpha) const;
    double overstress(double rate) const;
    double overstress_slope(double rate) const;
    bool find_surface(const Parts &trial, double p, double time_step,
                      Surface &surface) const;
    void set_tangent(const Surface &surface, const InternalVariables &variables,
                     const Strain &change, const Strain &eta_start,
                     double theta, Step &result) const;

    double lambda_, mu_, yield_, kinematic_, viscosity_, rate_exponent_, rate_;
    IsotropicHardening hardening_;
    bool plane_stress_;
    /// of the two parts of a strain: moduli, shares of them that flow, and
    /// what a unit of flow over q takes from them
    std::array<double, 2> modulus_, share_, decay_;
  };
} // namespace nsfd
