#pragma once

#include "spd_solver.h"

#include <vector>

namespace nsfd
{
  /**
   * Cholesky's factor of the first unknowns of a matrix, and what their
   * elimination leaves for the others, the boundary:
   *
   *     A = | A_ii A_ib |      L_ii L_ii^T = A_ii,  L_bi = A_bi L_ii^-T,
   *         | A_bi A_bb |      S = -L_bi L_bi^T.
   *
   * The order of elimination and the supernodes are those of CHOLMOD; fronts
   * are assembled one in the other (Duff & Reid, 1983).
   */
  class PartialCholesky
  {
  public:
    /**
     * Of the pattern of @p rows: A_ii and A_ib, whose columns follow those of
     * A_ii, for @p n_boundary unknowns. @throws std::bad_alloc
     */
    void analyse(const SparseRows &rows, int n_boundary);
    /**
     * Values of the same pattern. S, lower triangle, by columns of n_boundary
     * entries, is added to @p boundary. False: A_ii is not positive definite.
     */
    bool factorise(const SparseRows &rows, std::vector<double> &boundary);

    /**
     * @p x = b_i, then room for n_boundary: L_ii^-1 b_i, and what has to be
     * added to b_b.
     */
    void forward(std::vector<double> &x);
    /** From there, x_b in place: x_i. */
    void backward(std::vector<double> &x);

    double n_entries() const { return double(values_.size()); }

  private:
    struct Front {
      int first = 0;          ///< column in the order of elimination
      int n_columns = 0;      ///< that are eliminated
      int n_inner = 0;        ///< rows that are not of the boundary
      int parent = -1;        ///< the front that takes what is left
      std::vector<int> rows;  ///< ascending; its columns first
      std::size_t values = 0; ///< of L, by columns of rows.size() entries
    };
    int size(const Front &front) const { return int(front.rows.size()); }
    void assemble(const SparseRows &rows, const Front &front, double *L);
    void add_update(const Front &child, const double *update,
                    const Front &front, double *L, double *left);
    void add_to_boundary(const Front &front, const double *L, double *part,
                         std::vector<double> &boundary) const;
    std::size_t update_size(const Front &front) const;
    template <typename Visit>
    void for_fronts(const Visit &visit) const;

    int n_inner_ = 0, n_boundary_ = 0;
    /// unknown by place in the order of elimination, and the reverse
    std::vector<int> unknown_, place_;
    std::vector<Front> fronts_;
    std::vector<double> values_;
    std::vector<int> local_; ///< by place: row of the present front
    std::vector<double> ordered_, part_;
    std::size_t n_stack_ = 0; ///< entries of updates at one time
  };
} // namespace nsfd
