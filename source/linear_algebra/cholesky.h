#pragma once

#include "spd_solver.h"

#include <memory>

namespace nsfd
{
  /**
   * Factor of a matrix on one rank, or gathered on the first of several. The
   * order of elimination is kept while the pattern stays.
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

    /** Entries of the factor, 8 bytes each; 0 on other ranks. */
    double n_entries() const;

  private:
    struct Library;
    std::unique_ptr<Library> library_;
    const Communicator &communicator_;
    std::vector<int> counts_, offsets_; // rows per rank, on the first one
    void gather(const SparseRows &matrix);
    SparseRows gathered_;
    std::vector<double> b_, x_;
  };
} // namespace nsfd
