#include "linear_moreau_jean.h"

#include "bond_release.h"
#include "common_balance.h"
#include "elastic_forces.h"
#include "energy_balance.h"
#include "initial_state.h"
#include "point_name.h"
#include "save_problem.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "discretization/cells.h"
#include "discretization/loads.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /**
     * Sum of F^2/m over the nodes of the cells, F what the initial stress does
     * to each of them by itself, W/s: h^2 times this is what bodies of common
     * nodes do not get because their cells hold each other, to its last bits.
     * Collective.
     */
    template <int dim>
    double scale_of_stress(const Discretization<dim> &discretization,
                           const Communicator &communicator)
    {
      const auto &cells = discretization.cells();
      const auto &forces = discretization.loads().initial_stress()->forces();
      std::vector<double> terms(forces.size(), 0.);
      for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
        const BodyClass &body = cells.body_class(b);
        const std::size_t first = cells.first_node[b] * dim;
        for (unsigned int i = 0; !body.undeformed && i < body.n_dofs; ++i)
          terms[first + i] =
              forces[first + i] * forces[first + i] / body.mass(i, i);
      }
      return communicator.sum(terms);
    }
  } // namespace

  template <int dim>
  LinearMoreauJean<dim>::LinearMoreauJean(
      const SceneInput &input, const Discretization<dim> &discretization,
      DelassusOperator<dim> &delassus, NonsmoothSolver<dim> &solver,
      JoinedDelassus<dim> *bonded)
      : MoreauJean<dim>(input, discretization, delassus), solver_(solver),
        bonded_(bonded)
  {
    if (input.time.scheme.explicit_forces)
      elastic_forces_ = std::make_unique<ElasticForces<dim>>(delassus);
    if (input.has_bonded_faces()) {
      bulk_ = std::make_unique<BulkTraction<dim>>(
          delassus, discretization.loads().initial_stress());
      bulk_->mark(breakable_faces(this->problem_, delassus.points()));
    }
    if (bonded && discretization.loads().initial_stress())
      stress_scale_ = scale_of_stress(discretization, delassus.communicator());
  }

  template <int dim>
  LinearMoreauJean<dim>::~LinearMoreauJean() = default;

  template <int dim>
  State LinearMoreauJean<dim>::initial_state() const
  {
    State state = nsfd::initial_state(this->input_, this->discretization_,
                                      this->delassus_, this->problem_, bonded_);
    if (bulk_)
      set_bond_tractions(*bulk_, state);
    return state;
  }

  /** A step has the tractions of faces that can break alone. */
  template <int dim>
  void LinearMoreauJean<dim>::show(State &state) const
  {
    if (bulk_)
      set_bond_tractions(*bulk_, state);
  }

  template <int dim>
  void LinearMoreauJean<dim>::complete(State &state) const
  {
    if (bonded_) {
      // other cells, other common nodes
      const auto &origins = this->discretization_.origins();
      for (std::size_t i = 0; i < origins.size(); ++i)
        if (origins[i].kind == PointOrigin::Kind::interface &&
            this->input_.interfaces[origins[i].block].intact ==
                IntactFaces::bonded &&
            is_joined(state.kind[i]))
          state.kind[i] = PointKind::bonded;
      hold_by_rows(this->problem_, *bonded_, state);
      bonded_->set_bonds(bonded_points(state));
      join_motion(*bonded_, state);
    }
    set_energies(this->delassus_, this->problem_, state);
    if (elastic_forces_) {
      elastic_forces_->finish(state);
      state.energy.kinetic -= elastic_forces_->kinetic_share(state);
    }
    if (bulk_)
      set_bond_tractions(*bulk_, state);
  }

  template <int dim>
  std::string LinearMoreauJean<dim>::describe(const std::size_t i) const
  {
    return name_of_point<dim>(this->input_, this->discretization_.origins(),
                              this->discretization_.points().position, i);
  }

  /** What the step does without impulses, and the data of its points. */
  template <int dim>
  void LinearMoreauJean<dim>::start(const State &old, const double h,
                                    State &next)
  {
    const Stopwatch watch(this->timings_.assembly);
    const Charge charge(Cost::free_motion);
    const auto &time = this->input_.time;
    const bool others = bonded_ && bonded_->set_bonds(bonded_points(old));
    if (elastic_forces_)
      elastic_forces_->start(old, h, others);
    this->delassus_.reinit(h, time.bulk_theta());
    this->step_problem_.begin();
    this->step_problem_.set(this->discretization_.origins(), old, h,
                            this->problem_);
    if (bonded_)
      supports_.prescribe_once(*bonded_, this->discretization_.origins(),
                               others, this->problem_);
    if (this->free_motion_.set_loads(old.time + time.theta * h, old.clock))
      ++this->counters_.load_assemblies;
    this->free_motion_.set_pressure(old, old.time + time.theta * h,
                                    next.pressure);
    next.impulse = old.impulse;
    // a step of another length begins with the same forces
    if (bonded_ && old.last_step > 0. && old.last_step != h)
      for (double &P : next.impulse)
        P *= h / old.last_step;
    if (this->check_.starts_cold())
      std::fill(next.impulse.begin(), next.impulse.end(), 0.);
    this->free_motion_.move(old, next.pressure, this->problem_, next.impulse,
                            elastic_forces_ ? &elastic_forces_->in_step()
                                            : nullptr);
  }

  template <int dim>
  StepReport LinearMoreauJean<dim>::advance(const State &old, const double h,
                                            State &next,
                                            const unsigned int idle_rounds)
  {
    const auto &origins = this->discretization_.origins();
    start(old, h, next);
    // kinetic energies before the impulses: the scale of round-off
    const double energy_scale =
        2. * old.energy.kinetic + this->free_motion_.kinetic_product();
    const double tolerance = this->input_.solver.tolerance;
    if (!evaluation_)
      evaluation_ = std::make_unique<LawEvaluation<dim>>(
          this->problem_, this->delassus_, energy_scale, tolerance);
    else
      evaluation_->renew(energy_scale, tolerance);
    LawEvaluation<dim> &evaluation = *evaluation_;
    StepReport report;
    {
      const Stopwatch watch(this->timings_.solve);
      const Charge charge(Cost::solver);
      const auto solve = [&] {
        report.solver.go_on_with(this->step_problem_.solve(
            solver_, this->problem_, origins,
            this->step_problem_.control(idle_rounds, h, old), energy_scale, old,
            next.impulse, evaluation));
      };
      solve();
      // others of the cascade ask for U_free
      if (!report.solver.converged &&
          this->free_motion_.find(old, this->problem_))
        solve();
    }
    if (this->input_.solver.save_problems != "none")
      this->free_motion_.estimate(evaluation.velocity, next.impulse,
                                  this->problem_);
    save_problem<dim>(this->input_, this->problem_, this->delassus_, evaluation,
                      report.solver, old.step + 1, old.time);
    this->check_.check_solution(h, old.time, report.solver,
                                evaluation.worst_point);
    {
      const Stopwatch watch(this->timings_.update);
      const Charge charge(Cost::update);
      finish(old, evaluation, next);
    }
    if (old.step == 0)
      charge_memory("vectors of a step and its solver");
    const Stopwatch watch(this->timings_.ledger);
    const Charge charge(Cost::energy_balance);
    if (elastic_forces_)
      elastic_forces_->finish(next);
    const BodyEnergies bodies = this->balance_->book_bodies(
        this->free_motion_.loads(), h, old, next, elastic_forces_.get());
    this->balance_->account(this->problem_, evaluation, origins, bodies, old,
                            next, report);
    const double held = h * h * stress_scale_,
                 scale = std::max(energy_scale, held);
    report.changes.impulses += held;
    const TakenStep step{old, next, h, scale, evaluation.worst_point};
    this->check_.check_balance(step, report);
    relate_defect(scale, next, report);
    if (bulk_) {
      const BondReport bonds =
          release_bonds(this->problem_, *bulk_, *bonded_,
                        this->input_.discretization.degree == 1, old, next);
      report.released = bonds.released;
      report.overshoot = bonds.overshoot;
      report.share = bonds.share;
    }
    this->check_.watch_energy(step, report);
    return report;
  }

  /** v, q, U and u at the end of the step. */
  template <int dim>
  void LinearMoreauJean<dim>::finish(const State &old,
                                     const LawEvaluation<dim> &evaluation,
                                     State &next) const
  {
    const double h = this->problem_.time_step, theta = this->problem_.theta;
    next.step = old.step + 1;
    next.time = old.time + h;
    next.last_step = h;
    next.kept_step = this->delassus_.terms().kept_step;
    this->free_motion_.finish(next.impulse, old, next);
    const std::size_t n = next.velocity.size();
    next.displacement.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      next.displacement[i] =
          old.displacement[i] +
          h * (theta * next.velocity[i] + (1. - theta) * old.velocity[i]);
    next.relative_velocity =
        solved_velocity(this->problem_, evaluation, next.impulse);
    if (bonded_) { // W has no rows there
      std::vector<double> velocity(next.relative_velocity.size());
      this->delassus_.jumps(next.velocity.data(), velocity.data());
      for (std::size_t k = 0; k < velocity.size(); ++k)
        if (old.kind[k / dim] == PointKind::bonded)
          next.relative_velocity[k] = velocity[k];
    }
    next.jump.resize(old.jump.size());
    for (std::size_t k = 0; k < old.jump.size(); ++k)
      next.jump[k] =
          this->problem_.jump_free[k] + h * theta * next.relative_velocity[k];
  }

  template class LinearMoreauJean<2>;
  template class LinearMoreauJean<3>;
} // namespace nsfd
