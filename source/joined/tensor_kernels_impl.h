#pragma once

// Only for tensor_plane.cc and tensor_space.cc. No deal.II here: plain arrays,
// several instruction sets.
#include "tensor_points.h"

namespace nsfd
{
  namespace
  {
    /** @p act on the first place of every line in direction @p d. */
    template <int d, int dim, int N, typename Act>
    NSFD_INLINE void for_lines(const Grid<dim, N> &grid, const Act &act)
    {
      const unsigned int stride = grid.stride(d), size = grid.size();
      for (unsigned int outer = 0; outer < size; outer += stride * grid.n)
        for (unsigned int inner = 0; inner < stride; ++inner)
          act(outer + inner);
    }

    /** y = A x */
    template <int dim, int N>
    NSFD_INLINE void multiply(const Grid<dim, N> &grid, const double *A,
                              const Vector8 *x, Vector8 *y)
    {
      const unsigned int n = grid.n;
      for_nodes(grid, [&](const unsigned int i) NSFD_INLINED {
        Vector8 sum = A[i * n] * x[0];
        for_nodes(grid, [&](const unsigned int j) NSFD_INLINED {
          if (j > 0)
            sum += A[i * n + j] * x[j];
        });
        y[i] = sum;
      });
    }

    template <int dim, int N>
    NSFD_INLINE void load(const Grid<dim, N> &grid, const Vector8 *from,
                          const unsigned int stride, Vector8 *x)
    {
      for_nodes(grid, [&](const unsigned int i) NSFD_INLINED {
        x[i] = from[std::size_t(i) * stride];
      });
    }

    template <int dim, int N>
    NSFD_INLINE void store(const Grid<dim, N> &grid, const Vector8 *x,
                           const unsigned int stride, Vector8 *to)
    {
      for_nodes(grid, [&](const unsigned int i)
                          NSFD_INLINED { to[std::size_t(i) * stride] = x[i]; });
    }

    /** A times every line of @p from in direction @p d; may be @p to. */
    template <int d, int dim, int N>
    NSFD_INLINE void multiply_along(const Grid<dim, N> &grid, const double *A,
                                    const Vector8 *from, Vector8 *to)
    {
      const unsigned int stride = d == 0 ? 1 : grid.stride(d);
      Vector8 x[Grid<dim, N>::most], y[Grid<dim, N>::most];
      for_lines<d>(grid, [&](const unsigned int k) NSFD_INLINED {
        load(grid, from + k, stride, x);
        multiply(grid, A, x, y);
        store(grid, y, stride, to + k);
      });
    }

    /** The values of the corners: (component, node). */
    template <int dim, int N>
    NSFD_INLINE void gather(const Grid<dim, N> &grid, const TensorBlock &block,
                            const double *q, Vector8 *u)
    {
      const unsigned int size = grid.size();
      auto *scalars = reinterpret_cast<double *>(u);
      const unsigned int *groups[lanes];
      for (unsigned int l = 0; l < lanes; ++l) // beyond the last cell: that one
        groups[l] = block.groups +
                    std::size_t(l < block.count ? l : block.count - 1) * size;
      for (unsigned int i = 0; i < size; ++i)
#pragma GCC unroll 8
        for (unsigned int l = 0; l < lanes; ++l) {
          const double *value = q + std::size_t(groups[l][i]) * dim;
#pragma GCC unroll 3
          for (unsigned int c = 0; c < dim; ++c)
            scalars[(c * size + i) * lanes + l] = value[c];
        }
    }

    template <int dim, int N, bool affine>
    NSFD_INLINE void evaluate(const TensorLine &line, const TensorBlock &block,
                              const double *q, double *scratch,
                              double *dilatation, double *reference,
                              double *bound)
    {
      const Grid<dim, N> grid(line);
      const unsigned int size = grid.size();
      auto *u = reinterpret_cast<Vector8 *>(scratch);
      Vector8 *gradients = u + dim * size;
      gather(grid, block, q, u);
      const double *values = line.values.data(), *slopes = line.slopes.data();
      Vector8 x[Grid<dim, N>::most], y[Grid<dim, N>::most];
      for (unsigned int c = 0; c < dim; ++c) {
        Vector8 *mine = u + c * size, *G = gradients + c * dim * size;
        multiply_along<0>(grid, values, mine, mine);
        if constexpr (dim == 3)
          multiply_along<1>(grid, values, mine, mine);
        const unsigned int last = grid.stride(dim - 1);
        for_lines<dim - 1>(grid, [&](const unsigned int k) NSFD_INLINED {
          load(grid, mine + k, last, x);
          multiply(grid, values, x, y);
          store(grid, y, last, mine + k);
          multiply(grid, slopes, y, x);
          store(grid, x, last, G + (dim - 1) * size + k);
        });
        multiply_along<0>(grid, slopes, mine, G);
        if constexpr (dim == 3)
          multiply_along<1>(grid, slopes, mine, G + size);
      }
      set_fluxes<dim, N, affine>(grid, line, block, gradients,
                                 gradients + dim * dim * size, dilatation,
                                 reference, bound);
    }

    template <int dim, int N, bool affine>
    NSFD_INLINE void integrate(const TensorLine &line, const TensorBlock &block,
                               const double *tension, double *scratch,
                               double *corner_forces, double *forces)
    {
      const Grid<dim, N> grid(line);
      const unsigned int size = grid.size();
      auto *u = reinterpret_cast<Vector8 *>(scratch);
      const Vector8 *fluxes = u + dim * size,
                    *weighted = fluxes + dim * dim * size;
      const double *values = line.values_transposed.data(),
                   *slopes = line.slopes_transposed.data(),
                   *weights = line.weights.data();
      Vector8 pull;
      for (unsigned int l = 0; l < lanes; ++l)
        pull[l] = tension[l];
      Vector8 x[Grid<dim, N>::most], y[Grid<dim, N>::most];
      for (unsigned int a = 0; a < dim; ++a) {
        Vector8 *mine = u + a * size;
        // fluxes and those of the tension, along a line in direction d
        const auto load_flux = [&](const unsigned int d,
                                   const unsigned int k) NSFD_INLINED {
          const unsigned int stride = grid.stride(d);
          const Vector8 *flux = fluxes + (a * dim + d) * size + k;
          load(grid, flux, stride, x);
          if constexpr (affine) {
            double across = 1.;
#pragma GCC unroll 3
            for (unsigned int e = 0; e < dim; ++e)
              if (e != d)
                across *= weights[grid.place(k, e)];
            const Vector8 share = pull * weighted[d * dim + a] * across;
            for_nodes(grid, [&](const unsigned int i)
                                NSFD_INLINED { x[i] += share * weights[i]; });
          } else {
            const Vector8 *shares = weighted + (d * dim + a) * size + k;
            for_nodes(grid, [&](const unsigned int i) NSFD_INLINED {
              x[i] += pull * shares[std::size_t(i) * stride];
            });
          }
        };
        for_lines<0>(grid, [&](const unsigned int k) NSFD_INLINED {
          load_flux(0, k);
          multiply(grid, slopes, x, y);
          store(grid, y, 1, mine + k);
        });
        if constexpr (dim == 3) {
          const unsigned int stride = grid.stride(1);
          for_lines<1>(grid, [&](const unsigned int k) NSFD_INLINED {
            load_flux(1, k);
            multiply(grid, slopes, x, y);
            for_nodes(grid, [&](const unsigned int i) NSFD_INLINED {
              mine[k + std::size_t(i) * stride] += y[i];
            });
          });
        }
        const unsigned int last = grid.stride(dim - 1);
        for_lines<dim - 1>(grid, [&](const unsigned int k) NSFD_INLINED {
          load_flux(dim - 1, k);
          multiply(grid, slopes, x, y);
          for_nodes(grid, [&](const unsigned int i) NSFD_INLINED {
            y[i] += mine[k + std::size_t(i) * last];
          });
          multiply(grid, values, y, x);
          store(grid, x, last, mine + k);
        });
        if constexpr (dim == 3)
          multiply_along<1>(grid, values, mine, mine);
        multiply_along<0>(grid, values, mine, mine);
      }
      const auto *scalars = reinterpret_cast<const double *>(u);
      for (unsigned int l = 0; l < block.count; ++l) {
        const unsigned int *groups = block.groups + std::size_t(l) * size;
        double *mine = corner_forces + std::size_t(l) * size * dim;
        for (unsigned int i = 0; i < size; ++i) {
          double *force = forces + std::size_t(groups[i]) * dim;
#pragma GCC unroll 3
          for (unsigned int c = 0; c < dim; ++c) {
            const double value = scalars[(c * size + i) * lanes + l];
            mine[i * dim + c] = value;
            force[c] -= value;
          }
        }
      }
    }

    template <int dim, int N>
    NSFD_INLINE void set_tractions(const TensorLine &line,
                                   const TensorBlock &block, const double *q,
                                   double *scratch, double *tractions)
    {
      const Grid<dim, N> grid(line);
      const unsigned int size = grid.size(), n = grid.n;
      auto *u = reinterpret_cast<Vector8 *>(scratch);
      const std::size_t per_cell = std::size_t(2) * dim * dim * (size / n);
      gather(grid, block, q, u);
      const auto *map = reinterpret_cast<const Vector8 *>(block.map);
      const auto *moduli = reinterpret_cast<const Vector8 *>(block.moduli);
      const double *slopes = line.node_slopes.data();
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int side = 0; side < 2; ++side)
          for (unsigned int k = 0; k < size / n; ++k, tractions += dim) {
            unsigned int at[3] = {};
            const unsigned int d1 = d == 0 ? 1 : 0, d2 = d == 2 ? 1 : 2;
            at[d] = side ? n - 1 : 0;
            at[d1] = k % n;
            if (dim == 3)
              at[d2] = k / n;
            const double xi[3] = {line.nodes[at[0]], line.nodes[at[1]],
                                  line.nodes[at[2]]};
            Vector8 J[dim][dim], C[dim][dim], K[dim][dim], G[dim][dim];
            set_jacobian<dim, false>(map, xi, J);
            const Vector8 inverse = 1. / cofactors<dim>(J, C);
            unsigned int node = 0;
            for (unsigned int e = 0; e < dim; ++e)
              node += at[e] * grid.stride(e);
            for (unsigned int e = 0; e < dim; ++e) {
              const unsigned int stride = grid.stride(e);
              const unsigned int first = node - at[e] * stride;
              for (unsigned int a = 0; a < dim; ++a) {
                Vector8 sum = {};
                for (unsigned int j = 0; j < n; ++j)
                  sum +=
                      slopes[at[e] * n + j] * u[a * size + first + j * stride];
                G[a][e] = sum;
                K[e][a] = C[e][a] * inverse;
              }
            }
            Vector8 H[dim * dim], sigma[dim * (dim + 1) / 2];
            set_gradient<dim>(K, G, H);
            set_stress<dim>(H, moduli[0], moduli[1], sigma);
            Vector8 normal[dim], length = {};
            for (unsigned int c = 0; c < dim; ++c) {
              normal[c] = side ? K[d][c] : -K[d][c];
              length += normal[c] * normal[c];
            }
            for (unsigned int l = 0; l < lanes; ++l)
              length[l] = std::sqrt(length[l]);
            for (unsigned int a = 0; a < dim; ++a) {
              Vector8 sum = {};
              for (unsigned int b = 0; b < dim; ++b)
                sum += sigma[stress_at(dim, a < b ? a : b, a < b ? b : a)] *
                       normal[b];
              sum /= length;
              for (unsigned int l = 0; l < lanes; ++l)
                tractions[l * per_cell + a] = sum[l];
            }
          }
    }
  } // namespace
} // namespace nsfd

/**
 * The kernels of @p N nodes per direction; 0: of any number up to 9, which is
 * what processors without AVX2 take for all, as half of the code and of the
 * time to compile it would otherwise be for them.
 */
#define NSFD_TENSOR_KERNELS(attribute, dim, N, name)                           \
  attribute void evaluate_##name(                                              \
      const TensorLine &line, const TensorBlock &block, const double *q,       \
      double *scratch, double *dilatation, double *reference, double *bound)   \
  {                                                                            \
    if (block.affine)                                                          \
      evaluate<dim, N, true>(line, block, q, scratch, dilatation, reference,   \
                             bound);                                           \
    else                                                                       \
      evaluate<dim, N, false>(line, block, q, scratch, dilatation, reference,  \
                              bound);                                          \
  }                                                                            \
  attribute void integrate_##name(                                             \
      const TensorLine &line, const TensorBlock &block, const double *tension, \
      double *scratch, double *corner_forces, double *forces)                  \
  {                                                                            \
    if (block.affine)                                                          \
      integrate<dim, N, true>(line, block, tension, scratch, corner_forces,    \
                              forces);                                         \
    else                                                                       \
      integrate<dim, N, false>(line, block, tension, scratch, corner_forces,   \
                               forces);                                        \
  }                                                                            \
  attribute void set_tractions_##name(                                         \
      const TensorLine &line, const TensorBlock &block, const double *q,       \
      double *scratch, double *tractions)                                      \
  {                                                                            \
    set_tractions<dim, N>(line, block, q, scratch, tractions);                 \
  }

#define NSFD_TENSOR_LEVELS(dim, N)                                             \
  NSFD_TENSOR_KERNELS(NSFD_LEVEL_4, dim, N, v4_##N)                            \
  NSFD_TENSOR_KERNELS(NSFD_LEVEL_3, dim, N, v3_##N)

#define NSFD_TENSOR_CASE(level, N)                                             \
  case N:                                                                      \
    return                                                                     \
    {                                                                          \
      evaluate_##level##_##N, integrate_##level##_##N,                         \
          set_tractions_##level##_##N                                          \
    }

#define NSFD_TENSOR_CASES(level)                                               \
  switch (degree + 1) {                                                        \
    NSFD_TENSOR_CASE(level, 2);                                                \
    NSFD_TENSOR_CASE(level, 3);                                                \
    NSFD_TENSOR_CASE(level, 4);                                                \
    NSFD_TENSOR_CASE(level, 5);                                                \
    NSFD_TENSOR_CASE(level, 6);                                                \
    NSFD_TENSOR_CASE(level, 7);                                                \
  default:                                                                     \
    break;                                                                     \
  }

/** All of a dimension, and the function that chooses. */
#define NSFD_TENSOR_DIMENSION(dim)                                             \
  namespace                                                                    \
  {                                                                            \
    NSFD_TENSOR_KERNELS(NSFD_CLONES, dim, 0, any)                              \
    NSFD_TENSOR_LEVELS(dim, 2)                                                 \
    NSFD_TENSOR_LEVELS(dim, 3)                                                 \
    NSFD_TENSOR_LEVELS(dim, 4)                                                 \
    NSFD_TENSOR_LEVELS(dim, 5)                                                 \
    NSFD_TENSOR_LEVELS(dim, 6)                                                 \
    NSFD_TENSOR_LEVELS(dim, 7)                                                 \
  }                                                                            \
                                                                               \
  template <>                                                                  \
  TensorKernels tensor_kernels<dim>(const unsigned int degree)                 \
  {                                                                            \
    if (NSFD_HAS_LEVEL_4)                                                      \
      NSFD_TENSOR_CASES(v4)                                                    \
    else if (NSFD_HAS_LEVEL_3)                                                 \
      NSFD_TENSOR_CASES(v3)                                                    \
    return {evaluate_any, integrate_any, set_tractions_any};                   \
  }
