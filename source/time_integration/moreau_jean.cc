#include "moreau_jean.h"

#include "activation.h"
#include "bond_release.h"
#include "common_books.h"
#include "crack_pressure.h"
#include "driven_motion.h"
#include "elastic_forces.h"
#include "energy_safe_sliding.h"
#include "initial_state.h"
#include "ledger.h"
#include "nonsmooth/linear_spring.h"
#include "save_problem.h"
#include "step_data.h"
#include "uniqueness.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace nsfd
{
  template <int dim>
  MoreauJean<dim>::MoreauJean(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              Dynamics<dim> &dynamics,
                              NonsmoothSolver<dim> &solver,
                              BondedDynamics<dim> *bonded)
      : input_(input), discretization_(discretization), dynamics_(dynamics),
        solver_(solver), bonded_(bonded),
        problem_(constant_data(input, discretization)),
        uniqueness_(std::make_unique<UniquenessBound<dim>>(input, dynamics)),
        ledger_(std::make_unique<Ledger<dim>>(input, discretization, dynamics,
                                              *uniqueness_)),
        motion_(std::make_unique<DrivenMotion<dim>>(input, discretization)),
        crack_pressure_(CrackPressure<dim>::make(input, discretization)),
        sliding_(std::make_unique<EnergySafeSliding<dim>>(input)),
        forces_(discretization.bodies().n_dofs(), 0.)
  {
    if (input.has_viscous_bodies())
      dynamics.set_viscous_theta(input.time.work_theta());
    for (const auto &block : input.interfaces)
      has_extrinsic_ |= block.intact == IntactFaces::rigid && block.law;
    if (input.time.scheme == Scheme::symplectic)
      elastic_forces_ = std::make_unique<ElasticForces<dim>>(dynamics);
    if (input.has_bonded_faces())
      bulk_ = std::make_unique<BulkTraction<dim>>(dynamics);
  }

  template <int dim>
  MoreauJean<dim>::~MoreauJean() = default;

  template <int dim>
  State MoreauJean<dim>::initial_state() const
  {
    State state = nsfd::initial_state(input_, discretization_, dynamics_,
                                      problem_, bonded_);
    if (bulk_)
      set_bond_tractions(*bulk_, state);
    return state;
  }

  template <int dim>
  void MoreauJean<dim>::complete(State &state) const
  {
    if (bonded_)
      bonded_->set_bonds(bonded_points(state));
    set_energies(dynamics_, problem_, state);
    if (bulk_)
      set_bond_tractions(*bulk_, state);
  }

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
    return uniqueness_->next_step(problem_, state, time_step, bound_share);
  }

  template <int dim>
  const std::vector<double> &MoreauJean<dim>::reactions() const
  {
    return ledger_->reactions();
  }

  template <int dim>
  SolverControl
  MoreauJean<dim>::solver_control(const unsigned int idle_rounds) const
  {
    SolverControl control;
    control.tolerance = input_.solver.tolerance;
    control.maximum_iterations = input_.solver.maximum_iterations;
    control.idle_rounds = idle_rounds;
    return control;
  }

  template <int dim>
  StepReport MoreauJean<dim>::advance(const State &old, const double h,
                                      State &next,
                                      const unsigned int idle_rounds)
  {
    {
      const Stopwatch watch(timings_.assembly);
      const Charge charge(Cost::free_motion);
      const bool others = bonded_ && bonded_->set_bonds(bonded_points(old));
      if (elastic_forces_)
        elastic_forces_->start(old, others);
      dynamics_.reinit(h, input_.time.bulk_theta());
      sliding_->begin();
      set_problem_of_step(discretization_.origins(), old, h, problem_);
      set_loads(old.time + input_.time.bulk_theta() * h);
      if (crack_pressure_)
        crack_pressure_->evaluate(old, old.time + input_.time.theta * h,
                                  next.pressure);
      move_freely(old, next.pressure);
    }
    // kinetic energies before the impulses: the scale of round-off
    dynamics_.apply(Dynamics<dim>::Operator::mass, v_free_.data(),
                    work_.data());
    const double energy_scale =
        2. * old.energy.kinetic + dynamics_.communicator().dot(v_free_.data(),
                                                               work_.data(),
                                                               v_free_.size());
    LawEvaluation<dim> evaluation(problem_, dynamics_, energy_scale,
                                  input_.solver.tolerance);
    StepReport report;
    next.impulse = old.impulse;
    if (starts_cold_)
      std::fill(next.impulse.begin(), next.impulse.end(), 0.);
    {
      const Stopwatch watch(timings_.solve);
      const Charge charge(Cost::solver);
      report.solver = solve(solver_, problem_, discretization_.origins(),
                            solver_control(idle_rounds), energy_scale, old,
                            next.impulse, evaluation);
    }
    save_problem<dim>(input_, problem_, dynamics_, evaluation, report.solver,
                      old.step + 1, old.time);
    if (!report.solver.converged)
      reject(h, old.time, report.solver, evaluation.worst_point);
    {
      const Stopwatch watch(timings_.update);
      const Charge charge(Cost::update);
      move(old, evaluation, next);
    }
    if (old.step == 0)
      charge_memory("vectors of a step and its solver");
    const Stopwatch watch(timings_.ledger);
    const Charge charge(Cost::ledger);
    if (elastic_forces_)
      elastic_forces_->finish(next);
    ledger_->book(
        problem_, evaluation, discretization_.origins(),
        ledger_->book_bodies(forces_, h, old, next, elastic_forces_.get()), old,
        next, report);
    check_books(h, old.time, energy_scale, next, report,
                evaluation.worst_point);
    relate_defect(energy_scale, next, report);
    if (bulk_) {
      const BondReport bonds = release_bonds(problem_, *bulk_, old, next);
      report.released = bonds.released;
      report.overshoot = bonds.overshoot;
      report.share = bonds.share;
    }
    watch_energy(energy_scale, old, next, report);
    return report;
  }

  template <int dim>
  void MoreauJean<dim>::reject(const double h, const double time,
                               const SolverReport &report,
                               const std::size_t worst_point) const
  {
    throw StepRejected(fmt::format(
        "the step of {:.4g} at t = {:.6g} was not solved: residual {:.2e} "
        "after {} Newton steps and {} sweeps; worst face {}",
        h, time, report.residual, report.newton, report.sweeps,
        describe(worst_point)));
  }

  /** They close for any impulses, unless these have lost their digits. */
  template <int dim>
  void MoreauJean<dim>::check_books(const double h, const double time,
                                    const double energy_scale,
                                    const State &next, const StepReport &report,
                                    const std::size_t worst_point) const
  {
    // what is not a number is not within the bound
    starts_cold_ = true;
    if (!(report.ledger_defect * next.largest_energy <=
          1e-6 * std::max(next.largest_energy, energy_scale)))
      throw StepRejected(fmt::format(
          "the energies of the step of {:.4g} at t = {:.6g} do not add up "
          "(relative defect {:.1e}): rows that ask for the same have made "
          "impulses too large; worst face {}",
          h, time, report.ledger_defect, describe(worst_point)));
    starts_cold_ = false;
  }

  template <int dim>
  void MoreauJean<dim>::watch_energy(const double energy_scale,
                                     const State &old, const State &next,
                                     StepReport &report) const
  {
    LineChanges &changes = report.changes;
    changes.taken[std::size_t(WatchedLine::scheme)] =
        next.energy.numerical - old.energy.numerical;
    // at rest there is no energy but what the loads would give in a step
    changes.scale = std::max(next.largest_energy, energy_scale);
    // |P - P*|_R times |U|_(1/R): impulses of rows that ask for the same may be
    // far larger than what moves
    changes.noise =
        report.solver.residual *
        std::max(energy_scale, std::sqrt(energy_scale * changes.impulses));
    const double bound = energy_round_off * changes.scale + changes.noise +
                         // no line is known better than the balance closes
                         10. * report.ledger_defect * next.largest_energy;
    for (std::size_t k = 0; k < n_watched_lines; ++k) {
      const auto line = WatchedLine(k);
      const bool two_sided =
          line == WatchedLine::joints || line == WatchedLine::supports;
      const double given =
          two_sided ? std::abs(changes.taken[k]) : -changes.taken[k];
      // velocities of rows are known to the tolerance, impulses of rows that
      // ask for the same to less, and `numerical` is a difference of large
      // numbers in very long steps: the certificate holds their sum, a step is
      // given up only where hardly any digits are left
      const bool of_digits = two_sided || line == WatchedLine::scheme;
      if (given <= (of_digits ? 1e-4 * changes.scale + bound : bound) ||
          !never_gives(line, input_))
        continue;
      starts_cold_ = true;
      throw StepRejected(fmt::format(
          "the step of {:.4g} s at t = {:.6g} s would give {:.3g} J to `{}`, "
          "{:.1e} of the largest energy; worst face {}",
          next.time - old.time, old.time, given, name_of(line),
          given / changes.scale, describe(changes.worst[k])));
    }
  }

  /** Assembled again only if they depend on time. */
  template <int dim>
  void MoreauJean<dim>::set_loads(const double time)
  {
    if (!discretization_.has_loads())
      return;
    if (forces_known_ &&
        (!discretization_.loads_depend_on_time() || forces_time_ == time))
      return;
    std::fill(forces_.begin(), forces_.end(), 0.);
    discretization_.add_loads(time, forces_);
    forces_known_ = true;
    forces_time_ = time;
    ++counters_.load_assemblies;
  }

  /**
   * v_free = v_k + M_hat^{-1} h (F - K (q_k + h theta v_k) - C v_k), U_free;
   * pressure in cracks is a part of F.
   */
  template <int dim>
  void MoreauJean<dim>::move_freely(const State &old,
                                    const std::vector<double> &pressure)
  {
    const double h = problem_.time_step, theta = input_.time.bulk_theta(),
                 kick = input_.time.kick(h, old.last_step);
    const std::size_t n_dofs = old.velocity.size();
    work_.resize(n_dofs);
    v_free_.resize(n_dofs);
    if (elastic_forces_)
      work_ = elastic_forces_->at_start();
    else {
      for (std::size_t i = 0; i < n_dofs; ++i)
        v_free_[i] = old.displacement[i] + h * theta * old.velocity[i];
      dynamics_.apply(Dynamics<dim>::Operator::stiffness, v_free_.data(),
                      work_.data());
    }
    for (std::size_t i = 0; i < n_dofs; ++i)
      work_[i] = kick * (forces_[i] - work_[i]);
    if (dynamics_.is_viscous()) {
      dynamics_.apply(Dynamics<dim>::Operator::damping, old.velocity.data(),
                      v_free_.data());
      for (std::size_t i = 0; i < n_dofs; ++i)
        work_[i] -= h * v_free_[i];
    }
    dynamics_.apply(Dynamics<dim>::Operator::inverse, work_.data(),
                    v_free_.data());
    for (std::size_t i = 0; i < n_dofs; ++i)
      v_free_[i] += old.velocity[i];
    if (crack_pressure_)
      dynamics_.add_velocity_change(
          crack_pressure_->impulse(pressure, h).data(), v_free_.data());
    dynamics_.relative_velocity(v_free_.data(), problem_.free_velocity.data());
    dynamics_.set_free_velocity(&v_free_);
  }

  template <int dim>
  void
  MoreauJean<dim>::set_problem_of_step(const std::vector<PointOrigin> &origins,
                                       const State &old, const double h,
                                       OneStepProblem<dim> &problem) const
  {
    set_step(input_, discretization_, origins, dynamics_, *motion_, old, h,
             problem);
    sliding_->apply(old.relative_velocity, problem);
  }

  template <int dim>
  SolverReport MoreauJean<dim>::solve(
      NonsmoothSolver<dim> &solver, OneStepProblem<dim> &problem,
      const std::vector<PointOrigin> &origins, const SolverControl &control,
      const double energy_scale, const State &old, std::vector<double> &impulse,
      LawEvaluation<dim> &evaluation)
  {
    SolverReport report;
    for (unsigned int round = 0;; ++round) {
      const SolverReport part = solver.solve(problem, dynamics_, energy_scale,
                                             control, impulse, evaluation);
      report.go_on_with(part);
      ++counters_.solves;
      if (!part.converged || round > 30)
        break;
      if (has_extrinsic_ && activate(dynamics_, origins, impulse, problem))
        ++counters_.activation_rounds;
      else if (sliding_->revise(dynamics_.communicator(), evaluation, impulse,
                                old.relative_velocity,
                                std::max(old.largest_energy, energy_scale),
                                problem))
        ++counters_.sliding_rounds;
      else
        break;
    }
    counters_.newton += report.newton;
    counters_.krylov += report.krylov;
    counters_.sweeps += report.sweeps;
    counters_.law_sweeps += evaluation.law_calls;
    counters_.line_searches += report.line_searches;
    return report;
  }

  namespace
  {
    /**
     * U = U_free + W P is not known better than to the last bit of its largest
     * part, R |P|. Where the spring of a point, D = -dU/dP, makes impulses of
     * that which are larger than P, its own law tells U from P.
     */
    template <int dim>
    void set_stiff_velocities(const OneStepProblem<dim> &problem,
                              const LawEvaluation<dim> &evaluation, State &next)
    {
      constexpr double last_bit = std::numeric_limits<double>::epsilon();
      for (std::size_t k = 0; k < problem.n_points * dim; ++k)
        if (const auto *law = evaluation.linear(k / dim)) {
          const LinearSpring spring(problem, *law, k);
          if (spring.stiffness > 0. &&
              spring.compliance() <
                  last_bit * evaluation.majorant(k / dim, k % dim))
            next.relative_velocity[k] = spring.velocity(next.impulse[k]);
        }
    }
  } // namespace

  /** v, q, U and u at the end of the step. */
  template <int dim>
  void MoreauJean<dim>::move(const State &old,
                             const LawEvaluation<dim> &evaluation,
                             State &next) const
  {
    const double h = problem_.time_step, theta = problem_.theta;
    next.step = old.step + 1;
    next.time = old.time + h;
    next.last_step = h;
    next.velocity = v_free_;
    dynamics_.add_velocity_change(next.impulse.data(), next.velocity.data());
    next.displacement.resize(v_free_.size());
    for (std::size_t i = 0; i < v_free_.size(); ++i)
      next.displacement[i] =
          old.displacement[i] +
          h * (theta * next.velocity[i] + (1. - theta) * old.velocity[i]);
    next.relative_velocity = evaluation.velocity;
    set_stiff_velocities(problem_, evaluation, next);
    if (bonded_) { // W has no rows there
      std::vector<double> velocity(next.relative_velocity.size());
      dynamics_.relative_velocity(next.velocity.data(), velocity.data());
      for (std::size_t k = 0; k < velocity.size(); ++k)
        if (old.kind[k / dim] == PointKind::bonded)
          next.relative_velocity[k] = velocity[k];
    }
    next.jump.resize(old.jump.size());
    for (std::size_t k = 0; k < old.jump.size(); ++k)
      next.jump[k] =
          problem_.jump_free[k] + h * theta * next.relative_velocity[k];
  }

  template <int dim>
  std::string MoreauJean<dim>::describe(const PointOrigin &origin,
                                        const double *x) const
  {
    std::string name;
    switch (origin.kind) {
    case PointOrigin::Kind::interface:
      name = "Interface: " + input_.interfaces[origin.block].name;
      break;
    case PointOrigin::Kind::motion:
      name = "Boundary: " + input_.boundaries[origin.block].name;
      break;
    case PointOrigin::Kind::obstacle:
      name = "Obstacle: " + input_.obstacles[origin.block].name;
      break;
    case PointOrigin::Kind::surface:
      name = "Contact: " + input_.contacts[origin.block].name;
      break;
    case PointOrigin::Kind::pin:
      name = "Pin: " + input_.pins[origin.block].name;
      break;
    }
    std::string place;
    for (unsigned int c = 0; c < dim; ++c)
      place += fmt::format("{}{:.6g}", c ? ", " : "", x[c]);
    return fmt::format("at ({}) of `{}`", place, name);
  }

  template <int dim>
  std::string MoreauJean<dim>::describe(const std::size_t i) const
  {
    if (i >= discretization_.origins().size())
      return "unknown";
    return describe(discretization_.origins()[i],
                    &discretization_.points().position[i * dim]);
  }

  template <int dim>
  void MoreauJean<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    c["solver_calls"] = double(counters_.solves);
    c["newton"] = double(counters_.newton);
    c["krylov"] = double(counters_.krylov);
    c["gauss_seidel_sweeps"] = double(counters_.sweeps);
    c["line_searches"] = double(counters_.line_searches);
    c["law_sweeps"] = double(counters_.law_sweeps);
    c["load_assemblies"] = double(counters_.load_assemblies);
    c["activation_rounds"] = double(counters_.activation_rounds);
  }

  template class MoreauJean<2>;
  template class MoreauJean<3>;
} // namespace nsfd
