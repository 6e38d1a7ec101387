// The inner loops of the sparse factors: plain arrays, several instruction
// sets.
#include "contact_kernels.h"

#include "core/instruction_sets.h"

#include <cstddef>

namespace nsfd::stored
{
  namespace
  {
    typedef double Row __attribute__((vector_size(32), aligned(8)));

    NSFD_CLONES
    void eliminate_3(const double *const f, const double *upper,
                     const int *const index, const int count, double *const row)
    {
      for (int m = 0; m < count; ++m, upper += 12) {
        const Row u0 = *reinterpret_cast<const Row *>(upper),
                  u1 = *reinterpret_cast<const Row *>(upper + 4),
                  u2 = *reinterpret_cast<const Row *>(upper + 8);
        Row *const target =
            reinterpret_cast<Row *>(row + std::size_t(12) * index[m]);
        target[0] -= f[0] * u0 + f[1] * u1 + f[2] * u2;
        target[1] -= f[4] * u0 + f[5] * u1 + f[6] * u2;
        target[2] -= f[8] * u0 + f[9] * u1 + f[10] * u2;
      }
    }

    NSFD_CLONES
    void substitute_3(const double *block, const double *const x,
                      const int *const index, const int count,
                      double *const sum)
    {
      Row s0 = {}, s1 = {}, s2 = {};
      for (int m = 0; m < count; ++m, block += 12) {
        const Row v =
            *reinterpret_cast<const Row *>(x + std::size_t(4) * index[m]);
        s0 += *reinterpret_cast<const Row *>(block) * v;
        s1 += *reinterpret_cast<const Row *>(block + 4) * v;
        s2 += *reinterpret_cast<const Row *>(block + 8) * v;
      }
      sum[0] -= s0[0] + s0[1] + s0[2];
      sum[1] -= s1[0] + s1[1] + s1[2];
      sum[2] -= s2[0] + s2[1] + s2[2];
    }
  } // namespace

  template <>
  void eliminate<3>(const double *factor, const double *upper, const int *index,
                    const int count, double *row)
  {
    eliminate_3(factor, upper, index, count, row);
  }

  template <>
  void eliminate<2>(const double *const f, const double *u,
                    const int *const index, const int count, double *const row)
  {
    for (int m = 0; m < count; ++m, u += 4) {
      double *const target = row + std::size_t(4) * index[m];
      target[0] -= f[0] * u[0] + f[1] * u[2];
      target[1] -= f[0] * u[1] + f[1] * u[3];
      target[2] -= f[2] * u[0] + f[3] * u[2];
      target[3] -= f[2] * u[1] + f[3] * u[3];
    }
  }

  template <>
  void substitute<3>(const double *block, const double *x, const int *index,
                     const int count, double *sum)
  {
    substitute_3(block, x, index, count, sum);
  }

  template <>
  void substitute<2>(const double *b, const double *const x,
                     const int *const index, const int count, double *const sum)
  {
    for (int m = 0; m < count; ++m, b += 4) {
      const double *const v = x + std::size_t(2) * index[m];
      sum[0] -= b[0] * v[0] + b[1] * v[1];
      sum[1] -= b[2] * v[0] + b[3] * v[1];
    }
  }
} // namespace nsfd::stored
