#include "nsfd/core/archive.h"
#include "nsfd/verification/case_input.h"

#include <algorithm>

namespace nsfd
{
  /**
   * A body at rest under a force per volume that grows with time, f = k t. It
   * moves without strain:
   *
   *   v = k t^2 / (2 rho),   u = k t^3 / (6 rho).
   *
   * With theta = 1/2 the impulse of a step is exact, and so is v; u is a sum of
   * trapezoids of v, too large by the share h^2 / (2 t^2).
   */
  class GrowingForce final : public VerificationCase
  {
  public:
    explicit GrowingForce(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      cases::demand(input.materials.size() == 1 && input.boundaries.empty() &&
                        input.obstacles.empty(),
                    "there must be one material, and nothing may touch it");
      const MaterialInput &material = input.materials.front();
      for (unsigned int c = 0; c < input.dimension; ++c) {
        const auto force = [&](const double t) {
          return material.body_force[c](0., 0., 0., t);
        };
        cases::demand(force(0.) == 0. && force(2.) == 2. * force(1.),
                      "the body force must be a constant times t");
        rate_[c] = force(1.) / material.density;
      }
    }

    bool has_fields() const override { return true; }
    Vector displacement(const Vector &, const double t) const override
    {
      return times(t * t * t / 6.);
    }
    Vector velocity(const Vector &, const double t) const override
    {
      return times(t * t / 2.);
    }

    void observe(const StepView &view) override
    {
      elastic_ = std::max(elastic_, view.row->energy.elastic);
      kinetic_ = view.row->energy.kinetic;
    }
    void serialize(Archive &archive) override
    {
      archive.numbers("energies", elastic_, kinetic_);
    }
    void finish(std::map<std::string, double> &errors) const override
    {
      errors["elastic_energy"] = elastic_ / kinetic_;
    }

  private:
    Vector times(const double factor) const
    {
      return {{factor * rate_[0], factor * rate_[1], factor * rate_[2]}};
    }

    Vector rate_{}; ///< k / rho, m/s^3
    double elastic_ = 0., kinetic_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, GrowingForce, "growing force",
                "A force that grows with time: fields, no strain");
} // namespace nsfd
