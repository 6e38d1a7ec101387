#include "step_problem.h"

#include "activation.h"
#include "driven_motion.h"
#include "energy_watch.h"
#include "nonsmooth/linear_spring.h"
#include "nonsmooth/row_work.h"
#include "row_system.h"
#include "step_data.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /**
     * Impulses and what was found of them, to go back to: laws that are
     * evaluated anew at the same impulses begin elsewhere, and where a point
     * has several answers they may find another one.
     */
    template <int dim>
    class Judged
    {
    public:
      Judged(const std::vector<double> &impulse,
             const LawEvaluation<dim> &evaluation)
          : impulse_(impulse), velocity_(evaluation.velocity),
            defect_(evaluation.defect), solutions_(evaluation.solutions),
            error_(evaluation.error), worst_error_(evaluation.worst_error),
            worst_point_(evaluation.worst_point)
      {
      }

      void return_to(std::vector<double> &impulse,
                     LawEvaluation<dim> &evaluation) const
      {
        impulse = impulse_;
        evaluation.velocity = velocity_;
        evaluation.defect = defect_;
        evaluation.solutions = solutions_;
        evaluation.error = error_;
        evaluation.worst_error = worst_error_;
        evaluation.worst_point = worst_point_;
      }

      double error() const { return error_; }

    private:
      std::vector<double> impulse_, velocity_, defect_;
      std::vector<LocalSolution<dim>> solutions_;
      double error_, worst_error_;
      std::size_t worst_point_;
    };
  } // namespace

  template <int dim>
  StepProblem<dim>::StepProblem(const SceneInput &input,
                                const Discretization<dim> &discretization,
                                DelassusOperator<dim> &delassus,
                                StepCounters &counters)
      : input_(input), discretization_(discretization), delassus_(delassus),
        counters_(counters),
        motion_(std::make_unique<DrivenMotion<dim>>(input, discretization)),
        sliding_(input)
  {
    for (const auto &block : input.interfaces)
      has_extrinsic_ |= block.law && (block.intact == IntactFaces::rigid ||
                                      block.intact == IntactFaces::bonded);
  }

  template <int dim>
  StepProblem<dim>::~StepProblem() = default;

  template <int dim>
  SolverControl StepProblem<dim>::control(const unsigned int idle_rounds) const
  {
    SolverControl control;
    control.tolerance = input_.solver.tolerance;
    control.maximum_iterations = input_.solver.maximum_iterations;
    control.idle_rounds = idle_rounds;
    return control;
  }

  /**
   * A tenth of the share that a step has of what the certificate allows the
   * contacts, and the rows, of the whole run.
   */
  template <int dim>
  SolverControl StepProblem<dim>::control(const unsigned int idle_rounds,
                                          const double time_step,
                                          const State &old) const
  {
    SolverControl control = this->control(idle_rounds);
    const double share = std::min(1., time_step / input_.time.end);
    control.contact_energy =
        0.1 * energy_round_off * share * old.largest_energy;
    // joints of large motions depend on each other: along what they leave
    // open, steps for a last digit let impulses grow without end
    if (!input_.large_motion)
      control.row_energy = control.contact_energy;
    return control;
  }

  template <int dim>
  void StepProblem<dim>::set(const std::vector<PointOrigin> &origins,
                             const State &old, const double h,
                             OneStepProblem<dim> &problem) const
  {
    set_step(input_, discretization_, origins, delassus_, *motion_, old, h,
             problem);
    sliding_.apply(old.relative_velocity, problem);
  }

  template <int dim>
  SolverReport StepProblem<dim>::solve(
      NonsmoothSolver<dim> &solver, OneStepProblem<dim> &problem,
      const std::vector<PointOrigin> &origins, const SolverControl &control,
      const double energy_scale, const State &old, std::vector<double> &impulse,
      LawEvaluation<dim> &evaluation, const bool keeps_joints)
  {
    SolverReport report;
    for (unsigned int round = 0;; ++round) {
      const SolverReport part = solver.solve(problem, delassus_, energy_scale,
                                             control, impulse, evaluation);
      report.go_on_with(part);
      ++counters_.solves;
      if (!part.converged || round > 30)
        break;
      if (has_extrinsic_ && !keeps_joints &&
          activate(delassus_, origins, impulse, problem))
        ++counters_.activation_rounds;
      else if (sliding_.revise(delassus_.communicator(), evaluation, impulse,
                               old.relative_velocity,
                               std::max(old.largest_energy, energy_scale),
                               problem))
        ++counters_.sliding_rounds;
      else
        break;
    }
    const auto slower_than = [&](const double still) {
      return report.converged &&
             rests(still, problem, energy_scale, old, evaluation);
    };
    const auto stays = [&] {
      return may_stay_ && slower_than(0.1 * control.tolerance);
    };
    report.rests = stays();
    if (!report.rests && slower_than(100. * control.tolerance)) {
      settle(problem, control, energy_scale, impulse, evaluation, report);
      report.rests = stays();
    }
    if (report.converged && problem.free_motion == FreeVelocity::known)
      renew_rows(solver, problem, control, energy_scale, impulse, evaluation,
                 report);
    if (report.converged &&
        gives_by_contact(problem, control, old, impulse, evaluation))
      solve_closer(solver, problem, control, energy_scale, impulse, evaluation,
                   report);
    if (report.converged && problem.free_motion == FreeVelocity::known &&
        gives_by_rows(problem, control, energy_scale, impulse, evaluation))
      hold_rows(problem, control, energy_scale, impulse, evaluation, report);
    counters_.newton += report.newton;
    counters_.krylov += report.krylov;
    counters_.sweeps += report.sweeps;
    counters_.law_sweeps += evaluation.law_calls;
    counters_.line_searches += report.line_searches;
    return report;
  }

  /** Nothing moved, and nothing does, by more than @p still of what it would
      without the impulses. */
  template <int dim>
  bool StepProblem<dim>::rests(const double still,
                               const OneStepProblem<dim> &problem,
                               const double energy_scale, const State &old,
                               const LawEvaluation<dim> &evaluation) const
  {
    if (2. * old.energy.kinetic > still * still * energy_scale)
      return false;
    // rows of joints that depend on each other have no last bit to settle to
    const Communicator &all = delassus_.communicator();
    const bool only_contacts =
        problem.free_motion == FreeVelocity::known &&
        std::all_of(problem.kind.begin(), problem.kind.end(),
                    [](const auto kind) { return kind == PointKind::free; });
    if (all.any(!only_contacts))
      return false;
    double largest = 0., free = 0.;
    for (std::size_t k = 0; k < problem.n_owned * dim; ++k) {
      largest = std::max(largest, std::abs(evaluation.velocity[k]));
      free = std::max(free, std::abs(problem.free_velocity[k]));
    }
    return all.max(largest) <= still * all.max(free);
  }

  /**
   * The next step begins with what this one leaves, and where nothing moves all
   * that is left are errors, each on top of those before: bodies at rest would
   * creep by the tolerance times g h^2 in every step. Some Newton steps more
   * leave round-off; where the first ones do not come near it, as with contacts
   * that touch without a force, the others would not either.
   */
  template <int dim>
  void
  StepProblem<dim>::settle(const OneStepProblem<dim> &problem,
                           SolverControl control, const double energy_scale,
                           std::vector<double> &impulse,
                           LawEvaluation<dim> &evaluation, SolverReport &report)
  {
    control.tolerance = 1e-14;
    for (const unsigned int steps : {2u, 4u}) {
      const double error = evaluation.error;
      if (error <= control.tolerance)
        return;
      control.maximum_iterations = steps;
      go_on(problem, control, energy_scale, impulse, evaluation, report);
      if (evaluation.error > 0.1 * error)
        return;
    }
  }

  /**
   * What stays closed, or apart, and what sticks does no work but that of what
   * the tolerance leaves, and in many steps it adds up to more than the
   * certificate allows.
   */
  template <int dim>
  bool StepProblem<dim>::gives_by_contact(
      const OneStepProblem<dim> &problem, const SolverControl &control,
      const State &old, const std::vector<double> &impulse,
      const LawEvaluation<dim> &evaluation) const
  {
    if (!std::isfinite(control.contact_energy)) // statics
      return false;
    double given = 0.;
    for (std::size_t i = 0; i < problem.n_owned; ++i) {
      const auto &solution = evaluation.solutions[i];
      const double P = problem.kind[i] == PointKind::free
                           ? impulse[i * dim]
                           : solution.contact_impulse;
      if (!problem.contact[i])
        continue;
      given += std::max(
          0., P * (problem.theta * evaluation.velocity[i * dim] +
                   (1. - problem.theta) * old.relative_velocity[i * dim] -
                   solution.frozen.lift));
      if (solution.frozen.threshold > 0.)
        given += std::max(
            0.,
            friction_work<dim>(problem, i, solution, &impulse[i * dim],
                               &evaluation.velocity[i * dim],
                               &old.relative_velocity[i * dim], problem.theta));
    }
    return delassus_.communicator().sum(&given, 1) > control.contact_energy;
  }

  template <int dim>
  void StepProblem<dim>::solve_closer(NonsmoothSolver<dim> &solver,
                                      const OneStepProblem<dim> &problem,
                                      SolverControl control,
                                      const double energy_scale,
                                      std::vector<double> &impulse,
                                      LawEvaluation<dim> &evaluation,
                                      SolverReport &report)
  {
    if (problem.free_motion == FreeVelocity::known) {
      settle(problem, control, energy_scale, impulse, evaluation, report);
      return;
    }
    // only the solver itself knows the motion of the nodes
    const Judged<dim> before(impulse, evaluation);
    control.tolerance = std::max(1e-14, 1e-3 * control.tolerance);
    control.maximum_iterations = 10;
    report.add_work(solver.solve(problem, delassus_, energy_scale, control,
                                 impulse, evaluation));
    if (!(evaluation.error < before.error()))
      before.return_to(impulse, evaluation);
    report.residual = evaluation.error;
  }

  template <int dim>
  bool StepProblem<dim>::gives_by_rows(
      const OneStepProblem<dim> &problem, const SolverControl &control,
      const double energy_scale, const std::vector<double> &impulse,
      const LawEvaluation<dim> &evaluation) const
  {
    if (!std::isfinite(control.row_energy)) // statics
      return false;
    const RowWork rows = row_work(problem, delassus_.communicator(),
                                  evaluation.velocity, impulse);
    return rows.energy >
           std::max(control.row_energy, rows.round_off(energy_scale));
  }

  /**
   * The tolerance is one of impulses, and impulses of long steps are far larger
   * than what moves: what is left of the velocity of a support times its
   * impulse may be as large as all energies. Rows are linear, and a Newton step
   * more leaves round-off of them.
   */
  template <int dim>
  void StepProblem<dim>::hold_rows(const OneStepProblem<dim> &problem,
                                   SolverControl control,
                                   const double energy_scale,
                                   std::vector<double> &impulse,
                                   LawEvaluation<dim> &evaluation,
                                   SolverReport &report)
  {
    const auto present = [&] {
      return row_work(problem, delassus_.communicator(), evaluation.velocity,
                      impulse);
    };
    const RowWork rows = present();
    const double most =
        std::max(control.row_energy, rows.round_off(energy_scale));
    const Judged<dim> before(impulse, evaluation);
    control.tolerance =
        std::max(1e-15, 0.5 * evaluation.error * most / rows.energy);
    control.maximum_iterations = 3;
    if (go_on(problem, control, energy_scale, impulse, evaluation, report) &&
        !(present().energy < rows.energy)) {
      before.return_to(impulse, evaluation);
      report.residual = before.error();
    }
  }

  /**
   * Rows that depend on each other hold each other by impulses of any size that
   * move nothing, and a hard problem may leave large ones. The residual is
   * relative to the impulses: beside those the others are not solved at all,
   * and times the last bits of velocities they are an energy. Impulses of rows
   * far beyond what there is to move are found again from none, by conjugate
   * gradients; where they fall, what is left over is solved once more, and the
   * report says how far that has come.
   */
  template <int dim>
  void StepProblem<dim>::renew_rows(NonsmoothSolver<dim> &solver,
                                    const OneStepProblem<dim> &problem,
                                    const SolverControl &control,
                                    const double energy_scale,
                                    std::vector<double> &impulse,
                                    LawEvaluation<dim> &evaluation,
                                    SolverReport &report)
  {
    constexpr double most = 1e3, last_bits = 1e-15;
    // where nothing moves, all impulses are round-off
    const double harmless = std::max(most * energy_scale, control.row_energy);
    const Communicator &all = delassus_.communicator();
    const auto held = [&] {
      return row_work(problem, all, evaluation.velocity, impulse).impulses;
    };
    const double present = held();
    if (!std::isfinite(control.row_energy) || // statics
        !(present > harmless))
      return;
    const Judged<dim> before(impulse, evaluation);
    const std::size_t n = impulse.size();
    std::vector<double> D(n, -1.), wanted(n, 0.), found(n, 0.);
    for (std::size_t k = 0; k < n; ++k)
      if (problem.kind[k / dim] == PointKind::prescribed &&
          problem.mask[k / dim] & (1u << k % dim)) {
        D[k] = 0.;
        impulse[k] = 0.;
      }
    evaluation.update(impulse);
    for (std::size_t k = 0; k < n; ++k)
      if (D[k] == 0.)
        wanted[k] = problem.given_velocity[k] - evaluation.velocity[k];
    RowSystem<dim> rows(delassus_, problem.n_owned);
    rows.set(D);
    rows.solve(wanted,
               last_bits * std::sqrt(all.dot(wanted.data(), wanted.data(),
                                             problem.n_owned * dim)),
               found);
    for (std::size_t k = 0; k < n; ++k)
      if (D[k] == 0.)
        impulse[k] = found[k];
    evaluation.update(impulse);
    if (!(held() < present / most)) { // they move something
      before.return_to(impulse, evaluation);
      return;
    }
    report.residual = evaluation.error;
    if (evaluation.error <= control.tolerance)
      return;
    const SolverReport again = solver.solve(problem, delassus_, energy_scale,
                                            control, impulse, evaluation);
    report.go_on_with(again);
    report.converged = again.converged && !(held() > harmless);
  }

  /** By Newton's method, if it comes closer. */
  template <int dim>
  bool StepProblem<dim>::go_on(const OneStepProblem<dim> &problem,
                               const SolverControl &control,
                               const double energy_scale,
                               std::vector<double> &impulse,
                               LawEvaluation<dim> &evaluation,
                               SolverReport &report)
  {
    const auto newton = SolverRegistry<dim>::instance().create("dual newton");
    const Judged<dim> before(impulse, evaluation);
    report.add_work(newton->solve(problem, delassus_, energy_scale, control,
                                  impulse, evaluation));
    const bool closer = evaluation.error < before.error();
    if (!closer)
      before.return_to(impulse, evaluation);
    report.residual = evaluation.error;
    return closer;
  }

  template <int dim>
  std::vector<double> solved_velocity(const OneStepProblem<dim> &problem,
                                      const LawEvaluation<dim> &evaluation,
                                      const std::vector<double> &impulse)
  {
    constexpr double last_bit = std::numeric_limits<double>::epsilon();
    std::vector<double> velocity = evaluation.velocity;
    for (std::size_t k = 0; k < problem.n_points * dim; ++k)
      if (const auto *law = evaluation.linear(k / dim)) {
        const LinearSpring spring(problem, *law, k);
        if (spring.stiffness > 0. &&
            spring.compliance() <
                last_bit * evaluation.majorant(k / dim, k % dim))
          velocity[k] = spring.velocity(impulse[k]);
      }
    return velocity;
  }

#define INSTANTIATE(dim)                                                       \
  template class StepProblem<dim>;                                             \
  template std::vector<double> solved_velocity<dim>(                           \
      const OneStepProblem<dim> &, const LawEvaluation<dim> &,                 \
      const std::vector<double> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
