// Plain arrays, several instruction sets, and the same sums in the same order.
#include "sum_kernels.h"

#include "instruction_sets.h"
#include "vector8.h"

#include <cstring>

namespace nsfd
{
  NSFD_CLONES
  unsigned long long largest_bits(const double *x, const std::size_t n)
  {
    unsigned long long lane[8] = {};
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8)
      for (unsigned int l = 0; l < 8; ++l) {
        unsigned long long bits;
        std::memcpy(&bits, x + i + l, sizeof(bits));
        bits &= 0x7fffffffffffffffull;
        lane[l] = bits > lane[l] ? bits : lane[l];
      }
    for (; i < n; ++i) {
      unsigned long long bits;
      std::memcpy(&bits, x + i, sizeof(bits));
      bits &= 0x7fffffffffffffffull;
      lane[0] = bits > lane[0] ? bits : lane[0];
    }
    for (unsigned int l = 1; l < 8; ++l)
      lane[0] = lane[l] > lane[0] ? lane[l] : lane[0];
    return lane[0];
  }

  NSFD_CLONES
  void split_sums(const double *x, const std::size_t n, const double high,
                  const double low, double *parts)
  {
    Vector8 first = {}, second = {};
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8) {
      const Vector8 value = *reinterpret_cast<const Vector8u *>(x + i);
      const Vector8 top = (value + high) - high;
      const Vector8 rest = value - top;
      first += top;
      second += (rest + low) - low;
    }
    double sums[2] = {};
    for (; i < n; ++i) {
      const double top = (x[i] + high) - high;
      const double rest = x[i] - top;
      sums[0] += top;
      sums[1] += (rest + low) - low;
    }
    for (unsigned int l = 0; l < 8; ++l) {
      sums[0] += first[l];
      sums[1] += second[l];
    }
    parts[0] = sums[0];
    parts[1] = sums[1];
  }
} // namespace nsfd
