#pragma once

#include "breaking_fronts.h"
#include "mesh_changes.h"

#include "adaptivity/bisection.h"
#include "adaptivity/leaf_view.h"
#include "nsfd/adaptivity/indicator.h"

namespace nsfd
{
  /**
   * Triangles of explicit steps: what has taken a step is looked at, and the
   * steps that come find smaller cells where a front goes. All steps of a run
   * have one length, that of the smallest cells there may be: shorter ones
   * would create energy, see Leapfrog. All cells are on this rank.
   */
  class BisectedMesh final : public MeshChanges<2>
  {
  public:
    BisectedMesh(const SceneInput &input, const Communicator &communicator,
                 Model<2> &model);
    ~BisectedMesh() override;

    State start() override;
    State restore(const std::vector<std::uint32_t> &ids) override;
    void serialize(Archive &archive) override;
    bool accept(State &state) override;
    void fill_counters(std::map<std::string, double> &counters) const override;

    const Bisection &cells() const { return cells_; }
    /** Of a cell. */
    unsigned int material(const std::size_t cell) const
    {
      return materials_[cells_.cells()[cell].first];
    }

    // accept() by its parts
    void count_step();
    bool is_due(const State &state) const;
    /** Cells for the points. False: all are small enough. */
    bool refine(std::vector<MeshView::Point> points);
    /** After refine(): the parts of the model, and the state. */
    void change(State &state);

  private:
    void build();
    std::vector<Bisection::Family> not_wanted(double h) const;
    double kinetic_energy(const State &state) const;

    const SceneInput &input_;
    const Communicator &communicator_;
    Model<2> &model_;
    std::vector<unsigned int> materials_; ///< of the cells of the first mesh
    Bisection cells_;
    std::unique_ptr<LeafView> view_; ///< of them, or null
    BreakingFronts fronts_;
    unsigned int changes_ = 0;
    unsigned long long largest_cells_ = 0;
    unsigned long long n_joined_ = 0; ///< families of halves
    double cells_sum_ = 0., steps_ = 0.;
    double lost_ = 0.;  ///< kinetic energy, J
    double worst_ = 0.; ///< of one change, relative to the largest energy
  };

  /** By face of @p triangulation, which has @p cells or some of them: where
      blocks are asked. What holds for a face holds for its parts. */
  std::vector<dealii::Point<2>>
  middles_of(const Bisection &cells,
             const dealii::Triangulation<2> &triangulation);

  /** The longest stable step of cells of @p model halved as often as a scene
      may ask for, s. */
  double longest_bisected_step(const SceneInput &input, const Model<2> &model);
} // namespace nsfd
