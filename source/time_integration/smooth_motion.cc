#include "smooth_equations.h"

#include "bond_release.h"
#include "common_balance.h"

#include "core/cost.h"
#include "core/stop_request.h"
#include "core/stopwatch.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/index_set.h>
#include <deal.II/sundials/arkode.h>

#include <arkode/arkode_arkstep.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  /** The equations with their integrator, and what is read off at the end. */
  template <int dim>
  class SmoothMotion<dim>::Equations : public SmoothEquations<dim>
  {
  public:
    using typename SmoothEquations<dim>::Operator;
    using typename SmoothEquations<dim>::Values;
    using typename SmoothEquations<dim>::Vector;
    using SmoothEquations<dim>::counters;

    Equations(const SceneInput &input,
              const Discretization<dim> &discretization,
              DelassusOperator<dim> &delassus, JoinedDelassus<dim> *bonded,
              const State &start)
        : SmoothEquations<dim>(input, discretization, delassus, bonded, start)
    {
      reactions.assign(discretization.driven_boundaries().size() * dim, 0.);
    }

    /** Driven boundaries move as they are told from the start on: what @p state
        lacks of that comes by a blow, with the work P.(U- + U+)/2. */
    void start(State &state);
    StepReport advance(const State &old, double h, State &next);

    Values reactions;

  private:
    void integrate(double t, double h, Vector &y);
    bool is_balanced(const State &next, const StepReport &report) const;
    void read_off(const State &old, double h, const Vector &y, State &next);
    double kinetic_energy(const Values &v) { return half(Operator::mass, v); }
    /** x.A x / 2. */
    double half(const Operator op, const Values &x)
    {
      this->delassus_.apply(op, x.data(), this->work_.body.data());
      return this->communicator_.dot(x.data(), this->work_.body.data(),
                                     this->n_) /
             2.;
    }
  };

  template <int dim>
  void SmoothMotion<dim>::Equations::integrate(const double t, const double h,
                                               Vector &y)
  {
    const double tolerance =
        this->scales_.share * this->input_.time.smooth.tolerance;
    using Solver = dealii::SUNDIALS::ARKode<Vector>;
    const typename Solver::AdditionalData data(
        t, t + h, std::min(this->scales_.inner_step, h), 2. * h, 1e-12 * h,
        this->input_.time.smooth.order, 10, false, false, true, 0, tolerance,
        tolerance);
    Solver solver(data, this->communicator_.mpi());
    void *memory = nullptr;
    // what fails in a callback must not leave through C code
    std::string failure;
    bool stopped = false;
    const auto guard = [&failure, &stopped](const auto &work) {
      try {
        work();
      } catch (const std::exception &error) {
        failure = error.what();
        return -1;
      } catch (const StopRequested &) {
        stopped = true;
        return -1;
      }
      return 0;
    };
    const auto rate = [&, this](const double at, const Vector &in,
                                Vector &out) {
      return guard([&] { this->evaluate(at, in, out); });
    };
    if (this->input_.time.smooth.implicit) {
      solver.implicit_function = rate;
      solver.jacobian_times_vector = [](const Vector &, Vector &, double,
                                        const Vector &,
                                        const Vector &) { return 0; };
      solver.solve_linearized_system = [&](auto &, auto &, Vector &x,
                                           const Vector &b, double) {
        return guard([&] {
          double gamma = 0.;
          ARKStepGetCurrentGamma(memory, &gamma);
          this->solve_shifted(gamma, b, x);
        });
      };
    } else
      solver.explicit_function = rate;
    Vector tolerances(y);
    std::fill(this->displacement(tolerances), this->velocity(tolerances),
              tolerance * this->scales_.displacement);
    std::fill(this->velocity(tolerances), this->velocity(tolerances) + this->n_,
              tolerance * this->scales_.velocity);
    if (this->communicator_.is_root())
      tolerances.local_element(2 * this->n_) = tolerance * this->scales_.energy;
    solver.get_local_tolerances = [&]() -> Vector & { return tolerances; };
    solver.custom_setup = [&](void *arkode) {
      memory = arkode;
      ARKStepSetMaxNumSteps(arkode, 10000000);
    };
    try {
      solver.solve_ode(y);
    } catch (const std::exception &) {
      if (stopped)
        throw StopRequested();
      throw StepRejected(
          fmt::format("ARKODE could not go on between t = {:.6g} and {:.6g}{}",
                      t, t + h, failure.empty() ? "" : ": " + failure));
    }
    long int steps = 0;
    ARKStepGetNumSteps(memory, &steps);
    counters.steps += static_cast<unsigned long long>(steps);
    ARKStepGetCurrentStep(memory, &this->scales_.inner_step);
  }

  template <int dim>
  void SmoothMotion<dim>::Equations::start(State &state)
  {
    Values after;
    this->project(state.time, state.velocity.data(), after);
    const double work = kinetic_energy(after) - kinetic_energy(state.velocity);
    state.velocity = after;
    state.relative_velocity.resize(this->n_rows_);
    this->free_->relative_velocity(state.velocity.data(),
                                   state.relative_velocity.data());
    state.energy.kinetic += work;
    state.energy.work += work;
  }

  /**
   * The errors of single steps add up, and those of the energy know the
   * stiffness: the whole balance must keep what was asked for, by the share of
   * the time that is over. Rounding leaves a hundredth of it alone.
   */
  template <int dim>
  bool SmoothMotion<dim>::Equations::is_balanced(const State &next,
                                                 const StepReport &report) const
  {
    constexpr double least_share = 0.01;
    const auto &time = this->input_.time;
    return report.balance_residual <=
           time.smooth.tolerance *
               std::max(least_share, std::min(1., next.time / time.end));
  }

  template <int dim>
  StepReport SmoothMotion<dim>::Equations::advance(const State &old,
                                                   const double h, State &next)
  {
    const Charge charge(Cost::solver);
    const Stopwatch watch(counters.seconds);
    const bool holds_work = this->communicator_.is_root();
    const unsigned long long mine = 2 * this->n_ + (holds_work ? 1 : 0);
    unsigned long long last = 0, total = 0;
    MPI_Scan(&mine, &last, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM,
             this->communicator_.mpi());
    MPI_Allreduce(&mine, &total, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM,
                  this->communicator_.mpi());
    dealii::IndexSet owned(total);
    owned.add_range(last - mine, last);
    Vector y(owned, this->communicator_.mpi());
    const Counters before = counters;
    StepReport report;
    // the last of these tolerances has few digits above rounding
    constexpr double least_tolerance = 1e-13;
    for (bool again = true; again;) {
      y = 0.;
      std::copy(old.displacement.begin(), old.displacement.end(),
                this->displacement(y));
      std::copy(old.velocity.begin(), old.velocity.end(), this->velocity(y));
      std::fill(this->work_.mu.begin(), this->work_.mu.end(), 0.);
      integrate(old.time, h, y);
      read_off(old, h, y, next);
      double work = holds_work ? y.local_element(2 * this->n_) : 0.;
      work = this->communicator_.sum(Values{work});
      next.energy.work = old.energy.work + work;
      close_balance(old, next, report);
      again = !is_balanced(next, report) &&
              this->scales_.share * this->input_.time.smooth.tolerance >
                  least_tolerance;
      if (again) // and so it stays: the next step has the same motion
        this->scales_.share /= 10.;
    }
    report.solver.converged = true;
    report.solver.newton = unsigned(counters.steps - before.steps);
    report.solver.krylov = unsigned(counters.iterations - before.iterations);
    report.changes = changes_of_energy(old.energy, next);
    return report;
  }

  /** Motion, forces and energies at the end of the step. */
  template <int dim>
  void SmoothMotion<dim>::Equations::read_off(const State &old, const double h,
                                              const Vector &y, State &next)
  {
    const double t = old.time + h;
    carry_history(old, next);
    next.step = old.step + 1;
    next.time = t;
    next.displacement.assign(this->displacement(y),
                             this->displacement(y) + this->n_);
    this->project(t, this->velocity(y), next.velocity);
    next.jump.resize(this->n_rows_);
    next.relative_velocity.resize(this->n_rows_);
    this->free_->relative_velocity(next.displacement.data(), next.jump.data());
    this->free_->relative_velocity(next.velocity.data(),
                                   next.relative_velocity.data());
    this->set_reaction_forces(
        t, this->acceleration(t, next.displacement.data()).data());

    next.impulse.assign(this->n_rows_, 0.);
    Values stored(this->problem_.n_owned, 0.);
    double drift = 0.;
    for (std::size_t i = 0; i < this->kind_.size(); ++i) {
      const auto &joint =
          this->problem_.interactions[this->problem_.interaction[i]];
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        const double u = next.jump[k];
        if (this->kind_[i] == PointKind::elastic) {
          const double pull = this->problem_.weight[i] *
                              joint.normal_stiffness *
                              (c == 0 ? 1. : joint.stiffness_ratio) * u;
          next.impulse[k] = -h * pull;
          if (i < this->problem_.n_owned)
            stored[i] += pull * u / 2.;
        } else if (this->D_joined_[k] == 0.) {
          next.impulse[k] = h * this->work_.lambda[k];
          square += u * u;
        }
      }
      if (this->discretization_.origins()[i].kind ==
          PointOrigin::Kind::interface)
        drift = std::max(drift, std::sqrt(square));
    }
    next.rigid_drift =
        std::max(old.rigid_drift, this->communicator_.max(drift));

    next.energy = old.energy;
    next.energy.kinetic = kinetic_energy(next.velocity);
    next.energy.elastic = half(Operator::stiffness, next.displacement);
    next.energy.cohesive = this->communicator_.sum(stored);
    next.initial_energy = old.initial_energy;
    if (this->bulk_)
      set_bond_tractions(*this->bulk_, next);

    const auto &driven = this->discretization_.driven_boundaries();
    const std::size_t n_owned = this->problem_.n_owned;
    Values terms(reactions.size() * n_owned, 0.);
    for (std::size_t i = 0; i < n_owned; ++i) {
      const PointOrigin origin = this->discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::motion)
        continue;
      const std::size_t d =
          std::size_t(std::find(driven.begin(), driven.end(), origin.block) -
                      driven.begin());
      for (unsigned int c = 0; c < dim; ++c)
        terms[(d * dim + c) * n_owned + i] = next.impulse[i * dim + c] / h;
    }
    if (!reactions.empty())
      reactions =
          this->communicator_.sums(terms.data(), reactions.size(), n_owned);
  }

  template <int dim>
  SmoothMotion<dim>::SmoothMotion(const SceneInput &input,
                                  const Discretization<dim> &discretization,
                                  DelassusOperator<dim> &delassus,
                                  JoinedDelassus<dim> *const bonded)
      : input_(input), discretization_(discretization), delassus_(delassus),
        bonded_(bonded)
  {
  }

  template <int dim>
  SmoothMotion<dim>::~SmoothMotion() = default;

  template <int dim>
  State SmoothMotion<dim>::start_from(State given)
  {
    resume_from(given);
    equations_->start(given);
    return given;
  }

  template <int dim>
  void SmoothMotion<dim>::resume_from(const State &state)
  {
    equations_ = std::make_unique<Equations>(input_, discretization_, delassus_,
                                             bonded_, state);
  }

  template <int dim>
  StepReport SmoothMotion<dim>::advance(const State &old, const double h,
                                        State &next, unsigned int)
  {
    return equations_->advance(old, h, next);
  }

  template <int dim>
  void SmoothMotion<dim>::serialize(Archive &archive)
  {
    equations_->serialize(archive);
  }

  template <int dim>
  const std::vector<double> &SmoothMotion<dim>::reactions() const
  {
    return equations_->reactions;
  }

  template <int dim>
  auto SmoothMotion<dim>::counters() const -> Counters
  {
    return equations_ ? equations_->counters : Counters();
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  SmoothMotion<dim>::stage_seconds() const
  {
    return {{"integration", counters().seconds}};
  }

  template <int dim>
  void SmoothMotion<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    c["arkode_steps"] = double(counters().steps);
    c["arkode_evaluations"] = double(counters().evaluations);
    c["arkode_linear_solves"] = double(counters().linear_solves);
    c["krylov"] = double(counters().iterations);
  }

  template class SmoothMotion<2>;
  template class SmoothMotion<3>;
} // namespace nsfd
