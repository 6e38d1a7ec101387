#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Two bodies whose common face is pulled open at the constant speed v: until
   * it is broken at Delta the pull is T(d) + eta v, and its whole work per area
   * is G + eta v Delta. The largest pull is eta v above the peak of the law.
   *
   * Viscosity acts on points that are not broken when a step begins: the step
   * in which they break counts as a whole, at most eta v times v h too much.
   */
  class OpeningViscosity final : public VerificationCase
  {
  public:
    explicit OpeningViscosity(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      const InterfaceInput &face = cohesive_interface(input);
      law_ = face.law;
      demand(std::isfinite(law_->final_opening()), "the law needs an end");
      demand(input.boundaries.size() == 2 && input.boundaries[0].velocity[0] &&
                 input.boundaries[1].velocity[0],
             "two boundaries must have a velocity x");
      double speeds[2];
      for (unsigned int b = 0; b < 2; ++b)
        speeds[b] = (*input.boundaries[b].velocity[0])(0., 0., 0.);
      speed_ = std::abs(speeds[1] - speeds[0]);
      drag_ = face.opening_viscosity * speed_;
      area_ = cross_section(input, 0);
      demand(speed_ * input.time.end > law_->final_opening(),
             "the run ends before the face is broken");
    }

    void observe(const StepView &view) override
    {
      const HistoryRow &row = *view.row;
      step_ = std::max(step_, view.time_step);
      work_ = row.energy.work / area_;
      damage_ = row.energy.damage / area_;
      viscous_ = row.energy.viscous / area_;
      for (std::size_t i = 0; i < row.reactions.size(); i += 2)
        pull_ = std::max(pull_, std::abs(row.reactions[i]) / area_);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const double G = law_->toughness(),
                   viscous = drag_ * law_->final_opening();
      errors["work"] = relative_error(work_, G + viscous);
      errors["damage"] = relative_error(damage_, G);
      errors["viscous"] = relative_error(viscous_, viscous);
      errors["last_step"] = speed_ * step_ / law_->final_opening();
      errors["peak"] = relative_error(pull_, law_->strength() + drag_);
      errors["exact_work_over_G"] = 1. + viscous / G;
      errors["exact_peak_over_R"] = 1. + drag_ / law_->strength();
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", step_, work_, damage_, viscous_, pull_);
    }

  private:
    std::shared_ptr<const CohesiveLaw> law_;
    double speed_ = 0., drag_ = 0., area_ = 0., step_ = 0.;
    double work_ = 0., damage_ = 0., viscous_ = 0., pull_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, OpeningViscosity, "opening viscosity",
                "Face pulled open at constant speed against viscosity: work, "
                "peak");
} // namespace nsfd
