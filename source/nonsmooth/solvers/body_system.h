#pragma once

#include "nsfd/dynamics/dynamics.h"
#include "nsfd/dynamics/spd_solver.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * All bodies joined by a stiffness at their face points,
   *
   *     K = M_hat + sum_i H_i^T S_i H_i,      M_hat = M + h^2 theta^2 K_bulk,
   *
   * as one sparse matrix with a direct factor: Cholesky's where every S_i is
   * symmetric and K is positive definite, else that of UMFPACK, for which S need
   * not be either. The pattern, found once, is tight: a face couples only the
   * unknowns that its points see, and points may change S without a new
   * analysis. On one rank.
   */
  template <int dim>
  class BodySystem
  {
  public:
    BodySystem(const Dynamics<dim> &dynamics, double time_step, double theta);
    ~BodySystem();
    BodySystem(const BodySystem &) = delete;
    BodySystem &operator=(const BodySystem &) = delete;

    /** Other values on the same pattern, for another step. */
    void reinit(double time_step, double theta);

    /**
     * Factorise with @p S, dim x dim row-major per point, in impulse per
     * velocity (kg). False if the matrix is singular.
     */
    bool factorise(const std::vector<double> &S);

    /** K x = b with the last factor, over the unknowns of the bodies. */
    void solve(const std::vector<double> &b, std::vector<double> &x);

    /** y = M_hat x. */
    void apply(const std::vector<double> &x, std::vector<double> &y);

    /**
     * h M_hat h^T / (h h^T)^2 of every row h of H, in kg: what a body opposes
     * to a change of velocity at this point alone.
     */
    const std::vector<double> &impedance() const { return impedance_; }

    double time_step() const { return time_step_; }
    double theta() const { return theta_; }

  private:
    /** The unknowns a face sees, and where their pairs are in the matrix. */
    struct Face
    {
      std::vector<int> dofs;
      std::vector<double> rows; ///< dim per point x dofs, in the local frame
      std::vector<int> entries; ///< dofs x dofs, row-major
    };
    void find_faces();
    void find_pattern();
    void fill_bodies();
    void find_impedance();
    double matrix_entry(const BodyClass &body, unsigned int i,
                        unsigned int j) const
    {
      return body.mass(i, j) +
             (body.rigid ? 0. : factor_ * body.stiffness(i, j));
    }
    bool factorise_symmetric();
    bool factorise_general();
    void clear();

    const Dynamics<dim> &dynamics_;
    double time_step_, theta_, factor_;
    std::vector<Face> faces_;
    SparseRows matrix_;             // its columns: the pattern is symmetric
    std::vector<int> body_entries_; // of M_hat, bodies in order, column-major
    std::vector<double> bodies_, impedance_, work_;
    std::unique_ptr<SpdSolver> cholesky_;
    bool is_symmetric_ = false, is_analysed_ = false; // for cholesky_
    void *symbolic_ = nullptr, *numeric_ = nullptr;   // of UMFPACK
  };
} // namespace nsfd
