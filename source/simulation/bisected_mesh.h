#pragma once

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
   * would create energy, see Leapfrog. One rank.
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

  private:
    std::vector<MeshView::Point> new_fronts();
    template <typename Look>
    void for_fronts(const Look &look) const;
    MeshView::Point front(unsigned int point, double share) const;
    bool refine(std::vector<MeshView::Point> points);
    void build();
    std::vector<Bisection::Family> not_wanted() const;
    void change(State &state);
    double kinetic_energy(const State &state) const;

    const SceneInput &input_;
    const Communicator &communicator_;
    Model<2> &model_;
    std::vector<unsigned int> materials_; ///< of the cells of the first mesh
    Bisection cells_;
    std::unique_ptr<LeafView> view_; ///< of them, or null
    /// by point of the present mesh: hundredths of the strength at which
    /// indicators have been asked
    std::vector<std::uint8_t> asked_;
    unsigned int changes_ = 0;
    unsigned long long largest_cells_ = 0;
    unsigned long long n_joined_ = 0; ///< families of halves
    double cells_sum_ = 0., steps_ = 0.;
    double lost_ = 0.;  ///< kinetic energy, J
    double worst_ = 0.; ///< of one change, relative to the largest energy
  };

  /** The longest stable step of cells of @p model halved as often as a scene
      may ask for, s. */
  double longest_bisected_step(const SceneInput &input, const Model<2> &model);
} // namespace nsfd
