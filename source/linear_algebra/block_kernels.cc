// No deal.II here: plain arrays, several instruction sets, and the same sums
// in the same order in both kernels.
#include "block_kernels.h"

#include "core/instruction_sets.h"
#include "core/vector8.h"

namespace nsfd
{
  NSFD_CLONES
  void multiply_lanes(const double *A, const unsigned int rows,
                      const unsigned int cols, const double *X, double *Y)
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
  void multiply_one(const double *A, const unsigned int rows,
                    const unsigned int cols, const double *x, double *y)
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
} // namespace nsfd
