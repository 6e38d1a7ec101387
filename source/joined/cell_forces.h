#pragma once

#include "corner_groups.h"
#include "front_viscosity.h"
#include "viscous_forces.h"

#include <memory>

namespace nsfd
{
  /**
   * Faces that may be released: where the mean traction of both sides is
   * compared with a strength. A site is a face (its points are released
   * together, the traction is averaged along it), or a point of cells of higher
   * degree.
   */
  struct StrengthSites {
    /// share of its strength from which on the traction of a site is computed
    static constexpr double looked_at = 0.6;

    std::vector<unsigned int> first_point, n_points;
    std::vector<std::array<unsigned int, 2>> cells;
    /// unit normal from body 1 to body 2, dim components
    std::vector<double> normal;
    /// of |t_T|^2 beside <t_N>_+^2, and the square of the strength, Pa^2
    std::vector<double> shear_weight, limit;
    /// first sites of the faces, and the end
    std::vector<std::size_t> first_of_face;
    /// by face: no smaller square of a traction reaches a limit, Pa^2
    std::vector<double> least;

    std::size_t size() const { return cells.size(); }

    /** <t_N>_+^2 + shear_weight |t_T|^2 of a traction @p t at a site, Pa^2. */
    template <std::size_t dim>
    double square(const std::size_t site,
                  const std::array<double, dim> &t) const
    {
      double sum = 0., pull = 0.;
      for (std::size_t c = 0; c < dim; ++c) {
        sum += t[c] * t[c];
        pull += t[c] * normal[site * dim + c];
      }
      return (pull > 0. ? pull * pull : 0.) +
             shear_weight[site] * (sum - pull * pull);
    }
  };

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
     * <t_N>_+^2 + shear_weight |t_T|^2 of the mean traction at every site, of
     * the displacements of the last forces, Pa^2; 0 may stand where it is less
     * than `looked_at`^2 times the limit.
     */
    virtual void squared_tractions(const StrengthSites &sites,
                                   std::vector<double> &squares) const = 0;
    /** {sigma n} at a site in the axes x, y, z, Pa. */
    virtual std::array<double, dim> traction(const StrengthSites &sites,
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
   * If all materials are isotropic and not graded, constant strain on
   * simplices of degree 1 and sum factorisation on quads and hexes; the blocks
   * of the bodies else: on all ranks alike. @p ghosts of the cells, if there
   * may be some.
   */
  template <int dim>
  std::unique_ptr<CellForces<dim>>
  make_cell_forces(const Discretization<dim> &discretization,
                   const JoinedMesh<dim> &mesh, FrontViscosity front,
                   const GhostCells *ghosts = nullptr);
} // namespace nsfd
