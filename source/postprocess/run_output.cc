#include "run_output.h"

#include "serialize_pictures.h"
#include "units_file.h"

#include "core/cost.h"
#include "core/output_folder.h"
#include "core/stopwatch.h"
#include "field_output.h"
#include "fragment_output.h"
#include "history_file.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"
#include "progress.h"
#include "records/run_options.h"
#include "report.h"
#include "summary_file.h"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace nsfd
{
  template <int dim>
  RunOutput<dim>::RunOutput(const SceneInput &input, const RunInfo &info,
                            const RunOptions &options,
                            const Discretization<dim> &discretization,
                            const Communicator &communicator,
                            const std::vector<ObservableRecord> &observables)
      : input_(input), info_(info), communicator_(communicator)
  {
    for (const unsigned int b : discretization.driven_boundaries())
      driven_.push_back(input.boundaries[b].name);
    units_ = units_text(columns(), observables);
    if (options.check)
      return;
    if (communicator.is_root())
      open_files(options);
    if (input.output.fields || input.output.report)
      fields_ = std::make_unique<FieldOutput<dim>>(input.output.directory,
                                                   discretization, communicator,
                                                   input.output.format);
  }

  template <int dim>
  HistoryFile::Columns RunOutput<dim>::columns() const
  {
    return {driven_,
            dim,
            input_.has_absorbing_sides(),
            input_.axisymmetric,
            input_.has_heat(),
            has_heated_sides(input_),
            input_.follows_path()};
  }

  template <int dim>
  void RunOutput<dim>::open_files(const RunOptions &options)
  {
    if (!options.resume) {
      write_descriptions();
      history_file_ = std::make_unique<HistoryFile>(
          input_.output.directory + "/history.csv", columns());
    }
    progress_ = std::make_unique<Progress>(
        std::cout, input_.time.end,
        options.verbose ? Progress::Mode::every_step
                        : Progress::mode_for_stdout(options.quiet));
  }

  template <int dim>
  RunOutput<dim>::~RunOutput() = default;

  template <int dim>
  void
  RunOutput<dim>::set_fragments(std::unique_ptr<FragmentOutput<dim>> fragments)
  {
    fragments_ = std::move(fragments);
  }

  template <int dim>
  void RunOutput<dim>::write_descriptions() const
  {
    const std::string &directory = input_.output.directory;
    OutputFolder::instance().describe(describe_run(info_)); // before all others
    write_file_atomically(directory + "/parameters.prm", input_.echo);
    write_file_atomically(directory + "/units.json", units_);
  }

  template <int dim>
  void RunOutput<dim>::start(const HistoryRow &row)
  {
    if (history_file_)
      history_file_->write(row, row.time);
    keep(row);
  }

  template <int dim>
  void RunOutput<dim>::record(const HistoryRow &row, const double load_time)
  {
    if (history_file_)
      history_file_->write(row, load_time);
    if (progress_)
      progress_->step(row);
    keep(row);
  }

  /** The report draws at most some ten thousand rows. */
  template <int dim>
  void RunOutput<dim>::keep(const HistoryRow &row)
  {
    if (row.step % history_stride_ == 0)
      history_.push_back(row);
    if (history_.size() > 20000) {
      history_stride_ *= 2;
      std::vector<HistoryRow> thinned;
      for (auto &kept : history_)
        if (kept.step % history_stride_ == 0)
          thinned.push_back(std::move(kept));
      history_.swap(thinned);
    }
  }

  template <int dim>
  bool RunOutput<dim>::is_due(const State &state) const
  {
    const auto &output = input_.output;
    return state.step == 0 ||
           (output.fields_every > 0. &&
            state.time >= next_fields_ * (1. - 1e-12)) ||
           (output.fields_every_steps > 0 &&
            state.step % output.fields_every_steps == 0);
  }

  /**
   * Keeps every second one where there are too many pictures, or more polygons
   * than some 300 MB hold.
   */
  template <int dim>
  void RunOutput<dim>::thin_snapshots()
  {
    constexpr std::size_t most = 24, most_polygons = 600000;
    const std::size_t n = std::max<std::size_t>(
        1, snapshots_.empty() ? 0 : snapshots_.back().polygons.size());
    if (snapshots_.size() > std::clamp<std::size_t>(most_polygons / n, 2, most))
      for (std::size_t k = 1; k < snapshots_.size(); ++k)
        snapshots_.erase(snapshots_.begin() + long(k));
  }

  template <int dim>
  bool RunOutput<dim>::write_if_due(const State &state, const double time_step,
                                    const Fragments<dim> &fragments,
                                    const bool last)
  {
    const Stopwatch watch(cpu_);
    const auto &output = input_.output;
    const bool due = last || is_due(state),
               writes = due && !(last && fields_current_);
    if (writes) {
      charge_memory("vectors of a step and its solver");
      if (output.fields_every > 0.)
        next_fields_ =
            (std::floor(state.time / output.fields_every * (1. + 1e-12)) + 1.) *
            output.fields_every;
      if (fields_ && output.fields)
        fields_->write(state, time_step, fragments);
      if (fragments_)
        fragments_->write(state, fragments);
      if (fields_ && output.report) {
        snapshots_.push_back(fields_->snapshot(state, fragments));
        thin_snapshots();
      }
      charge_memory("fields and curves");
    }
    if (last && fragments_) // the rows may be those of a run before this one
      fragments_->measure(state, fragments);
    fields_current_ = due;
    return writes;
  }

  template <int dim>
  void RunOutput<dim>::mesh_changed(const State &start)
  {
    if (fields_)
      fields_->mesh_changed();
    if (fragments_)
      fragments_->mesh_changed(start);
  }

  template <int dim>
  void RunOutput<dim>::end_progress()
  {
    if (progress_)
      progress_->finish();
  }

  template <int dim>
  void RunOutput<dim>::message(const std::string &text)
  {
    if (progress_)
      progress_->message(text);
  }

  template <int dim>
  void RunOutput<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "output");
    serialize_history(archive);
    archive.numbers("due", next_fields_, fields_current_);
    if (fields_)
      fields_->serialize(archive);
    if (fragments_)
      fragments_->serialize(archive);
    nsfd::serialize(snapshots_, archive);
    if (archive.reads() && communicator_.is_root())
      write_descriptions();
  }

  template <int dim>
  void RunOutput<dim>::serialize_history(Archive &archive)
  {
    std::uintmax_t n_bytes = history_file_ ? history_file_->n_bytes() : 0;
    archive.numbers("history_bytes", n_bytes);
    if (!archive.reads())
      return;
    std::string failure;
    history_.clear();
    if (communicator_.is_root())
      try {
        const std::string path = input_.output.directory + "/history.csv";
        for (const HistoryRow &row :
             HistoryFile::read(path, columns(), n_bytes))
          keep(row);
        history_file_ = std::make_unique<HistoryFile>(path, columns(), n_bytes);
      } catch (const std::exception &error) {
        failure = error.what();
      }
    if (communicator_.any(!failure.empty()))
      throw BadCheckpoint(failure);
  }

  template <int dim>
  void RunOutput<dim>::write_summary(const Summary &summary,
                                     const Certificate &certificate)
  {
    if (!communicator_.is_root())
      return;
    const std::string &directory = input_.output.directory;
    RunFindings findings;
    findings.certificate = certificate;
    if (fragments_)
      findings.fragment_sizes = fragment_sizes(fragments_->records(), dim);
    nsfd::write_summary(directory + "/summary.json", summary, findings);
    if (input_.output.report)
      write_page(summary, findings);
    OutputFolder::instance().finish();
  }

  template <int dim>
  void RunOutput<dim>::write_page(const Summary &summary,
                                  const RunFindings &findings)
  {
    Report report;
    report.title = input_.title;
    report.description = input_.description;
    report.info = info_;
    report.summary = summary;
    report.findings = findings;
    report.history = history_;
    report.reaction_names = driven_;
    report.snapshots = std::move(snapshots_);
    report.parameters = input_.echo;
    write_report(input_.output.directory + "/report.html", report);
  }

  template class RunOutput<2>;
  template class RunOutput<3>;
} // namespace nsfd
