#include "simulation.h"

#include "adaptive_mesh.h"
#include "checkpoint/checkpoints.h"
#include "extremes.h"
#include "model.h"
#include "run_costs.h"
#include "run_end.h"
#include "run_facts.h"
#include "run_info.h"
#include "run_totals.h"
#include "static_run.h"
#include "step_controller.h"

#include "bodies/fragments.h"
#include "check.h"
#include "core/cost.h"
#include "core/exit_code.h"
#include "core/output_folder.h"
#include "core/stop_request.h"
#include "core/stopwatch.h"
#include "postprocess/fragment_output.h"
#include "postprocess/observers.h"
#include "postprocess/run_output.h"
#include "time_integration/remember_state.h"
#include "time_integration/smooth_motion.h"
#include "verification/case_observer.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>

namespace nsfd
{
  namespace
  {
    template <int dim>
    class Simulation
    {
    public:
      Simulation(const SceneInput &input, const RunOptions &options,
                 const Communicator &communicator);
      int run();

    private:
      bool prepare();
      void describe_mesh();
      bool change_mesh(State &next);
      void open_output();
      int fail(const std::string &failure);
      void build_smooth_motion();
      bool resume(const FoundCheckpoint &found);
      void renew_control();
      void remember_state(Archive &archive);
      void remember_parts(Archive &archive, bool with_solver);
      bool store(bool with_solver = true);
      bool find_equilibrium(std::string &failure);
      void start();
      void start_dynamics();
      int step_to_the_end();
      bool take_steps(bool &stopped, std::string &failure);
      int stop(bool between_steps);
      bool claim_folder(bool resumes);
      bool advance(State &next, std::string &failure);
      bool advance_load(State &next, std::string &failure);
      void accept(State &next, const StepReport &report, double time_step);
      void observe(const State *previous, const HistoryRow &row);
      void write_if_due(bool last = false);
      bool find_observables();
      const std::vector<double> &reactions() const;
      TimeIntegrator<dim> &integrator() const;
      void say(const std::vector<std::string> &sentences);
      LineChanges changes_of_energy(const EnergyLines &before) const;
      HistoryRow record(const StepReport &report, double time_step);
      void finish(const std::string &failure);
      RunTotals totals() const;
      void fill_counters(std::map<std::string, double> &counters) const;
      void print_end(const Certificate &certificate) const;

      const SceneInput &input_;
      const RunOptions &options_;
      const Communicator &communicator_;
      Model<dim> model_;
      StepController<dim> steps_;
      std::unique_ptr<CaseObserver<dim>> observer_;
      std::unique_ptr<Observers<dim>> observers_; ///< or null
      std::unique_ptr<Fragments<dim>> fragments_;
      std::unique_ptr<Extremes<dim>> extremes_;
      std::unique_ptr<RunOutput<dim>> output_;
      std::unique_ptr<StaticRun<dim>> static_run_; ///< or null
      bool is_static_ = false; ///< the steps are those of static_run_
      std::unique_ptr<SmoothMotion<dim>> smooth_;   ///< or null
      std::unique_ptr<AdaptiveMesh<dim>> adaptive_; ///< or null
      std::unique_ptr<Checkpoints<dim>> checkpoints_;
      EarlierTotals earlier_; ///< before the checkpoint, if resumed

      State state_;
      Summary summary_;
      RunCosts<dim> costs_;
      SolvedSteps solved_steps_;
      EnergyWatch watch_;          ///< of the lines that must not give energy
      EnergyLines watched_energy_; ///< after the step that it has seen last
      double start_wall_, last_step_ = 0.;
      unsigned int beyond_unique_ = 0;
      unsigned long long released_ = 0; ///< bonds, in accepted steps
      unsigned int stored_at_ = 0;      ///< step of the last checkpoint
      bool stored_ = false;             ///< it is on the disk
      bool resumed_ = false, certified_ = false;
      bool has_solver_ = true; ///< the checkpoint holds what solvers keep
      std::map<std::string, unsigned int> switches_;
    };

    template <int dim>
    Simulation<dim>::Simulation(const SceneInput &input,
                                const RunOptions &options,
                                const Communicator &communicator)
        : input_(input), options_(options), communicator_(communicator),
          steps_(input, model_, communicator), start_wall_(wall_seconds())
    {
    }

    template <int dim>
    int Simulation<dim>::run()
    {
      const double setup = cpu_seconds();
      begin_costs();
      auto charge = std::make_unique<Charge>(Cost::set_up);
      std::optional<FoundCheckpoint> found;
      if (options_.resume && !options_.check) {
        if (!claim_folder(true))
          return exit_code::bad_input;
        found = find_checkpoint(input_, communicator_);
        if (!found)
          return exit_code::bad_input;
      }
      if (!prepare())
        return exit_code::bad_input;
      if (options_.check)
        return print_check<dim>(
            input_, *model_.triangulation, *model_.discretization,
            *model_.stepper, *model_.dynamics,
            model_.dynamic_control(input_, 0.)->base_step(), communicator_);
      if (!input_.adaptivity)
        model_.forget_mesh();
      if (!found && !claim_folder(false))
        return exit_code::bad_input;

      model_.dynamics->reinit(model_.control->step(), input_.time.bulk_theta());
      charge_memory("blocks of the bodies");
      if (input_.adaptivity) {
        adaptive_ =
            std::make_unique<AdaptiveMesh<dim>>(input_, communicator_, model_);
        state_ = found ? adaptive_->restore(stored_cells(*found, communicator_))
                       : adaptive_->start();
        describe_mesh();
        if (!find_observables())
          return exit_code::bad_input;
      } else
        state_ = model_.stepper->initial_state();
      fragments_ = std::make_unique<Fragments<dim>>(*model_.discretization,
                                                    communicator_);
      fragments_->update(state_);
      extremes_ = std::make_unique<Extremes<dim>>(
          input_, *model_.discretization, communicator_);
      charge_memory("state and history of the points");
      open_output();
      summary_.setup_seconds = cpu_seconds() - setup;
      charge.reset();

      std::string failure;
      const bool watches = communicator_.is_root() && !options_.quiet;
      if (found) {
        const bool resumed = resume(*found);
        found.reset(); // a copy of the whole state
        stop_request::remember_signals(watches);
        return resumed ? step_to_the_end() : exit_code::bad_input;
      }
      const bool in_equilibrium =
          !model_.quasi_static || find_equilibrium(failure);
      build_smooth_motion();
      // all ranks do before anybody can see that the run has begun
      stop_request::remember_signals(watches);
      communicator_.any(false);
      start();
      return in_equilibrium ? step_to_the_end() : fail(failure);
    }

    /** One run in a folder at a time. Collective. */
    template <int dim>
    bool Simulation<dim>::claim_folder(const bool resumes)
    {
      bool ours = true;
      if (communicator_.is_root())
        ours = resumes
                   ? OutputFolder::instance().claim(input_.output.directory,
                                                    OutputFolder::Claim::go_on)
                   : claim_directory(input_.output.directory, options_.force);
      return !communicator_.any(!ours);
    }

    template <int dim>
    void Simulation<dim>::build_smooth_motion()
    {
      if (input_.time.scheme == Scheme::arkode)
        smooth_ = std::make_unique<SmoothMotion<dim>>(
            input_, *model_.discretization, *model_.dynamics, state_);
    }

    /** From a checkpoint on; false with the reason on standard error. */
    template <int dim>
    bool Simulation<dim>::resume(const FoundCheckpoint &found)
    {
      if (model_.quasi_static)
        static_run_ =
            std::make_unique<StaticRun<dim>>(input_, model_, communicator_);
      try {
        checkpoints_->read(found, [&](Archive &archive) {
          remember_state(archive);
          build_smooth_motion();
          remember_parts(archive, found.same_solver && has_solver_);
          if (!found.same_steps)
            renew_control();
          output_->remember(archive); // the first to touch a file
          if (observers_)
            observers_->remember(archive);
        });
      } catch (const BadCheckpoint &error) {
        if (communicator_.is_root())
          std::cerr << input_.file << ": error: " << found.file.string() << ": "
                    << error.what() << "\n";
        return false;
      }
      resumed_ = stored_ = true;
      watched_energy_ = state_.energy;
      stored_at_ = state_.step;
      fragments_->update(state_);
      output_->message(fmt::format("goes on after step {}, t = {:.6g}",
                                   state_.step, state_.time));
      return true;
    }

    /** Another end or other steps, from the checkpoint on. */
    template <int dim>
    void Simulation<dim>::renew_control()
    {
      const double end = is_static_ ? input_.statics->until : input_.time.end;
      if (!(end > state_.time * (1. + 1e-12)))
        throw BadCheckpoint(fmt::format(
            "Time/end = {:.6g} s is not after t = {:.6g} s", end, state_.time));
      model_.control = is_static_
                           ? std::make_unique<StepControl>(
                                 end, input_.statics->step,
                                 input_.time.maximum_halvings, state_.time)
                           : model_.dynamic_control(input_, state_.time);
    }

    template <int dim>
    void Simulation<dim>::remember_state(Archive &archive)
    {
      remember(state_, archive);
      archive.numbers("is_static", is_static_, has_solver_);
    }

    /** Everything else that later steps or the end of the run depend on. */
    template <int dim>
    void Simulation<dim>::remember_parts(Archive &archive,
                                         const bool with_solver)
    {
      archive.numbers("last_step", last_step_);
      steps_.serialize(archive);
      model_.control->remember(archive);
      if (smooth_)
        smooth_->remember(archive);
      if (with_solver) {
        const Archive::Part part(archive, "solver");
        model_.dynamics->remember(archive);
        model_.solver->remember(archive);
        if (model_.quasi_static)
          model_.quasi_static->remember(archive);
      }
      if (static_run_)
        static_run_->remember(archive);
      if (observer_)
        observer_->remember(archive);
      if (adaptive_)
        adaptive_->remember(archive);
      watch_.remember(archive);
      archive.numbers("largest", summary_.ledger_defect_max,
                      summary_.residual_max);
      solved_steps_.remember(archive);
      extremes_->remember(archive);
      costs_.remember(archive);
      earlier_.remember(archive, totals());
    }

    /**
     * What goes wrong is a warning: the checkpoints before are still there.
     * Without what the solver keeps if it was left in the middle of a step.
     */
    template <int dim>
    bool Simulation<dim>::store(const bool with_solver)
    {
      const Charge charge(Cost::output);
      stored_at_ = state_.step;
      has_solver_ = with_solver;
      const std::string failure = checkpoints_->write([&](Archive &archive) {
        remember_state(archive);
        remember_parts(archive, with_solver);
        output_->remember(archive);
        if (observers_)
          observers_->remember(archive);
      });
      stored_ = !communicator_.any(!failure.empty());
      if (!failure.empty())
        print_problems(communicator_, input_, "warning",
                       {fmt::format("no checkpoint after step {}: {}; {}",
                                    state_.step, failure,
                                    checkpoints_->has_earlier()
                                        ? "the one before is kept"
                                        : "there is none before it")});
      return stored_;
    }

    /** Instead of the given state at t = 0. */
    template <int dim>
    bool Simulation<dim>::find_equilibrium(std::string &failure)
    {
      static_run_ =
          std::make_unique<StaticRun<dim>>(input_, model_, communicator_);
      is_static_ = true;
      try {
        state_ = model_.quasi_static->start(state_);
      } catch (const StepRejected &rejected) {
        failure = rejected.what();
        return false;
      }
      fragments_->update(state_);
      if (!input_.statics->steps)
        start_dynamics();
      return true;
    }

    /** From an equilibrium on, at rest. */
    template <int dim>
    void Simulation<dim>::start_dynamics()
    {
      is_static_ = false;
      if (input_.statics->steps)
        model_.control = model_.dynamic_control(input_, state_.time);
      state_.impulse = state_.point_force;
      for (double &P : state_.impulse)
        P *= model_.control->step();
      state_.point_force.clear();
    }

    template <int dim>
    int Simulation<dim>::fail(const std::string &failure)
    {
      if (communicator_.is_root())
        std::cerr << input_.file << ": " << failure
                  << "\n  the last good state is in " << input_.output.directory
                  << "\n";
      finish(failure);
      return exit_code::step_failed;
    }

    template <int dim>
    const std::vector<double> &Simulation<dim>::reactions() const
    {
      return is_static_ ? model_.quasi_static->reactions()
                        : integrator().reactions();
    }

    /** Of the steps in time. */
    template <int dim>
    TimeIntegrator<dim> &Simulation<dim>::integrator() const
    {
      if (smooth_)
        return *smooth_;
      return *model_.stepper;
    }

    /** The parts and the verification case; false if the input is bad. */
    template <int dim>
    bool Simulation<dim>::prepare()
    {
      if (!model_.build(input_, communicator_))
        return false;
      describe_mesh();
      if (!input_.observables.empty()) {
        observers_ = std::make_unique<Observers<dim>>(
            input_, *model_.discretization, communicator_);
        if (!find_observables())
          return false;
      }
      if (!input_.verification)
        return true;
      try {
        input_.verification->initialise(input_);
      } catch (const std::runtime_error &error) {
        print_problems(communicator_, input_, "error", {error.what()});
        return false;
      }
      observer_ = std::make_unique<CaseObserver<dim>>(
          *input_.verification, input_.time, *model_.discretization,
          communicator_);
      return true;
    }

    /** What the observables look at; false if it is not there. */
    template <int dim>
    bool Simulation<dim>::find_observables()
    {
      if (!observers_)
        return true;
      try {
        observers_->find(*model_.triangulation, *model_.groups);
      } catch (const std::runtime_error &error) {
        print_problems(communicator_, input_, "error", {error.what()});
        return false;
      }
      return true;
    }

    template <int dim>
    void Simulation<dim>::describe_mesh()
    {
      const auto &mesh = *model_.discretization;
      summary_.dimension = dim;
      summary_.cells = mesh.n_global_cells();
      summary_.dofs = communicator_.sum_integer(mesh.bodies().n_dofs());
      summary_.interface_points =
          communicator_.sum_integer(mesh.points().n_owned);
    }

    /**
     * Where the step has arrived, the mesh may be too coarse. True if it has
     * changed, and the step is to be taken again.
     */
    template <int dim>
    bool Simulation<dim>::change_mesh(State &next)
    {
      if (!adaptive_)
        return false;
      const Charge charge(Cost::set_up);
      if (!adaptive_->follow(state_, next)) {
        adaptive_->accept();
        return false;
      }
      next = state_;
      describe_mesh();
      fragments_ = std::make_unique<Fragments<dim>>(*model_.discretization,
                                                    communicator_);
      fragments_->update(state_);
      const State at_start = model_.stepper->initial_state();
      output_->mesh_changed(at_start);
      checkpoints_->mesh_changed();
      extremes_->mesh_changed();
      if (observer_)
        observer_->mesh_changed(at_start);
      if (observers_)
        observers_->find(*model_.triangulation, *model_.groups);
      return true;
    }

    template <int dim>
    void Simulation<dim>::open_output()
    {
      const RunInfo info =
          run_info(input_, options_, model_, unsigned(communicator_.size()));
      output_ = std::make_unique<RunOutput<dim>>(
          input_, info, options_.quiet, options_.verbose,
          *model_.discretization, communicator_,
          observers_ ? observers_->records() : std::vector<ObservableRecord>(),
          options_.resume);
      if (has_fragments(input_, *model_.discretization, *fragments_,
                        communicator_))
        output_->set_fragments(std::make_unique<FragmentOutput<dim>>(
            input_.output.directory,
            FragmentMotion<dim>(*model_.discretization, communicator_,
                                model_.moving.get(),
                                model_.stepper->initial_state()),
            communicator_, options_.resume));
      if (observers_ && !options_.resume)
        observers_->start_files();
      checkpoints_ = std::make_unique<Checkpoints<dim>>(
          input_, options_, *model_.discretization, communicator_);
      if (communicator_.is_root() && !options_.quiet)
        print_opening(input_, info, summary_, model_.control->base_step(),
                      model_.discretization->crossing_time());
    }

    /** The state at t = 0. */
    template <int dim>
    void Simulation<dim>::start()
    {
      last_step_ = model_.control->step();
      write_if_due();
      HistoryRow row;
      row.energy = state_.energy;
      row.broken_area = state_.broken_area;
      row.fragments = fragments_->count();
      row.reactions = reactions();
      output_->start(row);
      say(extremes_->start(state_));
      observe(nullptr, row);
    }

    /** Observables first: cases may look at them. */
    template <int dim>
    void Simulation<dim>::observe(const State *previous, const HistoryRow &row)
    {
      if (observers_)
        observers_->observe(state_, previous, row);
      if (observer_)
        observer_->observe(state_, row,
                           observers_ ? &observers_->records() : nullptr);
    }

    template <int dim>
    void Simulation<dim>::write_if_due(const bool last)
    {
      if (output_->write_if_due(state_, last_step_, *fragments_, last) &&
          observers_)
        observers_->write_profiles(state_, last_step_);
    }

    template <int dim>
    int Simulation<dim>::step_to_the_end()
    {
      std::string failure;
      bool stopped = false;
      try {
        if (!take_steps(stopped, failure)) {
          store();
          return fail(failure);
        }
      } catch (const StopRequested &) {
        return stop(false);
      }
      if (stopped)
        return stop(true);
      if (checkpoints_->wanted() && stored_at_ != state_.step)
        store();
      finish("");
      return options_.strict && !certified_ ? exit_code::not_certified
                                            : exit_code::done;
    }

    /** To the end, or to where a signal asks to stop. False if it failed. */
    template <int dim>
    bool Simulation<dim>::take_steps(bool &stopped, std::string &failure)
    {
      State next = state_;
      charge_memory("state and history of the points");
      while (!model_.control->finished() || is_static_) {
        if (model_.control->finished()) {
          if (input_.statics->until >= input_.time.end)
            break;
          start_dynamics();
        }
        if (communicator_.any(stop_request::requested())) {
          stopped = true;
          return true;
        }
        if (!(is_static_ ? advance_load(next, failure)
                         : advance(next, failure)))
          return false;
      }
      return true;
    }

    /** The last good state is stored, with a line to paste. */
    template <int dim>
    int Simulation<dim>::stop(const bool between_steps)
    {
      const bool have =
          (stored_ && stored_at_ == state_.step) || store(between_steps);
      finish(fmt::format("stopped on request at t = {:.6g}", state_.time));
      if (communicator_.is_root())
        std::cerr << fmt::format("{}: stopped by {} at t = {:.6g}, after step "
                                 "{}{}\n  {}\n",
                                 input_.file, stop_request::reason(),
                                 state_.time, state_.step,
                                 between_steps ? "" : ", within the next one",
                                 have ? "go on with: " + options_.resume_line
                                      : "this state could not be stored");
      return exit_code::stopped;
    }

    /** Take a step, or shorten the next one; false with the reason. */
    template <int dim>
    bool Simulation<dim>::advance(State &next, std::string &failure)
    {
      using Outcome = typename StepController<dim>::Outcome;
      StepReport report;
      const Outcome outcome =
          steps_.step(integrator(), state_, next, report, failure);
      const double h = model_.control->step();
      if (outcome != Outcome::taken || change_mesh(next))
        return outcome != Outcome::failed;
      steps_.accept();
      accept(next, report, h);
      return true;
    }

    /** A step of the load. */
    template <int dim>
    bool Simulation<dim>::advance_load(State &next, std::string &failure)
    {
      using Outcome = typename StaticRun<dim>::Outcome;
      const double h = model_.control->step();
      StepReport report;
      const auto outcome = [&] {
        const stop_request::Interruptible step(communicator_.size());
        return static_run_->step(state_, next, report, failure);
      }();
      if (const std::string reason = bad_formulas_text(communicator_);
          !reason.empty()) {
        failure = reason;
        return false;
      }
      switch (outcome) {
      case Outcome::accepted:
        accept(next, report, h);
        return true;
      case Outcome::to_dynamics:
        start_dynamics();
        return true;
      case Outcome::shortened:
        return true;
      default:
        return false;
      }
    }

    template <int dim>
    void Simulation<dim>::accept(State &next, const StepReport &report,
                                 const double h)
    {
      model_.control->accept();
      next.time = model_.control->time();
      std::swap(state_, next);
      last_step_ = h;
      const Charge charge(Cost::output);
      fragments_->update(state_);
      const HistoryRow row = record(report, h);
      say(extremes_->observe(next, state_)); // next: before the step
      observe(&next, row);
      write_if_due();
      if (checkpoints_->is_due(state_.step))
        store();
    }

    /** Between the lines of the progress. */
    template <int dim>
    void Simulation<dim>::say(const std::vector<std::string> &sentences)
    {
      for (const std::string &sentence : sentences)
        output_->message(sentence);
    }

    /** Of a step of an integrator that does not split them by point. */
    template <int dim>
    LineChanges
    Simulation<dim>::changes_of_energy(const EnergyLines &before) const
    {
      LineChanges changes;
      changes.scale = state_.largest_energy;
      const auto take = [&](const WatchedLine line,
                            double EnergyLines::*const member) {
        changes.taken[std::size_t(line)] =
            state_.energy.*member - before.*member;
      };
      take(WatchedLine::friction, &EnergyLines::friction);
      take(WatchedLine::damage, &EnergyLines::damage);
      take(WatchedLine::impact, &EnergyLines::impact);
      take(WatchedLine::viscous, &EnergyLines::viscous);
      take(WatchedLine::plastic, &EnergyLines::plastic);
      take(WatchedLine::scheme, &EnergyLines::numerical);
      return changes;
    }

    template <int dim>
    HistoryRow Simulation<dim>::record(const StepReport &report,
                                       const double time_step)
    {
      beyond_unique_ += report.beyond_unique;
      released_ += report.released;
      watch_.add(is_static_ || smooth_ ? changes_of_energy(watched_energy_)
                                       : report.changes);
      watched_energy_ = state_.energy;
      costs_.record(report.solver, model_.dynamics->counters().delassus);
      solved_steps_.add(is_static_ ? SolvedSteps::Kind::quasi_static
                        : smooth_  ? SolvedSteps::Kind::smooth
                                   : SolvedSteps::Kind::dynamic,
                        report.solver.residual);
      for (const auto &name : report.solver.switches)
        ++switches_[name];
      HistoryRow row;
      row.step = state_.step;
      row.time = state_.time;
      row.time_step = time_step;
      row.energy = state_.energy;
      row.ledger_defect = report.ledger_defect;
      row.broken_area = state_.broken_area;
      row.fragments = fragments_->count();
      row.active = report.active;
      row.newton = report.solver.newton;
      row.krylov = report.solver.krylov;
      row.residual = report.solver.residual;
      row.reactions = reactions();
      summary_.ledger_defect_max =
          std::max(summary_.ledger_defect_max, row.ledger_defect);
      summary_.residual_max = std::max(summary_.residual_max, row.residual);
      output_->record(row);
      return row;
    }

    template <int dim>
    void Simulation<dim>::finish(const std::string &failure)
    {
      const Charge charge(Cost::output);
      write_if_due(true);
      say(extremes_->finish(state_));
      output_->end_progress();
      auto &s = summary_;
      s.completed = failure.empty();
      s.failure = failure;
      s.steps = state_.step;
      s.final_time = state_.time;
      s.energy = state_.energy;
      s.penetration_max = state_.penetration;
      s.positive_friction_work = state_.positive_friction_work;
      if (!state_.pressure.empty())
        s.pressure_work = state_.pressure_work;
      s.viscous_traction_max = state_.viscous_traction;
      s.rigid_drift_max = state_.rigid_drift;
      s.fragments = fragments_->count();
      s.penetration_bound = extremes_->penetration_bound();
      if (observer_)
        observer_->finish(state_, s.errors);
      if (observers_)
        s.observables = observers_->records();
      RunTotals sums = totals();
      earlier_.add_to(sums);
      s.counters = sums.counters;
      if (adaptive_)
        adaptive_->fill_counters(s.counters);
      s.wall_seconds = sums.wall_seconds;
      s.cpu_seconds = sums.cpu_seconds;
      s.timings = sums.timings;
      s.peak_memory_mb = peak_memory_mb();
      charge_memory("fields and curves");
      s.cost = costs_.finish(*model_.dynamics);
      const Certificate certificate =
          certify(run_facts(input_, model_, solved_steps_, *extremes_, watch_,
                            state_, s, communicator_));
      certified_ = certificate.is_ok();
      output_->write_summary(s, certificate);
      if (communicator_.is_root() && !options_.quiet)
        print_end(certificate);
    }

    /** Of this process. */
    template <int dim>
    RunTotals Simulation<dim>::totals() const
    {
      RunTotals sums;
      fill_counters(sums.counters);
      if (static_run_)
        static_run_->fill_counters(sums.counters);
      if (resumed_)
        sums.counters["resumed"] = 1.;
      if (checkpoints_->n_failed() > 0)
        sums.counters["failed_checkpoints"] = checkpoints_->n_failed();
      sums.timings =
          stage_timings(model_, summary_.setup_seconds, output_->cpu());
      if (smooth_)
        sums.timings.insert(sums.timings.begin() + 1,
                            {"integration", smooth_->counters().seconds});
      sums.wall_seconds = wall_seconds() - start_wall_;
      sums.cpu_seconds = cpu_seconds();
      return sums;
    }

    template <int dim>
    void Simulation<dim>::fill_counters(std::map<std::string, double> &c) const
    {
      const auto &dynamics = model_.dynamics->counters();
      model_.stepper->fill_counters(c);
      steps_.fill_counters(c);
      c["delassus_applications"] = double(dynamics.delassus);
      c["block_factorisations"] = double(dynamics.factorisations);
      c["global_factorisations"] = double(dynamics.global_factorisations);
      c["coarse_spaces"] = double(dynamics.coarse_spaces);
      c["global_solves"] = double(dynamics.global_solves);
      c["inner_iterations"] = double(dynamics.inner_iterations);
      // products with W and, inside the preconditioner, with A
      c["operator_applications"] =
          double(dynamics.delassus + dynamics.inner_iterations);
      if (model_.bonded)
        c["released_bonds"] = double(released_);
      c["steps_beyond_uniqueness"] = beyond_unique_;
      c["penetration_excess"] = state_.penetration_excess;
      if (smooth_)
        smooth_->fill_counters(c);
      count_points(input_, *model_.discretization, communicator_, c);
      c["body_classes"] = communicator_.max(
          double(model_.discretization->bodies().classes.size()));
      for (const auto &[name, count] : switches_)
        c["switches_to_" + name] = count;
    }

    template <int dim>
    void Simulation<dim>::print_end(const Certificate &certificate) const
    {
      const auto &output = input_.output;
      std::cout << run_end_text(summary_, certificate, state_.broken_area,
                                output.directory +
                                    (output.report ? "/report.html" : "/"),
                                options_.verbose);
    }
  } // namespace

  int run_scene(const SceneInput &input, const RunOptions &options,
                const MPI_Comm mpi)
  {
    const Communicator communicator(mpi);
    if (input.dimension == 2)
      return Simulation<2>(input, options, communicator).run();
    return Simulation<3>(input, options, communicator).run();
  }
} // namespace nsfd
