#pragma once

#include "corner_groups.h"
#include "front_viscosity.h"
#include "strength_sites.h"
#include "viscous_forces.h"

#include <memory>

namespace nsfd
{
  /** Elastic forces of cells on the groups of their corners. */
  template <int dim>
  class CellForces
  {
  public:
    explicit CellForces(FrontViscosity front) : front_(std::move(front)) {}
    virtual ~CellForces() = default;

    /**
     * f = -K q on all groups, and the forces of the front viscosity.
     * front() begins a step before, and is to be finished then.
     */
    virtual void set_forces(CornerGroups<dim> &groups) = 0;
    /** The part of a corner in the last forces, N. */
    virtual std::array<double, dim>
    corner_force(std::size_t corner, const CornerGroups<dim> &groups) const = 0;

    /**
     * <t_N>_+^2 + shear_weight |t_T|^2 of the mean traction, of the
     * displacements of the last forces, Pa^2, at all sites that are not
     * released where it is beyond `looked_at`^2 times the limit; at others it
     * may be 0.
     */
    virtual void
    squared_tractions(const StrengthSites<dim> &sites,
                      typename StrengthSites<dim>::Near &near) const = 0;
    /** {sigma n} at a site in the axes x, y, z, Pa. */
    virtual std::array<double, dim> traction(const StrengthSites<dim> &sites,
                                             std::size_t site) const = 0;

    FrontViscosity &front() { return front_; }

    /** Of viscous materials, by themselves; null if there are none. */
    ViscousForces<dim> *viscous() { return viscous_.get(); }
    const ViscousForces<dim> *viscous() const { return viscous_.get(); }
    void set_viscous(std::unique_ptr<ViscousForces<dim>> forces)
    {
      viscous_ = std::move(forces);
    }

  protected:
    FrontViscosity front_;

  private:
    std::unique_ptr<ViscousForces<dim>> viscous_;
  };

  /**
   * If no material varies in its cells, constant strain on simplices of degree
   * 1, and if all are isotropic, too, sum factorisation on quads and hexes; the
   * blocks of the bodies else: on all ranks alike. @p ghosts of the cells, if
   * there may be some, and @p divided as in FiniteForces.
   */
  template <int dim>
  std::unique_ptr<CellForces<dim>>
  make_cell_forces(const Discretization<dim> &discretization,
                   const JoinedMesh<dim> &mesh, FrontViscosity front,
                   const GhostCells *ghosts = nullptr,
                   const GhostCells *divided = nullptr);
} // namespace nsfd
