#pragma once

#include <cstddef>

namespace nsfd
{
  /** Bodies of one class that are worked on together. */
  constexpr unsigned int lanes = 8;

  /** Leading dimension of a block with @p rows rows. */
  constexpr unsigned int padded(const unsigned int rows)
  {
    return (rows + 7) / 8 * 8;
  }

  /**
   * Y = A X for `lanes` columns. A is column-major with leading dimension
   * padded(rows), zero below `rows`; X is cols x lanes and Y padded(rows) x
   * lanes, both row-major. Every column sees the same operations in the same
   * order as in multiply_one(), so results do not depend on how bodies are
   * grouped. Compiled for several instruction sets, chosen at run time.
   */
  void multiply_lanes(const double *A, unsigned int rows, unsigned int cols,
                      const double *X, double *Y);

  /** y = A x for one column; y has padded(rows) entries. */
  void multiply_one(const double *A, unsigned int rows, unsigned int cols,
                    const double *x, double *y);

  /** @p sums[j] = a.b_j over @p size entries, j < @p n: eight sums per product,
      of every eighth term. */
  void products_of(const double *a, const double *const *b, std::size_t n,
                   std::size_t size, double *sums);
} // namespace nsfd
