#pragma once

#include "discretization/discretization.h"
#include "records/certificate.h"
#include "state/state.h"

#include <string>
#include <vector>

namespace nsfd
{
  class Archive;

  /**
   * The largest values over a run of what its method assumes to be small, and
   * the bounds of its overlaps. Cells of small motions are looked at in every
   * 16th step, in every equilibrium and at the end; what turns and comes back
   * in between is missed.
   */
  template <int dim>
  class Extremes
  {
  public:
    Extremes(const SceneInput &input, const Discretization<dim> &discretization,
             const Communicator &communicator);

    /** Cells are others now. Collective. */
    void mesh_changed();

    /** At t = 0; sentences that are to be said. Collective. */
    std::vector<std::string> start(const State &state);

    /**
     * After an accepted step from @p previous; sentences for what was passed
     * for the first time, on all ranks the same. Collective.
     */
    std::vector<std::string> observe(const State &previous, const State &state);

    /** At the end. Collective. */
    std::vector<std::string> finish(const State &state);

    /** Limits, bound of the overlap and extent. Collective. */
    void fill(RunFacts &facts) const;

    /** Largest sum of both bounds of a point so far, m. Collective. */
    double penetration_bound() const;

    void serialize(Archive &archive);

  private:
    static constexpr unsigned int interval = 16; ///< steps

    void build_tables();
    void look_at_cells(const State &state);
    void look_at_stride(const State &previous, const State &state);
    void look_at_overlap(const State &state);
    double smallest_thickness() const;
    void share(Peak &peak) const;
    std::vector<std::string> news();

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    /// per class: displacement gradients (place, component, direction) x
    /// unknown, row by row; none where cells differ()
    std::vector<std::vector<double>> gradients_;
    Peak rotation_, strain_, stride_;
    bool has_stride_ = false;
    double thickness_ = 0., extent_ = 0., joints_ = 0., bound_ = 0.;
    bool said_rotation_ = false, said_strain_ = false, said_stride_ = false;
    std::optional<SharpFront> front_;
  };
} // namespace nsfd
