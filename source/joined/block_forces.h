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
    void
    squared_tractions(const StrengthSites<dim> &sites,
                      typename StrengthSites<dim>::Near &near) const override;
    std::array<double, dim> traction(const StrengthSites<dim> &sites,
                                     std::size_t site) const override;

  private:
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    std::vector<double> forces_;                  ///< K q by corner
    std::vector<std::vector<double>> divergence_; ///< mean of a class, 1/m
    BodyTractions<dim> tractions_;
  };
} // namespace nsfd
