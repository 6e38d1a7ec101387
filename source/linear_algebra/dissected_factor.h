#pragma once

#include "cholesky.h"
#include "dissection.h"

#include <vector>

namespace nsfd
{
  /**
   * Cholesky's factor of a matrix whose rows lie on several ranks: of joined
   * cells the nodes between ranks, which belong to the first of them, are
   * common; what the elimination of the others leaves for them is factored on
   * every rank.
   */
  class DissectedFactor
  {
  public:
    explicit DissectedFactor(const Communicator &communicator);

    /** False, on all ranks: not positive definite, or too large. */
    bool try_factorise(const SparseRows &matrix, bool new_pattern);
    void solve(const double *b, double *x);

    /** Of this rank and of what is common, 8 bytes each. */
    double n_entries() const;

  private:
    void set_common_pattern();
    void sum();

    const Communicator &communicator_;
    const Communicator alone_;
    Dissection dissection_;
    Cholesky common_;
    SparseRows common_matrix_; ///< lower triangle, by rows
    std::vector<double> right_, solution_;
  };
} // namespace nsfd
