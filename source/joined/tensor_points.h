#pragma once

// Only for tensor_kernels_impl.h. What happens at one point of `lanes` cells.
#include "tensor_kernels.h"

#include "core/instruction_sets.h"
#include "core/vector8.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    static_assert(lanes == 8, "one vector for all cells of a block");

    /** N nodes per direction, 0: what the line says, up to 9. */
    template <int dim, int N>
    struct Grid {
      explicit Grid(const TensorLine &line) : n(N > 0 ? N : line.n) {}
      static constexpr unsigned int most = N > 0 ? N : 9;
      const unsigned int n;

      unsigned int stride(const unsigned int d) const
      {
        return d == 0 ? 1 : d == 1 ? n : n * n;
      }
      unsigned int size() const { return dim == 2 ? n * n : n * n * n; }
      unsigned int place(const unsigned int k, const unsigned int d) const
      {
        return k / stride(d) % n;
      }
    };

    /** @p act on 0 to n - 1: no loop where n is known. */
    template <int dim, int N, typename Act>
    NSFD_INLINE void for_nodes(const Grid<dim, N> &grid, const Act &act)
    {
      if constexpr (N > 0) {
#pragma GCC unroll 9
        for (unsigned int i = 0; i < N; ++i)
          act(i);
      } else
        for (unsigned int i = 0; i < grid.n; ++i)
          act(i);
    }

    /** det J and its product with the inverse: C[d][c] = det dxi_d/dx_c. */
    template <int dim>
    NSFD_INLINE Vector8 cofactors(const Vector8 (&J)[dim][dim],
                                  Vector8 (&C)[dim][dim])
    {
      if constexpr (dim == 2) {
        C[0][0] = J[1][1];
        C[0][1] = -J[0][1];
        C[1][0] = -J[1][0];
        C[1][1] = J[0][0];
      } else {
#pragma GCC unroll 3
        for (unsigned int d = 0; d < 3; ++d)
#pragma GCC unroll 3
          for (unsigned int c = 0; c < 3; ++c) {
            const unsigned int c1 = (c + 1) % 3, c2 = (c + 2) % 3,
                               d1 = (d + 1) % 3, d2 = (d + 2) % 3;
            C[d][c] = J[c1][d1] * J[c2][d2] - J[c1][d2] * J[c2][d1];
          }
      }
      Vector8 det = J[0][0] * C[0][0];
#pragma GCC unroll 3
      for (unsigned int d = 1; d < dim; ++d)
        det += J[0][d] * C[d][0];
      return det;
    }

    /** dx_c/dxi_d at a place of the reference cell. */
    template <int dim, bool affine>
    NSFD_INLINE void set_jacobian(const Vector8 *map, const double *xi,
                                  Vector8 (&J)[dim][dim])
    {
#pragma GCC unroll 3
      for (unsigned int c = 0; c < dim; ++c) {
        const auto a = [&](const unsigned int subset)
                           NSFD_INLINED { return map[(subset - 1) * dim + c]; };
#pragma GCC unroll 3
        for (unsigned int d = 0; d < dim; ++d) {
          J[c][d] = a(1u << d);
          if constexpr (!affine) {
            const unsigned int e = (d + 1) % dim;
            J[c][d] += a((1u << d) | (1u << e)) * xi[e];
            if constexpr (dim == 3) {
              const unsigned int f = (d + 2) % dim;
              J[c][d] +=
                  a((1u << d) | (1u << f)) * xi[f] + a(7) * (xi[e] * xi[f]);
            }
          }
        }
      }
    }

    /** Index of sigma_ab among xx, yy(, zz), xy(, xz, yz). */
    constexpr unsigned int stress_at(const unsigned int dim,
                                     const unsigned int a, const unsigned int b)
    {
      return a == b ? a : dim == 2 ? 2u : a + b + 2u;
    }

    /** H_ab = du_a/dx_b from dxi_d/dx_b and du_a/dxi_d. */
    template <int dim>
    NSFD_INLINE void set_gradient(const Vector8 (&K)[dim][dim],
                                  const Vector8 (&G)[dim][dim], Vector8 *H)
    {
#pragma GCC unroll 3
      for (unsigned int a = 0; a < dim; ++a)
#pragma GCC unroll 3
        for (unsigned int b = 0; b < dim; ++b) {
          Vector8 sum = G[a][0] * K[0][b];
#pragma GCC unroll 3
          for (unsigned int d = 1; d < dim; ++d)
            sum += G[a][d] * K[d][b];
          H[a * dim + b] = sum;
        }
    }

    /** sigma of H; tr eps. */
    template <int dim>
    NSFD_INLINE Vector8 set_stress(const Vector8 *H, const Vector8 lambda,
                                   const Vector8 mu, Vector8 *sigma)
    {
      Vector8 trace = H[0];
#pragma GCC unroll 3
      for (unsigned int a = 1; a < dim; ++a)
        trace += H[a * dim + a];
      const Vector8 pressure = lambda * trace;
#pragma GCC unroll 3
      for (unsigned int a = 0; a < dim; ++a)
#pragma GCC unroll 3
        for (unsigned int b = a; b < dim; ++b)
          sigma[stress_at(dim, a, b)] =
              a == b ? pressure + 2. * mu * H[a * dim + a]
                     : mu * (H[a * dim + b] + H[b * dim + a]);
      return trace;
    }

    /** Squared Frobenius norm. */
    template <int dim>
    NSFD_INLINE Vector8 square(const Vector8 *sigma)
    {
      constexpr unsigned int n = dim * (dim + 1) / 2;
      Vector8 sum = sigma[0] * sigma[0];
#pragma GCC unroll 6
      for (unsigned int s = 1; s < n; ++s)
        sum += (s < dim ? 1. : 2.) * sigma[s] * sigma[s];
      return sum;
    }

    /**
     * At every point, in place: from du_a/dxi_d the flux, sigma_ab times
     * weight C[d][b]. Behind it, where cells are not affine, weight C.
     */
    template <int dim, int N, bool affine>
    NSFD_INLINE void
    set_fluxes(const Grid<dim, N> &grid, const TensorLine &line,
               const TensorBlock &block, Vector8 *gradients, Vector8 *weighted,
               double *dilatation, double *reference, double *bound)
    {
      constexpr unsigned int n_stresses = dim * (dim + 1) / 2;
      const unsigned int size = grid.size(), n = grid.n;
      const auto *map = reinterpret_cast<const Vector8 *>(block.map);
      const auto *moduli = reinterpret_cast<const Vector8 *>(block.moduli);
      auto *around = reinterpret_cast<Vector8 *>(reference);
      const Vector8 lambda = moduli[0], mu = moduli[1];
      Vector8 stress_around[n_stresses];
      set_stress<dim>(around, lambda, mu, stress_around);
      Vector8 J[dim][dim], C[dim][dim], K[dim][dim], det;
      const auto set_map = [&](const double *xi) NSFD_INLINED {
        set_jacobian<dim, affine>(map, xi, J);
        det = cofactors<dim>(J, C);
        const Vector8 inverse = 1. / det;
#pragma GCC unroll 3
        for (unsigned int d = 0; d < dim; ++d)
#pragma GCC unroll 3
          for (unsigned int c = 0; c < dim; ++c)
            K[d][c] = C[d][c] * inverse;
      };
      double xi[3] = {};
      if (affine)
        set_map(xi);
      Vector8 mean[dim * dim] = {}, all = {}, farthest = {}, turned = {};
      unsigned int q = 0;
      for (unsigned int z = 0; z < (dim == 3 ? n : 1); ++z)
        for (unsigned int y = 0; y < n; ++y)
          for (unsigned int x = 0; x < n; ++x, ++q) {
            double weight = line.weights[x] * line.weights[y];
            if (dim == 3)
              weight *= line.weights[z];
            if constexpr (!affine) {
              xi[0] = line.points[x];
              xi[1] = line.points[y];
              xi[2] = line.points[z];
              set_map(xi);
            }
            Vector8 G[dim][dim];
#pragma GCC unroll 3
            for (unsigned int a = 0; a < dim; ++a)
#pragma GCC unroll 3
              for (unsigned int d = 0; d < dim; ++d)
                G[a][d] = gradients[(a * dim + d) * size + q];
            Vector8 H[dim * dim], sigma[n_stresses], off[n_stresses];
            set_gradient<dim>(K, G, H);
            all += weight * det * set_stress<dim>(H, lambda, mu, sigma);
#pragma GCC unroll 9
            for (unsigned int s = 0; s < dim * dim; ++s)
              mean[s] += H[s];
#pragma GCC unroll 6
            for (unsigned int s = 0; s < n_stresses; ++s)
              off[s] = sigma[s] - stress_around[s];
            const Vector8 distance = square<dim>(off);
            farthest = distance > farthest ? distance : farthest;
            if constexpr (!affine) {
              Vector8 sum = {};
#pragma GCC unroll 9
              for (unsigned int s = 0; s < dim * dim; ++s) {
                H[s] -= around[s];
                sum += H[s] * H[s];
              }
              turned = sum > turned ? sum : turned;
            }
#pragma GCC unroll 3
            for (unsigned int d = 0; d < dim; ++d) {
              Vector8 shares[dim];
#pragma GCC unroll 3
              for (unsigned int b = 0; b < dim; ++b) {
                shares[b] = weight * C[d][b];
                if constexpr (!affine)
                  weighted[(d * dim + b) * size + q] = shares[b];
              }
#pragma GCC unroll 3
              for (unsigned int a = 0; a < dim; ++a) {
                Vector8 flux = sigma[stress_at(dim, 0, a)] * shares[0];
#pragma GCC unroll 3
                for (unsigned int b = 1; b < dim; ++b)
                  flux += sigma[stress_at(dim, a < b ? a : b, a < b ? b : a)] *
                          shares[b];
                gradients[(a * dim + d) * size + q] = flux;
              }
            }
          }
      if constexpr (affine)
#pragma GCC unroll 3
        for (unsigned int d = 0; d < dim; ++d)
#pragma GCC unroll 3
          for (unsigned int b = 0; b < dim; ++b)
            weighted[d * dim + b] = C[d][b];
      const Vector8 centre = square<dim>(stress_around);
      const double grows = line.extrapolation * line.extrapolation *
                           (dim == 2 ? 1. : line.extrapolation);
      for (unsigned int l = 0; l < lanes; ++l)
        bound[l] =
            (1. + 1e-10) * (std::sqrt(centre[l]) +
                            grows * (std::sqrt(farthest[l]) +
                                     moduli[2][l] * std::sqrt(turned[l])));
      for (unsigned int s = 0; s < dim * dim; ++s)
        around[s] = mean[s] / double(size);
      for (unsigned int l = 0; l < lanes; ++l)
        dilatation[l] = all[l];
    }
  } // namespace
} // namespace nsfd
