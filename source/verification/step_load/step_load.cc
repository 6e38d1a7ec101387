#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Block on a cohesive interface under a dead load F that acts from t = 0 on
   * one side. By the energy balance it fails if and only if
   *
   *   F / (A R_max) >= max over x of W(x) / (R_max x),
   *
   * W the area under the law: 0.6893021 for michel-suquet, 0.7760314 for
   * tvergaard, 1 for the linear extrinsic law. The entry `fails` says what is
   * expected.
   */
  class StepLoad final : public VerificationCase
  {
  public:
    explicit StepLoad(SectionReader &reader)
        : fails_(reader.boolean("fails", true,
                                "true if the load must break the interface"))
    {
    }

    void initialise(const SceneInput &input) override
    {
      const LoadedSide side = loaded_side(input);
      axis_ = side.normal.axis;
      area_ = cross_section(input, axis_);
      const CohesiveLaw &law = *cohesive_interface(input).law;
      opening_scale_ = std::isfinite(law.final_opening()) ? law.final_opening()
                                                          : law.peak_opening();
      threshold_ = side.tension(0.) / largest_mean_traction(law);
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      broken_ = view.row->broken_area / area_;
      double lowest = 0., highest = 0.;
      for (std::size_t i = 0; i < view.cells->size(); ++i) {
        const double u = (*view.cells)[i].displacement[axis_];
        lowest = i == 0 ? u : std::min(lowest, u);
        highest = i == 0 ? u : std::max(highest, u);
      }
      opening_ = std::max(opening_, highest - lowest);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const bool failed = broken_ > 1. - 1e-9;
      errors["failed"] = failed == fails_ ? 0. : 1.;
      errors["opening_max"] = opening_ / opening_scale_;
      errors["load_over_threshold"] = threshold_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", broken_, opening_);
    }

  private:
    bool fails_;
    unsigned int axis_ = 0;
    double area_ = 0., opening_scale_ = 0., threshold_ = 0.;
    double broken_ = 0., opening_ = 0.;

    /** max W(x)/x by golden section: it rises once and falls once. */
    static double largest_mean_traction(const CohesiveLaw &law)
    {
      const double ratio = 0.5 * (std::sqrt(5.) - 1.);
      double low = 0., high = std::isfinite(law.final_opening())
                                  ? law.final_opening()
                                  : 100. * law.toughness() / law.strength();
      const auto mean_traction = [&](const double x) {
        return law.energy(x) / x;
      };
      for (unsigned int i = 0; i < 100; ++i) {
        const double a = high - ratio * (high - low),
                     b = low + ratio * (high - low);
        (mean_traction(a) < mean_traction(b) ? low : high) =
            mean_traction(a) < mean_traction(b) ? a : b;
      }
      return mean_traction(0.5 * (low + high));
    }
  };

  NSFD_REGISTER(VerificationRegistry, StepLoad, "step load",
                "Block under a sudden dead load: does the interface fail?");
} // namespace nsfd
