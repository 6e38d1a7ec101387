#include "stable_step.h"

#include "discretization/body_frequency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    double step_of(const double largest) // omega^2
    {
      return largest > 0. ? 2. / std::sqrt(largest)
                          : std::numeric_limits<double>::infinity();
    }
  } // namespace

  double stable_step(const Bodies &bodies)
  {
    double largest = 0.;
    for (const BodyClass &body : bodies.classes)
      largest = std::max(largest, highest_frequency(body));
    return step_of(largest * largest);
  }

  /** Orthonormal with respect to M. */
  template <int dim>
  double stable_step(const DelassusOperator<dim> &delassus, const double enough)
  {
    using Operator = typename DelassusOperator<dim>::Operator;
    const auto &communicator = delassus.communicator();
    const std::size_t n = delassus.bodies().n_dofs();
    std::vector<double> v(n), before(n, 0.), w(n), Kv(n), Mw(n);
    for (std::size_t i = 0; i < n; ++i)
      w[i] = std::sin(1. + 12.9898 * double(i % 4096)); // in all modes
    std::vector<double> alpha, beta;
    const auto norm = [&] {
      delassus.apply(Operator::mass, w.data(), Mw.data());
      return std::sqrt(std::max(0., communicator.dot(w.data(), Mw.data(), n)));
    };
    double length = norm(), bound = 0.;
    for (unsigned int k = 0; k < 300 && length > 0.; ++k) {
      v.swap(before);
      for (std::size_t i = 0; i < n; ++i)
        v[i] = w[i] / length;
      delassus.apply(Operator::stiffness, v.data(), Kv.data());
      alpha.push_back(communicator.dot(v.data(), Kv.data(), n));
      delassus.apply(Operator::inverse, Kv.data(), w.data());
      const double last = k > 0 ? length : 0.;
      for (std::size_t i = 0; i < n; ++i)
        w[i] -= alpha.back() * v[i] + last * before[i];
      length = norm();
      beta.push_back(length);
      if (k % 10 != 9 && length > 0.)
        continue;
      Block T(k + 1, k + 1);
      for (unsigned int j = 0; j <= k; ++j) {
        T(j, j) = alpha[j];
        if (j < k)
          T(j, j + 1) = T(j + 1, j) = beta[j];
      }
      const auto [value, component] = largest_eigenpair(T);
      bound = value + length * std::abs(component);
      if (bound < 1.001 * value || step_of(bound) >= enough)
        break;
    }
    return step_of(bound);
  }

  template double stable_step(const DelassusOperator<2> &, double);
  template double stable_step(const DelassusOperator<3> &, double);
} // namespace nsfd
