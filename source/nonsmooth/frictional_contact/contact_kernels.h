#pragma once

namespace nsfd::stored
{
  /** Entries from one block of the factors to the next: 3 x 3 blocks have rows
   * of four, so that a row is one vector. */
  template <int d>
  constexpr int factor_stride = d == 3 ? 12 : 4;
  template <int d>
  constexpr int row_stride = d == 3 ? 4 : 2;

  /** row[index[m]] -= factor * upper[m], m = 0 .. count - 1: what eliminating
   * one block of a row does to the others. */
  template <int d>
  void eliminate(const double *factor, const double *upper, const int *index,
                 int count, double *row);

  /** sum -= block[m] * x[index[m]], m = 0 .. count - 1; x in rows of
   * row_stride, with zero padding. */
  template <int d>
  void substitute(const double *block, const double *x, const int *index,
                  int count, double *sum);
} // namespace nsfd::stored
