#pragma once

#include "bodies/finite_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

// Energies of finite strain and cells that store them.

namespace finite_strain
{
  using namespace nsfd;

  constexpr double young = 3., poisson = 0.3;

  template <int dim>
  constexpr unsigned int n_entries = dim *(dim + 1) / 2;

  template <int dim>
  struct Law {
    const char *name;
    std::shared_ptr<const Hyperelastic<dim>> material;
    double lambda, mu;
  };

  template <int dim>
  std::vector<Law<dim>> laws()
  {
    const double mu = young / (2. * (1. + poisson)),
                 lambda =
                     young * poisson / ((1. + poisson) * (1. - 2. * poisson));
    std::vector<Law<dim>> all = {
        {"Saint-Venant Kirchhoff",
         make_saint_venant_kirchhoff<dim>(young, poisson, false), lambda, mu},
        {"neo-Hooke", make_neo_hooke<dim>(young, poisson), lambda, mu}};
    if (dim == 2)
      all.push_back({"Saint-Venant Kirchhoff in plane stress",
                     make_saint_venant_kirchhoff<dim>(young, poisson, true),
                     2. * lambda * mu / (lambda + 2. * mu), mu});
    return all;
  }

  template <int dim>
  Voigt<dim> identity()
  {
    Voigt<dim> I{};
    std::fill_n(I.begin(), dim, 1.);
    return I;
  }

  template <int dim>
  Voigt<dim> sum(const double a, const Voigt<dim> &A, const double b,
                 const Voigt<dim> &B)
  {
    Voigt<dim> C;
    for (unsigned int i = 0; i < n_entries<dim>; ++i)
      C[i] = a * A[i] + b * B[i];
    return C;
  }

  template <int dim>
  double size(const Voigt<dim> &A)
  {
    return std::sqrt(contract<dim>(A, A));
  }

  struct Random {
    std::mt19937 generator{11};

    double number(const double size)
    {
      return std::uniform_real_distribution<double>(-size, size)(generator);
    }
    std::vector<double> numbers(const unsigned int n, const double size)
    {
      std::vector<double> x(n);
      for (double &c : x)
        c = number(size);
      return x;
    }
    template <int dim>
    Voigt<dim> symmetric(const double size)
    {
      Voigt<dim> A;
      for (double &a : A)
        a = number(size);
      return A;
    }
    /** A right Cauchy-Green tensor some way from 1. */
    template <int dim>
    Voigt<dim> stretch(const double size)
    {
      return sum<dim>(1., identity<dim>(), 1., symmetric<dim>(size));
    }
  };

  /** @p check once per dimension and material. */
  template <int dim, typename Check>
  void for_each_law(Check check)
  {
    for (const Law<dim> &law : laws<dim>()) {
      SCOPED_TRACE(law.name);
      SCOPED_TRACE(dim);
      check(law);
    }
  }

  template <int dim>
  struct Cell {
    std::vector<double> nodes; ///< positions before deformation
    std::vector<double> mass;  ///< of the density 1, consistent
    std::vector<double> JxW, gradients;
    std::unique_ptr<FiniteCell<dim>> finite;
    unsigned int n = 0; ///< unknowns

    Cell(std::shared_ptr<const Hyperelastic<dim>> material,
         const unsigned int degree, const double edge = 1.);

    std::vector<double> positions(const std::vector<double> &u) const
    {
      std::vector<double> x(nodes);
      for (unsigned int i = 0; i < n; ++i)
        x[i] += u[i];
      return x;
    }
  };

  /** Value and slope of the polynomial of node @p i. */
  inline std::pair<double, double>
  shape(const unsigned int i, const unsigned int degree, const double x)
  {
    double value = 1., slope = 0.;
    for (unsigned int k = 0; k <= degree; ++k)
      if (k != i) {
        const double over = double(degree) / (double(i) - double(k));
        const double factor = (x - double(k) / degree) * over;
        slope = slope * factor + value * over;
        value *= factor;
      }
    return {value, slope};
  }

  template <int dim>
  Cell<dim>::Cell(std::shared_ptr<const Hyperelastic<dim>> material,
                  const unsigned int degree, const double edge)
  {
    // Gauss' rule of three points, enough for the mass of degree 2
    const double g = std::sqrt(0.6) / 2.;
    const double x[] = {0.5 - g, 0.5, 0.5 + g};
    const double w[] = {5. / 18., 8. / 18., 5. / 18.};
    const unsigned int m = degree + 1;
    const unsigned int n_nodes = dim == 2 ? m * m : m * m * m;
    const unsigned int n_points = dim == 2 ? 9 : 27;
    n = n_nodes * dim;
    mass.assign(n * n, 0.);
    for (unsigned int i = 0; i < n_nodes; ++i)
      for (unsigned int c = 0, rest = i; c < dim; ++c, rest /= m)
        nodes.push_back(edge * (rest % m) / degree);
    for (unsigned int q = 0; q < n_points; ++q) {
      double weight = 1.;
      for (unsigned int c = 0, rest = q; c < dim; ++c, rest /= 3)
        weight *= edge * w[rest % 3];
      JxW.push_back(weight);
      std::vector<double> values;
      for (unsigned int i = 0; i < n_nodes; ++i) {
        double value = 1., gradient[dim];
        std::fill_n(gradient, dim, 1. / edge);
        for (unsigned int c = 0, a = i, b = q; c < dim; ++c, a /= m, b /= 3) {
          const auto s = shape(a % m, degree, x[b % 3]);
          value *= s.first;
          for (unsigned int d = 0; d < dim; ++d)
            gradient[d] *= c == d ? s.second : s.first;
        }
        values.push_back(value);
        gradients.insert(gradients.end(), gradient, gradient + dim);
      }
      for (unsigned int i = 0; i < n_nodes; ++i)
        for (unsigned int j = 0; j < n_nodes; ++j)
          for (unsigned int c = 0; c < dim; ++c)
            mass[(j * dim + c) * n + i * dim + c] +=
                weight * values[i] * values[j];
    }
    finite = std::make_unique<FiniteCell<dim>>(material, JxW, gradients);
  }

  /** Turned by @p angle, in space about (1, 1, 1), stretched by @p stretch
   *  along x before, and displaced by @p away. */
  template <int dim>
  std::vector<double> turned(const Cell<dim> &cell, const double angle,
                             const double stretch = 1., const double away = 0.)
  {
    const double c = std::cos(angle), s = std::sin(angle),
                 third = (1. - c) / 3., r = s / std::sqrt(3.);
    double R[3][3] = {{c, -s, 0.}, {s, c, 0.}, {0., 0., 1.}};
    if (dim == 3)
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int b = 0; b < 3; ++b)
          R[a][b] = third + (a == b ? c : (b + 1) % 3 == a ? r : -r);
    std::vector<double> u(cell.n);
    for (unsigned int i = 0; i < cell.n; i += dim)
      for (unsigned int a = 0; a < dim; ++a) {
        double x = away;
        for (unsigned int b = 0; b < dim; ++b)
          x += R[a][b] * cell.nodes[i + b] * (b == 0 ? stretch : 1.);
        u[i + a] = x - cell.nodes[i + a];
      }
    return u;
  }

  inline double scalar(const std::vector<double> &a,
                       const std::vector<double> &b)
  {
    double total = 0.;
    for (std::size_t i = 0; i < a.size(); ++i)
      total += a[i] * b[i];
    return total;
  }

  inline std::vector<double> applied(const std::vector<double> &M,
                                     const std::vector<double> &v)
  {
    std::vector<double> Mv(v.size(), 0.);
    for (std::size_t j = 0; j < v.size(); ++j)
      for (std::size_t i = 0; i < v.size(); ++i)
        Mv[i] += M[j * v.size() + i] * v[j];
    return Mv;
  }

  template <int dim>
  std::array<double, dim> resultant(const std::vector<double> &f)
  {
    std::array<double, dim> total{};
    for (std::size_t i = 0; i < f.size(); ++i)
      total[i % dim] += f[i];
    return total;
  }

  /** sum_i x_i x f_i; of the plane the last one. */
  template <int dim>
  std::array<double, 3> moment(const std::vector<double> &x,
                               const std::vector<double> &f)
  {
    std::array<double, 3> total{};
    for (std::size_t i = 0; i < f.size(); i += dim) {
      total[2] += x[i] * f[i + 1] - x[i + 1] * f[i];
      if (dim == 3) {
        total[0] += x[i + 1] * f[i + 2] - x[i + 2] * f[i + 1];
        total[1] += x[i + 2] * f[i] - x[i] * f[i + 2];
      }
    }
    return total;
  }

  inline double norm(const std::vector<double> &x)
  {
    return std::sqrt(scalar(x, x));
  }
} // namespace finite_strain
