#pragma once

#include "cells.h"

#include "nsfd/discretization/point_origin.h"

#include <array>
#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * A stress sigma_0 of the bodies at no strain: sigma = sigma_0 + C : strain.
   * It acts on the nodes of a cell as the dead load -int B^T sigma_0, so that
   * its work is -int sigma_0 : change of strain.
   *
   * Interfaces carry R_0 = sigma_f n at t = 0, n from body 1 to body 2, with
   * the components of sigma_f that their block gives, and the mean of both
   * cells for the others. Where the block gives some, both sides get the dead
   * loads -w (R_0 - {sigma_0} n) and +w (R_0 - {sigma_0} n): it is R_0 that
   * holds them in equilibrium then. On common nodes the two cancel.
   */
  template <int dim>
  class InitialStress
  {
  public:
    /** Null if the scene has none. */
    static std::unique_ptr<const InitialStress>
    make(const SceneInput &input, const Cells<dim> &cells,
         const InterfacePoints<dim> &points,
         const std::vector<PointOrigin> &origins);

    InitialStress(const SceneInput &input, const Cells<dim> &cells,
                  const InterfacePoints<dim> &points,
                  const std::vector<PointOrigin> &origins);

    /** xx, yy, zz, xy, xz, yz in a material at @p x, Pa. */
    static std::array<double, 6> at(const MaterialInput &material,
                                    const dealii::Point<dim> &x);

    /** The dead loads by node and component, N (N/m in the plane). */
    const std::vector<double> &forces() const { return forces_; }

    /** R_0 in the axes x, y, z, Pa; 0 but at interfaces. */
    const double *traction(const std::size_t point) const
    {
      return &traction_[point * dim];
    }
    /** R_0 in the frame of the point. */
    const double *local_traction(const std::size_t point) const
    {
      return &local_[point * dim];
    }

  private:
    void set_tractions(const SceneInput &input,
                       const InterfacePoints<dim> &points,
                       const std::vector<PointOrigin> &origins);
    void load_cells(const SceneInput &input, const Cells<dim> &cells);
    void load_faces(const Cells<dim> &cells,
                    const InterfacePoints<dim> &points);

    std::vector<double> traction_, local_;
    std::vector<double> beside_; ///< R_0 - {sigma_0} n; empty: 0 everywhere
    std::vector<double> forces_;
  };
} // namespace nsfd
