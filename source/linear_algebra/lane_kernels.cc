// No deal.II here: plain arrays, several instruction sets.
#include "lane_kernels.h"

#include "core/instruction_sets.h"

#include <cmath>

namespace nsfd::lane
{
  namespace
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

    /** Values of one class, or of every lane. */
    template <bool shared>
    NSFD_INLINE void add_product(Lanes &sum, const float *a, const Lanes &x)
    {
      if constexpr (shared)
        sum += *a * x;
      else
        sum += load(a) * x;
    }

    NSFD_INLINE void add_exactly(const Lanes &terms, const double high,
                                 Half &sum)
    {
      const Eight low = __builtin_shufflevector(terms, terms, 0, 1, 2, 3, 4, 5,
                                                6, 7),
                  up = __builtin_shufflevector(terms, terms, 8, 9, 10, 11, 12,
                                               13, 14, 15);
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

    /** y = A x, A of rows x cols, column by column. */
    template <bool shared>
    NSFD_INLINE void multiply(const float *A, const unsigned int rows,
                              const unsigned int cols, const float *x, float *y)
    {
      constexpr unsigned int step = shared ? 1 : width;
      unsigned int r = 0;
      for (; r + 8 <= rows; r += 8) {
        Lanes y0 = {}, y1 = {}, y2 = {}, y3 = {}, y4 = {}, y5 = {}, y6 = {},
              y7 = {};
        const float *a = A + std::size_t(r) * step;
        for (unsigned int k = 0; k < cols; ++k, a += std::size_t(rows) * step) {
          const Lanes v = load(x + std::size_t(k) * width);
          add_product<shared>(y0, a, v);
          add_product<shared>(y1, a + step, v);
          add_product<shared>(y2, a + 2 * step, v);
          add_product<shared>(y3, a + 3 * step, v);
          add_product<shared>(y4, a + 4 * step, v);
          add_product<shared>(y5, a + 5 * step, v);
          add_product<shared>(y6, a + 6 * step, v);
          add_product<shared>(y7, a + 7 * step, v);
        }
        float *out = y + std::size_t(r) * width;
        store(out, y0);
        store(out + width, y1);
        store(out + 2 * width, y2);
        store(out + 3 * width, y3);
        store(out + 4 * width, y4);
        store(out + 5 * width, y5);
        store(out + 6 * width, y6);
        store(out + 7 * width, y7);
      }
      for (; r < rows; ++r) {
        Lanes sum = {};
        const float *a = A + std::size_t(r) * step;
        for (unsigned int k = 0; k < cols; ++k, a += std::size_t(rows) * step)
          add_product<shared>(sum, a, load(x + std::size_t(k) * width));
        store(y + std::size_t(r) * width, sum);
      }
    }

    /**
     * y = H x for rows of H with @p entries each, or with any number (0).
     */
    template <bool shared, unsigned int entries>
    NSFD_INLINE void multiply_sparse(const std::vector<unsigned int> &first,
                                     const std::vector<unsigned int> &column,
                                     const float *h, const float *x, float *y)
    {
      constexpr unsigned int step = shared ? 1 : width;
      const unsigned int *at = column.data();
      const std::size_t rows = first.size() - 1;
      for (std::size_t r = 0; r < rows; ++r) {
        Lanes sum = {};
        const unsigned int count =
            entries > 0 ? entries : first[r + 1] - first[r];
        for (unsigned int e = 0; e < count; ++e, ++at, h += step)
          add_product<shared>(sum, h, load(x + std::size_t(*at) * width));
        store(y + r * width, sum);
      }
    }

    /** Per row and per column of H as many entries as given, or any (0). */
    template <bool shared, unsigned int in_row, unsigned int in_column>
    NSFD_INLINE void multiply_group(const BodyGroup &g, const std::size_t begin,
                                    const std::size_t end, const float *X,
                                    float *Y)
    {
      static thread_local std::vector<float> scratch;
      scratch.resize(std::size_t(2) * g.dofs * width);
      float *const t = scratch.data(), *const s =
                                           t + std::size_t(g.dofs) * width;
      const std::size_t size = std::size_t(g.rows) * width;
      const unsigned int order = g.dense ? g.rows : g.dofs;
      for (std::size_t b = begin; b < end; ++b) {
        const float *x = X + g.first + b * size;
        float *y = Y + g.first + b * size;
        const std::size_t own = shared ? 0 : b;
        const float *A = g.matrix.data() + own * order * order * width;
        if (g.dense) {
          multiply<shared>(A, g.rows, g.rows, x, y);
          continue;
        }
        multiply_sparse<shared, in_column>(
            g.column_first, g.column_row,
            g.by_column.data() + own * g.column_row.size() * width, x, t);
        if (in_row == 2 && g.dofs == 8)
          multiply<shared>(A, 8, 8, t, s);
        else
          multiply<shared>(A, g.dofs, g.dofs, t, s);
        multiply_sparse<shared, in_row>(
            g.row_first, g.row_column,
            g.by_row.data() + own * g.row_column.size() * width, s, y);
      }
    }

    /** Every row has as many entries. */
    bool is_regular(const std::vector<unsigned int> &first,
                    const unsigned int entries)
    {
      for (std::size_t r = 0; r + 1 < first.size(); ++r)
        if (first[r + 1] - first[r] != entries)
          return false;
      return true;
    }

    template <bool shared>
    NSFD_INLINE void multiply_any(const BodyGroup &g, const std::size_t begin,
                                  const std::size_t end, const float *X,
                                  float *Y)
    {
      // linear elements with as many points as nodes on a face
      if (is_regular(g.row_first, 2) && is_regular(g.column_first, 4))
        multiply_group<shared, 2, 4>(g, begin, end, X, Y);
      else if (is_regular(g.row_first, 4) && is_regular(g.column_first, 12))
        multiply_group<shared, 4, 12>(g, begin, end, X, Y);
      else
        multiply_group<shared, 0, 0>(g, begin, end, X, Y);
    }

    template <unsigned int dim>
    NSFD_INLINE void scatter_faces(const FaceGroup &g, const unsigned int count,
                                   const float *p, float *X)
    {
      const int *place = g.place.data();
      const float *frame = g.frame.data();
      p += g.first;
      for (std::size_t b = 0; b < g.n_batches; ++b)
        for (unsigned int q = 0; q < count; ++q, p += dim * width,
                          frame += dim * dim * width, place += 2 * width)
          for (unsigned int c = 0; c < dim; ++c) {
            Lanes value = {};
            for (unsigned int k = 0; k < dim; ++k)
              value +=
                  load(frame + (k * dim + c) * width) * load(p + k * width);
            float out[width];
            store(out, value);
            float *x = X + c * width;
            for (unsigned int l = 0; l < width; ++l) {
              x[place[l]] = -out[l];
              x[place[width + l]] = out[l];
            }
          }
    }

    /** U of a point of a batch, from both sides, in the scaled frame. */
    template <unsigned int dim>
    NSFD_INLINE void velocity(const int *place, const float *frame,
                              const float *Y, Lanes *u)
    {
      Lanes jump[dim];
      for (unsigned int c = 0; c < dim; ++c) {
        float one[width], two[width];
        const float *y = Y + c * width;
        for (unsigned int l = 0; l < width; ++l) {
          one[l] = y[place[l]];
          two[l] = y[place[width + l]];
        }
        jump[c] = load(two) - load(one);
      }
      for (unsigned int k = 0; k < dim; ++k) {
        u[k] = Lanes{};
        for (unsigned int c = 0; c < dim; ++c)
          u[k] += load(frame + (k * dim + c) * width) * jump[c];
      }
    }

    template <unsigned int dim>
    NSFD_INLINE void gather_faces(const FaceGroup &g, const unsigned int count,
                                  const float *Y, const float *p, float *w,
                                  ExactSum &sum)
    {
      const int *place = g.place.data();
      const float *frame = g.frame.data(), *D = g.D.data(),
                  *owned = g.owned.data();
      p += g.first;
      w += g.first;
      Half all = {};
      for (std::size_t b = 0; b < g.n_batches; ++b, owned += width) {
        Lanes terms = {};
        for (unsigned int q = 0; q < count;
             ++q, frame += dim * dim * width, place += 2 * width) {
          Lanes u[dim];
          velocity<dim>(place, frame, Y, u);
          for (unsigned int k = 0; k < dim;
               ++k, p += width, w += width, D += width) {
            const Lanes v = load(p);
            const Lanes value = u[k] + load(D) * v;
            store(w, value);
            terms += v * value;
          }
        }
        add_exactly(terms * load(owned), sum.high, all);
      }
      sum.value += total(all);
    }

    template <unsigned int dim>
    NSFD_INLINE void
    gather_coupled_faces(const FaceGroup &g, const unsigned int count,
                         const float *Y, const float *p, float *w)
    {
      const int *place = g.place.data();
      const float *frame = g.frame.data(), *J = g.jacobian.data(),
                  *ratio = g.ratio.data();
      p += g.first;
      w += g.first;
      for (std::size_t j = 0; j < g.n_batches * count; ++j,
                       frame += dim * dim * width, place += 2 * width,
                       J += dim * dim * width, ratio += dim * width,
                       p += dim * width, w += dim * width) {
        Lanes u[dim];
        velocity<dim>(place, frame, Y, u);
        for (unsigned int k = 0; k < dim; ++k)
          u[k] -= load(ratio + k * width) * load(p + k * width);
        for (unsigned int k = 0; k < dim; ++k) {
          Lanes value = load(p + k * width);
          for (unsigned int c = 0; c < dim; ++c)
            value -= load(J + (k * dim + c) * width) * u[c];
          store(w + k * width, value);
        }
      }
    }

    /** Entry (i, j) of a packed symmetric block. */
    NSFD_INLINE constexpr unsigned int entry(const unsigned int i,
                                             const unsigned int j)
    {
      return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
    }

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
  void multiply_bodies(const BodyGroup &group, const std::size_t begin,
                       const std::size_t end, const float *X, float *Y)
  {
    if (group.shared)
      multiply_any<true>(group, begin, end, X, Y);
    else
      multiply_any<false>(group, begin, end, X, Y);
  }

  // two Gauss points in two dimensions are by far the most frequent
  NSFD_CLONES
  void scatter(const FaceGroup &group, const float *p, float *X)
  {
    if (group.dim == 2 && group.count == 2)
      scatter_faces<2>(group, 2, p, X);
    else if (group.dim == 2)
      scatter_faces<2>(group, group.count, p, X);
    else
      scatter_faces<3>(group, group.count, p, X);
  }

  NSFD_CLONES
  void gather(const FaceGroup &group, const float *Y, const float *p, float *w,
              ExactSum &sum)
  {
    if (group.dim == 2 && group.count == 2)
      gather_faces<2>(group, 2, Y, p, w, sum);
    else if (group.dim == 2)
      gather_faces<2>(group, group.count, Y, p, w, sum);
    else
      gather_faces<3>(group, group.count, Y, p, w, sum);
  }

  NSFD_CLONES
  void gather_coupled(const FaceGroup &group, const float *Y, const float *p,
                      float *w)
  {
    if (group.dim == 2)
      gather_coupled_faces<2>(group, group.count, Y, p, w);
    else
      gather_coupled_faces<3>(group, group.count, Y, p, w);
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
} // namespace nsfd::lane
