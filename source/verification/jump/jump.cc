#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A bar of stiffness k = E/L with one cohesive interface, pulled so slowly
   * that it is in equilibrium until there is none (39)-(42): the grip is at
   *
   *   U(u) = u + T(u)/k
   *
   * for an opening u. If U falls somewhere, max |T'| > k, the interface jumps
   * at the first maximum U_a = U(u_a) to u_b = U_a (broken), and the energy
   *
   *   T(u_a)^2 / (2 k) - (I(u_b) - I(u_a)),        I the area under T,
   *
   * is released. In dynamics it is the kinetic and elastic energy of the bar
   * right after. Without a jump nothing is left.
   *
   * Measured when the interface is broken: the displacement of the grip, over
   * U_a, and the mechanical energy, over the toughness. With quasi-static steps
   * that energy is what the last step counts as numerical, and before it every
   * force of the grip is T(u) with U(u) = U.
   */
  class Jump final : public VerificationCase
  {
  public:
    explicit Jump(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const double k = bar_of(input).young / extent(input, 0);
      area_ = cross_section(input, 0);
      const CohesiveLaw &law = *cohesive_interface(input).law;
      demand(std::isfinite(law.final_opening()), "the law needs an end");
      if (input.statics && input.statics->steps)
        law_ = cohesive_interface(input).law;
      stiffness_ = k;
      n_components_ = input.dimension;
      find_jump(law, k);
      toughness_ = law.toughness();
      scale_ = law.strength() / k;
      for (const BoundaryInput &boundary : input.boundaries)
        if (boundary.name == "right" && boundary.displacement[0])
          grip_ = *boundary.displacement[0];
        else
          demand(boundary.name == "left", "only `left` and `right` are held");
      x_ = input.mesh.upper[0];
      demand(grip_(x_, 0., 0., input.time.end) > grip_at_jump_,
             "the grip must move on until the interface breaks");
    }

    void observe(const StepView &view) override
    {
      if (grip_at_break_ > 0.)
        return;
      const bool broken = view.row->broken_area >= (1. - 1e-9) * area_;
      if (law_ && !broken)
        compare_force(*view.row, view.time);
      if (broken) {
        grip_at_break_ = grip_(x_, 0., 0., view.time);
        released_ = (law_ ? view.row->energy.numerical - numerical_
                          : mechanical_energy(*view.row)) /
                    area_;
      }
      numerical_ = view.row->energy.numerical;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["broken"] = grip_at_break_ > 0. ? 0. : 1.;
      errors["grip"] = relative_error(grip_at_break_, grip_at_jump_);
      errors["excess"] = std::abs(released_ - excess_) / toughness_;
      if (law_)
        errors["force"] = force_;
      errors["exact_grip_over_R_k"] = grip_at_jump_ / scale_;
      errors["exact_excess_over_G"] = excess_ / toughness_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", grip_at_break_, released_, numerical_, force_);
    }

  private:
    Expression grip_;
    double x_ = 0., area_ = 0., toughness_ = 0., scale_ = 0.;
    double grip_at_jump_ = 0., excess_ = 0.;
    double grip_at_break_ = 0., released_ = 0.;
    std::shared_ptr<const CohesiveLaw> law_; // with quasi-static steps
    double stiffness_ = 0., u_at_jump_ = 0., numerical_ = 0., force_ = 0.;
    unsigned int n_components_ = 2;

    /** The grip pulls with A T(u), u on the first branch of U(u). */
    void compare_force(const HistoryRow &row, const double t)
    {
      const double U = grip_(x_, 0., 0., t);
      double low = 0., high = u_at_jump_;
      for (unsigned int m = 0; m < 200; ++m) {
        const double u = 0.5 * (low + high);
        (u + law_->traction(u) / stiffness_ < U ? low : high) = u;
      }
      const double u = 0.5 * (low + high);
      // an extrinsic law holds any traction up to its strength at u = 0
      const double T = law_->extrinsic() && stiffness_ * U < law_->strength()
                           ? stiffness_ * U
                           : law_->traction(u);
      const double measured = row.reactions[n_components_] / area_;
      force_ = std::max(force_, std::abs(measured - T) / law_->strength());
    }

    /** The first maximum of U(u): a scan, then golden section. */
    void find_jump(const CohesiveLaw &law, const double k)
    {
      const auto grip = [&](const double u) { return u + law.traction(u) / k; };
      const double end = law.final_opening();
      constexpr unsigned int n = 20000;
      unsigned int i = 0;
      while (i < n && grip(end * (i + 1) / n) >= grip(end * i / n))
        ++i;
      if (i == n) { // no jump
        grip_at_jump_ = u_at_jump_ = end;
        return;
      }
      const double ratio = 0.5 * (std::sqrt(5.) - 1.);
      double low = end * (i > 0 ? i - 1 : 0) / n, high = end * (i + 1) / n;
      for (unsigned int m = 0; m < 100; ++m) {
        const double a = high - ratio * (high - low),
                     b = low + ratio * (high - low);
        (grip(a) < grip(b) ? low : high) = grip(a) < grip(b) ? a : b;
      }
      const double u = i == 0 ? 0. : low, T = law.traction(u);
      u_at_jump_ = u;
      grip_at_jump_ = grip(u);
      demand(grip_at_jump_ >= end, "the jump must break the interface");
      excess_ = T * T / (2. * k) - (law.toughness() - law.energy(u));
    }
  };

  NSFD_REGISTER(VerificationRegistry, Jump, "jump",
                "Bar pulled slowly until its interface snaps: grip, released "
                "energy");
} // namespace nsfd
