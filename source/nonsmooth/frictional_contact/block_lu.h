#pragma once

#include "block_problem.h"
#include "contact_kernels.h"

#include <algorithm>

namespace nsfd::stored
{
  /**
   * Sparse factors of A + B W, with A and B block diagonal: what every Newton
   * method on a contact problem has to solve with. One ordering (approximate
   * minimum degree) and one pattern serve all A and B; pivots are chosen inside
   * the d x d blocks only. Contacts with B = 0 cost nothing.
   */
  template <int d>
  class BlockLU
  {
  public:
    static constexpr int area = d * d;

    explicit BlockLU(const BlockProblem<d> &problem);

    /** @return false if a diagonal block is singular */
    bool factor(const double *A, const double *B);

    /** @p x: right-hand side in, solution out. */
    void solve(double *x);

    std::size_t n_factor_blocks() const { return lower_index_.size(); }

    /** Products of blocks in one factorisation with all contacts closed. */
    double work() const;

  private:
    static constexpr int stride = factor_stride<d>;

    void order();
    void find_pattern();
    double *inverse(const int i) { return &inverse_[std::size_t(area) * i]; }

    static void pad(const double *plain, double *padded)
    {
      for (int c = 0; c < d; ++c)
        std::copy(plain + d * c, plain + d * (c + 1),
                  padded + row_stride<d> * c);
    }
    static void unpad(const double *padded, double *plain)
    {
      for (int c = 0; c < d; ++c)
        std::copy(padded + row_stride<d> * c, padded + row_stride<d> * c + d,
                  plain + d * c);
    }
    static bool is_zero_block(const double *padded)
    {
      return std::all_of(padded, padded + stride,
                         [](const double x) { return x == 0.; });
    }

    const BlockProblem<d> &problem_;
    std::vector<int> to_old_, to_new_;
    // rows of L by lower_*, rows of U by upper_*, both without the diagonal
    std::vector<int> lower_start_, lower_index_, upper_start_, upper_index_;
    std::vector<double> lower_, upper_, inverse_; ///< inverse: of U_ii
    std::vector<double> row_, permuted_;
    std::vector<char> trivial_;
  };
} // namespace nsfd::stored
