#include "inelastic_motion.h"

#include "common_books.h"
#include "crack_pressure.h"
#include "driven_motion.h"
#include "energy_safe_sliding.h"
#include "ledger.h"
#include "save_problem.h"
#include "step_data.h"
#include "uniqueness.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int most_iterations = 40;
  } // namespace

  template <int dim>
  InelasticMotion<dim>::InelasticMotion(
      const SceneInput &input, const Discretization<dim> &discretization,
      InelasticBodies<dim> &bodies, Dynamics<dim> &dynamics,
      NonsmoothSolver<dim> &solver)
      : MoreauJean<dim>(input, discretization, dynamics, solver),
        bodies_(bodies)
  {
  }

  template <int dim>
  State InelasticMotion<dim>::initial_state() const
  {
    State state = MoreauJean<dim>::initial_state();
    state.material_history = bodies_.begin_history();
    return state;
  }

  /** From velocities near @p v, which are right for linear bodies. */
  template <int dim>
  bool InelasticMotion<dim>::move_bodies(const std::vector<double> &impulse,
                                         std::vector<double> &v)
  {
    std::vector<double> all(impulse), r(v.size());
    for (std::size_t k = 0; k < crack_impulse_.size(); ++k)
      all[k] += crack_impulse_[k];
    this->dynamics_.generalised_impulse(all.data(), r.data());
    return !this->dynamics_.communicator().any(!bodies_.move(r, v));
  }

  /** v.M v. */
  template <int dim>
  double
  InelasticMotion<dim>::kinetic_product(const std::vector<double> &v) const
  {
    std::vector<double> product(v.size());
    this->dynamics_.apply(Dynamics<dim>::Operator::mass, v.data(),
                          product.data());
    return this->dynamics_.communicator().dot(v.data(), product.data(),
                                              v.size());
  }

  /** Tangents at the motion at hand, and the data of the points with them. */
  template <int dim>
  void InelasticMotion<dim>::linearise(const State &old, const double h)
  {
    const double theta = this->input_.time.theta;
    if (this->dynamics_.communicator().any(bodies_.set_tangents(v_)))
      this->dynamics_.renew(h, theta);
    else
      this->dynamics_.reinit(h, theta);
    this->set_problem_of_step(this->discretization_.origins(), old, h,
                              this->problem_);
  }

  /** Under the impulses of the last step. */
  template <int dim>
  bool InelasticMotion<dim>::begin(const State &old, const double h,
                                   const State &next)
  {
    v_ = old.velocity;
    linearise(old, h);
    this->move_freely(old, next.pressure);
    v_ = this->v_free_;
    this->dynamics_.add_velocity_change(next.impulse.data(), v_.data());
    bodies_.put_old_velocities(v_);
    return move_bodies(next.impulse, v_);
  }

  template <int dim>
  SolverReport
  InelasticMotion<dim>::iterate(const State &old, const double h,
                                const SolverControl &control, State &next,
                                std::unique_ptr<LawEvaluation<dim>> &evaluation)
  {
    auto &dynamics = this->dynamics_;
    const double rest = std::max(0.1 * control.tolerance, 1e-13);
    const auto lost = [&] {
      return StepRejected(fmt::format(
          "a body has no motion in the step of {:.4g} at t = {:.6g}: its "
          "material finds no stress",
          h, old.time));
    };
    SolverReport total;
    std::vector<double> difference;
    for (unsigned int round = 0;; ++round) {
      if (round == 0 && !begin(old, h, next))
        throw lost();
      linearise(old, h);
      this->v_free_ = v_;
      std::vector<double> less(next.impulse);
      for (double &P : less)
        P = -P;
      dynamics.add_velocity_change(less.data(), this->v_free_.data());
      dynamics.relative_velocity(this->v_free_.data(),
                                 this->problem_.free_velocity.data());
      dynamics.set_free_velocity(&this->v_free_);
      if (round == 0)
        energy_scale_ =
            2. * old.energy.kinetic + kinetic_product(this->v_free_);
      evaluation = std::make_unique<LawEvaluation<dim>>(
          this->problem_, dynamics, energy_scale_, control.tolerance);
      // factors are those of one round
      const auto solver = SolverRegistry<dim>::instance().create(
          this->input_.solver.method == "auto" ? "chain"
                                               : this->input_.solver.method);
      const SolverReport part =
          this->solve(*solver, this->problem_, this->discretization_.origins(),
                      control, energy_scale_, old, next.impulse, *evaluation);
      total.go_on_with(part);
      if (!part.converged)
        return total;
      v_linear_ = this->v_free_;
      dynamics.add_velocity_change(next.impulse.data(), v_linear_.data());
      v_ = v_linear_;
      if (!move_bodies(next.impulse, v_))
        throw lost();
      if (energy_scale_ == 0.) // all at rest, and something pulls
        energy_scale_ = kinetic_product(v_);
      difference.resize(v_.size());
      for (std::size_t k = 0; k < v_.size(); ++k)
        difference[k] = v_[k] - v_linear_[k];
      const double change = kinetic_product(difference);
      ++motion_counters_.iterations;
      motion_counters_.most_iterations = std::max<unsigned long long>(
          motion_counters_.most_iterations, round + 1);
      if (change <= rest * rest * energy_scale_)
        return total;
      if (round == most_iterations || !std::isfinite(change))
        throw StepRejected(fmt::format(
            "the flow of the step of {:.4g} at t = {:.6g} did not come to "
            "rest: velocities are off by {:.1e} of all after {} iterations",
            h, old.time, std::sqrt(change / energy_scale_), round + 1));
    }
  }

  /** That of the bodies, in place of that of their tangents. */
  template <int dim>
  void InelasticMotion<dim>::correct_motion(const State &old, State &next) const
  {
    const double h = this->problem_.time_step, theta = this->problem_.theta;
    std::vector<double> off(v_), U(next.relative_velocity.size());
    for (std::size_t i = 0; i < v_.size(); ++i)
      off[i] -= v_linear_[i];
    this->dynamics_.relative_velocity(off.data(), U.data());
    for (std::size_t k = 0; k < U.size(); ++k) {
      next.relative_velocity[k] += U[k];
      next.jump[k] += h * theta * U[k];
    }
    next.velocity = v_;
    for (std::size_t i = 0; i < v_.size(); ++i)
      next.displacement[i] =
          old.displacement[i] +
          h * (theta * v_[i] + (1. - theta) * old.velocity[i]);
  }

  template <int dim>
  StepReport InelasticMotion<dim>::advance(const State &old, const double h,
                                           State &next,
                                           const unsigned int idle_rounds)
  {
    const double theta = this->input_.time.theta;
    {
      const Stopwatch watch(this->timings_.assembly);
      const Charge charge(Cost::free_motion);
      this->set_loads(old.time + theta * h);
      this->sliding_->begin();
      bodies_.start(old, h, theta, this->forces_);
      crack_impulse_.clear();
      if (this->crack_pressure_) {
        this->crack_pressure_->evaluate(old, old.time + theta * h,
                                        next.pressure);
        crack_impulse_ = this->crack_pressure_->impulse(next.pressure, h);
      }
      next.impulse = old.impulse;
      if (this->starts_cold_)
        std::fill(next.impulse.begin(), next.impulse.end(), 0.);
    }
    StepReport report;
    std::unique_ptr<LawEvaluation<dim>> evaluation;
    {
      const Stopwatch watch(this->timings_.solve);
      const Charge charge(Cost::solver);
      report.solver =
          iterate(old, h, this->solver_control(idle_rounds), next, evaluation);
    }
    save_problem<dim>(this->input_, this->problem_, this->dynamics_,
                      *evaluation, report.solver, old.step + 1, old.time);
    if (!report.solver.converged)
      this->reject(h, old.time, report.solver, evaluation->worst_point);
    const Stopwatch watch(this->timings_.ledger);
    const Charge charge(Cost::ledger);
    this->move(old, *evaluation, next);
    correct_motion(old, next);
    this->ledger_->book(this->problem_, *evaluation,
                        this->discretization_.origins(),
                        sum(this->dynamics_.communicator(), bodies_.book(next)),
                        old, next, report);
    this->check_books(h, old.time, energy_scale_, next, report,
                      evaluation->worst_point);
    this->watch_energy(energy_scale_, old, next, report);
    relate_defect(energy_scale_, next, report);
    return report;
  }

  template class InelasticMotion<2>;
  template class InelasticMotion<3>;
} // namespace nsfd
