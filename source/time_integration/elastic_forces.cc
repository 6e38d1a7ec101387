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
  void ElasticForces<dim>::start(const State &old, const bool bonds_changed)
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
  }

  template <int dim>
  void ElasticForces<dim>::finish(const State &next)
  {
    evaluate(next, end_);
  }

  template <int dim>
  void ElasticForces<dim>::evaluate(const State &state, Known &result) const
  {
    result.force.resize(state.displacement.size());
    delassus_.apply(DelassusOperator<dim>::Operator::stiffness,
                    state.displacement.data(), result.force.data());
    result.known = true;
    result.step = state.step;
    result.time = state.time;
  }

  template class ElasticForces<2>;
  template class ElasticForces<3>;
} // namespace nsfd
