#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"
#include "parameters/parameter_file.h"

#include <algorithm>
#include <fmt/format.h>

namespace nsfd
{
  using namespace cases;

  /**
   * A body pulled apart at speed along one plane that may break: the
   * separation takes the toughness times the area of the plane, at every step
   * and on every mesh. Besides the dissipation the case reports when the
   * plane has separated and how strongly the side `right` was pulled.
   */
  class Midplane final : public VerificationCase
  {
  public:
    explicit Midplane(SectionReader &reader)
    {
      const std::string text = "of the separation, J/m in two dimensions; "
                               "default toughness times cross-section";
      if (reader.optional("exact dissipation", text))
        exact_ = reader.number("exact dissipation", "", energy_per_depth,
                               Range::positive(), text);
      const std::string times = "at which the force on `right` is reported";
      if (reader.optional("force times", times))
        if (const auto list =
                reader.raw("force times", "", times, "1 ns, 2 ns"))
          read_times(reader, *list);
    }

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      if (exact_ == 0.)
        exact_ = cohesive_interface(input).law->toughness() *
                 cross_section(input, 0);
      unsigned int n_driven = 0;
      bool found = false;
      for (const BoundaryInput &boundary : input.boundaries) {
        bool is_driven = false;
        for (unsigned int c = 0; c < input.dimension; ++c)
          is_driven |= boundary.velocity[c].has_value() ||
                       boundary.displacement[c].has_value();
        if (is_driven && boundary.name == "right") {
          reaction_ = n_driven * input.dimension;
          found = true;
        }
        n_driven += is_driven;
      }
      demand(found, "the case needs a driven boundary `right`");
    }

    void observe(const StepView &view) override
    {
      const double damage = view.row->energy.damage, h = view.time_step;
      // 1e-6 below the end: the round-off of the sum over the faces
      const double separated = (1. - 1e-6) * exact_;
      if (separation_time_ < 0. && damage >= separated) {
        const double gain = damage - damage_;
        separation_time_ =
            view.time - (gain > 0. ? h * (damage - separated) / gain : 0.);
      }
      if (view.row->step > 0) {
        const double force = view.row->reactions[reaction_];
        if (damage_ < separated)
          peak_force_ = std::max(peak_force_, std::abs(force));
        // the reaction is the mean over the step
        const double middle = view.time - 0.5 * h;
        for (std::size_t i = 0; i < times_.size(); ++i)
          if (times_[i] > old_middle_ && times_[i] <= middle)
            forces_[i] = old_force_ + (force - old_force_) *
                                          (times_[i] - old_middle_) /
                                          (middle - old_middle_);
        old_force_ = force;
        old_middle_ = middle;
      }
      damage_ = damage;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["damage"] = relative_error(damage_, exact_);
      errors["peak_force"] = peak_force_;
      if (separation_time_ >= 0.)
        errors["separation_time"] = separation_time_;
      for (std::size_t i = 0; i < times_.size(); ++i)
        if (times_[i] <= old_middle_)
          errors[fmt::format("force_{}", i + 1)] = forces_[i];
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", damage_, separation_time_, peak_force_,
                      old_force_, old_middle_);
      archive.common("forces", forces_);
    }

  private:
    static constexpr Unit energy_per_depth{1, 1, -2};
    double exact_ = 0.;
    std::size_t reaction_ = 0; // x component on `right`
    std::vector<double> times_, forces_;
    double damage_ = 0., separation_time_ = -1., peak_force_ = 0.;
    double old_force_ = 0., old_middle_ = 0.;

    void read_times(SectionReader &reader, const SourceText &list)
    {
      const std::string &text = list.text();
      for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        times_.push_back(reader.number_in(list.part(begin, end - begin),
                                          "force times", "1 ns", units::time,
                                          Range::positive()));
        begin = end + 1;
      }
      forces_.assign(times_.size(), 0.);
    }
  };

  NSFD_REGISTER(VerificationRegistry, Midplane, "midplane",
                "Separation of one plane: exact dissipation, force and time");
} // namespace nsfd
