#include "nsfd/verification/case_input.h"

namespace nsfd
{
  using namespace cases;

  /**
   * A bar held at its left end and pulled at its right one by the traction
   * T(t), so slowly that it is in equilibrium, with E = E_0 exp(s / l), s from
   * the left end:
   *
   *   u = T l / E_0 (1 - exp(-s / l)),   sigma = T.
   */
  class GradedBar final : public VerificationCase
  {
  public:
    explicit GradedBar(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.materials.size() == 1 && input.materials[0].graded,
             "there must be one material, with a graded Young modulus");
      const MaterialInput &material = input.materials[0];
      demand(material.poisson == 0., "the bar must not contract");
      start_ = input.mesh.lower[0];
      const double length = extent(input, 0);
      const auto young = [&](const double share) {
        return material.graded->young(start_ + share * length,
                                      input.mesh.lower[1], 0.);
      };
      young_ = young(0.);
      growth_ = std::log(young(1.) / young_) / length;
      for (const double share : {0.3, 0.7})
        demand(relative_error(young(share), young_ * std::exp(growth_ * share *
                                                              length)) < 1e-12,
               "the Young modulus must grow exponentially along x");
      const LoadedSide side = loaded_side(input);
      demand(side.normal.axis == 0 && side.normal.sign > 0. && growth_ != 0.,
             "the right end must be pulled");
      side_ = side.centre;
      traction_ = side.boundary->traction[0];
    }

    bool has_fields() const override { return true; }
    bool has_stress() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      return {-tension(t) / (growth_ * young_) *
                  std::expm1(-growth_ * (x[0] - start_)),
              0., 0.};
    }

    std::array<double, 6> stress(const Vector &, const double t) const override
    {
      return {tension(t), 0., 0., 0., 0., 0.};
    }

  private:
    double start_ = 0., young_ = 0., growth_ = 0.;
    Vector side_{};
    Expression traction_;

    double tension(const double t) const
    {
      return traction_(side_[0], side_[1], side_[2], t);
    }
  };

  NSFD_REGISTER(VerificationRegistry, GradedBar, "graded bar",
                "Bar in equilibrium whose Young modulus grows exponentially: "
                "displacement, stress");
} // namespace nsfd
