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

  NSFD_CLONES
  void products_of(const double *a, const double *const *b, const std::size_t n,
                   const std::size_t size, double *sums)
  {
    const std::size_t whole = size / 8 * 8;
    for (std::size_t j = 0; j < n; j += 4) {
      // the last ones are counted several times over
      const double *b0 = b[j], *b1 = b[j + 1 < n ? j + 1 : j],
                   *b2 = b[j + 2 < n ? j + 2 : j],
                   *b3 = b[j + 3 < n ? j + 3 : j];
      Vector8 s0 = {}, s1 = {}, s2 = {}, s3 = {};
      for (std::size_t i = 0; i < whole; i += 8) {
        const Vector8 x = *reinterpret_cast<const Vector8u *>(a + i);
        s0 += x * *reinterpret_cast<const Vector8u *>(b0 + i);
        s1 += x * *reinterpret_cast<const Vector8u *>(b1 + i);
        s2 += x * *reinterpret_cast<const Vector8u *>(b2 + i);
        s3 += x * *reinterpret_cast<const Vector8u *>(b3 + i);
      }
      double s[4] = {};
      for (unsigned int l = 0; l < 8; ++l) {
        s[0] += s0[l];
        s[1] += s1[l];
        s[2] += s2[l];
        s[3] += s3[l];
      }
      for (std::size_t i = whole; i < size; ++i) {
        s[0] += a[i] * b0[i];
        s[1] += a[i] * b1[i];
        s[2] += a[i] * b2[i];
        s[3] += a[i] * b3[i];
      }
      for (std::size_t k = j; k < n && k < j + 4; ++k)
        sums[k] = s[k - j];
    }
  }
} // namespace nsfd
