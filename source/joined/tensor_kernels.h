#pragma once

#include "linear_algebra/block_kernels.h"

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * Polynomials of one degree along a line [0, 1]: nodes of Gauss-Lobatto, as
   * many points of Gauss. Tables are row-major.
   */
  struct TensorLine {
    explicit TensorLine(unsigned int degree);

    unsigned int n; ///< degree + 1
    std::vector<double> nodes, points, weights;
    /// values at the points from those at the nodes, and its transpose
    std::vector<double> values, values_transposed;
    /// slopes at the points from the values there, and its transpose
    std::vector<double> slopes, slopes_transposed;
    std::vector<double> node_slopes; ///< the same of the nodes
    /// of a polynomial with values within 1 at the points: largest at a node
    double extrapolation = 0.;
  };

  /**
   * `lanes` quads or hexes. The map is x_c = sum over the subsets m of the
   * directions of a_mc times the product of xi_d, d in m; subset 0 is left out.
   */
  struct TensorBlock {
    const double *map;          ///< (subset - 1, component, lane), m
    const double *moduli;       ///< lambda, mu by lane, Pa
    bool affine;                ///< only subsets of one direction count
    const unsigned int *groups; ///< by corner, cell after cell
    unsigned int count;         ///< cells, at most `lanes`
  };

  /**
   * Forces of cells by sums over one direction after the other. Scratch is
   * aligned to 64 bytes and of tensor_scratch() numbers; integrate() needs that
   * of evaluate().
   */
  struct TensorKernels {
    /**
     * Stresses of the displacements @p q of the groups, and by lane the
     * integral of tr eps. @p reference is any gradient H_0 of the cells, which
     * becomes the mean of those at the points.
     *
     * @p bound is one of |sigma| at the nodes of a cell, Pa. The gradient in
     * the reference cell is G = sum over the points of L_q G_q, for polynomials
     * L_q, and so is J = dx/dxi; with H_q = G_q J_q^{-1}, C the elasticity and
     * B the sum of |L_q|,
     *
     *   sigma(x) = C H_0 + sum L_q(x) C (H_q - H_0) J_q J(x)^{-1}
     *   |sigma(x)| <= |C H_0| + B max |C (H_q - H_0)|
     *                 + B |C| max |H_q - H_0| max |J_q J(x)^{-1} - 1|.
     */
    void (*evaluate)(const TensorLine &line, const TensorBlock &block,
                     const double *q, double *scratch, double *dilatation,
                     double *reference, double *bound);
    /**
     * The integral of (sigma + tension 1) grad N_i: @p corner_forces by corner,
     * and taken off from the @p forces of the groups.
     */
    void (*integrate)(const TensorLine &line, const TensorBlock &block,
                      const double *tension, double *scratch,
                      double *corner_forces, double *forces);
    /**
     * On the outward normal at the nodes of all faces: (lane, face, node of
     * the face, component), Pa.
     */
    void (*set_tractions)(const TensorLine &line, const TensorBlock &block,
                          const double *q, double *scratch, double *tractions);
  };

  template <int dim>
  TensorKernels tensor_kernels(unsigned int degree);

  template <int dim>
  constexpr std::size_t tensor_scratch(const unsigned int n)
  {
    return std::size_t(dim == 2 ? n * n : n * n * n) * (dim + 2 * dim * dim) *
           lanes;
  }
} // namespace nsfd
