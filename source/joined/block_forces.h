#pragma once

#include "cell_forces.h"

namespace nsfd
{
  /** Cells of any kind by the stiffness and traction blocks of their class. */
  template <int dim>
  class BlockForces final : public CellForces<dim>
  {
  public:
    BlockForces(const Discretization<dim> &discretization,
                const JoinedMesh<dim> &mesh, FrontViscosity front);

    void set_forces(CornerGroups<dim> &groups) override;
    std::array<double, dim>
    corner_force(std::size_t corner,
                 const CornerGroups<dim> &groups) const override;
    void squared_tractions(const StrengthSites &sites,
                           std::vector<double> &squares) const override;
    std::array<double, dim> traction(const StrengthSites &sites,
                                     std::size_t site) const override;

  private:
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    std::vector<double> forces_;                  ///< K q by corner
    std::vector<std::vector<double>> divergence_; ///< mean of a class, 1/m
    /// traction on the outward normal at every slot of every body, Pa
    std::vector<double> tractions_;
    std::vector<std::size_t> first_traction_; ///< per body
    /// by point: where it is in `tractions_`, of body 1 and of body 2
    std::vector<std::array<std::size_t, 2>> place_;
  };
} // namespace nsfd
