#pragma once

#include "nsfd/materials/hyperelastic.h"

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
    const double *history = nullptr; ///< at the start, of cells that have one
  };

  /** Memory of DeformableCell::solve(), for cells one after another. */
  struct FiniteScratch {
    std::vector<double> matrix;
    std::vector<double> end, force, residual, step, trial, solution;
    std::vector<unsigned int> pivots;
  };

  /** Displacements of a cell at both ends of a step, m. */
  struct CellMotion {
    const double *start = nullptr, *end = nullptr;
    double theta = 0.5, time_step = 0.;
    const double *history = nullptr; ///< at the start, of cells that have one
  };

  /** What a cell takes in a step and does not store, J. */
  struct CellLosses {
    double numerical = 0., plastic = 0., viscous = 0.;
  };

  /**
   * A cell whose forces are no linear function of its displacements, or depend
   * on what it keeps. Its forces between two displacements are
   *
   *   f_ic = sum_q JxW_q (F S)_cd grad_i,d
   *
   * with F and S of each quadrature point, see Point. All functions but
   * energy() return false, or NaN, where a point has no stress.
   */
  template <int dim>
  class DeformableCell
  {
  public:
    /**
     * @p JxW per quadrature point, in m^dim; @p gradients of the shape
     * functions before deformation, in 1/m: entry (q n_nodes + i) dim + d.
     * @p modulus in Pa says how large forces are.
     */
    DeformableCell(std::vector<double> JxW, std::vector<double> gradients,
                   double modulus);
    virtual ~DeformableCell() = default;

    unsigned int n_nodes() const { return n_nodes_; }
    unsigned int n_dofs() const { return n_nodes_ * dim; }

    /** Numbers that the cell keeps from step to step. */
    virtual std::size_t n_history() const { return 0; }
    /** Of a cell that has never been strained. */
    virtual void begin_history(double *) const {}

    /** Stored energy in J; infinite where det F <= 0. */
    virtual double energy(const double *u,
                          const double *history = nullptr) const = 0;

    /** The work f.(u1 - u0) less the change of energy; what the cell keeps
        then goes to @p history, n_history() numbers, unless it is null. */
    virtual CellLosses account(const CellMotion &motion,
                               double *history = nullptr) const = 0;

    /** @p f has n_dofs() entries, in N. */
    bool force(const CellMotion &motion, double *f) const;

    /** @p K = df/du1 in N/m, n_dofs() square, column-major, not symmetric. */
    bool tangent(const CellMotion &motion, double *K) const;

    /**
     * A symmetric positive semidefinite stand-in for tangent(): F on both
     * sides, the symmetric part of dS (where that is not definite, with a part
     * of the one at rest, or the latter alone), and S without compression.
     */
    bool symmetric_tangent(const CellMotion &motion, double *K) const;

    /**
     * With F on both sides, the symmetric part of dS and all of S, where with
     * this and @p mass the matrix of the step, M + h^2 theta K, leaves no
     * motion much softer than its mass alone; else symmetric_tangent(). (Bodies
     * that turn are nearer to F on both sides than to the symmetric part of
     * tangent().)
     */
    bool step_tangent(const CellMotion &motion, const double *mass,
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

  protected:
    /** The step at a quadrature point. */
    struct Point {
      double F[dim * dim];     ///< of the force
      double F_end[dim * dim]; ///< F_end^T dF_end is half of what S depends on
      Voigt<dim> S;
      Voigt<dim> turning;      ///< S where F depends on the end, else 0
      VoigtBlock<dim> tangent; ///< dS/dC1, if asked for
    };
    virtual bool set_point(unsigned int q, const CellMotion &motion,
                           bool with_tangent, Point &point) const = 0;
    /** dS/dC1 of a cell that is not strained. */
    virtual VoigtBlock<dim> tangent_at_rest(double theta) const = 0;
    /** How little of it is tried first to make another tangent definite. */
    virtual double least_share() const { return 1.; }

    /** Displacement gradient, and @p unit on the diagonal. */
    void gradient(unsigned int q, const double *u, double *F,
                  double unit = 1.) const;

    unsigned int n_nodes_;
    std::vector<double> JxW_, gradients_;

  private:
    struct Balance;

    void add_tangent(unsigned int q, const double *F_left,
                     const double *F_right, const Voigt<dim> &geometric,
                     const VoigtBlock<dim> &tangent, double *K) const;
    bool add_symmetric(const CellMotion &motion, bool definite,
                       double *K) const;
    bool balance(const FiniteStep &step, const double *v,
                 FiniteScratch &scratch, Balance &result) const;
    bool factorize_derivative(const FiniteStep &step,
                              FiniteScratch &scratch) const;
    bool improve(const FiniteStep &step, double *v, FiniteScratch &scratch,
                 Balance &now) const;
    bool iterate(const FiniteStep &step, double *v,
                 FiniteScratch &scratch) const;

    double strain_force_ = 0.; ///< at a node, of a strain of about one, N
    double largest_gradient_ = 0.;
  };
} // namespace nsfd
