#pragma once

#include "discretization/discretization.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * Heat in a cell whose temperature is linear between its corners (bilinear
   * on quads, trilinear on hexes), per kelvin. In two dimensions per metre of
   * depth, of axisymmetric scenes per radian.
   */
  struct HeatCell {
    unsigned int n_corners = 0, n_slots = 0;
    std::vector<double> capacity;   ///< by corner, J/K: lumped, int rho c N
    std::vector<double> conduction; ///< corner x corner, W/K
    std::vector<double> values;     ///< of N, slot x corner
    /// k grad N on the outward normal, slot x corner, W/(m^2 K)
    std::vector<double> fluxes;
    /// at least the largest ratio of sum over slots w flux^2 to T.K T, in
    /// W/(m^2 K); 0: the cell does not conduct
    double flux_bound = 0.;
    double effusivity = 0.; ///< sqrt(k rho c), W s^(1/2) / (m^2 K)
    /// at least the largest frequency of the cell by itself, 1/s
    double rate = 0.;
  };

  /** The cells of a rank: tables of a class, or of each cell if they differ. */
  template <int dim>
  class HeatCells
  {
  public:
    explicit HeatCells(const Discretization<dim> &discretization);

    unsigned int n_corners() const { return n_corners_; }
    const HeatCell &of(const std::size_t cell) const
    {
      return tables_[differ_ ? cell : discretization_.bodies().class_of[cell]];
    }
    /** Of all cells of this rank, 1/s. */
    double fastest() const;

  private:
    const Discretization<dim> &discretization_;
    const unsigned int n_corners_;
    const bool differ_;
    std::vector<HeatCell> tables_;
  };
} // namespace nsfd
