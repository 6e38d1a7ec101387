#include "step_rule.h"

#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace nsfd
{
  /**
   * `step = auto`: a step where points soften has one solution up to some
   * length, section 7 of doc/theory.md. Down the step levels at once, up one
   * level per step; a step that is too long for points that came to soften in
   * it is repeated, with shorter ones to its end.
   */
  class UniqueSolutionRule final : public StepRule
  {
  public:
    unsigned int place() const override { return 0; }

    bool applies(const TimeInput &time) const override
    {
      return time.step_kind == StepKind::automatic;
    }

    std::optional<double> longest(const PresentStep &view) const override
    {
      return view.limits.automatic_step(view.state, view.control.base_step());
    }

    std::optional<ShorterStep> repeat(const PresentStep &view,
                                      const StepReport &report,
                                      const State &next) const override
    {
      if (!report.beyond_unique)
        return std::nullopt;
      const double unique = view.limits.unique_step(view.state, next);
      if (view.control.step() < unique)
        return std::nullopt; // by laws alone that no step is short enough for
      return ShorterStep{StepLimits::bound_share * unique, true};
    }
  };

  /**
   * A bonded point that went too far beyond its strength: the energy that it
   * misses is of the order of the square of the overshoot. The step is taken
   * again, to where the first of these points reaches its strength; three
   * levels down the step levels a front is steeper than the mesh resolves.
   */
  class OvershootRule final : public StepRule
  {
  public:
    unsigned int place() const override { return 1; }

    void read(SectionReader &reader, SceneInput &scene) const override
    {
      const std::string name = "largest overshoot";
      const auto breaks = [](const InterfaceInput &block) {
        return block.law && block.intact == IntactFaces::bonded;
      };
      if (std::none_of(scene.interfaces.begin(), scene.interfaces.end(),
                       breaks))
        return reader.refuse({name},
                             "there are no bonded faces that may break");
      // the fastest modes take energy from every change of an explicit step
      if (scene.time.scheme.explicit_forces)
        return reader.refuse({name}, "explicit steps are not bisected for it");
      scene.time.largest_overshoot = reader.number(
          name, "0.05", units::none, Range::positive(),
          "of a bonded point over its strength; beyond it the step is "
          "rejected and bisected");
    }

    bool applies(const TimeInput &time) const override
    {
      return std::isfinite(time.largest_overshoot);
    }

    std::optional<ShorterStep> repeat(const PresentStep &view,
                                      const StepReport &report,
                                      const State &) const override
    {
      if (report.overshoot <= view.time.largest_overshoot ||
          view.control.level() >= 3)
        return std::nullopt;
      return ShorterStep{std::clamp(report.share, 0.125, 0.5) *
                         view.control.step()};
    }
  };

  NSFD_REGISTER(StepRuleRegistry, UniqueSolutionRule, "unique solution",
                "step = auto: as long as a step with softening points has one "
                "solution");
  NSFD_REGISTER(StepRuleRegistry, OvershootRule, "overshoot",
                "steps end where a bonded point reaches its strength");

  StepRules all_step_rules()
  {
    const auto &registry = StepRuleRegistry::instance();
    StepRules rules; // by their names
    for (const std::string &name : registry.names())
      rules.push_back(registry.create(name));
    std::stable_sort(
        rules.begin(), rules.end(),
        [](const auto &a, const auto &b) { return a->place() < b->place(); });
    return rules;
  }

  StepRules step_rules(const TimeInput &time)
  {
    StepRules rules = all_step_rules();
    rules.erase(std::remove_if(
                    rules.begin(), rules.end(),
                    [&time](const auto &rule) { return !rule->applies(time); }),
                rules.end());
    return rules;
  }
} // namespace nsfd
