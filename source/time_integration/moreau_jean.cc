#include "moreau_jean.h"

#include "energy_balance.h"
#include "step_data.h"
#include "uniqueness.h"

#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  template <int dim>
  MoreauJean<dim>::MoreauJean(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              DelassusOperator<dim> &delassus)
      : input_(input), discretization_(discretization), delassus_(delassus),
        problem_(constant_data(input, discretization)),
        uniqueness_(std::make_unique<UniquenessBound<dim>>(
            input, discretization.origins(), delassus)),
        balance_(std::make_unique<EnergyBalance<dim>>(input, discretization,
                                                      delassus, *uniqueness_)),
        free_motion_(input, discretization, delassus),
        step_problem_(input, discretization, delassus, counters_),
        check_(input, [this](const std::size_t i) { return describe(i); })
  {
    if (input.has_viscous_bodies() || input.has_absorbing_sides())
      delassus.set_terms({input.time.theta, delassus.terms().kept_step});
  }

  template <int dim>
  MoreauJean<dim>::~MoreauJean() = default;

  template <int dim>
  double MoreauJean<dim>::unique_step(const State &state) const
  {
    return uniqueness_->largest_step(problem_, state);
  }

  template <int dim>
  double MoreauJean<dim>::unique_step(const State &old, const State &next) const
  {
    return uniqueness_->largest_step(problem_, old, next);
  }

  template <int dim>
  double MoreauJean<dim>::automatic_step(const State &state,
                                         const double time_step) const
  {
    return uniqueness_->next_step(problem_, state, time_step,
                                  StepLimits::bound_share);
  }

  template <int dim>
  const std::vector<double> &MoreauJean<dim>::reactions() const
  {
    return balance_->reactions();
  }

  template <int dim>
  void MoreauJean<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    nsfd::fill_counters(counters_, c);
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  MoreauJean<dim>::stage_seconds() const
  {
    auto stages = nsfd::stage_seconds(timings_);
    if (input_.large_motion)
      stages.insert(stages.begin() + 1,
                    {"contact search", timings_.contact_search});
    return stages;
  }

  template class MoreauJean<2>;
  template class MoreauJean<3>;
} // namespace nsfd
