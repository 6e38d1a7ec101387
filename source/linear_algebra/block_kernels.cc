// No deal.II here: plain arrays, several instruction sets, and the same sums
// in the same order in both kernels.
#include "nsfd/linear_algebra/block_kernels.h"

#include "core/instruction_sets.h"

#include <cstring>

namespace nsfd
{
  namespace
  {
    typedef double Vector8 __attribute__((vector_size(64)));
    typedef double Vector8u __attribute__((vector_size(64), aligned(8)));
  } // namespace

  NSFD_CLONES
  void multiply_lanes(const double *A,
                      const unsigned int rows,
                      const unsigned int cols,
                      const double *X,
                      double *Y)
  {
    const unsigned int ld = padded(rows);
    for (unsigned int r = 0; r < ld; r += 8) {
      Vector8 y0 = {}, y1 = {}, y2 = {}, y3 = {}, y4 = {}, y5 = {}, y6 = {},
              y7 = {};
      const double *a = A + r;
      for (unsigned int k = 0; k < cols; ++k, a += ld) {
        const Vector8 x =
          *reinterpret_cast<const Vector8u *>(X + std::size_t(k) * 8);
        y0 += a[0] * x;
        y1 += a[1] * x;
        y2 += a[2] * x;
        y3 += a[3] * x;
        y4 += a[4] * x;
        y5 += a[5] * x;
        y6 += a[6] * x;
        y7 += a[7] * x;
      }
      Vector8u *y = reinterpret_cast<Vector8u *>(Y + std::size_t(r) * 8);
      y[0] = y0;
      y[1] = y1;
      y[2] = y2;
      y[3] = y3;
      y[4] = y4;
      y[5] = y5;
      y[6] = y6;
      y[7] = y7;
    }
  }

  NSFD_CLONES
  void multiply_one(const double *A,
                    const unsigned int rows,
                    const unsigned int cols,
                    const double *x,
                    double *y)
  {
    const unsigned int ld = padded(rows);
    for (unsigned int r = 0; r < ld; r += 8) {
      Vector8 sum = {};
      const double *a = A + r;
      for (unsigned int k = 0; k < cols; ++k, a += ld)
        sum += x[k] * *reinterpret_cast<const Vector8u *>(a);
      *reinterpret_cast<Vector8u *>(y + r) = sum;
    }
  }

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
  void split_sums(const double *x,
                  const std::size_t n,
                  const double high,
                  const double low,
                  double *parts)
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
