#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * An intrinsic law whose springs have the compliance c / C, 0 < c <= 1,
   * instead of 1 / C, in opening and in shear. The opening of the law consists
   * of that of an elastic spring and of the rest, one behind the other,
   *
   *   u = T / C + u_rest;
   *
   * only the first part changes. With r = (1 - c) / C the traction is that of
   * the law at the opening d of
   *
   *   d' = d - r T(d),        beta' = c beta / (1 - (1 - c) beta),
   *
   * at every d' one, since T / d <= C falls with d. What a jump does in
   * traction does not depend on c: strength and toughness stay (int T dT = 0
   * over the whole way), the direction of the traction, and what a point with a
   * given traction at its largest opening has dissipated,
   *
   *   I'(d') = I(d) - r T^2 / 2,      D' = I' - T d' / 2 = D.
   *
   * Where T jumps down it falls with the slope -1 / r.
   */
  class StiffenedLaw final : public CohesiveLaw
  {
  public:
    /** @p law must allow it, see not_stiffened(). */
    StiffenedLaw(std::shared_ptr<const CohesiveLaw> law, double compliance);

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override { return stiffness_; }
    double stiffness_ratio() const override { return law_->stiffness_ratio(); }
    double shear_weight() const override { return law_->shear_weight(); }
    double beta(double d) const override;
    double traction(double d) const override;
    double energy(double d) const override;
    std::vector<double> kinks() const override;
    double elastic_limit() const override { return elastic_limit_; }
    double peak_opening() const override
    {
      return opening(law_->peak_opening());
    }
    double final_opening() const override;
    double strength() const override { return law_->strength(); }
    double toughness() const override { return law_->toughness(); }
    double steepest_softening() const override;

    /** d' of d, and d of d'. */
    double opening(double law_opening) const;
    double law_opening(double opening) const;

  private:
    struct Place {
      double opening, traction; ///< d and T
    };
    Place place(double opening) const;

    std::shared_ptr<const CohesiveLaw> law_;
    double stiffness_, removed_, elastic_limit_;
  };

  /** Why springs of the law cannot have another compliance; empty: they can. */
  std::string not_stiffened(const CohesiveLaw &law);

  /** The law itself for @p compliance 1. */
  std::shared_ptr<const CohesiveLaw>
  with_compliance(const std::shared_ptr<const CohesiveLaw> &law,
                  double compliance);

  /**
   * The largest opening of a point that had @p opening with the compliance
   * @p from and has the compliance @p to: the traction there stays.
   */
  double opening_at_compliance(const std::shared_ptr<const CohesiveLaw> &law,
                               double opening, double from, double to);
} // namespace nsfd
