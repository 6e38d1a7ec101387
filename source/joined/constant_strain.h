#pragma once

#include "cell_forces.h"

namespace nsfd
{
  /** Simplices of degree 1, of one Hooke's law each, `lanes` of them at a
      time. */
  template <int dim>
  class ConstantStrainForces final : public CellForces<dim>
  {
  public:
    ConstantStrainForces(const Discretization<dim> &discretization,
                         FrontViscosity front);

    void set_forces(CornerGroups<dim> &groups) override;
    std::array<double, dim>
    corner_force(std::size_t corner,
                 const CornerGroups<dim> &groups) const override;
    void
    squared_tractions(const StrengthSites<dim> &sites,
                      typename StrengthSites<dim>::Near &near) const override;
    std::array<double, dim> traction(const StrengthSites<dim> &sites,
                                     std::size_t site) const override;

    /** All cells are such. */
    static bool fits(const Discretization<dim> &discretization);

  private:
    static constexpr unsigned int n_stresses = dim * (dim + 1) / 2;

    std::size_t n_cells_;
    bool isotropic_ = true; ///< all materials are
    /// by block of lanes: gradients of the shape functions 1 to dim, volume,
    /// lambda and mu, or the upper half of Hooke's matrix
    std::vector<double> cells_;
    /// by block: sigma_xx, yy(, zz), xy(, xz, yz), Pa
    std::vector<double> stresses_;
    std::vector<double> peaks_; ///< by block: the largest sigma : sigma, Pa^2
  };
} // namespace nsfd
