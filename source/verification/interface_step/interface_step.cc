#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

namespace nsfd
{
  using namespace cases;

  /**
   * A step of tension sigma_0 on one end of a bar of length 2a meets an
   * elastic interface K at its middle. With Z = rho c, tau = Z/(2K), x the
   * distance from the loaded end and s the time since the front has reached
   * the interface,
   *
   *   transmitted  sigma_0 (1 - exp(-s/tau)) = K [u],
   *   reflected   -sigma_0 exp(-s/tau),
   *
   * and a wave of stress sigma moves its particles by -sigma/Z if it runs away
   * from the loaded end, by +sigma/Z if it runs back. Exact until a wave meets
   * an end of the bar, t < 2a/c.
   */
  class InterfaceStep final : public VerificationCase
  {
  public:
    explicit InterfaceStep(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      bar_ = bar_of(input);
      const LoadedSide side = loaded_side(input);
      normal_ = side.normal;
      end_ = side.centre[normal_.axis];
      stress_ = side.tension(0.);
      half_ = 0.5 * extent(input, normal_.axis);
      stiffness_ = elastic_interface(input).normal_stiffness;
      area_ = cross_section(input, normal_.axis);
      tau_ = bar_.impedance() / (2. * stiffness_);
      demand(stress_ != 0. && side.tension(input.time.end) == stress_,
             "the traction must be a step, constant in time");
      demand(input.time.end <= 2. * half_ / bar_.speed * (1. + 1e-9),
             "the solution is known until t = L/c, when waves come back");
    }

    bool has_fields() const override { return true; }
    bool has_stress() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      const Waves w = waves(x, t);
      const double integral = tau_ * (1. - std::exp(-w.late / tau_));
      const double sum =
          w.behind ? w.late - integral : positive_part(w.incident) + integral;
      return inward(-stress_ / bar_.impedance() * sum);
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      const Waves w = waves(x, t);
      const double decay = w.arrived ? std::exp(-w.late / tau_) : 0.;
      const double sum = w.behind ? (w.arrived ? 1. - decay : 0.)
                                  : heaviside(w.incident) + decay;
      return inward(-stress_ / bar_.impedance() * sum);
    }

    std::array<double, 6> stress(const Vector &x, const double t) const override
    {
      const Waves w = waves(x, t);
      const double decay = w.arrived ? std::exp(-w.late / tau_) : 0.;
      std::array<double, 6> sigma{};
      sigma[normal_.axis] =
          stress_ * (w.behind ? (w.arrived ? 1. - decay : 0.)
                              : heaviside(w.incident) - decay);
      return sigma;
    }

    /** The jump comes from the energy K [u]^2/2 that the interface stores. */
    void observe(const StepView &view) override
    {
      const double jump =
          std::sqrt(2. * view.row->energy.cohesive / (stiffness_ * area_));
      const double s = positive_part(view.time - half_ / bar_.speed);
      const double exact =
          std::abs(stress_) / stiffness_ * (1. - std::exp(-s / tau_));
      difference_ += view.time_step * (jump - exact) * (jump - exact);
      reference_ += view.time_step * exact * exact;
      last_difference_ = std::abs(jump - exact);
      last_exact_ = exact;
    }

    /** Transmitted stress: K times the jump, L2 in time and at the end. */
    void finish(std::map<std::string, double> &errors) const override
    {
      if (reference_ == 0.)
        return;
      errors["transmitted"] = std::sqrt(difference_ / reference_);
      errors["transmitted_end"] = last_difference_ / last_exact_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", difference_, reference_, last_difference_,
                      last_exact_);
    }

  private:
    Bar bar_;
    Direction normal_;
    double end_ = 0., half_ = 0., stress_ = 0., stiffness_ = 0., area_ = 0.,
           tau_ = 0.;
    double difference_ = 0., reference_ = 0., last_difference_ = 0.,
           last_exact_ = 0.;

    struct Waves {
      bool behind;     // the interface, seen from the loaded end
      double incident; // time since the incident front has passed
      double late;     // since the reflected or transmitted one has, >= 0
      bool arrived;
    };

    Waves waves(const Vector &x, const double t) const
    {
      const double distance = normal_.sign * (end_ - x[normal_.axis]);
      const double way = std::abs(distance - half_);
      const double late = t - (half_ + way) / bar_.speed;
      return {distance > half_, t - distance / bar_.speed, positive_part(late),
              late >= 0.};
    }

    Vector inward(const double value) const
    {
      Vector result{};
      result[normal_.axis] = -normal_.sign * value;
      return result;
    }
  };

  NSFD_REGISTER(VerificationRegistry, InterfaceStep, "interface step",
                "Step of tension meets an elastic interface in a bar: fields, "
                "transmitted stress");
} // namespace nsfd
