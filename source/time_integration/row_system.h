#pragma once

#include "delassus/delassus_operator.h"
#include "linear_algebra/krylov.h"

#include <vector>

namespace nsfd
{
  /**
   * Linear systems (W + D) P = b on some of the rows of the points, by
   * conjugate gradients with the preconditioner of the operator. W may be
   * singular: b must be in its range then.
   */
  template <int dim>
  class RowSystem
  {
  public:
    RowSystem(DelassusOperator<dim> &delassus, std::size_t n_owned)
        : delassus_(delassus), n_owned_(n_owned * dim)
    {
    }

    /** D >= 0 of the rows that take part, negative elsewhere. Collective. */
    void set(const std::vector<double> &D);

    /** No row of any rank takes part. */
    bool empty() const { return empty_; }

    /**
     * From @p P, which is the start, until the residual is @p goal in the
     * Euclidean norm over all rows. Collective. @return the iterations
     */
    unsigned int solve(const std::vector<double> &b, double goal,
                       std::vector<double> &P);

  private:
    void apply(const std::vector<double> &P, std::vector<double> &U) const;

    DelassusOperator<dim> &delassus_;
    std::size_t n_owned_;
    std::vector<double> D_;
    krylov::CgVectors vectors_;
    bool empty_ = true;
  };
} // namespace nsfd
