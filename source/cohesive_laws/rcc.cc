#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace nsfd
{
  /**
   * Adhesion of Raous, Cangemi and Cocu. Their intensity b minimises
   * b^2 C d^2 / 2 - w b, so b = min(1, w / (C d^2)) at rest, with
   * C d^2 = C_N <u_N>_+^2 + C_T |u_T|^2, and the traction is b^2 C u. In the
   * form (4) of [AM06] the damage is therefore beta = b^2:
   *
   *   T = C d up to u_0 = sqrt(w / C),   T = w^2 / (C d^3) beyond,   G = w,
   *
   * half of it dissipated after the peak, in a tail without end. With a
   * viscosity eta the intensity follows eta db/dt = min(0, w - b C d^2), solved
   * exactly over a step for the opening at its end. With a healing time tau it
   * grows again where the face is pressed, db/dt = min(1, p/p_h)/tau: the
   * driving force is -w there, and the surface energy that is set free is
   * dissipated.
   */
  class Rcc final : public CohesiveLaw
  {
  public:
    explicit Rcc(SectionReader &reader)
    {
      stiffness_ = reader.number("stiffness", "", units::stiffness_per_area,
                                 Range::positive(), "Normal stiffness C_N");
      adhesion_energy_ =
          reader.number("adhesion energy", "", units::energy_per_area,
                        Range::positive(), "Adhesion energy w = G");
      const std::string text = "Stiffness C_T in shear; default C_N";
      stiffness_ratio_ = reader.optional("tangential stiffness", text)
                             ? reader.number("tangential stiffness", "",
                                             units::stiffness_per_area,
                                             Range::positive(), text) /
                                   stiffness_
                             : 1.;
      elastic_limit_ = std::sqrt(adhesion_energy_ / stiffness_);
      viscosity_ = reader.number("damage viscosity", "0",
                                 units::damage_viscosity, Range::non_negative(),
                                 "Of the intensity, J s/m^2; 0: none");
      healing_ = laws::read_healing(reader);
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override { return stiffness_; }
    double stiffness_ratio() const override { return stiffness_ratio_; }
    double shear_weight() const override { return stiffness_ratio_; }

    double beta(const double d) const override
    {
      const double b = intensity(d);
      return b * b;
    }

    double traction(const double d) const override
    {
      if (d <= elastic_limit_)
        return stiffness_ * d;
      return strength() * intensity(d) * (elastic_limit_ / d);
    }

    double energy(const double d) const override
    {
      if (d <= elastic_limit_)
        return 0.5 * stiffness_ * d * d;
      return adhesion_energy_ * (1. - 0.5 * intensity(d));
    }

    double elastic_limit() const override { return elastic_limit_; }
    double peak_opening() const override { return elastic_limit_; }

    double final_opening() const override
    {
      return std::numeric_limits<double>::infinity();
    }

    double strength() const override { return stiffness_ * elastic_limit_; }
    double toughness() const override { return adhesion_energy_; }

    bool rate_dependent() const override { return viscosity_ > 0.; }

    double delayed_opening(const double d_m, const double d,
                           const double time) const override
    {
      if (viscosity_ == 0. || d <= d_m)
        return std::max(d_m, d);
      const double rate = stiffness_ * d * d / viscosity_;
      const double end = intensity(d);
      const double b = end + (intensity(d_m) - end) * std::exp(-rate * time);
      return std::clamp(elastic_limit_ / std::sqrt(b), d_m, d);
    }

    bool heals() const override { return healing_.time > 0.; }

    double healed_opening(const double d_m, const double pressure,
                          const double time) const override
    {
      if (!heals() || d_m <= elastic_limit_)
        return d_m;
      const double b = intensity(d_m) + healing_.rate(pressure) * time;
      return b >= 1. ? elastic_limit_
                     : std::min(d_m, elastic_limit_ / std::sqrt(b));
    }

    /** Just after the peak. */
    double steepest_softening() const override { return 3. * stiffness_; }

  private:
    double stiffness_, adhesion_energy_, stiffness_ratio_, elastic_limit_;
    double viscosity_;
    laws::Healing healing_;

    /** The authors' own beta, min(1, w / (C d^2)). */
    double intensity(const double d) const
    {
      if (d <= elastic_limit_)
        return 1.;
      const double x = elastic_limit_ / d;
      return x * x;
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, Rcc, "rcc",
                "Intrinsic adhesion of Raous, Cangemi and Cocu, endless tail; "
                "from stiffness and adhesion energy; by choice viscous, and "
                "healing under pressure",
                "stiffness = 2e12; adhesion energy = 8 J/m^2",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "tangential stiffness = 5e12",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "damage viscosity = 0.01",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "healing time = 1 ms; healing pressure = 1 MPa");
} // namespace nsfd
