#pragma once

#include "leapfrog_chains.h"

#include "joined/corner_groups.h"

#include <memory>

namespace nsfd
{
  struct SceneInput;

  /**
   * The pressure of a fluid in open cracks in the steps of Leapfrog: w p n on
   * the groups at both sides of a point, half of it for each chain of the point
   * whose beta is at or below the threshold of its block. A load, known before
   * the step is solved; see CrackPressure.
   */
  template <int dim>
  class LeapfrogPressure
  {
  public:
    /** Null if no block of the scene has a pressure. */
    static std::unique_ptr<LeapfrogPressure>
    make(const SceneInput &input, const Discretization<dim> &discretization,
         const JoinedMesh<dim> &mesh);

    LeapfrogPressure(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh)
        : input_(input), discretization_(discretization), mesh_(mesh)
    {
    }

    /** At @p time, of the points as they are. */
    void set(double time, const LeapfrogChains<dim> &chains,
             const CornerGroups<dim> &groups);
    /** The last one at points, Pa. @p place: see LeapfrogChains. */
    void show(const std::vector<unsigned int> &place, State &state) const;
    /** dim values per group, N. */
    const std::vector<double> &of_groups() const { return of_groups_; }

  private:
    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    std::vector<unsigned int> order_; ///< of the points, as in the mesh
    std::vector<double> of_groups_;
    std::vector<std::pair<unsigned int, double>> of_points_; ///< of the mesh
  };
} // namespace nsfd
