#pragma once

#include <vector>

namespace nsfd
{
  /** LU with row pivots of a few unknowns; the memory is used again. Zeros at
     both ends of rows cost nothing: unknowns of one place should be neighbours.
   */
  class DenseLU
  {
  public:
    /** A matrix of zeros, to be filled. */
    void reinit(int n);

    int size() const { return n_; }
    double *row(const int i) { return &a_[std::size_t(i) * n_]; }
    const double *row(const int i) const { return &a_[std::size_t(i) * n_]; }

    /** False if singular. */
    bool factorise();

    /** In place. */
    void solve(double *x) const;

  private:
    int n_ = 0;
    std::vector<double> a_;
    std::vector<int> pivot_, begin_, end_; ///< of what is not zero in a row
  };
} // namespace nsfd
