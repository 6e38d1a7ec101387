#pragma once

#include "nsfd/materials/hyperelastic.h"

#include <memory>

namespace nsfd
{
  struct PlasticInput; // see scene/scene_input.h

  /**
   * A material whose stress depends on how it was strained. C stands for F^T F
   * in finite strain, where S is the second Piola-Kirchhoff stress, and for
   * 2 eps in small strain, where S is that stress: S:dC / 2 is work per volume
   * in both. In the plane C33 is what no strain is, 1 or 0.
   */
  template <int dim>
  class HistoryMaterial
  {
  public:
    virtual ~HistoryMaterial() = default;

    /** Internal variables of a point, their number. */
    virtual unsigned int n_history() const = 0;
    /** Of a point that has never been strained. */
    virtual void begin(double *history) const = 0;

    /** A step at a point. */
    struct Way {
      Voigt<dim> C0, C1;
      const double *history = nullptr; ///< at C0
      double time_step = 0., theta = 0.5;
    };
    struct Step {
      Voigt<dim> S;
      VoigtBlock<dim> tangent; ///< dS/dC1, if asked for
      /// what S:(C1 - C0) / 2 is more than the change of energy, J per volume
      double plastic = 0., viscous = 0., numerical = 0.;
      /// of that work, what the mean of the stresses at both ends does not do:
      /// with them alone a step takes as much less, theta = 1/2
      double added = 0.;
    };

    /** Stored, J per volume; infinite where det C <= 0. */
    virtual double energy(const Voigt<dim> &C, const double *history) const = 0;

    /** What is kept at C1 goes to @p history, unless it is null. False
        where det C <= 0 or numbers are not finite. */
    virtual bool step(const Way &way, bool with_tangent, Step &result,
                      double *history) const = 0;

    /** @p S is the stress of @p C itself, twice the derivative of the
        @p energy at this history; false as there. */
    virtual bool state(const Voigt<dim> &C, const double *history,
                       Voigt<dim> &S, double &energy) const = 0;

    /** dS/dC1 of a step at rest. */
    virtual VoigtBlock<dim> tangent_at_rest(double theta) const = 0;

    /** Cauchy's, xx, yy, zz, xy, xz, yz in Pa, from a displacement gradient
        [component][direction]; zeros where there is none. */
    virtual std::array<double, 6> stress(const double *gradient,
                                         const double *history) const = 0;
    /** Sum of all flow, in the measure of von Mises. */
    virtual double equivalent_strain(const double *history) const = 0;

    /** lambda + 2 mu of small strain, Pa. */
    virtual double modulus() const = 0;
  };

  /**
   * Flow on the surface of von Mises (J2Flow), of small strain: a point
   * keeps its plastic strain and its p, 7 numbers.
   *
   * Of finite strain: multiplicative, F = F_e F_p, with Hencky's law between
   * E = ln(F_e^T F_e) / 2 and its stress. From the F_p of the start a step is
   * one of small strain in E; then F_e^T F_e = exp(2 E), and F_p changes
   * without spin: exp(dp N) where strains are coaxial. Its determinant stays
   * 1. A point keeps F_p^{-1}, alpha and p, 16 numbers. Not in plane
   * stress: throws invalid_argument.
   */
  template <int dim>
  std::unique_ptr<const HistoryMaterial<dim>>
  make_history_material(double young, double poisson,
                        const PlasticInput &plastic, bool finite,
                        bool plane_stress);
} // namespace nsfd
