#include "simulation.h"

#include "check.h"
#include "choose_scheme.h"
#include "forecast.h"
#include "path_report.h"
#include "print_problems.h"
#include "run_store.h"
#include "silence.h"

#include "core/cost.h"
#include "core/exit_code.h"
#include "core/output_folder.h"
#include "core/pages_of_zeros.h"
#include "core/stop_request.h"
#include "core/stopwatch.h"
#include "records/engineering.h"
#include "state/point_fields.h"

#include <fmt/format.h>

#include <iostream>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** From the parts of a scene over all steps to an exit code. */
    template <int dim>
    class Simulation
    {
    public:
      /** @p built: all its parts, or null. */
      Simulation(const SceneInput &input, const RunOptions &options,
                 const Communicator &communicator,
                 std::unique_ptr<Model<dim>> built);
      int run();

    private:
      bool build();
      int check();
      FirstSteps try_steps(double set_up);
      bool claim_folder(bool resumes);
      bool set_state(const std::optional<FoundCheckpoint> &found);
      int resume(std::optional<FoundCheckpoint> &found);
      void watch_signals() const;
      int start();
      int step_to_the_end();
      bool take_steps(bool &stopped, std::string &failure);
      bool is_over();
      bool advance(State &next, std::string &failure);
      bool change_mesh(State &next);
      bool warm(State &before, std::string &failure);
      bool accept(State &next, const StepReport &report, double time_step,
                  std::string &failure);
      int stop(bool between_steps);
      int fail(const std::string &failure);
      void finish(const std::string &failure);

      const SceneInput &input_;
      const RunOptions &options_;
      const Communicator &communicator_;
      RunParts<dim> parts_;
      Model<dim> &model_ = parts_.model;
      TimeStepping<dim> &steps_ = parts_.steps;
      RunRecorder<dim> &recorder_ = parts_.recorder;
      State &state_ = parts_.state;
      std::unique_ptr<RunStore<dim>> store_; ///< null: only checked
      const bool is_built_;                  ///< before
      bool certified_ = false;
    };

    template <int dim>
    Simulation<dim>::Simulation(const SceneInput &input,
                                const RunOptions &options,
                                const Communicator &communicator,
                                std::unique_ptr<Model<dim>> built)
        : input_(input), options_(options), communicator_(communicator),
          parts_(input, options, communicator), is_built_(built)
    {
      if (built)
        model_ = std::move(*built);
    }

    template <int dim>
    int Simulation<dim>::run()
    {
      auto charge = std::make_unique<Charge>(Cost::set_up);
      std::optional<FoundCheckpoint> found;
      if (options_.resume && !options_.check) {
        if (!claim_folder(true))
          return exit_code::bad_input;
        found = find_checkpoint(input_, communicator_);
        if (!found)
          return exit_code::bad_input;
      }
      if (!build() || !recorder_.prepare())
        return exit_code::bad_input;
      if (options_.check)
        return check();
      if (!input_.mesh_changes())
        model_.forget_mesh();
      if (!found && !claim_folder(false))
        return exit_code::bad_input;
      if (!set_state(found))
        return exit_code::bad_input;
      recorder_.open(state_);
      if (!input_.may_move())
        model_.forget_dynamics();
      release_freed_memory();
      store_ = std::make_unique<RunStore<dim>>(parts_);
      charge.reset();
      if (!found)
        return start();
      return resume(found);
    }

    template <int dim>
    bool Simulation<dim>::build()
    {
      std::vector<std::string> problems;
      if (!is_built_)
        problems = model_.build(input_, communicator_);
      if (problems.empty() && input_.mesh_changes())
        try {
          parts_.adaptive = make_mesh_changes(input_, communicator_, model_);
        } catch (const std::runtime_error &error) {
          problems.push_back(error.what());
        }
      print_problems(communicator_, input_, "error", problems);
      return problems.empty();
    }

    template <int dim>
    int Simulation<dim>::check()
    {
      const double set_up = cpu_seconds();
      const int code = print_check<dim>(
          input_, *model_.triangulation, *model_.discretization,
          model_.stepper.get(), model_.delassus.get(),
          model_.dynamic_control(input_, 0.)->base_step(), communicator_);
      if (code != exit_code::done)
        return code;
      print_path(input_, model_, communicator_);
      const OutputCounts counts = {
          double(model_.discretization->cells().n_global),
          double(communicator_.sum_integer(
              model_.discretization->points().n_owned))};
      const FirstSteps trial = try_steps(set_up);
      const double megabytes = communicator_.max(peak_memory_mb());
      if (communicator_.is_root())
        std::cout << forecast_text(input_, trial,
                                   forecast(input_, trial, counts, megabytes));
      return code;
    }

    /** The first ones of the run, without a file. Collective. */
    template <int dim>
    FirstSteps Simulation<dim>::try_steps(const double set_up)
    {
      const Silence silence; // it is the run that says what happens
      StepTrial trial(communicator_, set_up);
      const double before = cpu_seconds();
      std::string failure;
      try {
        if (!set_state({}))
          return trial.finish();
        recorder_.open(state_);
        if (!input_.may_move())
          model_.forget_dynamics();
        trial.begin(set_up + cpu_seconds() - before, state_.time);
        try {
          const stop_request::Interruptible interruptible(communicator_.size());
          steps_.start(state_);
        } catch (const StepRejected &rejected) { // on all ranks
          failure = rejected.what();
        }
        recorder_.start(state_);
        State next;
        if (!steps_.integrator().keeps_motion())
          next = state_;
        while (failure.empty() && !is_over() && trial.goes_on()) {
          const unsigned int step = state_.step;
          advance(next, failure);
          if (state_.step > step)
            trial.add(state_.time);
        }
      } catch (const StopRequested &) { // the time of the trial is over
      } catch (const std::exception &error) {
        if (communicator_.size() > 1) // others may wait for this one
          throw;
        failure = error.what();
      }
      trial.fail(failure);
      return trial.finish();
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

    /** The given state at t = 0, on the mesh of the checkpoint if resumed. */
    template <int dim>
    bool Simulation<dim>::set_state(const std::optional<FoundCheckpoint> &found)
    {
      // steps of a load have an operator of their own, and dynamic ones after
      // them set theirs
      if (model_.delassus && !(input_.statics && input_.statics->steps))
        model_.delassus->reinit(model_.control->step(),
                                input_.time.bulk_theta());
      charge_memory("blocks of the bodies");
      if (!input_.mesh_changes())
        state_ = model_.initial_state();
      else
        state_ =
            found
                ? parts_.adaptive->restore(stored_cells(*found, communicator_))
                : parts_.adaptive->start();
      if (input_.has_heat()) {
        parts_.heat = std::make_unique<BodyHeat<dim>>(*model_.discretization,
                                                      communicator_);
        parts_.heat->start(state_);
      }
      parts_.events.start(*model_.discretization, communicator_, state_);
      return !input_.mesh_changes() || recorder_.find_observables();
    }

    template <int dim>
    int Simulation<dim>::resume(std::optional<FoundCheckpoint> &found)
    {
      const bool resumed = store_->resume(*found);
      found.reset(); // a copy of the whole state
      if (resumed)
        recorder_.resume(state_);
      watch_signals();
      return resumed ? step_to_the_end() : exit_code::bad_input;
    }

    template <int dim>
    void Simulation<dim>::watch_signals() const
    {
      stop_request::catch_signals(communicator_.is_root() && !options_.quiet);
    }

    template <int dim>
    int Simulation<dim>::start()
    {
      std::string failure;
      try {
        steps_.start(state_);
      } catch (const StepRejected &rejected) {
        failure = rejected.what();
      }
      // all ranks do before anybody can see that the run has begun
      watch_signals();
      communicator_.any(false);
      recorder_.start(state_);
      return failure.empty() ? step_to_the_end() : fail(failure);
    }

    template <int dim>
    int Simulation<dim>::step_to_the_end()
    {
      std::string failure;
      bool stopped = false;
      try {
        if (!take_steps(stopped, failure)) {
          store_->store();
          return fail(failure);
        }
      } catch (const StopRequested &) {
        return stop(false);
      }
      if (stopped)
        return stop(true);
      if (parts_.events.ends_run(state_))
        recorder_.message(fmt::format("nothing has broken for {} steps: the "
                                      "run ends at t = {}",
                                      input_.time.rest_steps,
                                      engineering(state_.time, "s", 6)));
      store_->store_last();
      finish("");
      return options_.strict && !certified_ ? exit_code::not_certified
                                            : exit_code::done;
    }

    /** To the end, or to where a signal asks to stop. False if it failed. */
    template <int dim>
    bool Simulation<dim>::take_steps(bool &stopped, std::string &failure)
    {
      State next;
      if (!steps_.integrator().keeps_motion())
        next = state_;
      charge_memory("state and history of the points");
      while (!is_over()) {
        if (communicator_.any(stop_request::requested())) {
          stopped = true;
          return true;
        }
        if (!advance(next, failure))
          return false;
      }
      return true;
    }

    /** The end is reached, or the crack has come to rest. Collective. */
    template <int dim>
    bool Simulation<dim>::is_over()
    {
      return parts_.events.ends_run(state_) || steps_.finished(state_);
    }

    /** Take a step, or shorten the next one; false with the reason. */
    template <int dim>
    bool Simulation<dim>::advance(State &next, std::string &failure)
    {
      using Outcome = typename TimeStepping<dim>::Outcome;
      StepReport report;
      const Outcome outcome = steps_.step(state_, next, report, failure);
      const double h = model_.control->step();
      if (outcome != Outcome::taken || change_mesh(next))
        return outcome != Outcome::failed;
      return accept(next, report, h, failure);
    }

    /**
     * Where the step has arrived, the mesh may be too coarse. True if it has
     * changed, and the step is to be repeated.
     */
    template <int dim>
    bool Simulation<dim>::change_mesh(State &next)
    {
      auto &adaptive = parts_.adaptive;
      if (!adaptive)
        return false;
      const Charge charge(Cost::set_up);
      if (!adaptive->follow(state_, next))
        return false;
      next = state_;
      recorder_.change_mesh(state_);
      if (store_)
        store_->mesh_changed();
      return true;
    }

    /** @p before: the state before the step, which has the temperatures. False
        with the reason if heat could not be conducted. */
    template <int dim>
    bool Simulation<dim>::warm(State &before, std::string &failure)
    {
      if (!parts_.heat)
        return true;
      const Charge charge(Cost::heat);
      std::swap(state_.heat.of_points, before.heat.of_points);
      std::swap(state_.heat.of_cells, before.heat.of_cells);
      std::swap(state_.heat, before.heat);
      try {
        parts_.heat->accept(state_,
                            [this] { steps_.integrator().show(state_); });
      } catch (const std::runtime_error &error) { // on all ranks
        failure = fmt::format("{} at t = {:.6g} s", error.what(), state_.time);
        return false;
      }
      return true;
    }

    /** False with the reason if the run cannot go on after it. */
    template <int dim>
    bool Simulation<dim>::accept(State &next, const StepReport &report,
                                 const double h, std::string &failure)
    {
      steps_.accept();
      next.time = model_.control->time();
      std::swap(state_, next);
      if (steps_.integrator().keeps_motion())
        swap_motion(state_, next); // there is one of it
      const bool is_good = warm(next, failure);
      const auto news =
          parts_.events.accept(next, steps_.integrator(),
                               *model_.discretization, communicator_, state_);
      {
        const Charge charge(Cost::output);
        recorder_.record(next, state_, report, h); // next: before the step
        for (const std::string &sentence : news)
          recorder_.message(sentence);
      }
      if (parts_.adaptive) {
        const Charge charge(Cost::set_up);
        if (parts_.adaptive->accept(state_)) {
          recorder_.change_mesh(state_);
          if (store_)
            store_->mesh_changed();
        }
      }
      const Charge charge(Cost::output);
      if (store_)
        store_->store_if_due();
      return is_good;
    }

    /** The last good state is stored, with a line to paste. */
    template <int dim>
    int Simulation<dim>::stop(const bool between_steps)
    {
      const bool have = store_->keep(between_steps);
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
    void Simulation<dim>::finish(const std::string &failure)
    {
      const Charge charge(Cost::output);
      std::map<std::string, double> counters;
      if (parts_.adaptive)
        parts_.adaptive->fill_counters(counters);
      parts_.events.fill_counters(state_, counters);
      if (parts_.heat)
        parts_.heat->fill_counters(state_.time, counters);
      certified_ = recorder_.finish(state_, failure, store_->n_failed(),
                                    std::move(counters));
    }
  } // namespace

  int run_scene(const SceneInput &input, const RunOptions &options,
                const MPI_Comm mpi)
  {
    const Communicator communicator(mpi);
    begin_costs();
    ChosenScene chosen = [&] {
      const Charge charge(Cost::set_up);
      return choose_scheme(input, options.check, communicator);
    }();
    std::cerr << chosen.warnings;
    if (!std::get<0>(chosen.built) && !std::get<1>(chosen.built))
      begin_costs(); // nothing of it is in the run
    const auto run = [&](auto &built) {
      using Parts = std::decay_t<decltype(*built)>;
      return Simulation<Parts::dimension>(*chosen.scene, options, communicator,
                                          std::move(built))
          .run();
    };
    return chosen.scene->dimension == 2 ? run(std::get<0>(chosen.built))
                                        : run(std::get<1>(chosen.built));
  }
} // namespace nsfd
