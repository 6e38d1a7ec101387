#pragma once

#include <vector>

namespace nsfd
{
  /**
   * A dense symmetric matrix of which some unknowns are eliminated for good
   * (LAPACK): with those that are kept, k, and the others, e,
   *
   *     L L^T = S_ee,  Y = L^-1 S_ek,  what is left: S_kk - Y^T Y.
   */
  class DenseElimination
  {
  public:
    /**
     * @p matrix, lower triangle by columns; those that are marked are @p kept.
     * @p left is what is left of them, of the same form. False: S_ee is not
     * positive definite.
     */
    bool eliminate(std::vector<double> &&matrix, const std::vector<char> &kept,
                   std::vector<double> &left);

    /** Of a @p right side of all: that of the unknowns that are kept. */
    void forward(const std::vector<double> &right, std::vector<double> &kept);
    /** After forward(): all of the @p solution from that of those. */
    void backward(const std::vector<double> &kept,
                  std::vector<double> &solution) const;

    /** Unknowns that are kept, in their order. */
    const std::vector<int> &kept() const { return kept_; }
    double n_entries() const { return double(L_.size() + Y_.size()); }

  private:
    std::vector<int> kept_, gone_;
    std::vector<double> L_, Y_, part_;
  };
} // namespace nsfd
