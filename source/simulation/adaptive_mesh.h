#pragma once

#include "model.h"

#include "state/state.h"

#include <map>
#include <memory>
#include <string>

namespace nsfd
{
  template <int dim>
  class MeshAdaptor;
  class Archive;

  /**
   * A mesh that follows the motion: the parts of a model are built again
   * whenever cells change, and the state goes with them. What a change does to
   * the stored energies counts as numerical.
   */
  template <int dim>
  class AdaptiveMesh
  {
  public:
    AdaptiveMesh(const SceneInput &input, const Communicator &communicator,
                 Model<dim> &model);
    ~AdaptiveMesh();

    /** Fine enough for the state at t = 0, which is returned. Collective. */
    State start();

    /**
     * The mesh of a checkpoint from the first one on: ids of all cells of all
     * ranks, four numbers each. Returns the state at t = 0 there. Collective.
     */
    State restore(const std::vector<std::uint32_t> &ids);

    /** What has been counted so far. Collective. */
    void serialize(Archive &archive);

    /**
     * Whether the mesh is good enough for a step from @p state to @p next, as
     * far as it is looked at: no wave gets further than a quarter of the
     * smallest cell in between. If it is not, it changes, with @p state on it,
     * and the step is to be repeated. Collective.
     */
    bool follow(State &state, const State &next);

    /** The step was taken: cells may grow again. */
    void accept() { rounds_ = 0; }

    void fill_counters(std::map<std::string, double> &counters) const;

  private:
    void change(State &state);
    void weigh_cells(const State &state);
    double dissipated(const State &state) const;
    double broken_area(const State &state) const;
    void count_cells();

    const SceneInput &input_;
    const Communicator &communicator_;
    Model<dim> &model_;
    std::unique_ptr<MeshAdaptor<dim>> adaptor_;
    std::vector<unsigned int> weights_; ///< by active cell index
    bool is_due(const State &next) const;

    unsigned int rounds_ = 0;    ///< changes in the present step
    double looked_ = -1.;        ///< s, when the indicators were asked last
    unsigned int coarsened_ = 0; ///< step in which cells might grow last
    unsigned int changes_ = 0;
    unsigned long long largest_cells_ = 0;
    double cells_sum_ = 0., steps_ = 0.;
    double energy_ = 0.; ///< stored energy lost in changes, J
    double worst_ = 0.;  ///< of one change, relative to the largest energy
  };
} // namespace nsfd
