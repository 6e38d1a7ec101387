// Vectors over faces and the blocks of faces: no deal.II here either.
#include "simd_kernels.h"
#include "simd_lanes.h"

#include <cmath>

namespace nsfd::simd
{
  namespace
  {
    NSFD_INLINE void advance_faces(const FaceGroup &g, const unsigned int n,
                                   const float alpha, const float *p,
                                   const float *w, float *x, float *r, float *z,
                                   ExactSum &sum)
    {
      const float *B = g.inverse.data(), *owned = g.owned.data();
      const unsigned int packed = n * (n + 1) / 2;
      const std::size_t size = std::size_t(n) * width;
      p += g.first;
      w += g.first;
      x += g.first;
      r += g.first;
      z += g.first;
      Half all = {};
      for (std::size_t b = 0; b < g.n_batches; ++b, p += size, w += size,
                       x += size, r += size, z += size,
                       B += std::size_t(packed) * width, owned += width) {
        for (unsigned int k = 0; k < n; ++k) {
          store(x + k * width,
                load(x + k * width) + alpha * load(p + k * width));
          store(r + k * width,
                load(r + k * width) - alpha * load(w + k * width));
        }
        Lanes terms = {};
        for (unsigned int i = 0; i < n; ++i) {
          Lanes value = {};
          for (unsigned int j = 0; j < n; ++j)
            value += load(B + entry(i, j) * width) * load(r + j * width);
          store(z + i * width, value);
          terms += value * load(r + i * width);
        }
        add_exactly(terms * load(owned), sum.high, all);
      }
      sum.value += total(all);
    }
  } // namespace

  ExactSum::ExactSum(const double scale)
      : high(scale > 0. ? std::ldexp(1.5, std::ilogb(scale) - 36 + 52) : 1.5)
  {
  }

  NSFD_CLONES
  void advance(const FaceGroup &group, const float alpha, const float *p,
               const float *w, float *x, float *r, float *z, ExactSum &sum)
  {
    if (group.n() == 4)
      advance_faces(group, 4, alpha, p, w, x, r, z, sum);
    else
      advance_faces(group, group.n(), alpha, p, w, x, r, z, sum);
  }

  NSFD_CLONES
  void precondition(const FaceGroup &group, const float *in, float *out)
  {
    const unsigned int n = group.n();
    const float *B = group.inverse.data(), *weight = group.weight.data(),
                *idle = group.idle.data();
    const std::size_t size = std::size_t(n) * width;
    in += group.first;
    out += group.first;
    for (std::size_t b = 0; b < group.n_batches; ++b, in += size, out += size,
                     weight += size, idle += size,
                     B += std::size_t(group.packed()) * width)
      for (unsigned int i = 0; i < n; ++i) {
        Lanes value = load(idle + i * width) * load(in + i * width);
        for (unsigned int j = 0; j < n; ++j)
          value += load(B + entry(i, j) * width) *
                   (load(weight + j * width) * load(in + j * width));
        store(out + i * width, value);
      }
  }

  NSFD_CLONES
  void face_products(const FaceGroup &group, const float *a, const float *b,
                     double *terms)
  {
    const unsigned int n = group.n();
    a += group.first;
    b += group.first;
    for (std::size_t k = 0; k < group.n_batches; ++k) {
      Lanes sum = {};
      for (unsigned int i = 0; i < n; ++i, a += width, b += width)
        sum += load(a) * load(b);
      sum *= load(group.owned.data() + k * width);
      for (unsigned int l = 0; l < width; ++l)
        *terms++ = double(sum[l]);
    }
  }

  NSFD_CLONES
  void dots(const FaceGroup &group, const float *const *V,
            const unsigned int count, const float *w, ExactSum *sums)
  {
    const unsigned int n = group.n();
    const std::size_t size = std::size_t(n) * width;
    w += group.first;
    for (unsigned int j = 0; j < count; j += 4) {
      const unsigned int last = count - 1;
      const float *v[4];
      Half all[4] = {};
      for (unsigned int c = 0; c < 4; ++c)
        v[c] = V[j + c < last ? j + c : last] + group.first;
      for (std::size_t b = 0; b < group.n_batches; ++b) {
        Lanes terms[4] = {};
        for (unsigned int i = 0; i < n; ++i) {
          const std::size_t at = b * size + i * width;
          const Lanes x = load(w + at);
          for (unsigned int c = 0; c < 4; ++c)
            terms[c] += load(v[c] + at) * x;
        }
        const Lanes owned = load(group.owned.data() + b * width);
        for (unsigned int c = 0; c < 4; ++c)
          add_exactly(terms[c] * owned, sums[0].high, all[c]);
      }
      for (unsigned int c = 0; c < 4 && j + c < count; ++c)
        sums[j + c].value += total(all[c]);
    }
  }

  NSFD_CLONES
  void combine(const std::size_t n, const float beta, const float *z, float *p)
  {
    for (std::size_t k = 0; k < n; k += width)
      store(p + k, load(z + k) + beta * load(p + k));
  }

  NSFD_CLONES
  void subtract(const std::size_t n, const float *const *V, const float *h,
                const unsigned int count, float *w)
  {
    unsigned int j = 0;
    for (; j + 4 <= count; j += 4)
      for (std::size_t k = 0; k < n; k += width)
        store(w + k, load(w + k) - h[j] * load(V[j] + k) -
                         h[j + 1] * load(V[j + 1] + k) -
                         h[j + 2] * load(V[j + 2] + k) -
                         h[j + 3] * load(V[j + 3] + k));
    for (; j < count; ++j)
      for (std::size_t k = 0; k < n; k += width)
        store(w + k, load(w + k) - h[j] * load(V[j] + k));
  }

  namespace
  {
    NSFD_INLINE Half load_half(const double *x)
    {
      return *reinterpret_cast<const HalfU *>(x);
    }

    /** For eight lanes of the sixteen: arrays have a stride of `width`. */
    NSFD_INLINE void invert_half(const unsigned int n, const double *W,
                                 const double *D, const double *part,
                                 double *work, float *inverse)
    {
      HalfU *const L = reinterpret_cast<HalfU *>(work), *const X =
                                                            L + n * (n + 1) / 2;
      for (unsigned int j = 0; j < n; ++j) {
        const Half pj = load_half(part + j * width);
        Half pivot = load_half(W + entry(j, j) * width) * pj +
                     load_half(D + j * width) * pj + (1. - pj);
        const Half original = pivot;
        for (unsigned int k = 0; k < j; ++k)
          pivot -= L[entry(j, k)] * L[entry(j, k)];
        Half inverted;
        for (unsigned int l = 0; l < 8; ++l)
          inverted[l] =
              pivot[l] > 1e-10 * original[l] ? 1. / std::sqrt(pivot[l]) : 0.;
        L[entry(j, j)] = inverted;
        for (unsigned int i = j + 1; i < n; ++i) {
          Half value = load_half(W + entry(i, j) * width) * pj *
                       load_half(part + i * width);
          for (unsigned int k = 0; k < j; ++k)
            value -= L[entry(i, k)] * L[entry(j, k)];
          L[entry(i, j)] = value * inverted;
        }
      }
      // L^{-1}, column by column, then L^{-T} L^{-1}
      for (unsigned int c = 0; c < n; ++c)
        for (unsigned int i = c; i < n; ++i) {
          Half value = {};
          if (i == c)
            value += 1.;
          for (unsigned int k = c; k < i; ++k)
            value -= L[entry(i, k)] * X[entry(k, c)];
          X[entry(i, c)] = value * L[entry(i, i)];
        }
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j) {
          Half value = {};
          for (unsigned int k = i; k < n; ++k)
            value += X[entry(k, i)] * X[entry(k, j)];
          value *= load_half(part + i * width) * load_half(part + j * width);
          for (unsigned int l = 0; l < 8; ++l)
            inverse[entry(i, j) * width + l] = float(value[l]);
        }
    }
  } // namespace

  NSFD_CLONES
  void invert(const unsigned int n, const double *W, const double *D,
              const double *part, double *work, float *inverse)
  {
    for (unsigned int half = 0; half < width; half += 8)
      if (n == 4)
        invert_half(4, W + half, D + half, part + half, work, inverse + half);
      else
        invert_half(n, W + half, D + half, part + half, work, inverse + half);
  }
} // namespace nsfd::simd
