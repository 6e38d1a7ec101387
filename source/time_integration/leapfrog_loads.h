#pragma once

#include "leapfrog_pressure.h"

#include "joined/absorbing_nodes.h"
#include "joined/hanging_nodes.h"
#include "joined/viscous_forces.h"

#include <array>
#include <utility>

namespace nsfd
{
  /**
   * What is given before a step of Leapfrog besides the elastic forces: loads
   * by corner and by group of corners, those of fluid in cracks, and absorbing
   * sides.
   */
  template <int dim>
  class LeapfrogLoads
  {
  public:
    LeapfrogLoads(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const JoinedMesh<dim> &mesh, const HangingNodes<dim> &hanging)
        : discretization_(discretization), mesh_(mesh), hanging_(hanging),
          cracks_(LeapfrogPressure<dim>::make(input, discretization, mesh)),
          absorbing_(AbsorbingNodes<dim>::make(discretization, mesh, hanging)),
          extra_weights_(extra_weights(input, discretization))
    {
    }

    /** Groups are others now. Collective. */
    void start(double time, const LoadClock &clock,
               const CornerGroups<dim> &groups);
    /** By the @p clock of the state before. Collective. */
    void move_to(double time, const LoadClock &clock,
                 const CornerGroups<dim> &groups);
    /** A node has split. */
    void gather(std::size_t node, const CornerGroups<dim> &groups);

    /** All of them at @p time and those of viscous materials, if there are
        some, N by group; empty: none. */
    const std::vector<double> &sum(double time,
                                   const ViscousForces<dim> *viscous,
                                   const LeapfrogChains<dim> &chains,
                                   const CornerGroups<dim> &groups);
    /** Without those of cracks, N; empty: none. */
    const std::vector<double> &of_groups() const { return of_groups_; }
    /** Null: there are none. */
    const LeapfrogPressure<dim> *cracks() const { return cracks_.get(); }
    /** The same. */
    AbsorbingNodes<dim> *absorbing() const { return absorbing_.get(); }

  private:
    /// of rigid bodies heavier than their cells: by corner, N
    using Forces = std::vector<std::pair<std::size_t, std::array<double, dim>>>;

    static Forces extra_weights(const SceneInput &input,
                                const Discretization<dim> &discretization);
    void set(double time, const CornerGroups<dim> &groups);

    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const HangingNodes<dim> &hanging_;
    const std::unique_ptr<LeapfrogPressure<dim>> cracks_;
    const std::unique_ptr<AbsorbingNodes<dim>> absorbing_;
    const Forces extra_weights_;
    std::vector<double> of_corners_, of_groups_; ///< empty: none
    std::vector<double> shares_;                 ///< see HangingNodes
    std::vector<double> sum_; ///< where there are several kinds
    double time_ = 0.;
    LoadClock clock_;
  };
} // namespace nsfd
