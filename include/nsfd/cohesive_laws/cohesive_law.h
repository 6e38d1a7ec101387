#pragma once

#include "nsfd/core/registry.h"

#include <limits>
#include <memory>
#include <vector>

namespace nsfd
{
  class SectionReader;

  /**
   * A law with two damage scalars: the largest opening x and the largest slip
   * y, both in m, give a secant to each direction,
   *
   *   R = K_N(x, y) <u_N>_+ n + K_T(x, y) u_T.
   *
   * Neither secant grows with x or y, so that damage never gives energy back.
   */
  class MixedLaw
  {
  public:
    virtual ~MixedLaw() = default;

    /** K_N and K_T in Pa/m, finite at 0. */
    virtual double normal_secant(double x, double y) const = 0;
    virtual double tangential_secant(double x, double y) const = 0;

    /** int K_N(x, y) x dx from @p x0 to @p x1 at the slip @p y, in J/m^2. */
    virtual double normal_energy(double x0, double x1, double y) const = 0;
    /** int K_T(x, y) y dy from @p y0 to @p y1 at the opening @p x. */
    virtual double tangential_energy(double y0, double y1, double x) const = 0;

    /** max |dT_T/dy| in pure shear, in Pa/m. */
    virtual double steepest_shear_softening() const = 0;

    /** Slip at the largest traction in pure shear, in m. */
    virtual double peak_slip() const = 0;

    /** What is left: the larger of both secants over those at 0. */
    double beta(double x, double y) const;
  };

  /**
   * A cohesive law with one damage scalar, stated by its envelope: traction
   * T(d) against the effective opening
   *
   *   d^2 = <u_N>_+^2 + r^2 |u_T|^2,        r^2 = shear_weight().
   *
   * With beta(d) falling along the envelope (1 intact, 0 broken), the traction
   * of an intrinsic law is R = beta (C_N <u_N>_+ n + C_T u_T) (equations (3)
   * and (4) of [AM06]), T(d) = beta(d) C_N d. An extrinsic law is rigid
   * before activation, and unloads on the secant from the largest opening d_m:
   * R = (T(d_m) / d_m) (<u_N>_+ n + r^2 u_T).
   *
   * Lengths in m, tractions in Pa, energies in J/m^2. All functions are pure:
   * history (the largest opening) is kept by the caller. They accept any
   * d >= 0, also far beyond separation, and return finite values.
   *
   * A law may let its damage lag behind the opening (rate_dependent()), or
   * have two damage scalars (mixed()): what it says here is then its envelope
   * at rest, or its curve in pure opening.
   *
   * A point with a times the strength and g times the toughness evaluates
   * a T(a d / g): the shape stays, openings scale with g / a and the stiffness
   * with a^2 / g. The caller does this scaling.
   *
   * LawPoint (law_point.h) makes of a law and these factors what is stored and
   * dissipated between two states and the strength for a traction.
   */
  class CohesiveLaw
  {
  public:
    virtual ~CohesiveLaw() = default;

    /** Rigid before activation, no stiffness there. */
    virtual bool extrinsic() const = 0;

    /** C_N in Pa/m; intrinsic laws only (infinity for extrinsic ones). */
    virtual double normal_stiffness() const = 0;

    /** C_T / C_N, or r^2 for extrinsic laws. */
    virtual double stiffness_ratio() const = 0;

    /** r^2 in the effective opening. */
    virtual double shear_weight() const = 0;

    /**
     * The effective opening is the norm of the stored energy (r^2 = C_T/C_N),
     * so that the work to any opening does not depend on the way.
     */
    bool has_potential() const;

    /** Damage on the envelope, non-increasing in d; 1 at d = 0. */
    virtual double beta(double d) const = 0;

    /** Envelope T(d) in Pa; for extrinsic laws T(0) is the strength. */
    virtual double traction(double d) const = 0;

    /** I(d), the area under the envelope from 0 to d, in J/m^2. */
    virtual double energy(double d) const = 0;

    /**
     * I(d1) - I(d0) without cancellation when d1 is close to d0. The default
     * integrates T between the kinks of the law by a Gauss rule for close
     * openings and takes the difference of energy() otherwise.
     */
    virtual double energy_increment(double d0, double d1) const;

    /** Openings between which T is smooth, in any order. */
    virtual std::vector<double> kinks() const;

    /** Secant stiffness T(d)/d, with its limit C_N at d = 0 if intrinsic. */
    double secant(double d) const;

    /** Opening up to which beta = 1 (0 if damage starts at once). */
    virtual double elastic_limit() const = 0;

    /** Opening at the largest traction. */
    virtual double peak_opening() const = 0;

    /** Opening at which beta = 0; infinity for laws with a tail. */
    virtual double final_opening() const = 0;

    /** Largest traction R_max in Pa. */
    virtual double strength() const = 0;

    /** G = I(infinity) in J/m^2. */
    virtual double toughness() const = 0;

    /** max |T'| over the softening branch, in Pa/m; infinity at a jump. */
    virtual double steepest_softening() const = 0;

    /**
     * The opening is the sum d = <u_N>_+ + r |u_T|, and each direction has a
     * traction of its own, kept while the point closes:
     *
     *   R = T(d_m) (n + r u_T / |u_T|),
     *
     * set-valued where u_N = 0 or u_T = 0. Of an extrinsic law alone, with the
     * stored energy T(d_m) d; stiffness_ratio() is r^2.
     */
    virtual bool adds_openings() const { return false; }

    /** The law with two damage scalars that this is, or null. */
    virtual const MixedLaw *mixed() const { return nullptr; }

    /** Default of s in the weight (1 - beta)^s of friction; 0: friction acts in
        full from the start, and holds what is intact as well. */
    virtual double friction_exponent() const { return 1.; }

    /** Damage takes time: delayed_opening() and not the opening itself. */
    virtual bool rate_dependent() const { return false; }

    /**
     * The opening d_m whose beta is reached after @p time seconds at the
     * opening @p d > @p d_m, from that of @p d_m; between the two.
     */
    virtual double delayed_opening(double d_m, double d, double time) const;

    /**
     * What is pressed grows together again: healed_opening(). Of intrinsic laws
     * with one damage scalar.
     */
    virtual bool heals() const { return false; }

    /**
     * The opening d_m that is left of @p d_m, which may be infinite, where the
     * faces are pressed for @p time seconds by @p pressure > 0, in Pa: at most
     * @p d_m and at least elastic_limit(). Two times one after the other are
     * their sum.
     */
    virtual double healed_opening(double d_m, double pressure,
                                  double time) const;
  };

  /**
   * Laws by name; a factory reads the law's own entries of its section. A law
   * registers examples of them, at least one.
   */
  using CohesiveLawRegistry = Registry<CohesiveLaw, SectionReader &>;
} // namespace nsfd
