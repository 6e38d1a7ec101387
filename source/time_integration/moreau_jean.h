#pragma once

#include "time_integrator.h"

#include "nsfd/discretization/discretization.h"

#include <memory>

namespace nsfd
{
  struct SceneInput;
  template <int dim>
  class CrackPressure;
  template <int dim>
  class ElasticForces;
  template <int dim>
  class EnergySafeSliding;
  template <int dim>
  class Ledger;
  template <int dim>
  class UniquenessBound;
  template <int dim>
  class DrivenMotion;
  template <int dim>
  class BondedDynamics;
  template <int dim>
  class BulkTraction;

  /**
   * The implicit Moreau-Jean step: theta scheme in the bulk, velocity-level
   * contact, impulses of all points in one nonsmooth problem (report, 5.2-5.3).
   * Every energy line of the step is computed on its own.
   */
  template <int dim>
  class MoreauJean : public TimeIntegrator<dim>
  {
  public:
    /** @p bonded is @p dynamics if the scene has bonded faces, else null. */
    MoreauJean(const SceneInput &input,
               const Discretization<dim> &discretization,
               Dynamics<dim> &dynamics, NonsmoothSolver<dim> &solver,
               BondedDynamics<dim> *bonded = nullptr);
    ~MoreauJean() override;

    /** State at t = 0: positions, velocities, gaps, broken points. */
    virtual State initial_state() const;

    /**
     * The motion and the points of @p state are known: its stored energies,
     * bonds and their tractions.
     */
    void complete(State &state) const;

    /** Rejected is what was not solved to the tolerance. */
    StepReport
    advance(const State &old, double time_step, State &next,
            unsigned int idle_rounds = SolverControl().idle_rounds) override;

    /**
     * Up to which a step has one solution, by the points that soften at
     * @p state; infinite if there is none.
     */
    double unique_step(const State &state) const;
    /** The same by the points that softened between two states. */
    double unique_step(const State &old, const State &next) const;
    /** Share of unique_step() that `step = auto` takes. */
    static constexpr double bound_share = 0.95;
    /** What `step = auto` takes from @p state, at most @p time_step. */
    double automatic_step(const State &state, double time_step) const;

    const std::vector<double> &reactions() const override;
    void fill_counters(std::map<std::string, double> &counters) const override;

    const OneStepProblem<dim> &problem() const { return problem_; }

    struct Timings {
      double assembly = 0., solve = 0., update = 0., ledger = 0.;
    };
    const Timings &timings() const { return timings_; }
    struct Counters {
      unsigned long long solves = 0, newton = 0, krylov = 0, sweeps = 0,
                         law_sweeps = 0, line_searches = 0, load_assemblies = 0,
                         activation_rounds = 0, sliding_rounds = 0;
    };
    const Counters &counters() const { return counters_; }
    /** Counts go on where those of another mesh have ended. */
    void continue_counters(const Timings &timings, const Counters &counters)
    {
      timings_ = timings;
      counters_ = counters;
    }

  protected:
    /** What the input asks of the solver of a step. */
    SolverControl solver_control(unsigned int idle_rounds) const;
    void set_loads(double time);
    void move_freely(const State &old, const std::vector<double> &pressure);
    /** set_step(), and the velocities that friction opposes. */
    void set_problem_of_step(const std::vector<PointOrigin> &origins,
                             const State &old, double time_step,
                             OneStepProblem<dim> &problem) const;
    /**
     * Again as long as extrinsic points reach their strength, or friction gives
     * energy; @p old as it was for set_step().
     */
    SolverReport solve(NonsmoothSolver<dim> &solver,
                       OneStepProblem<dim> &problem,
                       const std::vector<PointOrigin> &origins,
                       const SolverControl &control, double energy_scale,
                       const State &old, std::vector<double> &impulse,
                       LawEvaluation<dim> &evaluation);
    [[noreturn]] void reject(double time_step, double time,
                             const SolverReport &report,
                             std::size_t worst_point) const;
    void check_books(double time_step, double time, double energy_scale,
                     const State &next, const StepReport &report,
                     std::size_t worst_point) const;
    /**
     * Notes what the lines of the balance took. @throws StepRejected where one
     * gave energy that its rule cannot give: line, step and place.
     */
    void watch_energy(double energy_scale, const State &old, const State &next,
                      StepReport &report) const;
    void move(const State &old, const LawEvaluation<dim> &evaluation,
              State &next) const;
    virtual std::string describe(std::size_t point) const;
    std::string describe(const PointOrigin &origin, const double *place) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    Dynamics<dim> &dynamics_;
    NonsmoothSolver<dim> &solver_;
    BondedDynamics<dim> *bonded_; ///< or null
    OneStepProblem<dim> problem_;
    std::unique_ptr<UniquenessBound<dim>> uniqueness_;
    std::unique_ptr<Ledger<dim>> ledger_;
    std::unique_ptr<DrivenMotion<dim>> motion_;
    std::unique_ptr<CrackPressure<dim>> crack_pressure_; ///< or null
    std::unique_ptr<BulkTraction<dim>> bulk_; ///< or null: no bonded faces
    std::unique_ptr<ElasticForces<dim>> elastic_forces_; ///< of explicit steps
    std::unique_ptr<EnergySafeSliding<dim>> sliding_;
    bool has_extrinsic_ = false;
    /// The last attempt lost its digits or its energy: rows that ask for the
    /// same share what no motion tells, warm starts carry it on, and it grows.
    /// The next attempt starts without impulses.
    mutable bool starts_cold_ = false;
    std::vector<double> forces_, v_free_, work_;
    bool forces_known_ = false;
    double forces_time_ = 0.;
    Timings timings_;
    Counters counters_;
  };
} // namespace nsfd
