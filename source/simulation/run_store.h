#pragma once

#include "crack_events.h"
#include "mesh_changes.h"
#include "run_recorder.h"

#include "checkpoint/checkpoints.h"
#include "heat/body_heat.h"

namespace nsfd
{
  /** What a run consists of. */
  template <int dim>
  struct RunParts {
    RunParts(const SceneInput &scene, const RunOptions &run_options,
             const Communicator &ranks)
        : input(scene), options(run_options), communicator(ranks),
          steps(input, model, communicator), events(input),
          recorder(input, options, model, steps, communicator)
    {
    }

    const SceneInput &input;
    const RunOptions &options;
    const Communicator &communicator;
    Model<dim> model;
    TimeStepping<dim> steps;
    CrackEvents<dim> events;
    RunRecorder<dim> recorder;
    std::unique_ptr<MeshChanges<dim>> adaptive; ///< or null
    std::unique_ptr<BodyHeat<dim>> heat;        ///< or null
    State state;
  };

  /**
   * The checkpoints of a run: names everything that later steps or the end of
   * the run depend on.
   */
  template <int dim>
  class RunStore
  {
  public:
    /** Of the parts that are built. */
    explicit RunStore(RunParts<dim> &parts);

    /**
     * From a checkpoint on; false with the reason on standard error.
     * Collective.
     */
    bool resume(const FoundCheckpoint &found);

    /**
     * What goes wrong is a warning: the checkpoints before are still there.
     * Without what the solvers keep if they were left in the middle of a step.
     * Collective.
     */
    bool store(bool with_solvers = true);

    /** After an accepted step, if it is time to. Collective. */
    void store_if_due();
    /** At the end of a run that wants checkpoints. Collective. */
    void store_last();
    /** The present state, unless it is on the disk; false if it cannot be. */
    bool keep(bool with_solvers);

    /** Bodies and points are others now. */
    void mesh_changed() { checkpoints_.mesh_changed(); }

    unsigned int n_failed() const { return checkpoints_.n_failed(); }

  private:
    void serialize_state(Archive &archive);
    void serialize_parts(Archive &archive, bool with_solvers,
                         bool all_integrators);
    void read(Archive &archive, const FoundCheckpoint &found);

    RunParts<dim> &parts_;
    Checkpoints<dim> checkpoints_;
    unsigned int stored_at_ = 0; ///< step of the last checkpoint
    bool stored_ = false;        ///< it is on the disk
    bool has_solvers_ = true;    ///< it holds what solvers keep
  };
} // namespace nsfd
