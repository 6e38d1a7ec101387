#include "inelastic_model.h"

#include "initial_state.h"
#include "point_name.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  InelasticModel<dim>::InelasticModel(const StepParts<dim> &parts,
                                      InelasticBodies<dim> &bodies)
      : parts_(parts), bodies_(bodies)
  {
  }

  template <int dim>
  State InelasticModel<dim>::initial_state() const
  {
    State state =
        nsfd::initial_state<dim>(parts_.input, parts_.discretization,
                                 parts_.delassus, parts_.problem, nullptr);
    state.material_history = bodies_.begin_history();
    return state;
  }

  template <int dim>
  void InelasticModel<dim>::complete(State &state) const
  {
    set_energies(parts_.delassus, parts_.problem, state);
  }

  template <int dim>
  void InelasticModel<dim>::start(const State &old, const double h,
                                  const std::vector<double> &loads, State &next)
  {
    const double theta = parts_.input.time.theta;
    old_ = &old;
    time_step_ = h;
    bodies_.start(old, h, theta, loads);
    parts_.free_motion.set_pressure(old, old.time + theta * h, next.pressure);
    pressure_ = next.pressure;
    pressure_impulse_ = parts_.free_motion.pressure_impulse(pressure_, h);
  }

  template <int dim>
  bool InelasticModel<dim>::predict(const bool starts_cold,
                                    std::vector<double> &impulse)
  {
    impulse = old_->impulse;
    if (starts_cold)
      std::fill(impulse.begin(), impulse.end(), 0.);
    v_ = old_->velocity;
    linearise();
    parts_.free_motion.move(*old_, pressure_, parts_.problem, {});
    v_ = parts_.free_motion.velocity();
    parts_.delassus.add_velocity_change(impulse.data(), v_.data());
    bodies_.put_old_velocities(v_);
    if (!move(impulse, v_))
      return false;
    linearise();
    return true;
  }

  template <int dim>
  void InelasticModel<dim>::linearise()
  {
    auto &delassus = parts_.delassus;
    const double theta = parts_.input.time.theta;
    if (delassus.communicator().any(bodies_.set_tangents(v_)))
      delassus.renew(time_step_, theta);
    else
      delassus.reinit(time_step_, theta);
    parts_.step_problem.set(parts_.discretization.origins(), *old_, time_step_,
                            parts_.problem);
  }

  template <int dim>
  bool InelasticModel<dim>::move(const std::vector<double> &impulse,
                                 const std::vector<double> &v)
  {
    v_ = v_linear_ = v;
    std::vector<double> all(impulse), r(v.size());
    for (std::size_t k = 0; k < pressure_impulse_.size(); ++k)
      all[k] += pressure_impulse_[k];
    parts_.delassus.generalised_impulse(all.data(), r.data());
    return !parts_.delassus.communicator().any(!bodies_.move(r, v_));
  }

  template <int dim>
  double InelasticModel<dim>::error() const
  {
    std::vector<double> off(v_);
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] -= v_linear_[i];
    return kinetic_product(off);
  }

  /** That of the bodies, in place of that of their tangents. */
  template <int dim>
  void InelasticModel<dim>::finish(const LawEvaluation<dim> &evaluation,
                                   State &next) const
  {
    const auto &problem = parts_.problem;
    const double h = problem.time_step, theta = problem.theta;
    next.relative_velocity =
        solved_velocity<dim>(problem, evaluation, next.impulse);
    next.jump.resize(next.relative_velocity.size());
    std::vector<double> off(v_), U(next.jump.size());
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] -= v_linear_[i];
    parts_.delassus.relative_velocity(off.data(), U.data());
    for (std::size_t k = 0; k < U.size(); ++k) {
      next.jump[k] =
          problem.jump_free[k] + h * theta * next.relative_velocity[k];
      next.relative_velocity[k] += U[k];
      next.jump[k] += h * theta * U[k];
    }
    next.velocity = v_;
    next.displacement.resize(v_.size());
    for (std::size_t i = 0; i < v_.size(); ++i)
      next.displacement[i] =
          old_->displacement[i] +
          h * (theta * v_[i] + (1. - theta) * old_->velocity[i]);
  }

  template <int dim>
  BodyEnergies InelasticModel<dim>::account(State &next) const
  {
    return sum(parts_.delassus.communicator(), bodies_.account(next));
  }

  template <int dim>
  StepPoints<dim> InelasticModel<dim>::points()
  {
    return {parts_.problem, parts_.discretization.origins(), *old_};
  }

  template <int dim>
  std::vector<double>
  InelasticModel<dim>::free_velocity(const std::vector<double> &impulse) const
  {
    std::vector<double> less(impulse), v(v_);
    for (double &P : less)
      P = -P;
    parts_.delassus.add_velocity_change(less.data(), v.data());
    return v;
  }

  template <int dim>
  void InelasticModel<dim>::relative_velocity(const std::vector<double> &v,
                                              std::vector<double> &U) const
  {
    parts_.delassus.relative_velocity(v.data(), U.data());
  }

  template <int dim>
  double
  InelasticModel<dim>::kinetic_product(const std::vector<double> &v) const
  {
    std::vector<double> product(v.size());
    parts_.delassus.apply(DelassusOperator<dim>::Operator::mass, v.data(),
                          product.data());
    return parts_.delassus.communicator().dot(v.data(), product.data(),
                                              v.size());
  }

  template <int dim>
  std::string InelasticModel<dim>::describe(const std::size_t i) const
  {
    return name_of_point<dim>(parts_.input, parts_.discretization.origins(),
                              parts_.discretization.points().position, i);
  }

  template class InelasticModel<2>;
  template class InelasticModel<3>;
} // namespace nsfd
