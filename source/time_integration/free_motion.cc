#include "free_motion.h"

#include "crack_pressure.h"

#include "delassus/velocity_solver.h"
#include "discretization/loads.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  FreeMotion<dim>::FreeMotion(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              DelassusOperator<dim> &delassus)
      : input_(input), discretization_(discretization), delassus_(delassus),
        crack_pressure_(CrackPressure<dim>::make(input, discretization)),
        loads_(discretization.bodies().n_dofs(), 0.)
  {
  }

  template <int dim>
  FreeMotion<dim>::~FreeMotion() = default;

  template <int dim>
  bool FreeMotion<dim>::set_loads(const double time, const LoadClock &clock)
  {
    if (!discretization_.loads().any())
      return false;
    if (loads_known_ &&
        (!discretization_.loads().depend_on_time() ||
         (loads_time_ == time && loads_clock_.stopped == clock.stopped)))
      return false;
    std::fill(loads_.begin(), loads_.end(), 0.);
    discretization_.add_loads(time, loads_, clock);
    loads_known_ = true;
    loads_time_ = time;
    loads_clock_ = clock;
    return true;
  }

  template <int dim>
  void FreeMotion<dim>::set_pressure(const State &old, const double time,
                                     std::vector<double> &pressure) const
  {
    if (crack_pressure_)
      crack_pressure_->evaluate(old, time, pressure);
  }

  template <int dim>
  std::vector<double>
  FreeMotion<dim>::pressure_impulse(const std::vector<double> &pressure,
                                    const double h) const
  {
    return crack_pressure_ ? crack_pressure_->impulse(pressure, h)
                           : std::vector<double>();
  }

  template <int dim>
  void FreeMotion<dim>::move(const State &old,
                             const std::vector<double> &pressure,
                             OneStepProblem<dim> &problem,
                             const std::vector<double> &impulse,
                             const std::vector<double> *const elastic)
  {
    const double h = problem.time_step, theta = input_.time.theta;
    const std::size_t n_dofs = old.velocity.size();
    work_.resize(n_dofs);
    velocity_.resize(n_dofs);
    if (elastic)
      work_ = *elastic;
    else {
      for (std::size_t i = 0; i < n_dofs; ++i)
        velocity_[i] = old.displacement[i] + h * theta * old.velocity[i];
      delassus_.apply(DelassusOperator<dim>::Operator::stiffness,
                      velocity_.data(), work_.data());
    }
    for (std::size_t i = 0; i < n_dofs; ++i)
      work_[i] = h * (loads_[i] - work_[i]);
    if (delassus_.terms().viscous_theta > 0.) {
      delassus_.apply(DelassusOperator<dim>::Operator::damping,
                      old.velocity.data(), velocity_.data());
      for (std::size_t i = 0; i < n_dofs; ++i)
        work_[i] -= h * velocity_[i];
    }
    if (auto *const bodies = dynamic_cast<VelocitySolver *>(&delassus_))
      return move_nodes(old, pressure, impulse, bodies->motion(), problem);
    delassus_.apply(DelassusOperator<dim>::Operator::inverse, work_.data(),
                    velocity_.data());
    for (std::size_t i = 0; i < n_dofs; ++i)
      velocity_[i] += old.velocity[i];
    if (crack_pressure_)
      delassus_.add_velocity_change(
          crack_pressure_->impulse(pressure, h).data(), velocity_.data());
    delassus_.jumps(velocity_.data(), problem.free_velocity.data());
    delassus_.set_free_velocity(&velocity_);
  }

  /**
   * Of bodies that share nodes the start of their motion under @p impulse: what
   * iterations leave is made good by those of the step, and U_free is not
   * needed.
   */
  template <int dim>
  void FreeMotion<dim>::move_nodes(const State &old,
                                   const std::vector<double> &pressure,
                                   const std::vector<double> &impulse,
                                   NodeMotion &motion,
                                   OneStepProblem<dim> &problem)
  {
    std::vector<double> start(problem.free_velocity.size());
    delassus_.jumps(old.velocity.data(), start.data());
    motion.start(work_, pressure_impulse(pressure, problem.time_step), start);
    motion.balance(impulse, NodeMotion::rough);
    velocity_ = old.velocity;
    motion.add_to(velocity_);
    problem.free_motion = FreeVelocity::estimated;
  }

  template <int dim>
  bool FreeMotion<dim>::find(const State &old, OneStepProblem<dim> &problem)
  {
    if (problem.free_motion == FreeVelocity::known)
      return false;
    auto &motion = dynamic_cast<VelocitySolver &>(delassus_).motion();
    motion.balance(std::vector<double>(problem.free_velocity.size(), 0.), 0.);
    velocity_ = old.velocity;
    motion.add_to(velocity_);
    delassus_.jumps(velocity_.data(), problem.free_velocity.data());
    motion.cancel();
    problem.free_motion = FreeVelocity::known;
    return true;
  }

  template <int dim>
  void FreeMotion<dim>::estimate(const std::vector<double> &U,
                                 const std::vector<double> &P,
                                 OneStepProblem<dim> &problem) const
  {
    if (problem.free_motion != FreeVelocity::estimated)
      return;
    delassus_.apply_delassus(P.data(), problem.free_velocity.data());
    for (std::size_t k = 0; k < U.size(); ++k)
      problem.free_velocity[k] = U[k] - problem.free_velocity[k];
  }

  template <int dim>
  void FreeMotion<dim>::finish(const std::vector<double> &impulse,
                               const State &old, State &next) const
  {
    auto *const bodies = dynamic_cast<VelocitySolver *>(&delassus_);
    if (bodies && bodies->motion().is_on()) {
      next.velocity = old.velocity;
      bodies->motion().add_to(next.velocity);
    } else {
      next.velocity = velocity_;
      delassus_.add_velocity_change(impulse.data(), next.velocity.data());
    }
  }

  template <int dim>
  double FreeMotion<dim>::kinetic_product()
  {
    delassus_.apply(DelassusOperator<dim>::Operator::mass, velocity_.data(),
                    work_.data());
    return delassus_.communicator().dot(velocity_.data(), work_.data(),
                                        velocity_.size());
  }

  template class FreeMotion<2>;
  template class FreeMotion<3>;
} // namespace nsfd
