#include "elastic_forces.h"

#include <utility>

namespace nsfd
{
  template <int dim>
  ElasticForces<dim>::ElasticForces(const DelassusOperator<dim> &delassus)
      : delassus_(delassus)
  {
  }

  template <int dim>
  void ElasticForces<dim>::start(const State &old, const double h,
                                 const bool bonds_changed)
  {
    const auto is_of_old = [&](const Known &force) {
      return force.known && force.step == old.step && force.time == old.time;
    };
    if (bonds_changed)
      start_.known = end_.known = false;
    if (is_of_old(end_))
      std::swap(start_, end_);
    else if (!is_of_old(start_))
      evaluate(old, start_);
    end_.known = false;
    in_step_.resize(old.velocity.size());
    for (std::size_t i = 0; i < in_step_.size(); ++i)
      in_step_[i] = start_.of_displacement[i] + h / 2. * start_.of_velocity[i];
    const double kept = delassus_.terms().kept_step, before = old.kept_step;
    share_of_step_ = kept == before ? 0.
                                    : (kept - before) * (kept + before) / 8. *
                                          product(old.velocity, start_);
  }

  template <int dim>
  void ElasticForces<dim>::finish(const State &next)
  {
    evaluate(next, end_);
  }

  template <int dim>
  double ElasticForces<dim>::kinetic_share(const State &state) const
  {
    return state.kept_step * state.kept_step / 8. *
           product(state.velocity, end_);
  }

  template <int dim>
  void ElasticForces<dim>::evaluate(const State &state, Known &result) const
  {
    const auto apply = [&](const std::vector<double> &motion,
                           std::vector<double> &forces) {
      forces.resize(motion.size());
      delassus_.apply(DelassusOperator<dim>::Operator::stiffness, motion.data(),
                      forces.data());
    };
    apply(state.displacement, result.of_displacement);
    apply(state.velocity, result.of_velocity);
    result.known = true;
    result.step = state.step;
    result.time = state.time;
  }

  template <int dim>
  double ElasticForces<dim>::product(const std::vector<double> &velocity,
                                     const Known &forces) const
  {
    std::vector<double> terms(velocity.size());
    for (std::size_t i = 0; i < terms.size(); ++i)
      terms[i] = velocity[i] * forces.of_velocity[i];
    return delassus_.communicator().sum(terms);
  }

  template class ElasticForces<2>;
  template class ElasticForces<3>;
} // namespace nsfd
