#pragma once

#include "checkpoint_archive.h"
#include "parameter_changes.h"

#include "core/communicator.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct RunOptions;

  /** What all parts of a run carry along, to or from an archive. */
  using SerializeAll = std::function<void(Archive &)>;

  /** The newest whole checkpoint of a folder. */
  struct FoundCheckpoint {
    std::filesystem::path file;
    std::unique_ptr<Hdf5Image> image; ///< on the first rank
    bool same_solver = true;          ///< what solvers have kept is of use
    bool same_steps = true; ///< the sequence of bisected steps goes on
    /** Steps in time follow those of the load then and now, or neither. */
    bool same_integrators = true;
    std::string notes; ///< about older files, and changed parameters
  };

  /**
   * Nothing, with sentences on standard error, if there is no whole one, or if
   * parameters have changed that give what was computed another meaning.
   * Nothing is written. Collective.
   */
  std::optional<FoundCheckpoint>
  find_checkpoint(const SceneInput &input, const Communicator &communicator);

  /** Ids of all cells, four numbers each, sorted. Collective. */
  std::vector<std::uint32_t> stored_cells(const FoundCheckpoint &found,
                                          const Communicator &communicator);

  /** When a run is stored, and what of it. */
  template <int dim>
  class Checkpoints
  {
  public:
    Checkpoints(const SceneInput &input, const RunOptions &options,
                const Discretization<dim> &discretization,
                const Communicator &communicator);

    /** The scene asks for checkpoints. */
    bool wanted() const;

    /** After an accepted step, by steps or wall time. Collective. */
    bool is_due(unsigned int step) const;

    /**
     * Store all that @p serialize names; empty, or why it could not be: the
     * checkpoints before are as they were then. Collective.
     */
    std::string write(const SerializeAll &serialize);

    /** A file of this or an earlier step is there; on the first rank. */
    bool has_earlier() const;

    /** @throws BadCheckpoint if it belongs to another mesh. Collective. */
    void read(const FoundCheckpoint &found,
              const SerializeAll &serialize) const;

    /** Bodies and points are others now. */
    void mesh_changed() { orders_.reset(); }

    unsigned int n_failed() const { return n_failed_; }

  private:
    void write_head(Hdf5Image *image) const;
    const CheckpointOrders<dim> &orders() const;

    const SceneInput &input_;
    const RunOptions &options_;
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    mutable std::unique_ptr<CheckpointOrders<dim>> orders_; ///< when needed
    double last_ = 0.;                                      ///< s of wall time
    unsigned int n_failed_ = 0;
  };
} // namespace nsfd
