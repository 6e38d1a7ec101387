#pragma once

#include "core/communicator.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * The rows of this rank of a sparse symmetric matrix, both triangles. Ranks
   * own consecutive rows. Columns are numbered locally: the own rows first,
   * from 0, then what `ghosts` lists; ascending in every row.
   */
  struct SparseRows {
    long long first_row = 0; ///< global number of the first own row
    std::vector<int> start;  ///< per own row and one more
    std::vector<int> column;
    std::vector<double> value;
    std::vector<long long> ghosts; ///< global numbers, ascending

    int n_rows() const { return int(start.size()) - 1; }
  };

  /**
   * A space of fewer unknowns for the smooth part of a solution: P maps a
   * coarse unknown to all own unknowns that carry its number. Ranks own
   * consecutive numbers; `number` may name those of other ranks.
   */
  struct CoarseSpace {
    std::vector<long long> number; ///< per unknown of this rank
    long long first = 0, n_own = 0, n_global = 0;
    /** One of the numbers that a number follows, x_number += weight x_master.
     */
    struct Tie {
      long long number, master;
      double weight;
    };
    /// of all ranks on each, ascending by number; masters follow nothing
    std::vector<Tie> ties;
    /// functions of no or little energy on the own coarse unknowns (the rigid
    /// motions), n_own values each: what a multigrid method must represent
    std::vector<std::vector<double>> modes;
    unsigned int per_node = 1; ///< consecutive unknowns of one node
    /// equal versions say that P has not changed and P^T A P is still good
    unsigned long long version = 0;
  };

  /**
   * Solves A x = b with A sparse, symmetric and positive definite, for many
   * right-hand sides, then for other values of A on the same pattern.
   */
  class SpdSolver
  {
  public:
    virtual ~SpdSolver() = default;

    /**
     * Get ready for @p matrix, which must stay alive and unchanged until the
     * next call. The pattern may only change with @p new_pattern. @p coarse is
     * looked at by iterative solvers: a hierarchy on it is built again when
     * its version is another one, else kept although A has changed.
     * @throws std::runtime_error A is not positive definite or too large.
     */
    virtual void prepare(const SparseRows &matrix, const CoarseSpace &coarse,
                         bool new_pattern) = 0;

    /** y += A x, for own values. */
    using Product = std::function<void(const double *x, double *y)>;

    /**
     * To be called before prepare() by who knows A more precisely on the
     * coarse space than its entries tell: @p matrix, read at once, and @p
     * add_product agree with A there, but lack large entries of A that cancel
     * each other on it. Without effect on factors.
     */
    virtual void prepare_coarse(const SparseRows & /*matrix*/,
                                const CoarseSpace & /*coarse*/,
                                const Product & /*add_product*/)
    {
    }

    /**
     * x = A^{-1} b on the own rows; @p x is the start of an iteration.
     * Iterations end when the residual, in the norm of the preconditioner, is
     * @p tolerance of that of b. Returns their number, 0 for a factor.
     */
    virtual unsigned int solve(const double *b, double *x,
                               double tolerance) = 0;

    /**
     * The same in two parts, x = rest + coarse, the second of them a function
     * of the coarse space to the last bit where the solver knows one, else
     * zero; both start from zero.
     */
    virtual unsigned int solve_parts(const double *b, std::size_t rows,
                                     double *rest, double *coarse,
                                     double tolerance)
    {
      std::fill_n(rest, rows, 0.);
      std::fill_n(coarse, rows, 0.);
      return solve(b, rest, tolerance);
    }

    /**
     * The same for @p n right-hand sides of @p rows own values each, one after
     * the other in memory.
     */
    virtual void solve_columns(const double *B, double *X, std::size_t rows,
                               std::size_t n, double tolerance)
    {
      for (std::size_t c = 0; c < n; ++c)
        solve(B + c * rows, X + c * rows, tolerance);
    }

    /** Whether the last solve() reached its tolerance. */
    bool converged() const { return converged_; }

    struct Counters {
      unsigned long long analyses = 0;       ///< of a pattern
      unsigned long long factorisations = 0; ///< of A itself
      unsigned long long coarse_spaces = 0;  ///< built, with their solvers
      unsigned long long solves = 0, iterations = 0;
    };
    const Counters &counters() const { return counters_; }

  protected:
    Counters counters_;
    bool converged_ = true;
  };

  /**
   * Sparse Cholesky factor, supernodal, as of class Cholesky.
   */
  std::unique_ptr<SpdSolver>
  make_cholesky_solver(const Communicator &communicator);

  /**
   * Conjugate gradients with the additive preconditioner
   *
   *     sum_b E_b A_bb^{-1} E_b^T + P (P^T A P)^{-1} P^T,
   *
   * b running over the bodies, whose unknowns start at @p first_dof (one entry
   * more than bodies). The coarse matrix is factorised up to
   * @p largest_factor unknowns, beyond that one V-cycle of smoothed
   * aggregation (ML) stands for its inverse.
   */
  std::unique_ptr<SpdSolver>
  make_two_level_cg(const Communicator &communicator,
                    const std::vector<std::size_t> &first_dof,
                    long long largest_factor);
} // namespace nsfd
