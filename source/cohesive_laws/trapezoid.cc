#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

namespace nsfd
{
  /**
   * The trapezoid of Tvergaard and Hutchinson, intrinsic: with
   * d^2 = <u_N>_+^2 + (delta_N / delta_T)^2 |u_T|^2, d_c = delta_N,
   * d_1 = l1 d_c and d_2 = l2 d_c,
   *
   *   T = R_max d / d_1,   R_max,   R_max (d_c - d) / (d_c - d_2)
   *       on [0, d_1],   [d_1, d_2],   [d_2, d_c],
   *   G = (1 + l2 - l1) / 2 R_max d_c.
   *
   * It has a potential. l1 = l2 is the bilinear law. On the plateau damage
   * grows at constant traction; softening begins at peak_opening() = d_2.
   */
  class Trapezoid final : public CohesiveLaw
  {
  public:
    explicit Trapezoid(SectionReader &reader)
    {
      double l1 = reader.number("l1", "0.15", units::none, {0., 1., true, true},
                                "d_1 / d_c, where the traction reaches R_max");
      double l2 = reader.number("l2", "0.5", units::none, {0., 1., true, true},
                                "d_2 / d_c, where the traction begins to fall");
      if (l1 > l2) {
        reader.error("l2", "l2 is below l1: the plateau ends before it begins",
                     "write l1 <= l2");
        l1 = l2;
      }
      zeta_ = 0.5 * (1. + l2 - l1);
      laws::Separation separation(reader);
      separation.complete(reader, "trapezoid", zeta_,
                          "G = (1 + l2 - l1) / 2 R_max d_c");
      strength_ = *separation.strength;
      critical_opening_ = *separation.critical_opening;
      plateau_begin_ = l1 * critical_opening_;
      plateau_end_ = l2 * critical_opening_;
      opening_ratio_ = laws::read_opening_ratio(reader, critical_opening_);
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override
    {
      return strength_ / plateau_begin_;
    }
    double stiffness_ratio() const override { return shear_weight(); }
    double shear_weight() const override
    {
      return opening_ratio_ * opening_ratio_;
    }

    double beta(const double d) const override
    {
      if (d <= plateau_begin_)
        return 1.;
      return plateau_begin_ * rest(d) / d;
    }

    double traction(const double d) const override
    {
      if (d <= plateau_begin_)
        return strength_ * (d / plateau_begin_);
      return strength_ * rest(d);
    }

    double energy(const double d) const override
    {
      if (d <= plateau_begin_)
        return 0.5 * traction(d) * d;
      if (d <= plateau_end_)
        return strength_ * (d - 0.5 * plateau_begin_);
      if (d >= critical_opening_)
        return toughness();
      return toughness() - 0.5 * traction(d) * (critical_opening_ - d);
    }

    double elastic_limit() const override { return plateau_begin_; }
    double peak_opening() const override { return plateau_end_; }
    double final_opening() const override { return critical_opening_; }
    double strength() const override { return strength_; }

    double toughness() const override
    {
      return zeta_ * strength_ * critical_opening_;
    }

    double steepest_softening() const override
    {
      return strength_ / (critical_opening_ - plateau_end_);
    }

  private:
    double zeta_, strength_, critical_opening_;
    double plateau_begin_, plateau_end_, opening_ratio_;

    /** T / R_max on the plateau and beyond. */
    double rest(const double d) const
    {
      if (d <= plateau_end_)
        return 1.;
      if (d >= critical_opening_)
        return 0.;
      return (critical_opening_ - d) / (critical_opening_ - plateau_end_);
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, Trapezoid, "trapezoid",
                "Intrinsic, with a plateau (Tvergaard-Hutchinson); from two of "
                "strength, toughness and critical opening",
                "strength = 3 MPa; toughness = 4 J/m^2",
                "strength = 300 MPa; critical opening = 10 nm; l1 = 0.4; "
                "l2 = 0.9; tangential critical opening = 6 nm");
} // namespace nsfd
