#pragma once

#include "bisected_mesh.h"

namespace nsfd
{
  /**
   * The same on several ranks, which share the steps: each of them keeps the
   * whole mesh and changes it by itself, from what all have in the order of the
   * cells. Every rank has the mesh and the state of one alone then, to the last
   * bit, and takes its part of them.
   */
  class SpreadBisection final : public MeshChanges<2>
  {
  public:
    /** @p model is of the parts of the ranks; its steps are those of the whole
        mesh then. @throws std::runtime_error with a sentence. */
    SpreadBisection(const SceneInput &input, const Communicator &communicator,
                    Model<2> &model);
    ~SpreadBisection() override;

    State start() override;
    State restore(const std::vector<std::uint32_t> &ids) override;
    void serialize(Archive &archive) override;
    bool accept(State &state) override;
    void fill_counters(std::map<std::string, double> &counters) const override;

  private:
    void build();
    State whole_of(State &state);
    void hand_out(State &whole, State &state);

    const SceneInput &input_;
    const Communicator &communicator_;
    const Communicator alone_;
    Model<2> &model_;
    Model<2> whole_; ///< of all cells, on every rank
    std::unique_ptr<BisectedMesh> mesh_;
    BreakingFronts fronts_; ///< of this rank
  };
} // namespace nsfd
