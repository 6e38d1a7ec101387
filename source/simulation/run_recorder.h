#pragma once

#include "extremes.h"
#include "run_tally.h"

#include "bodies/fragments.h"
#include "postprocess/observers.h"
#include "postprocess/run_output.h"
#include "verification/case_observer.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  struct RunOptions;

  /**
   * What is seen of a run: looks at the states, shows them to the observables
   * and to the verification case, writes rows, fields and messages, and at the
   * end the summary with its certificate.
   */
  template <int dim>
  class RunRecorder
  {
  public:
    RunRecorder(const SceneInput &input, const RunOptions &options,
                const Model<dim> &model, const TimeStepping<dim> &steps,
                const Communicator &communicator);

    /**
     * The observables and the verification case of the built model; false, with
     * the reason on standard error, if they do not fit. Collective.
     */
    bool prepare();

    /** Again on a mesh that has changed; false as above. Collective. */
    bool find_observables();

    /** The parts that look at states, and all files. Collective. */
    void open(const State &state);

    /** The state at t = 0. Collective. */
    void start(const State &state);

    /** An accepted step from @p previous. Collective. */
    void record(const State &previous, State &state, const StepReport &report,
                double time_step);

    /** Bodies and points are others now. Collective. */
    void change_mesh(const State &state);

    /** The run goes on from a checkpoint, at @p state. */
    void resume(const State &state);

    /**
     * The last fields and the summary, of a run that failed if there is a
     * @p failure. Returns whether its certificate is ok. Collective.
     */
    bool finish(State &state, const std::string &failure,
                unsigned int failed_checkpoints,
                std::map<std::string, double> more_counters);

    /** A line of its own between those of the progress; on rank 0. */
    void message(const std::string &text) { output_->message(text); }

    /** What later rows and the end of the run depend on. Collective. */
    void serialize(Archive &archive, const State &state,
                   unsigned int failed_checkpoints);
    /** How far the files have come. Collective. */
    void serialize_files(Archive &archive);

  private:
    void describe_mesh();
    void observe(const State &state, const State *previous,
                 const HistoryRow &row);
    void write_if_due(const State &state, bool last = false);
    bool looks_at(const State &state) const;
    void say(const std::vector<std::string> &sentences);
    void fill_summary(const State &state, const std::string &failure);

    const SceneInput &input_;
    const RunOptions &options_;
    const Model<dim> &model_;
    const TimeStepping<dim> &steps_;
    const Communicator &communicator_;
    RunTally<dim> tally_;
    std::unique_ptr<CaseObserver<dim>> observer_; ///< or null
    std::unique_ptr<Observers<dim>> observers_;   ///< or null
    std::unique_ptr<Fragments<dim>> fragments_;
    std::unique_ptr<Extremes<dim>> extremes_;
    std::unique_ptr<RunOutput<dim>> output_;
    Summary summary_;
    double last_step_ = 0.; ///< s
  };
} // namespace nsfd
