#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  /**
   * How far a point is open, in m: its effective opening, or, for laws with
   * two damage scalars, <u_N>_+ and |u_T|.
   */
  struct Reach {
    double opening = 0., slip = 0.;
  };

  /** R_coh = normal <u_N>_+ n + tangential u_T, in Pa/m. */
  struct Secant {
    double normal = 0., tangential = 0.;

    static constexpr Secant rigid()
    {
      return {std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()};
    }
  };

  /** A jump as a cohesive law sees it: compression is left to contact. */
  struct JumpSize {
    double opening = 0.;     ///< <u_N>_+, m
    double slip_square = 0.; ///< |u_T|^2, m^2

    /** Of the @p dim components of @p jump, u_N first. */
    template <int dim>
    static JumpSize of(const double *jump)
    {
      JumpSize size;
      size.opening = jump[0] > 0. ? jump[0] : 0.;
      for (unsigned int c = 1; c < dim; ++c)
        size.slip_square += jump[c] * jump[c];
      return size;
    }
  };

  /** A point of a law at one time; the default is a point never loaded. */
  struct LawState {
    JumpSize jump;
    Reach history; ///< the largest reach so far
  };

  /** Energy per area that does not come back, in J/m^2. */
  struct Dissipation {
    double damage = 0.;
    double viscous = 0.; ///< because damage takes time

    double total() const { return damage + viscous; }
  };

  /**
   * One damage scalar has a potential where C_T / C_N is r^2, equal up to the
   * round-off of reading the two from the input.
   */
  inline bool has_potential(const double stiffness_ratio,
                            const double shear_weight)
  {
    return std::abs(stiffness_ratio - shear_weight) <= 1e-12 * shear_weight;
  }

  /** A step from the history @p history that ends at @p end damages. */
  inline bool grows(const Reach &history, const Reach &end)
  {
    return !(end.opening <= history.opening && end.slip <= history.slip);
  }

  /**
   * A cohesive law at a point: with its factors of strength and opening, the
   * potential and the dissipation at two states, and the strength for a
   * traction. All functions are pure; none throws. Lengths in m, tractions in
   * Pa, energies in J/m^2, times in s.
   *
   * Where damage grows, what a step dissipates may depend on the way between
   * its two states. One damage scalar: the squares of opening and slip go
   * straight, and with a potential (CohesiveLaw::has_potential()) the way does
   * not matter. Two scalars: the mean of the two ways that go along one opening
   * after the other. A step may be of any length: a separation dissipates the
   * toughness also in a single one (section 6 of doc/theory.md).
   */
  class LawPoint
  {
  public:
    /**
     * @p strength_factor a and @p opening_factor l make a T(l d) of the law, l
     * the first over the factor of the toughness. With @p plateau the traction
     * does not fall while the point closes: form (5) of [AM06], for extrinsic
     * laws, and all that add openings. @p law must outlive the point.
     */
    explicit LawPoint(const CohesiveLaw &law, const double strength_factor = 1.,
                      const double opening_factor = 1.,
                      const bool plateau = false)
        : LawPoint(law, strength_factor, opening_factor, plateau,
                   law.stiffness_ratio(), law.shear_weight())
    {
    }

    /** The same with C_T / C_N and r^2, which the caller has at hand. */
    LawPoint(const CohesiveLaw &law, const double strength_factor,
             const double opening_factor, const bool plateau,
             const double stiffness_ratio, const double shear_weight)
        : law_(law), mixed_(law.mixed()), a_(strength_factor),
          l_(opening_factor), stiffness_ratio_(stiffness_ratio),
          shear_weight_(shear_weight), adds_(law.adds_openings()),
          plateau_(plateau || adds_)
    {
    }

    const CohesiveLaw &law() const { return law_; }
    double opening_factor() const { return l_; }

    /** How far @p jump is open. */
    Reach reach(const JumpSize &jump) const
    {
      if (mixed_)
        return {jump.opening, std::sqrt(jump.slip_square)};
      if (adds_)
        return {jump.opening + std::sqrt(shear_weight_ * jump.slip_square), 0.};
      return {std::sqrt(jump.opening * jump.opening +
                        shear_weight_ * jump.slip_square),
              0.};
    }

    /** The history after @p time at @p end; a delay needs the time. */
    Reach history_after(const Reach &history, const Reach &end,
                        double time) const;

    /** The state after a step to @p jump that takes @p time. */
    LawState
    moved(const LawState &from, const JumpSize &jump,
          const double time = std::numeric_limits<double>::infinity()) const
    {
      return {jump, history_after(from.history, reach(jump), time)};
    }

    /**
     * Secants with which the point unloads and is loaded again up to
     * @p history. Infinite for an extrinsic law that was never open; of no use
     * on a plateau, where the traction has the size traction(d_m).
     */
    Secant secant(const Reach &history) const;

    /** The envelope a T(l d) of one damage scalar, or in pure opening. */
    double traction(const double opening) const
    {
      return a_ * law_.traction(l_ * opening);
    }

    /** What is left: 1 intact, 0 broken. */
    double beta(const Reach &history) const;

    /**
     * The potential: what the point gives back when it closes. Its gradient
     * at a fixed history is the traction. No energy of an overlap.
     */
    double stored(const LawState &state) const;

    /**
     * What a step between two states dissipates, both parts at least 0:
     * with the change of stored() it is the work of the traction along the way.
     * @p to comes from moved(), or is @p from.
     */
    Dissipation dissipated(const LawState &from, const LawState &to) const;

    /** Reach at the end of a step and the largest one then. */
    struct Reached {
      Reach now, largest;
    };

    /**
     * The discrete gradient of stored plus dissipated energy: with it the work
     * of b (u_from + u_to) / 2 over u_to - u_from is what is stored and
     * dissipated, to round-off, in a step of any length (equation (6.5) of
     * doc/theory.md; u_N in its squares' quotient where it changes sign).
     */
    Secant mean_secant(const Reached &from, const Reached &to) const;

    /**
     * The mean traction on a plateau and along the envelope beyond it, of a way
     * from @p from to the opening @p opening: its product with their
     * difference is what is stored and dissipated.
     */
    double mean_traction(const Reached &from, double opening) const;

    /**
     * Largest traction in pure opening of a point that was never open; with a
     * plateau, what the largest opening has left of it.
     */
    double strength(const Reach &history = {}) const
    {
      return plateau_ ? traction(history.opening) : a_ * law_.strength();
    }

    /**
     * The traction in pure opening that is as close to the strength as the
     * traction with the normal part @p normal (tension positive) and the
     * @p dim - 1 shear components @p shear. Homogeneous of degree one, so that
     * impulses and forces may be given as well.
     *
     * The point begins to open (extrinsic laws), or passes its largest traction
     * (intrinsic ones), where it exceeds strength(). One damage scalar:
     * sqrt(<t_N>_+^2 + |t_T|^2 / s^2) with s = (C_T/C_N) / r the strength in
     * shear over that in opening; 1/s^2 = 1/r^2 with a potential. Two scalars:
     * the surface that the law itself has, found by a search over the envelope
     * in the direction of the traction, some thousand evaluations of secants.
     * Added openings: max(<t_N>_+, |t_T| / r), each direction by itself.
     * Compression counts as none but for friction: @p friction, mu kappa(beta),
     * carries @p friction times the pressure of the shear. A law whose damage
     * takes time is taken at rest.
     */
    template <int dim>
    double effective_traction(const double normal, const double *shear,
                              const double friction = 0.) const
    {
      if (mixed_ || (friction > 0. && normal < 0.)) {
        double square = 0.;
        for (unsigned int c = 0; c + 1 < dim; ++c)
          square += shear[c] * shear[c];
        return reduced_traction(normal, std::sqrt(square), friction);
      }
      const double pull = std::max(0., normal), weight = strength_weight();
      double square = adds_ ? 0. : pull * pull;
      if (weight > 0.)
        for (unsigned int c = 0; c + 1 < dim; ++c)
          square += shear[c] * shear[c] / weight;
      return adds_ ? std::max(pull, std::sqrt(square)) : std::sqrt(square);
    }

  private:
    const CohesiveLaw &law_;
    const MixedLaw *mixed_;
    double a_, l_;
    double stiffness_ratio_, shear_weight_;
    bool adds_; ///< CohesiveLaw::adds_openings()
    bool plateau_;

    struct Growth {
      double opening;  ///< d where damage begins to grow
      double from, to; ///< d_m before and after
    };
    Growth growth(const Reached &from, const Reached &to) const;

    double secant_at(const double opening) const
    {
      return a_ * l_ * law_.secant(l_ * opening);
    }
    double released(double from, double to) const;
    double scalar_secant(const Reached &from, const Reached &to) const;
    Secant mixed_secant(const Reached &from, const Reached &to) const;
    double lost_energy(const LawState &from, const LawState &to,
                       double damage) const;
    double mixed_dissipation(const Reached &from, const Reached &to) const;
    double reduced_traction(double normal, double shear, double friction) const;

    /** s^2: the strength in shear over that in opening, squared. */
    double strength_weight() const
    {
      return has_potential(stiffness_ratio_, shear_weight_)
                 ? shear_weight_
                 : stiffness_ratio_ * stiffness_ratio_ / shear_weight_;
    }
  };

  /** The share of the strength that a traction in Pa takes; splits above 1. */
  template <int dim>
  double strength_ratio(const LawPoint &point, const double normal,
                        const double *shear, const Reach &history = {},
                        const double friction = 0.)
  {
    return point.effective_traction<dim>(normal, shear, friction) /
           point.strength(history);
  }
} // namespace nsfd
