#pragma once

#include "point_law.h"

namespace nsfd
{
  /**
   * The cohesive law of a point during one step: what its history, the jump at
   * the start and the rule of the cohesive force make of a jump at the end.
   * Lengths in m, secants in Pa/m, energies in J/m^2.
   *
   * The `exact` rule takes from the motion what is stored and dissipated along
   * a way between both jumps. One scalar: the squares of opening and slip go
   * straight, and with a potential the way does not matter. On a plateau the
   * stored energy is T(d_m) d instead of b d^2/2. Two scalars: the mean of the
   * two ways that go along one opening after the other.
   */
  template <int dim>
  class PointDamage
  {
  public:
    PointDamage(const OneStepProblem<dim> &problem, std::size_t point);

    /** How far the jump @p u is open. */
    Reach reach(const double *u) const;

    /** The largest reach before the step. */
    const Reach &history() const { return history_; }

    /** The same after a step that ends at @p end. */
    Reach history_after(const Reach &end) const;

    /**
     * A step that ends at @p end damages the point; also where the end is not a
     * number, as against the infinite secant of an extrinsic law at 0.
     */
    bool grows(const Reach &end) const
    {
      return !(end.opening <= history_.opening && end.slip <= history_.slip);
    }

    /** The traction does not fall to zero with the opening: form (5). */
    bool plateau() const { return interaction_.plateau; }

    /** The secants of the rule for a step that ends at @p end. */
    Secant secant(const Reach &end) const;

    /** R_max of a point that was never open, T(d_m) on a plateau. */
    double strength() const;

    double beta(const Reach &history) const;

    /** Openings at the elastic limit, the peak and the end of the law. */
    std::array<double, 3> kinks() const
    {
      return {{law_.elastic_limit() / l_, law_.peak_opening() / l_,
               law_.final_opening() / l_}};
    }

    /** The traction drops to 0 at the end. */
    bool drops() const
    {
      return std::isinf(law_.steepest_softening()) &&
             law_.traction(law_.final_opening() * (1. - 1e-9)) >
                 1e-3 * law_.strength();
    }

    /** Elastic energy of cohesion at the jump @p u, no overlap. */
    double stored(const Reach &history, const double *u) const;

    struct Dissipation {
      double damage = 0., viscous = 0.;
    };
    /** Of a step to the jump @p u. */
    Dissipation dissipation(const double *u) const;

  private:
    const OneStepProblem<dim> &problem_;
    const Interaction &interaction_;
    const CohesiveLaw &law_;
    const MixedLaw *mixed_;
    std::size_t point_;
    double a_, l_; // T(d) = a T_0(l d)
    Reach history_;
    const double *old_;

    struct Growth {
      double opening;  ///< d where damage begins to grow
      double from, to; ///< d_m before and after
    };
    Growth growth(double opening) const;

    Secant isotropic(const double b) const
    {
      return {b, b * interaction_.stiffness_ratio};
    }
    double secant_at(const double opening) const
    {
      return a_ * l_ * law_.secant(l_ * opening);
    }
    double released(double from, double to) const;
    Secant secants_at(const Reach &history) const;
    double scalar_secant(double opening) const;
    double lost_energy(const double *u, double damage) const;
    double plateau_secant(double opening) const;
    Secant mixed_secant(const Reach &end) const;
    double mixed_dissipation(const Reach &start, const Reach &end) const;
  };
} // namespace nsfd
