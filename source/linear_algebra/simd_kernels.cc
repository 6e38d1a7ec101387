// No deal.II here: plain arrays, several instruction sets.
#include "simd_kernels.h"
#include "simd_lanes.h"

namespace nsfd::simd
{
  namespace
  {
    /** Values of one class, or of every lane. */
    template <bool shared>
    NSFD_INLINE void add_product(Lanes &sum, const float *a, const Lanes &x)
    {
      if constexpr (shared)
        sum += *a * x;
      else
        sum += load(a) * x;
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

  } // namespace

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
} // namespace nsfd::simd
