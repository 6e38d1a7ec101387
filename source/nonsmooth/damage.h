#pragma once

#include "nsfd/cohesive_laws/law_point.h"
#include "point_law.h"

namespace nsfd
{
  /** The law of an interaction at a point of these factors of strength and
      opening. */
  LawPoint law_at(const Interaction &interaction, double strength,
                  double opening);

  /**
   * The cohesive law of a point during one step: what its history, the jump at
   * the start and the rule of the cohesive force make of a jump at the end.
   * Lengths in m, secants in Pa/m, energies in J/m^2. The `exact` rule takes
   * from the motion what LawPoint stores and dissipates.
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
    bool grows(const Reach &end) const { return nsfd::grows(history_, end); }

    /** The traction does not fall to zero with the opening: form (5). */
    bool plateau() const { return interaction_.plateau; }

    /** CohesiveLaw::adds_openings(): no secants, see mean_traction(). */
    bool adds() const { return interaction_.law->adds_openings(); }

    /** Of added openings, for a step that ends at @p end; in Pa. */
    double mean_traction(const Reach &end) const;

    /** r of the slip in the opening. */
    double slip_weight() const { return std::sqrt(interaction_.shear_weight); }

    /** The jump at the start of the way that the rule sees; dim numbers. */
    const double *start() const { return old_; }

    /** The secants of the rule for a step that ends at @p end. */
    Secant secant(const Reach &end) const;

    /** R_max of a point that was never open, T(d_m) on a plateau. */
    double strength() const { return law_.strength(history_); }

    /** What is compared with it: LawPoint::effective_traction(), with the
        friction that holds what is intact. */
    double effective_traction(const double normal, const double *shear) const
    {
      return law_.effective_traction<dim>(
          normal, shear, interaction_.friction_exponent == 0. ? friction_ : 0.);
    }

    double beta(const Reach &history) const { return law_.beta(history); }

    /** Openings at the elastic limit, the peak and the end of the law. */
    std::array<double, 3> kinks() const
    {
      const CohesiveLaw &law = law_.law();
      const double l = law_.opening_factor();
      return {{law.elastic_limit() / l, law.peak_opening() / l,
               law.final_opening() / l}};
    }

    double final_opening() const { return kinks().back(); }

    /** The traction drops to 0 at the end. */
    bool drops() const
    {
      const CohesiveLaw &law = law_.law();
      return std::isinf(law.steepest_softening()) &&
             law.traction(law.final_opening() * (1. - 1e-9)) >
                 1e-3 * law.strength();
    }

    /** Elastic energy of cohesion at the jump @p u, no overlap. */
    double stored(const Reach &history, const double *u) const
    {
      return law_.stored({JumpSize::of<dim>(u), history});
    }

    /** Of a step to the jump @p u. */
    Dissipation dissipation(const double *u) const;

  private:
    const Interaction &interaction_;
    double friction_;
    LawPoint law_;
    Reach history_;
    const double *old_;
    CohesionRule rule_;
    double time_step_;
  };
} // namespace nsfd
