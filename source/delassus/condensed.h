#pragma once

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * W of few rows as a dense matrix, and the Cholesky factor of W + D on the
   * rows that take part.
   */
  class CondensedDelassus
  {
  public:
    /// rows: 32 MB
    static constexpr std::size_t largest = 2000;

    bool empty() const { return rows_.empty(); }
    void clear();
    /** @p rows out of @p n components; columns to come. */
    void reset(std::size_t n, const std::vector<std::size_t> &rows);
    /** W e_k of row @p k, all components. */
    void set_column(std::size_t k, const double *velocity);

    /** U = W P; the components that are no rows are left at 0. */
    void apply(const double *impulse, double *velocity) const;

    /** A factor costs no more than some solves with a sparse one. */
    bool can_factor() const { return rows_.size() <= 800; }
    /** Of W + D, all components; negative D: does not take part. */
    void factor(const std::vector<double> &D);
    void solve(const double *r, double *z) const;

  private:
    std::size_t n_ = 0;
    std::vector<std::size_t> rows_, part_; ///< part_: rows that take part
    std::vector<double> matrix_, factor_, D_;
    mutable std::vector<double> in_, out_;
  };
} // namespace nsfd
