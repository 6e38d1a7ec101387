#include "body_frequency.h"

#include "cells.h"

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <set>

namespace nsfd
{
  std::array<double, 2> largest_eigenpair(const Block &A)
  {
    const unsigned int n = A.rows;
    dealii::LAPACKFullMatrix<double> matrix(n);
    double bound = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      double row = 0.;
      for (unsigned int j = 0; j < n; ++j) {
        matrix(i, j) = (A(i, j) + A(j, i)) / 2.;
        row += std::abs(matrix(i, j));
      }
      bound = std::max(bound, row);
    }
    dealii::Vector<double> values;
    dealii::FullMatrix<double> vectors;
    matrix.compute_eigenvalues_symmetric(-bound, 1.1 * bound, 0., values,
                                         vectors);
    unsigned int at = 0;
    for (unsigned int k = 1; k < values.size(); ++k)
      if (values[k] > values[at])
        at = k;
    return {{values[at], vectors(n - 1, at)}};
  }

  double largest_eigenvalue(const Block &A)
  {
    dealii::LAPACKFullMatrix<double> matrix(A.rows);
    for (unsigned int i = 0; i < A.rows; ++i)
      for (unsigned int j = 0; j < A.rows; ++j)
        matrix(i, j) = (A(i, j) + A(j, i)) / 2.;
    matrix.compute_eigenvalues();
    double largest = 0.;
    for (unsigned int k = 0; k < A.rows; ++k)
      largest = std::max(largest, matrix.eigenvalue(k).real());
    return largest;
  }

  namespace
  {
    /** Of M^{-1} K. */
    double largest_eigenvalue(const Block &M, const Block &K)
    {
      const Block L = cholesky(M);
      return nsfd::largest_eigenvalue(
          forward_solve(L, forward_solve(L, K).transposed()));
    }
  } // namespace

  double highest_frequency(const BodyClass &body)
  {
    if (body.undeformed)
      return 0.;
    if (body.damping.rows > 0)
      return std::sqrt(largest_eigenvalue(body.mass, body.stiffness));
    // of L^{-1} K L^{-T}, M = L L^T
    const Block L = cholesky(body.mass);
    const Block A =
        forward_solve(L, forward_solve(L, body.stiffness).transposed());
    return std::sqrt(std::max(0., largest_eigenpair(A)[0]));
  }

  namespace
  {
    /** Components a, b of strain number @p k: xx, yy(, zz), xy(, xz, yz). */
    template <int dim>
    std::array<unsigned int, 2> pair_of(const unsigned int k)
    {
      constexpr std::array<std::array<unsigned int, 2>, 3> shear = {
          {{{0, 1}}, {{0, 2}}, {{1, 2}}}};
      return k < dim ? std::array<unsigned int, 2>{{k, k}} : shear[k - dim];
    }

    /** Hooke's matrix for sqrt(2) e_ab off the diagonal, so that sigma : e is
        a product. */
    template <int dim>
    Block hooke_matrix(const LinearElasticity<dim> &law)
    {
      constexpr unsigned int n = dim * (dim + 1) / 2;
      Block C(n, n);
      for (unsigned int k = 0; k < n; ++k)
        for (unsigned int l = 0; l < n; ++l) {
          if (law.is_isotropic()) {
            C(k, l) = (k == l ? 2. * law.mu : 0.) +
                      (k < dim && l < dim ? law.lambda : 0.);
            continue;
          }
          const auto [a, b] = pair_of<dim>(k);
          const auto [c, d] = pair_of<dim>(l);
          C(k, l) = (k < dim ? 1. : std::sqrt(2.)) *
                    (l < dim ? 1. : std::sqrt(2.)) * law.modulus(a, b, c, d);
        }
      return C;
    }

    /** At least the largest eigenvalue of that matrix; isotropic: it. */
    template <int dim>
    double largest_modulus(const LinearElasticity<dim> &law)
    {
      if (law.is_isotropic())
        return std::max(2. * law.mu, dim * law.lambda + 2. * law.mu);
      const Block C = hooke_matrix(law);
      double largest = 0.;
      for (unsigned int k = 0; k < C.rows; ++k) {
        double sum = 0.;
        for (unsigned int l = 0; l < C.cols; ++l)
          sum += std::abs(C(k, l));
        largest = std::max(largest, sum);
      }
      return largest;
    }
  } // namespace

  /** Of L^T (V/m) B B^T L, C = L L^T: strains instead of displacements. */
  template <int dim>
  double highest_frequency(const BodyShape<dim> &shape)
  {
    constexpr unsigned int n = dim * (dim + 1) / 2;
    const Block C = hooke_matrix(shape.elasticity[0]);
    Block S(n, n);
    for (unsigned int k = 0; k < n; ++k)
      for (unsigned int l = 0; l < n; ++l) {
        const auto [a, b] = pair_of<dim>(k);
        const auto [c, d] = pair_of<dim>(l);
        const double scale =
            (k < dim ? 1. : std::sqrt(0.5)) * (l < dim ? 1. : std::sqrt(0.5));
        double sum = 0.;
        for (unsigned int i = 0; i <= dim; ++i) {
          const auto &g = shape.gradients[i];
          const auto row = [&](const unsigned int p, const unsigned int q,
                               const unsigned int e) {
            return (p == e ? g[q] : 0.) + (q == e && p != q ? g[p] : 0.);
          };
          for (unsigned int e = 0; e < dim; ++e)
            sum += row(a, b, e) * row(c, d, e);
        }
        S(k, l) = scale * sum;
      }
    const Block L = cholesky(C);
    const Block A = product(L.transposed(), product(S, L));
    return std::sqrt(largest_eigenpair(A)[0] * shape.volume /
                     lumped_mass(shape, 0));
  }

  template <int dim>
  double frequency_bound(const BodyShape<dim> &shape)
  {
    dealii::SymmetricTensor<2, dim> gram;
    for (unsigned int i = 0; i <= dim; ++i)
      gram += dealii::symmetrize(
          dealii::outer_product(shape.gradients[i], shape.gradients[i]));
    return std::sqrt(dealii::eigenvalues(gram)[0] *
                     largest_modulus(shape.elasticity[0]) * shape.volume /
                     lumped_mass(shape, 0));
  }

  template <int dim>
  std::vector<double> frequencies_of_bodies(const Cells<dim> &cells)
  {
    std::vector<double> result(cells.bodies.size());
    if (cells.differ()) {
      for (std::size_t b = 0; b < result.size(); ++b)
        result[b] = frequency_bound(*cells.shape(b));
      return result;
    }
    for (const BodyClass &body : cells.bodies.classes) {
      const double frequency = highest_frequency(body);
      for (const unsigned int b : body.bodies)
        result[b] = frequency;
    }
    return result;
  }

  namespace
  {
    /** Bodies without blocks: exact ones of those alone whose bounds matter. */
    template <int dim>
    double highest_of_different(const Cells<dim> &cells)
    {
      const auto bounds = frequencies_of_bodies(cells);
      std::vector<unsigned int> order(bounds.size());
      std::iota(order.begin(), order.end(), 0u);
      std::sort(order.begin(), order.end(),
                [&](const unsigned int a, const unsigned int b) {
                  return bounds[a] > bounds[b];
                });
      double highest = 0.;
      // congruent cells: gradients, moduli, axes of the crystal
      std::set<std::vector<double>> known;
      for (const unsigned int b : order) {
        if (bounds[b] <= highest)
          break;
        const auto shape = cells.shape(b);
        std::vector<double> key = {shape->elasticity[0].lambda,
                                   shape->elasticity[0].mu,
                                   shape->moduli[0].density};
        key.insert(key.end(), shape->moduli[0].orientation.begin(),
                   shape->moduli[0].orientation.end());
        for (unsigned int i = 0; i <= dim; ++i)
          for (unsigned int d = 0; d < dim; ++d)
            key.push_back(shape->gradients[i][d]);
        if (known.insert(std::move(key)).second)
          highest = std::max(highest, highest_frequency(*shape));
      }
      return highest;
    }
  } // namespace

  template <int dim>
  double highest_frequency(const Cells<dim> &cells)
  {
    if (cells.differ())
      return highest_of_different(cells);
    double highest = 0.;
    for (const BodyClass &body : cells.bodies.classes)
      highest = std::max(highest, highest_frequency(body));
    return highest;
  }

  double longest_step(const double omega, const double b)
  {
    return omega > 0. ? 2. / omega * (std::sqrt(1. + b * b) - b)
                      : std::numeric_limits<double>::infinity();
  }

  template <int dim>
  std::vector<double> longest_steps(const Cells<dim> &cells, const double b)
  {
    std::vector<double> result(cells.bodies.size());
    if (cells.differ()) {
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = longest_step(highest_frequency(*cells.shape(i)), b);
      return result;
    }
    for (const BodyClass &body : cells.bodies.classes) {
      const double omega = highest_frequency(body);
      double share = b;
      if (body.damping.rows > 0)
        share += largest_eigenvalue(body.mass, body.damping) / (2. * omega);
      for (const unsigned int i : body.bodies)
        result[i] = longest_step(omega, share);
    }
    return result;
  }

  template <int dim>
  std::vector<double> shortest_steps(const Cells<dim> &cells, const double b,
                                     const std::size_t n, const double factor)
  {
    if (!cells.differ())
      return longest_steps(cells, b);
    auto result = frequencies_of_bodies(cells);
    for (double &x : result)
      x = longest_step(x, b);
    std::vector<unsigned int> order(result.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](const unsigned int one, const unsigned int two) {
                return result[one] < result[two];
              });
    std::priority_queue<double> shortest; // the n first ones of those known
    double least = std::numeric_limits<double>::infinity();
    for (const unsigned int i : order) {
      if (shortest.size() == n && result[i] > shortest.top() &&
          result[i] > factor * least)
        break; // bounds only grow from here
      result[i] = longest_step(highest_frequency(*cells.shape(i)), b);
      least = std::min(least, result[i]);
      shortest.push(result[i]);
      if (shortest.size() > n)
        shortest.pop();
    }
    return result;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template double highest_frequency(const BodyShape<dim> &);                   \
  template double frequency_bound(const BodyShape<dim> &);                     \
  template std::vector<double> frequencies_of_bodies(const Cells<dim> &);      \
  template double highest_frequency(const Cells<dim> &);                       \
  template std::vector<double> longest_steps(const Cells<dim> &, double);      \
  template std::vector<double> shortest_steps(const Cells<dim> &, double,      \
                                              std::size_t, double)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
