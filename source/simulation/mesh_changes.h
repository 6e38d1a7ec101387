#pragma once

#include "model.h"

#include "state/state.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;

  /**
   * How the mesh of a run follows the motion: the parts of the model are built
   * again whenever cells change, and the state goes with them.
   */
  template <int dim>
  class MeshChanges
  {
  public:
    virtual ~MeshChanges() = default;

    /** Fine enough for the state at t = 0, which is returned. Collective. */
    virtual State start() = 0;

    /**
     * The mesh of a checkpoint from the first one on: ids of all cells of all
     * ranks, four numbers each. Returns the state at t = 0 there. Collective.
     */
    virtual State restore(const std::vector<std::uint32_t> &ids) = 0;

    /** What has been counted so far. Collective. */
    virtual void serialize(Archive &archive) = 0;

    /**
     * Whether the mesh is good enough for a step from @p state to @p next. If
     * it is not, it changes, with @p state on it, and the step is to be
     * repeated. Collective.
     */
    virtual bool follow(State &, const State &) { return false; }

    /** The step to @p state was taken. True if the mesh changes for those that
        come. Collective. */
    virtual bool accept(State &state) = 0;

    virtual void
    fill_counters(std::map<std::string, double> &counters) const = 0;
  };

  /** Of a scene whose mesh changes. */
  template <int dim>
  std::unique_ptr<MeshChanges<dim>>
  make_mesh_changes(const SceneInput &input, const Communicator &communicator,
                    Model<dim> &model);
} // namespace nsfd
