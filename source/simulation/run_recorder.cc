#include "run_recorder.h"

#include "print_problems.h"
#include "run_end.h"
#include "run_info.h"

#include "core/cost.h"
#include "discretization/cells.h"
#include "nsfd/core/archive.h"
#include "postprocess/fragment_output.h"
#include "records/run_options.h"

#include <iostream>
#include <optional>

namespace nsfd
{
  namespace
  {
    std::string files_text(const OutputInput &output)
    {
      if (!output.report)
        return "no pictures were asked for; numbers: " + output.directory + "/";
      std::string text = "pictures: " + output.directory + "/report.html";
      if (output.fields)
        text += fmt::format("; for ParaView: fields.{0} and interfaces.{0} "
                            "beside it",
                            output.format == FieldFormat::vtkhdf ? "vtkhdf"
                            : output.format == FieldFormat::hdf5 ? "xdmf"
                                                                 : "pvd");
      return text;
    }

    std::optional<HeatRecord> heat_of(const SceneInput &input,
                                      const State &state, const double hottest)
    {
      if (!input.has_heat())
        return std::nullopt;
      return HeatRecord{state.heat.made, state.heat.stored, hottest,
                        state.heat.given};
    }
  } // namespace

  template <int dim>
  RunRecorder<dim>::RunRecorder(const SceneInput &input,
                                const RunOptions &options,
                                const Model<dim> &model,
                                const TimeStepping<dim> &steps,
                                const Communicator &communicator)
      : input_(input), options_(options), model_(model), steps_(steps),
        communicator_(communicator), tally_(input, model, steps, communicator)
  {
  }

  template <int dim>
  bool RunRecorder<dim>::prepare()
  {
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

  template <int dim>
  bool RunRecorder<dim>::find_observables()
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
  void RunRecorder<dim>::describe_mesh()
  {
    const auto &mesh = *model_.discretization;
    summary_.dimension = dim;
    summary_.axisymmetric = mesh.input().axisymmetric;
    summary_.cells = mesh.cells().n_global;
    summary_.dofs = communicator_.sum_integer(mesh.bodies().n_dofs());
    summary_.interface_points =
        communicator_.sum_integer(mesh.points().n_owned);
  }

  template <int dim>
  void RunRecorder<dim>::open(const State &state)
  {
    describe_mesh();
    fragments_ =
        std::make_unique<Fragments<dim>>(*model_.discretization, communicator_);
    fragments_->update(state);
    extremes_ = std::make_unique<Extremes<dim>>(input_, *model_.discretization,
                                                communicator_);
    charge_memory("state and history of the points");
    const RunInfo info =
        run_info(input_, options_, model_, unsigned(communicator_.size()));
    output_ = std::make_unique<RunOutput<dim>>(
        input_, info, options_, *model_.discretization, communicator_,
        observers_ ? observers_->records() : std::vector<ObservableRecord>());
    if (!options_.check && has_fragments(input_, *model_.discretization,
                                         *fragments_, communicator_)) {
      std::optional<State> given; // else it is `state`
      if (input_.mesh_changes())
        given = model_.initial_state();
      output_->set_fragments(std::make_unique<FragmentOutput<dim>>(
          input_.output.directory,
          FragmentMotion<dim>(*model_.discretization, communicator_,
                              model_.moving.get(), given ? *given : state),
          communicator_, options_.resume,
          input_.output.fields && input_.output.format == FieldFormat::vtkhdf));
    }
    if (observers_ && !options_.resume && !options_.check)
      observers_->start_files();
    if (communicator_.is_root() && !options_.quiet && !options_.check)
      print_opening(input_, info, summary_, model_.control->base_step(),
                    model_.discretization->crossing_time());
    tally_.set_up();
  }

  template <int dim>
  void RunRecorder<dim>::start(const State &state)
  {
    fragments_->update(state);
    last_step_ = model_.control->step();
    write_if_due(state);
    HistoryRow row;
    row.energy = state.energy;
    row.broken_area = state.broken_area;
    row.fragments = fragments_->count();
    row.reactions = steps_.integrator().reactions();
    row.heat = heat_of(input_, state, state.heat.hottest);
    output_->start(row);
    say(extremes_->start(state));
    observe(state, nullptr, row);
  }

  template <int dim>
  void RunRecorder<dim>::record(const State &previous, State &state,
                                const StepReport &report,
                                const double time_step)
  {
    last_step_ = time_step;
    const bool is_due = looks_at(state),
               keeps = steps_.integrator().keeps_motion(),
               is_shown = is_due || report.separates || !keeps;
    if (is_due || (keeps && report.separates))
      steps_.integrator().show(state);
    if (is_shown && report.separates)
      fragments_->update(state);
    tally_.add(report);
    HistoryRow row;
    row.step = state.step;
    row.time = state.time;
    row.time_step = time_step;
    row.energy = state.energy;
    row.balance_residual = report.balance_residual;
    row.broken_area = state.broken_area;
    row.fragments = fragments_->count();
    row.active = report.active;
    row.newton = report.solver.newton;
    row.krylov = report.solver.krylov;
    row.residual = report.solver.residual;
    row.reactions = steps_.integrator().reactions();
    row.heat = heat_of(input_, state, state.heat.hottest);
    output_->record(row, steps_.integrator().load_time(state));
    if (is_shown)
      say(extremes_->observe(previous, state));
    observe(state, &previous, row);
    write_if_due(state);
  }

  /** Somebody needs now what an integrator keeps by itself. */
  template <int dim>
  bool RunRecorder<dim>::looks_at(const State &state) const
  {
    constexpr unsigned int interval = 64; // of Extremes, in short steps
    return observers_ || (observer_ && observer_->wants_states()) ||
           state.step % interval == 0 || output_->is_due(state);
  }

  template <int dim>
  void RunRecorder<dim>::change_mesh(const State &state)
  {
    describe_mesh();
    fragments_ =
        std::make_unique<Fragments<dim>>(*model_.discretization, communicator_);
    fragments_->update(state);
    const State at_start = model_.initial_state();
    output_->mesh_changed(at_start);
    extremes_->mesh_changed();
    if (observer_)
      observer_->mesh_changed(at_start);
    if (observers_)
      observers_->find(*model_.triangulation, *model_.groups);
  }

  template <int dim>
  void RunRecorder<dim>::resume(const State &state)
  {
    tally_.resume();
    fragments_->update(state);
    message(fmt::format("goes on after step {}, t = {:.6g}", state.step,
                        state.time));
  }

  /** Observables first: cases may look at them. */
  template <int dim>
  void RunRecorder<dim>::observe(const State &state, const State *previous,
                                 const HistoryRow &row)
  {
    if (observers_)
      observers_->observe(state, previous, row);
    if (observer_)
      observer_->observe(state, row,
                         observers_ ? &observers_->records() : nullptr);
  }

  template <int dim>
  void RunRecorder<dim>::write_if_due(const State &state, const bool last)
  {
    if (output_->write_if_due(state, last_step_, *fragments_, last) &&
        observers_)
      observers_->write_profiles(state, last_step_);
  }

  /** Between the lines of the progress. */
  template <int dim>
  void RunRecorder<dim>::say(const std::vector<std::string> &sentences)
  {
    for (const std::string &sentence : sentences)
      message(sentence);
  }

  template <int dim>
  void RunRecorder<dim>::fill_summary(const State &state,
                                      const std::string &failure)
  {
    Summary &s = summary_;
    s.completed = failure.empty();
    s.failure = failure;
    s.steps = state.step;
    s.final_time = state.time;
    s.energy = state.energy;
    s.setup_seconds = tally_.setup_seconds();
    s.balance_residual_max = tally_.balance_residual_max();
    s.residual_max = tally_.residual_max();
    s.penetration_max = state.penetration;
    s.positive_friction_work = state.positive_friction_work;
    if (!state.pressure.empty())
      s.pressure_work = state.pressure_work;
    s.viscous_traction_max = state.viscous_traction;
    s.heat = heat_of(input_, state, state.heat.hottest_of_run);
    s.rigid_drift_max = state.rigid_drift;
    s.fragments = fragments_->count();
    s.penetration_bound = extremes_->penetration_bound();
    if (observer_)
      observer_->finish(state, s.errors);
    if (observers_)
      s.observables = observers_->records();
  }

  template <int dim>
  bool RunRecorder<dim>::finish(State &state, const std::string &failure,
                                const unsigned int failed_checkpoints,
                                std::map<std::string, double> more_counters)
  {
    steps_.integrator().show(state);
    fragments_->update(state);
    write_if_due(state, true);
    say(extremes_->finish(state));
    output_->end_progress();
    fill_summary(state, failure);
    Summary &s = summary_;
    RunTotals sums = tally_.totals(state, output_->cpu(), failed_checkpoints);
    s.counters = sums.counters;
    for (const auto &[name, value] : more_counters)
      s.counters[name] = value;
    s.wall_seconds = sums.wall_seconds;
    s.cpu_seconds = sums.cpu_seconds;
    s.timings = sums.timings;
    s.peak_memory_mb = peak_memory_mb();
    charge_memory("fields and curves");
    s.cost = tally_.costs();
    const Certificate certificate =
        certify(run_facts(input_, model_, tally_.solved_steps(), *extremes_,
                          tally_.watch(), state, s, communicator_));
    output_->write_summary(s, certificate);
    if (communicator_.is_root() && !options_.quiet)
      std::cout << run_end_text(s, certificate, state.broken_area,
                                files_text(input_.output), options_.verbose);
    return certificate.is_ok();
  }

  template <int dim>
  void RunRecorder<dim>::serialize(Archive &archive, const State &state,
                                   const unsigned int failed_checkpoints)
  {
    archive.numbers("last_step", last_step_);
    if (observer_)
      observer_->serialize(archive);
    extremes_->serialize(archive);
    tally_.serialize(archive, state, output_->cpu(), failed_checkpoints);
  }

  template <int dim>
  void RunRecorder<dim>::serialize_files(Archive &archive)
  {
    output_->serialize(archive);
    if (observers_)
      observers_->serialize(archive);
  }

  template class RunRecorder<2>;
  template class RunRecorder<3>;
} // namespace nsfd
