#include "nsfd/verification/case_input.h"

namespace nsfd
{
  using namespace cases;

  /**
   * A thick-walled tube, a < r < b, whose length is held, under the pressure
   * p(t) inside, in equilibrium (Lame):
   *
   *   u_r = (1 + nu) / E p a^2 / (b^2 - a^2) ((1 - 2 nu) r + b^2 / r),
   *   sigma_rr, sigma_tt = p a^2 / (b^2 - a^2) (1 -+ b^2 / r^2),
   *   sigma_zz = nu (sigma_rr + sigma_tt).
   *
   * Where the ends are free to slide radially alone, both are planes that stay.
   */
  class Tube final : public VerificationCase
  {
  public:
    explicit Tube(SectionReader &) {}

    bool is_axisymmetric() const override { return true; }

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.axisymmetric && input.statics && input.statics->steps,
             "the tube needs plane = axisymmetric and scheme = quasi-static");
      inner_ = input.mesh.lower[0];
      outer_ = input.mesh.upper[0];
      height_ = input.mesh.lower[1];
      demand(inner_ > 0.,
             "the tube must be hollow, its left side off the axis");
      const MaterialInput &material = input.materials.front();
      demand(input.materials.size() == 1 && !material.graded,
             "the tube has one material, the same everywhere");
      young_ = material.young;
      poisson_ = material.poisson;
      for (const BoundaryInput &boundary : input.boundaries)
        if (boundary.where.kind == Where::Kind::side &&
            boundary.where.name == "left" && boundary.has_pressure)
          pressure_ = boundary.pressure;
      demand(!pressure_.is_zero(), "the left side needs a pressure");
    }

    bool has_fields() const override { return true; }
    bool has_stress() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      const double r = x[0];
      return {(1. + poisson_) / young_ * mean_tension(t) *
                  ((1. - 2. * poisson_) * r + outer_ * outer_ / r),
              0., 0.};
    }

    std::array<double, 6> stress(const Vector &x, const double t) const override
    {
      const double mean = mean_tension(t), share = outer_ / x[0];
      return {mean * (1. - share * share),
              2. * poisson_ * mean,
              mean * (1. + share * share),
              0.,
              0.,
              0.};
    }

  private:
    double inner_ = 0., outer_ = 0., height_ = 0., young_ = 0., poisson_ = 0.;
    Expression pressure_;

    /** Half the sum of the stresses along r and along the hoops. */
    double mean_tension(const double t) const
    {
      const double p = pressure_(inner_, height_, 0., t);
      return p * inner_ * inner_ / (outer_ * outer_ - inner_ * inner_);
    }
  };

  NSFD_REGISTER(VerificationRegistry, Tube, "tube",
                "Thick-walled tube under pressure (Lame): displacement, "
                "stress");
} // namespace nsfd
