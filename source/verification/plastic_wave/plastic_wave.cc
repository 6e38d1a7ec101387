#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

namespace nsfd
{
  using namespace cases;

  /**
   * The left end of a bar at rest that cannot get thicker (uniaxial strain) is
   * driven into it at speed V from t = 0 on. Up to the limit
   * sigma_H = yield (1 - nu) / (1 - 2 nu) it is elastic; beyond, with linear
   * hardening H of both kinds together, its modulus is
   * K + 4 mu H / (3 (3 mu + H)). So there are two waves: behind the first one,
   * at c_p, bodies move at v_e = sigma_H / (rho c_p), behind the second one, at
   * c_pl, at V. Exact until the first one is at the other end.
   */
  class PlasticWave final : public VerificationCase
  {
  public:
    explicit PlasticWave(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.materials.size() == 1 && input.materials[0].plastic &&
                 !input.large_motion && !input.plane_stress,
             "the bar has one material that flows, motion = small and plane = "
             "strain");
      const MaterialInput &material = input.materials[0];
      const PlasticInput &plastic = *material.plastic;
      demand(plastic.viscosity == 0. && plastic.saturation_stress == 0. &&
                 plastic.hardening_exponent == 0.,
             "the material hardens linearly, without viscosity");
      const double E = material.young, nu = material.poisson,
                   rho = material.density,
                   H = plastic.isotropic + plastic.kinematic;
      shear_ = E / (2. * (1. + nu));
      bulk_ = E / (3. * (1. - 2. * nu));
      yield_ = plastic.yield_stress;
      hardening_ = H;
      start_ = input.mesh.lower[0];
      section_ = cross_section(input, 0);
      for (const BoundaryInput &boundary : input.boundaries)
        if (boundary.velocity[0]) {
          const Direction side = direction_of(boundary.where);
          demand(side.axis == 0 && side.sign < 0. &&
                     boundary.velocity[0]->is_constant(),
                 "velocity x must be constant, of the left side alone");
          speed_ = (*boundary.velocity[0])(0., 0., 0.);
        }
      const double limit = yield_ * (1. - nu) / (1. - 2. * nu);
      fast_ = std::sqrt((bulk_ + 4. / 3. * shear_) / rho);
      slow_ =
          std::sqrt((bulk_ + 4. * shear_ * H / (3. * (3. * shear_ + H))) / rho);
      first_ = limit / (rho * fast_);
      demand(speed_ > first_,
             "the left end must be faster than the material bears without "
             "flow");
      demand(fast_ * input.time.end <= extent(input, 0) * (1. + 1e-9),
             "the solution is known until the first wave is at the other end");
    }

    bool has_fields() const override { return true; }
    Vector displacement(const Vector &x, const double t) const override
    {
      const double s = x[0] - start_;
      return {first_ * std::max(0., t - s / fast_) +
                  (speed_ - first_) * std::max(0., t - s / slow_),
              0., 0.};
    }
    Vector velocity(const Vector &x, const double t) const override
    {
      const double s = x[0] - start_;
      return {s < slow_ * t ? speed_ : s < fast_ * t ? first_ : 0., 0., 0.};
    }
    bool has_stress() const override { return true; }
    std::array<double, 6> stress(const Vector &x, const double t) const override
    {
      const double s = x[0] - start_;
      double strain = 0., q = 0.; // of compression
      if (s < fast_ * t) {
        strain = first_ / fast_;
        q = yield_;
      }
      if (s < slow_ * t) {
        strain += (speed_ - first_) / slow_;
        q = yield_ + hardening_ * flow(strain);
      }
      const double mean = -bulk_ * strain;
      return {mean - 2. / 3. * q, mean + q / 3., mean + q / 3., 0., 0., 0.};
    }

    void observe(const StepView &view) override
    {
      plastic_ = view.row->energy.plastic;
      time_ = view.time;
    }
    void finish(std::map<std::string, double> &errors) const override
    {
      const double strain = first_ / fast_ + (speed_ - first_) / slow_;
      errors["plastic_work"] = relative_error(
          plastic_, yield_ * flow(strain) * slow_ * time_ * section_);
    }
    void serialize(Archive &archive) override
    {
      archive.numbers("found", plastic_, time_);
    }

  private:
    /** p of a compression beyond the limit. */
    double flow(const double strain) const
    {
      return (2. * shear_ * strain - yield_) / (3. * shear_ + hardening_);
    }

    double shear_ = 0., bulk_ = 0., yield_ = 0., hardening_ = 0., start_ = 0.,
           section_ = 0., speed_ = 0., fast_ = 0., slow_ = 0., first_ = 0.;
    double plastic_ = 0., time_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, PlasticWave, "plastic wave",
                "Elastic and plastic wave in uniaxial strain: fields, stress, "
                "work of the flow");
} // namespace nsfd
