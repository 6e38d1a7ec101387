#pragma once

#include "linear_algebra/ghost_values.h"
#include "linear_algebra/krylov.h"
#include "linear_algebra/spd_solver.h"
#include "linear_algebra/tied_unknowns.h"

#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace nsfd
{
  class Cholesky;
  class Multigrid;

  /**
   * Solves among the functions of a space alone, x = P A^{-1} P^T b: joined
   * cells with common nodes. A on the space is given. It has a sparse Cholesky
   * factor up to a number of unknowns; beyond, conjugate gradients that one
   * V-cycle of smoothed aggregation preconditions, or what the caller gives.
   */
  class ConformingSolver
  {
  public:
    ConformingSolver(const Communicator &communicator,
                     long long largest_factor);
    ~ConformingSolver();

    /** It is to stay where it is. Collective. */
    void set_space(const CoarseSpace &space);
    /** Symmetric, and of the present space. Collective. @throws as Cholesky. */
    void prepare(const SparseRows &matrix);
    /** The same; false where it is known not to be positive definite. */
    bool try_to_prepare(const SparseRows &matrix);
    /** y = A x of own values; collective. */
    using Product = std::function<void(const std::vector<double> &x,
                                       std::vector<double> &y)>;
    /**
     * From now on conjugate gradients with these solve, until a matrix is
     * prepared; both map own values, and @p preconditioner is of the matrix.
     * @p general: it is not symmetric, and set_product() has to follow.
     */
    void iterate_with(Product product, Product preconditioner,
                      bool general = false);
    /** x = A^{-1} b of own values; collective. */
    using Solution = std::function<void(const double *b, double *x)>;
    /**
     * From now on this factor solves, of a matrix that is symmetric or not
     * (@p general), until a matrix is prepared; it has so many @p entries.
     * Collective.
     */
    void solve_with(Solution factor, bool general, double entries);
    /**
     * From now on solutions are those of another matrix, symmetric or not, by
     * generalised minimal residuals that what was prepared last preconditions,
     * in its norm where it is symmetric; null: of what was prepared.
     */
    void set_product(Product product) { product_ = std::move(product); }

    /** Where iterations end. */
    struct Goal {
      /// of the residual in the norm of the preconditioner, over its start
      double tolerance;
      /// its own norm, where minimal residuals end as well: round-off of
      /// motions that next to nothing resists is large in that norm
      double residual = 0.;

      Goal(const double of, const double left = 0.)
          : tolerance(of), residual(left)
      {
      }
    };
    /** Of x = A^{-1} b by iterations; none for a factor. Collective. */
    krylov::Outcome solve(const double *b, double *x, const Goal &goal);
    /** The same with own values of the space. Collective. */
    krylov::Outcome solve_own(const std::vector<double> &b,
                              std::vector<double> &x, const Goal &goal);
    /** P^T b, own values of the space. Collective. */
    void restrict_to_space(const std::vector<double> &b,
                           std::vector<double> &own);
    /** C^T of own values: what follows gives its share to what it follows.
        Collective. */
    void fold(std::vector<double> &own) const
    {
      if (ties_.any())
        ties_.fold(own.data());
    }
    /** @p x += P of own values. Collective. */
    void add(const std::vector<double> &own, double *x);
    /** @p n columns of @p rows values each. */
    void solve_columns(const double *B, double *X, std::size_t rows,
                       std::size_t n, double tolerance);

    /** What was prepared last has a factor of the whole matrix. */
    bool has_factor() const { return factor_ || given_.factor; }
    /** Of the factor, 0: there is none on this rank. */
    double n_factor_entries() const;

  private:
    void restrict_to_space(const double *b, double *own);
    void expand(double *own, double *x);
    krylov::Outcome solve_here(const Goal &goal);
    void precondition(const std::vector<double> &r, std::vector<double> &z);
    krylov::Outcome iterate(const Goal &goal);

    const Communicator &communicator_;
    const long long largest_factor_;
    const CoarseSpace *space_ = nullptr;
    /// per unknown: place among own ones of the space, then its ghosts
    std::vector<int> place_;
    std::size_t n_own_ = 0;
    GhostValues exchange_; ///< of the space
    TiedUnknowns ties_;
    bool new_pattern_ = true;
    Product product_; ///< or null
    struct {
      Product product, preconditioner;
      Solution factor;
      double entries = 0.;    ///< of it
    } given_;                 ///< by the caller, or null
    bool is_general_ = false; ///< its preconditioner
    std::unique_ptr<Cholesky> factor_;
    std::unique_ptr<Multigrid> multigrid_;
    SparseRows matrix_; ///< of the iterations
    GhostValues of_matrix_;
    krylov::CgVectors vectors_;
    std::vector<double> b_, x_; ///< own, with room for ghosts
  };
} // namespace nsfd
