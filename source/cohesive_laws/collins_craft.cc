#include "linear_softening.h"

#include "nsfd/cohesive_laws/law_input.h"

namespace nsfd
{
  /**
   * The law of Collins-Craft, Bourrier and Acary (2024), extrinsic, with the
   * free energy
   *
   *   Psi = beta s (u_N + gamma |u_T|) + w (1 - beta)^2,   w = s delta / 2,
   *   beta = min (1 - (u_N + gamma |u_T|) / delta) over the past.
   *
   * Its gradient is a traction beta s in opening and beta s gamma in shear,
   * each by itself, which unloading does not lower and which is set-valued in a
   * direction that does not move. w (1 - beta)^2 never comes back and is what
   * is dissipated: G = s delta / 2 in opening and in shear. Friction is that of
   * the reaction r_N + beta s of the contact, at all beta.
   */
  class CollinsCraft final : public LinearSoftening
  {
  public:
    explicit CollinsCraft(SectionReader &reader)
    {
      laws::Separation separation(reader);
      separation.complete(reader, "collins-craft", 0.5, "G = R_max d_c / 2");
      strength_ = separation.strength.value_or(1.);
      critical_opening_ = separation.critical_opening.value_or(1.);
      const double gamma = reader.number(
          "mode mixity", "1", units::none, Range::positive(),
          "Weight gamma of the slip in the opening, d = u_N + gamma |u_T|");
      shear_weight_ = gamma * gamma;
    }

    bool adds_openings() const override { return true; }

    double energy(const double d) const override
    {
      return energy_increment(0., d);
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, CollinsCraft, "collins-craft",
                "Extrinsic, opening and slip in one sum, no elasticity in "
                "unloading; from two of strength, toughness, critical opening",
                "strength = 45 MPa; toughness = 140 J/m^2",
                "strength = 0.5 MPa; critical opening = 1 mm; "
                "mode mixity = 0.7");
} // namespace nsfd
