#pragma once

#include "cell_forces.h"
#include "cell_histories.h"

#include "discretization/cells.h"
#include "nsfd/materials/hyperelastic.h"

namespace nsfd
{
  /** Forces that are no linear function of the motion. */
  template <int dim>
  class NonlinearForces : public CellForces<dim>
  {
  public:
    using CellForces<dim>::CellForces;

    // all of the last forces; what is summed is 0 of ghosts

    /** By cell, J. */
    virtual const std::vector<double> &stored() const = 0;
    /** Terms of the power of the front viscosity against each of @p velocities
        of the groups, one row after the other, W. */
    virtual std::vector<double> front_powers(
        const CornerGroups<dim> &groups,
        const std::vector<const std::vector<double> *> &velocities) const = 0;
    /** Rows n, t1, t2 at a point between two cells. */
    virtual std::array<double, dim * dim> frame(std::size_t point) const = 0;
    /** A cell that is turned inside out, or has no stress; -1: none. */
    virtual int inverted() const = 0;
    /**
     * How much higher the square of the largest frequency of a cell may be
     * than at rest: an estimate that is 1 there. Of all cells that are divided,
     * collective then; else of those that are here.
     */
    virtual double stiffening() const = 0;
    /** What flow took on the way to the places of the last forces, J: by cell
        the plastic part, then the viscous one. Empty: nothing flows. */
    virtual const std::vector<double> &taken() const = 0;
    virtual KeptHistories &histories() = 0;
  };

  /** Of a class of cells, or of one of those that have no class. */
  struct FiniteTables {
    unsigned int n_nodes = 0;
    std::vector<double> JxW, gradients;    ///< point x node x sdim, 1/m
    std::vector<double> slot_gradients;    ///< slot x node x sdim; empty: those
                                           ///< of the one point
    std::vector<char> on_axis;             ///< by node; empty: none is
    std::vector<unsigned int> slot_points; ///< nearest points of quadrature
    unsigned int n_same = 0;     ///< points of quadrature beside the one point
    bool one_dilatation = false; ///< of small strain: flow would lock them
  };

  /**
   * Forces of finite strain on joined cells, f = -dU/dq,
   *
   *   f_i = -sum_q JxW_q P grad N_i,   P = F S(F^T F),
   *
   * and the pressure of the front viscosity on the cofactors of F. Tractions
   * are nominal ones, P N, per area before deformation, with their parts along
   * and across the normal that the face has now. Frames of faces turn with the
   * mean motion of both sides.
   *
   * Cells of materials with a history have the mean dilatation of the cell
   * everywhere, since flow keeps the volume:
   *
   *   U = sum_q JxW_q W(C), C = (theta/J)^(2/sdim) F^T F,
   *   theta = sum_q JxW_q J_q / sum_q JxW_q
   *
   * In small motions, of scenes with such materials, F is 1 and strains are
   * linear: small_strain.h. Bilinear and trilinear cells that flow have the
   * mean of tr(H) everywhere, the others are fully integrated.
   *
   * Rings of an axisymmetric scene are strained in space, sdim = 3, with the
   * stretch 1 + u_r/r along their hoops; densities are per radian.
   *
   * Where every rank has all cells each computes its own, and gets those of the
   * others from their ranks.
   */
  template <int dim, int sdim = dim>
  class FiniteForces final : public NonlinearForces<dim>
  {
  public:
    /** @p ghosts of the cells, if there may be some, or all cells of other
        ranks, which are @p divided, outlive it. */
    FiniteForces(const Discretization<dim> &discretization,
                 const JoinedMesh<dim> &mesh, FrontViscosity front,
                 const GhostCells *ghosts = nullptr,
                 const GhostCells *divided = nullptr);
    ~FiniteForces() override;

    void set_forces(CornerGroups<dim> &groups) override;
    std::array<double, dim>
    corner_force(std::size_t corner,
                 const CornerGroups<dim> &groups) const override;
    void
    squared_tractions(const StrengthSites<dim> &sites,
                      typename StrengthSites<dim>::Near &near) const override;
    /** Turned back: its parts along the axes of the frame at rest are those
        along the axes of frame(). */
    std::array<double, dim> traction(const StrengthSites<dim> &sites,
                                     std::size_t site) const override;

    const std::vector<double> &stored() const override { return stored_; }
    std::vector<double>
    front_powers(const CornerGroups<dim> &groups,
                 const std::vector<const std::vector<double> *> &velocities)
        const override;
    std::array<double, dim * dim> frame(std::size_t point) const override;
    int inverted() const override { return inverted_; }
    double stiffening() const override;
    const std::vector<double> &taken() const override { return taken_; }
    KeptHistories &histories() override { return histories_; }

  private:
    using Matrix = std::array<double, sdim * sdim>;
    const FiniteTables &tables(const std::size_t cell) const
    {
      return tables_[differ_ ? cell : discretization_.bodies().class_of[cell]];
    }
    const Hyperelastic<sdim> &material(std::size_t cell) const;
    Matrix deformation(std::size_t cell, const double *gradients) const;
    const double *at_slot(std::size_t cell, unsigned int slot) const;
    Matrix stress_at(std::size_t cell, unsigned int slot) const;
    Matrix flowing_stress(std::size_t cell, unsigned int q,
                          const Matrix &F) const;
    double flowing_stiffening(std::size_t cell) const;
    void set_cell(std::size_t cell);
    std::array<double, 2> set_elastic_cell(std::size_t cell, double *f);
    std::array<double, 2> set_flowing_cell(std::size_t cell, double *f);
    std::array<double, 2> set_small_cell(std::size_t cell, double *f);
    void share_cells();

    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const GhostCells *const ghosts_;  ///< null: there are none
    const GhostCells *const divided_; ///< null: cells are not
    const bool differ_;
    const bool small_; ///< motions: nothing turns
    std::vector<FiniteTables> tables_;
    std::vector<std::unique_ptr<const Hyperelastic<sdim>>> materials_;
    /// of a point, both sides: cell and slot
    std::vector<std::array<std::pair<int, unsigned int>, 2>> sides_;
    std::vector<double> displacement_, forces_, front_forces_; ///< of corners
    std::vector<double> stored_, peaks_; ///< J; largest P:P of a cell
    /// by cell, before the motion and now, where cells are divided
    std::vector<std::array<double, 2>> volumes_;
    CellHistories<dim, sdim> histories_;
    std::vector<double> dilatations_, taken_; ///< theta by cell; see taken()
    int inverted_ = -1;
  };
} // namespace nsfd
