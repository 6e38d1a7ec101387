#pragma once

#include "history_file.h"

#include "discretization/discretization.h"
#include "nsfd/records/run_record.h"
#include "state/state.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  template <int dim>
  class FieldOutput;
  template <int dim>
  class FragmentOutput;
  template <int dim>
  class Fragments;
  class Progress;
  struct Certificate;
  struct RunFindings;
  struct RunOptions;

  /** Everything that a run writes, and what it says while it runs. */
  template <int dim>
  class RunOutput
  {
  public:
    /**
     * Starts all files in the claimed directory of the input, or, if the run
     * resumes, leaves them to serialize(). A verbose run says every step; one
     * that is only checked writes and says nothing.
     */
    RunOutput(const SceneInput &input, const RunInfo &info,
              const RunOptions &options,
              const Discretization<dim> &discretization,
              const Communicator &communicator,
              const std::vector<ObservableRecord> &observables);
    ~RunOutput();

    /** Of a scene that has fragments. */
    void set_fragments(std::unique_ptr<FragmentOutput<dim>> fragments);

    /** The initial state: the row of step 0. */
    void start(const HistoryRow &row);

    /** An accepted step, whose loads are those of @p load_time (s):
        history.csv, progress, the curves of the report. */
    void record(const HistoryRow &row, double load_time);

    /**
     * Fields and pictures if they are due; at the end always. True if this was
     * a time for them. Collective.
     */
    bool write_if_due(const State &state, double time_step,
                      const Fragments<dim> &fragments, bool last = false);

    /** Bodies and points are others now; @p start is their state at t = 0. */
    void mesh_changed(const State &start);

    /** The progress line ends here. */
    void end_progress();

    /** A line of its own between those of the progress; on rank 0. */
    void message(const std::string &text);

    /**
     * How far the files have come. After reading, history.csv ends with the
     * row of the checkpoint, and the series of fields go on after its last.
     * @throws std::runtime_error if history.csv does not reach it. Collective.
     */
    void serialize(Archive &archive);

    /** summary.json and the report; nothing except on rank 0. */
    void write_summary(const Summary &summary, const Certificate &certificate);

    /** CPU seconds spent on fields and pictures. */
    double cpu() const { return cpu_; }

    /** It is a time for fields and pictures. */
    bool is_due(const State &state) const;

  private:
    HistoryFile::Columns columns() const;
    void keep(const HistoryRow &row);
    void write_descriptions() const;
    void open_files(const RunOptions &options);
    void serialize_history(Archive &archive);
    void thin_snapshots();
    void write_page(const Summary &summary, const RunFindings &findings);

    const SceneInput &input_;
    const RunInfo info_;
    const Communicator &communicator_;
    std::vector<std::string> driven_;
    std::string units_; ///< units.json
    std::unique_ptr<HistoryFile> history_file_;
    std::unique_ptr<Progress> progress_;
    std::unique_ptr<FieldOutput<dim>> fields_;
    std::unique_ptr<FragmentOutput<dim>> fragments_; ///< or null
    std::vector<HistoryRow> history_;
    unsigned int history_stride_ = 1;
    std::vector<Snapshot> snapshots_;
    double next_fields_ = 0., cpu_ = 0.;
    bool fields_current_ = false;
  };
} // namespace nsfd
