#include "newton_moreau_jean.h"

#include "common_balance.h"
#include "energy_balance.h"
#include "inelastic_model.h"
#include "large_motion_model.h"
#include "save_problem.h"
#include "step_entry.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "nonsmooth/solver_name.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int most_iterations = 40;

    /** All bodies are rigid, and what they may touch stands still. */
    bool may_rest(const SceneInput &input)
    {
      return all_rigid(input) &&
             std::none_of(
                 input.obstacles.begin(), input.obstacles.end(),
                 [](const auto &obstacle) { return obstacle.moves(); });
    }
  } // namespace

  template <int dim>
  NewtonMoreauJean<dim>::NewtonMoreauJean(
      const SceneInput &input, const Discretization<dim> &discretization,
      MovingBodies<dim> &bodies, DelassusOperator<dim> &delassus)
      : MoreauJean<dim>(input, discretization, delassus),
        bodies_(std::make_unique<LargeMotionModel<dim>>(
            StepParts<dim>{input, discretization, delassus, this->problem_,
                           this->free_motion_, this->step_problem_,
                           this->timings_},
            bodies)),
        solver_name_(solver_name(input.solver.method, "frictional contact"))
  {
    only_rigid_ = all_rigid(input);
    if (!may_rest(input))
      return;
    this->step_problem_.let_stay(true);
    stay_ = [&bodies] { bodies.stay(); };
  }

  template <int dim>
  NewtonMoreauJean<dim>::NewtonMoreauJean(
      const SceneInput &input, const Discretization<dim> &discretization,
      InelasticBodies<dim> &bodies, DelassusOperator<dim> &delassus)
      : MoreauJean<dim>(input, discretization, delassus),
        bodies_(std::make_unique<InelasticModel<dim>>(
            StepParts<dim>{input, discretization, delassus, this->problem_,
                           this->free_motion_, this->step_problem_,
                           this->timings_},
            bodies)),
        solver_name_(solver_name(input.solver.method, "cascade"))
  {
  }

  template <int dim>
  NewtonMoreauJean<dim>::~NewtonMoreauJean() = default;

  template <int dim>
  State NewtonMoreauJean<dim>::initial_state() const
  {
    return bodies_->initial_state();
  }

  template <int dim>
  void NewtonMoreauJean<dim>::complete(State &state) const
  {
    bodies_->complete(state);
  }

  template <int dim>
  std::string NewtonMoreauJean<dim>::describe(const std::size_t i) const
  {
    return bodies_->describe(i);
  }

  template <int dim>
  SolverReport NewtonMoreauJean<dim>::iterate(
      const State &old, const double h, const SolverControl &control,
      std::unique_ptr<LawEvaluation<dim>> &evaluation)
  {
    auto &delassus = this->delassus_;
    const auto lost = [&] {
      return StepRejected(fmt::format(
          "a cell would be inverted in the step of {:.4g} at t = {:.6g}, or "
          "the stress of its material was not found",
          h, old.time));
    };
    SolverReport total;
    SolverControl present = control;
    present.row_energy = std::numeric_limits<double>::infinity();
    present.contact_energy = std::numeric_limits<double>::infinity();
    present.bodies_change = true;
    // what is left in a step of rigid bodies is there in all later ones
    if (only_rigid_)
      present.tolerance *= 0.1;
    bool last = false;
    for (unsigned int round = 0;; ++round) {
      if (round > 0)
        bodies_->linearise();
      else if (!bodies_->predict(this->check_.starts_cold(), impulse_))
        throw lost();
      // linear in what further impulses do
      v_free_ = bodies_->free_velocity(impulse_);
      const StepPoints<dim> points = bodies_->points();
      bodies_->relative_velocity(v_free_, points.problem.free_velocity);
      delassus.set_free_velocity(&v_free_);
      if (round == 0)
        energy_scale_ =
            2. * old.energy.kinetic + bodies_->kinetic_product(v_free_);
      evaluation = std::make_unique<LawEvaluation<dim>>(
          points.problem, delassus, energy_scale_, control.tolerance);
      // factors are those of one round
      const auto solver = SolverRegistry<dim>::instance().create(solver_name_);
      SolverReport part = this->step_problem_.solve(
          *solver, points.problem, points.origins, present, energy_scale_,
          points.old, impulse_, *evaluation);
      part.converged = part.converged || part.residual <= control.tolerance;
      total.go_on_with(part);
      if (!part.converged)
        return total;
      std::vector<double> v = v_free_;
      delassus.add_velocity_change(impulse_.data(), v.data());
      // a body that turns about its contact has no velocity there
      const double still = 0.1 * control.tolerance;
      if (part.rests && round == 0 &&
          bodies_->kinetic_product(v) <= still * still * energy_scale_) {
        stay_();
        return total;
      }
      if (!bodies_->move(impulse_, v))
        throw lost();
      if (!has_settled(old, h, control, round))
        continue;
      // contacts and rows need their last digits once, in the last round
      const auto &step = this->step_problem_;
      if (last || (!step.gives_by_contact(points.problem, control, points.old,
                                          impulse_, *evaluation) &&
                   !step.gives_by_rows(points.problem, control, energy_scale_,
                                       impulse_, *evaluation)))
        return total;
      last = true;
      present.contact_energy = control.contact_energy;
      present.row_energy = control.row_energy;
    }
  }

  /** Well within what the solver leaves, over the root of the energy. */
  template <int dim>
  bool NewtonMoreauJean<dim>::has_settled(const State &old, const double h,
                                          const SolverControl &control,
                                          const unsigned int round)
  {
    if (energy_scale_ == 0.) // all at rest, and something moves it
      energy_scale_ = bodies_->kinetic_product(bodies_->velocity());
    const double rest = std::max(0.1 * control.tolerance, 1e-13);
    const double error = bodies_->error();
    ++iterations_;
    most_iterations_ =
        std::max<unsigned long long>(most_iterations_, round + 1);
    if (error <= rest * rest * energy_scale_)
      return true;
    // a step that goes on so slowly is shorter work in two halves
    constexpr unsigned int patience = 8;
    if (round == 0)
      errors_.clear();
    errors_.push_back(error);
    const bool idles =
        round >= patience && !(error < 0.25 * errors_[round - patience]);
    if (round == most_iterations || idles || !std::isfinite(error))
      throw StepRejected(fmt::format(
          "the Newton iteration of the step of {:.4g} at t = {:.6g} did not "
          "converge: relative error {:.1e} after {} iterations",
          h, old.time, std::sqrt(error / energy_scale_), round + 1));
    return false;
  }

  template <int dim>
  StepReport NewtonMoreauJean<dim>::advance(const State &old, const double h,
                                            State &next,
                                            const unsigned int idle_rounds)
  {
    {
      const Stopwatch watch(this->timings_.assembly);
      const Charge charge(Cost::free_motion);
      if (this->free_motion_.set_loads(old.time + this->input_.time.theta * h,
                                       old.clock))
        ++this->counters_.load_assemblies;
      this->step_problem_.begin();
      bodies_->start(old, h, this->free_motion_.loads(), next);
    }
    StepReport report;
    std::unique_ptr<LawEvaluation<dim>> evaluation;
    {
      const Stopwatch watch(this->timings_.solve);
      const Charge charge(Cost::solver);
      report.solver = iterate(
          old, h, this->step_problem_.control(idle_rounds, h, old), evaluation);
    }
    const StepPoints<dim> points = bodies_->points();
    save_problem<dim>(this->input_, points.problem, this->delassus_,
                      *evaluation, report.solver, old.step + 1, old.time);
    this->check_.check_solution(h, old.time, report.solver,
                                evaluation->worst_point);
    const Stopwatch watch(this->timings_.ledger);
    const Charge charge(Cost::energy_balance);
    next.step = old.step + 1;
    next.time = old.time + h;
    next.last_step = h;
    next.impulse = impulse_;
    bodies_->finish(*evaluation, next);
    this->balance_->account(points.problem, *evaluation, points.origins,
                            bodies_->account(next), points.old, next, report);
    bodies_->account_rest(next, report);
    const TakenStep step{old, next, h, energy_scale_, evaluation->worst_point};
    this->check_.check_balance(step, report);
    this->check_.watch_energy(step, report);
    relate_defect(energy_scale_, next, report);
    bodies_->accept(next);
    return report;
  }

  template <int dim>
  void
  NewtonMoreauJean<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    MoreauJean<dim>::fill_counters(c);
    c["motion_iterations"] = double(iterations_);
    c["motion_iterations_most"] = double(most_iterations_);
    bodies_->fill_counters(c);
  }

  template class NewtonMoreauJean<2>;
  template class NewtonMoreauJean<3>;
} // namespace nsfd
