#pragma once

#include "spd_solver.h"

#include <memory>

namespace nsfd
{
  class DissectedFactor;

  /**
   * Factor of a matrix on one rank (CHOLMOD), or of the rows of several
   * (DissectedFactor). The order of elimination is kept while the pattern
   * stays.
   */
  class Cholesky
  {
  public:
    explicit Cholesky(const Communicator &communicator);
    ~Cholesky();

    /** @throws std::runtime_error on all ranks. */
    void factorise(const SparseRows &matrix, bool new_pattern);
    /** False, on all ranks, where the other one throws. */
    bool try_factorise(const SparseRows &matrix, bool new_pattern);
    void solve(const double *b, double *x);
    /** @p n columns at once; on one rank. */
    void solve_columns(const double *B, double *X, std::size_t n);

    /** Entries of the factor on this rank, 8 bytes each. */
    double n_entries() const;

  private:
    struct Library;
    std::unique_ptr<Library> library_;
    std::unique_ptr<DissectedFactor> dissected_; ///< of several ranks
  };
} // namespace nsfd
