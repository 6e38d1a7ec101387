#pragma once

#include "nsfd/motion/hyperelastic.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * What the implicit step of one cell is given; arrays have an entry per
   * unknown, node by node with dim components each.
   */
  struct FiniteStep {
    double time_step = 0., theta = 0.5;
    const double *mass =
        nullptr; ///< n x n, column-major, kg; positive definite
    const double *displacement = nullptr; ///< at the start, m
    const double *velocity = nullptr;     ///< at the start, m/s
    const double *load = nullptr;         ///< mean forces of the step, N
    const double *impulse = nullptr;      ///< N s, or none
  };

  /** Memory of FiniteCell::solve(), for cells of any kind one after another. */
  struct FiniteScratch {
    std::vector<double> matrix;
    std::vector<double> end, force, residual, step, trial, solution;
    std::vector<unsigned int> pivots;
  };

  /**
   * Forces in a cell of finite strain between two displacements u0 and u1,
   *
   *   f_ic = sum_q JxW_q (F_mid S)_cd grad_i,d,   F_mid = (F0 + F1) / 2,
   *
   * with the stress S of step_stress(). As F_mid^T (F1 - F0) has the symmetric
   * part (C1 - C0) / 2, the work f.(u1 - u0) is the change of energy and what
   * theta > 1/2 dissipates, exactly. F_mid S F_mid^T is symmetric, so that f
   * has no moment about the mean positions, and sums to zero over the nodes as
   * the gradients do. All functions but energy() return false, or a NaN, where
   * det F0 <= 0 or det F1 <= 0 at a quadrature point.
   */
  template <int dim>
  class FiniteCell
  {
  public:
    /**
     * @p JxW per quadrature point, in m^dim; @p gradients of the shape
     * functions before deformation, in 1/m: entry (q n_nodes + i) dim + d.
     */
    FiniteCell(std::shared_ptr<const Hyperelastic<dim>> material,
               std::vector<double> JxW, std::vector<double> gradients);

    unsigned int n_nodes() const { return n_nodes_; }
    unsigned int n_dofs() const { return n_nodes_ * dim; }

    /** Stored energy in J; infinite where det F <= 0. */
    double energy(const double *u) const;

    /** The part (theta - 1/2) dS:dE of the work f.(u1 - u0), in J. */
    double dissipated(const double *u0, const double *u1, double theta) const;

    /** @p f has n_dofs() entries, in N. */
    bool force(const double *u0, const double *u1, double theta,
               double *f) const;

    /** @p K = df/du1 in N/m, n_dofs() square, column-major, not symmetric. */
    bool tangent(const double *u0, const double *u1, double theta,
                 double *K) const;

    /**
     * A symmetric positive semidefinite stand-in for tangent(): F_mid on both
     * sides, the symmetric part of dS/dC1 (that of small strain where it is
     * not definite), and S without compression.
     */
    bool symmetric_tangent(const double *u0, const double *u1, double theta,
                           double *K) const;

    /**
     * Find @p v with
     *
     *   M (v - v_k) + h f(u_k, u_k + h (theta v + (1 - theta) v_k))
     *     = h load + impulse
     *
     * to round-off by Newton steps that begin at @p v. False, with v as it
     * was, if they do not get there.
     */
    bool solve(const FiniteStep &step, double *v, FiniteScratch &scratch) const;

  private:
    struct Point;
    struct Balance;

    void gradient(unsigned int q, const double *u, double *F) const;
    bool strain(unsigned int q, const double *u0, const double *u1,
                Point &point) const;
    void add_tangent(unsigned int q, const double *F_left,
                     const double *F_right, const Voigt<dim> &geometric,
                     const VoigtBlock<dim> &tangent, double *K) const;
    bool balance(const FiniteStep &step, const double *v,
                 FiniteScratch &scratch, Balance &result) const;
    bool factorize_derivative(const FiniteStep &step,
                              FiniteScratch &scratch) const;
    bool improve(const FiniteStep &step, double *v, FiniteScratch &scratch,
                 Balance &now) const;
    bool iterate(const FiniteStep &step, double *v,
                 FiniteScratch &scratch) const;

    std::shared_ptr<const Hyperelastic<dim>> material_;
    unsigned int n_nodes_;
    std::vector<double> JxW_, gradients_;
    double strain_force_ = 0.; ///< at a node, of a strain of about one, N
    double largest_gradient_ = 0.;
  };
} // namespace nsfd
