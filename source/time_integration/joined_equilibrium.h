#pragma once

#include "equilibrium_springs.h"
#include "leapfrog_ghosts.h"
#include "leapfrog_loads.h"
#include "prescribed_groups.h"

#include "joined/cell_forces.h"

#include <cstdint>
#include <memory>

namespace nsfd
{
  struct SceneInput;

  /**
   * The equilibrium that explicit steps start from: K q = F on the groups of
   * corners, where faces that are not intact are springs or carry nothing but
   * the pressure in them, by conjugate gradients with the forces of the steps.
   * What a group is divided by is the sum of m omega^2 of its corners, at most
   * which K has on its diagonal, and that of its springs.
   */
  template <int dim>
  class JoinedEquilibrium
  {
  public:
    /** All outlive this; @p hanging follow other groups afterwards. */
    JoinedEquilibrium(const SceneInput &input, const Communicator &communicator,
                      const Discretization<dim> &discretization,
                      const JoinedMesh<dim> &mesh,
                      const LeapfrogGhosts<dim> &ghosts,
                      HangingNodes<dim> &hanging, CellForces<dim> &forces,
                      EquilibriumSprings<dim> &springs);

    /**
     * Takes @p state, with ghosts, to rest under the loads of its time; @p
     * faces as they are at the start. Collective. @throws StepRejected if it
     * cannot be found, would close what is not joined, or open a spring beyond
     * its straight part.
     */
    void find(const FaceRelease<dim> &faces, State &state);

  private:
    void set_inverse();
    void set_forces();
    double find_residual();
    bool descend(double goal, double residual);
    double solve();
    void refuse(bool here, std::size_t point, const State &state,
                const std::string &what, const std::string &cure) const;
    void check_open(const State &state) const;

    const SceneInput &input_;
    const Communicator &communicator_;
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const LeapfrogGhosts<dim> &ghosts_;
    HangingNodes<dim> &hanging_;
    CellForces<dim> &forces_;
    EquilibriumSprings<dim> &springs_;
    LeapfrogLoads<dim> loads_;
    PrescribedGroups<dim> supports_;
    std::vector<std::uint8_t> intact_;
    std::unique_ptr<CornerGroups<dim>> groups_;
    /// by component of a group: N, and 1 over the diagonal of K, 0 where it is
    /// not free
    std::vector<double> given_, inverse_;
    std::vector<double> place_, residual_, direction_, scaled_;
    double size_ = 0.; ///< of the forces present, N
    unsigned int iterations_ = 0;
  };
} // namespace nsfd
