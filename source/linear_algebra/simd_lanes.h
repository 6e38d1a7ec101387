#pragma once

#include "core/instruction_sets.h"
#include "simd_kernels.h"

#include <cstddef>

/** The vectors that the kernels compute with, sixteen lanes of floats. */
namespace nsfd::simd
{
  typedef float Lanes __attribute__((vector_size(64)));
  typedef float LanesU __attribute__((vector_size(64), aligned(4)));
  typedef double Half __attribute__((vector_size(64)));
  typedef double HalfU __attribute__((vector_size(64), aligned(8)));
  typedef float Eight __attribute__((vector_size(32)));

  NSFD_INLINE Lanes load(const float *x)
  {
    return *reinterpret_cast<const LanesU *>(x);
  }

  NSFD_INLINE void store(float *x, const Lanes &value)
  {
    *reinterpret_cast<LanesU *>(x) = value;
  }

  NSFD_INLINE void add_exactly(const Lanes &terms, const double high, Half &sum)
  {
    const Eight low = __builtin_shufflevector(terms, terms, 0, 1, 2, 3, 4, 5, 6,
                                              7),
                up = __builtin_shufflevector(terms, terms, 8, 9, 10, 11, 12, 13,
                                             14, 15);
    sum += (__builtin_convertvector(low, Half) + high) - high;
    sum += (__builtin_convertvector(up, Half) + high) - high;
  }

  NSFD_INLINE double total(const Half &sum)
  {
    double value = 0.;
    for (unsigned int l = 0; l < 8; ++l)
      value += sum[l];
    return value;
  }

  /** Entry (i, j) of a packed symmetric block. */
  NSFD_INLINE constexpr unsigned int entry(const unsigned int i,
                                           const unsigned int j)
  {
    return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
  }
} // namespace nsfd::simd
