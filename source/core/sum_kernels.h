#pragma once

#include <cstddef>

namespace nsfd
{
  /** Bit pattern of the largest |x_i|; above that of infinity if one is NaN. */
  unsigned long long largest_bits(const double *x, std::size_t n);

  /**
   * Split every x_i at two binary places and add the parts, both exactly:
   * parts[0] what is above the ulp of @p high, parts[1] of the rest what is
   * above the ulp of @p low.
   */
  void split_sums(const double *x, std::size_t n, double high, double low,
                  double *parts);
} // namespace nsfd
