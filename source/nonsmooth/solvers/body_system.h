#pragma once

#include "body_krylov.h"
#include "linear_algebra/sparse_lu.h"
#include "tied_nodes.h"

#include "linear_algebra/factor_limits.h"

#include "delassus/delassus_operator.h"
#include "linear_algebra/spd_solver.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * All bodies joined by a stiffness at their face points,
   *
   *     K = M_hat + sum_i H_i^T S_i H_i,      M_hat = M + h^2 theta^2 K_bulk,
   *
   * as one sparse matrix. Where every S_i is symmetric and K is positive
   * definite it has Cholesky's factor. Else S need not be either: up to @p
   * largest_factor unknowns the factor of UMFPACK, beyond it BodyKrylov, which
   * takes the place of Cholesky's too beyond 10 times as many. Where its
   * iterations do not end, factors come back for good, up to that number. The
   * pattern, found once, is tight: a face couples only the unknowns that its
   * points see, and points may change S without a new analysis. On one rank.
   */
  template <int dim>
  class BodySystem
  {
  public:
    using Vector = std::vector<double>;

    /** With @p ties, which stay the owner's, of the unknowns that are left;
        there is a factor then, whatever their number. */
    BodySystem(const DelassusOperator<dim> &delassus, double time_step,
               double theta,
               long long largest_factor = nsfd::largest_factor<dim>,
               const TiedNodes<dim> *ties = nullptr);

    /** Other values on the same pattern, for another step. */
    void reinit(double time_step, double theta);

    /**
     * Get ready for @p S, dim x dim row-major per point, in impulse per
     * velocity (kg). False if the matrix is singular.
     */
    bool factorise(const Vector &S);

    /**
     * K x = b over the unknowns of the bodies, iterations to @p tolerance of b:
     * of a Newton step, whose error is found again by the next one. Returns
     * their number, 1 for a factor.
     */
    unsigned int solve(const Vector &b, Vector &x, double tolerance = 1e-3);

    /**
     * The answer to momenta @p b and to changes of impulses that the velocities
     * oppose: M_hat x = b + H^T dP, dP = change - S dU, dU = H x. Where S is
     * large dP has more digits than change - S dU. Returns as solve() does.
     */
    unsigned int respond(const Vector &b, const Vector &change, Vector &x,
                         Vector &dU, Vector &dP, double tolerance = 1e-3);

    /** y = M_hat x. */
    void apply(const Vector &x, Vector &y);

    /**
     * h M_hat h^T / (h h^T)^2 of every row h of H, in kg: what a body opposes
     * to a change of velocity at this point alone.
     */
    const std::vector<double> &impedance() const { return impedance_; }

    /** False for good once iterations have not come to their end. */
    bool may_iterate() const { return may_iterate_; }
    void forbid_iterations() { may_iterate_ = false; }

    double time_step() const { return time_step_; }
    double theta() const { return theta_; }

  private:
    std::size_t unknown(const std::size_t dof) const
    {
      return ties_ ? std::size_t(ties_->unknown()[dof]) : dof;
    }
    void find_faces();
    void find_pattern();
    void fill_bodies();
    void find_impedance();
    double matrix_entry(const BodyClass &body, unsigned int i,
                        unsigned int j) const
    {
      return step_entry(body, shares_, i, j);
    }
    void assemble(const Vector &S);
    bool factorise_symmetric();
    bool factorise_general();
    bool iterates_in_vain(unsigned int iterations);

    const DelassusOperator<dim> &delassus_;
    double time_step_, theta_;
    StepShares shares_ = {0.};
    const long long largest_factor_;
    const TiedNodes<dim> *const ties_;
    std::vector<FaceRows> faces_;
    std::vector<std::vector<int>> entries_; // of a face, dofs x dofs, row-major
    SparseRows matrix_;             // its columns: the pattern is symmetric
    std::vector<int> body_entries_; // of M_hat, bodies in order, column-major
    Vector bodies_, impedance_, work_, stiffness_;

    enum class Means { cholesky, factor, iteration } means_ = Means::factor;
    std::unique_ptr<SpdSolver> cholesky_; // each when it is needed first
    std::unique_ptr<SparseLU> factor_;
    std::unique_ptr<BodyKrylov> iteration_;
    bool may_iterate_ = true;
  };
} // namespace nsfd
