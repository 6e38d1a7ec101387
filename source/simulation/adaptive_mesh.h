#pragma once

#include "mesh_changes.h"

namespace nsfd
{
  template <int dim>
  class MeshAdaptor;

  /**
   * Quads and hexes: a step is repeated on the mesh that it needs. What a
   * change does to the stored energies counts as numerical.
   */
  template <int dim>
  class AdaptiveMesh final : public MeshChanges<dim>
  {
  public:
    AdaptiveMesh(const SceneInput &input, const Communicator &communicator,
                 Model<dim> &model);
    ~AdaptiveMesh() override;

    State start() override;
    State restore(const std::vector<std::uint32_t> &ids) override;
    void serialize(Archive &archive) override;

    /** As far as it is looked at: no wave gets further than a quarter of the
        smallest cell in between. */
    bool follow(State &state, const State &next) override;

    /** Cells may grow again. */
    bool accept(State &) override
    {
      rounds_ = 0;
      return false;
    }

    void fill_counters(std::map<std::string, double> &counters) const override;

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
