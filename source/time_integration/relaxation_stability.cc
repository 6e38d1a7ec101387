#include "relaxation.h"

#include "delassus/velocity_solver.h"
#include "discretization/body_frequency.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    using Vector = std::vector<double>;

    /**
     * The largest one by the method of Lanczos with all vectors kept
     * orthogonal, from @p v, to some four digits; infinity where @p multiply
     * fails.
     */
    double lanczos(
        Vector v, const std::function<bool(const Vector &, Vector &)> &multiply,
        const std::function<double(const Vector &, const Vector &)> &product)
    {
      constexpr unsigned int least = 3, most = 60;
      constexpr double digits = 1e-4, none = 1e-10;
      std::vector<Vector> basis;
      std::vector<double> alpha, beta;
      double largest = 0., size = std::sqrt(product(v, v));
      Vector next;
      while (size > none * std::abs(largest) && alpha.size() < most) {
        for (double &x : v)
          x /= size;
        if (!alpha.empty())
          beta.push_back(size);
        basis.push_back(v);
        if (!multiply(v, next))
          return std::numeric_limits<double>::infinity();
        alpha.push_back(product(v, next));
        for (const Vector &one : basis) {
          const double share = product(one, next);
          for (std::size_t i = 0; i < next.size(); ++i)
            next[i] -= share * one[i];
        }
        const unsigned int m = unsigned(alpha.size());
        Block T(m, m);
        for (unsigned int i = 0; i < m; ++i) {
          T(i, i) = alpha[i];
          if (i > 0)
            T(i, i - 1) = T(i - 1, i) = beta[i - 1];
        }
        const double before = std::exchange(largest, largest_eigenvalue(T));
        if (m >= least && std::abs(largest - before) < digits * largest)
          break;
        v = next;
        size = std::sqrt(product(v, v));
      }
      return largest;
    }

    /** b - T'(d) on the envelope of a point, b its secant @p secant or less. */
    double softening_slope(const CohesiveLaw &law, const double a,
                           const double l, const double opening,
                           const double secant)
    {
      const double x = l * opening,
                   step =
                       1e-6 * std::max(x, law.extrinsic()
                                              ? law.toughness() / law.strength()
                                              : 0.),
                   back = std::min(step, x / 2.);
      const double slope =
          (law.traction(x + step) - law.traction(x - back)) / (step + back);
      return std::max(0., secant - a * l * slope);
    }

    /** -d k/d ln(s) of the secant k along the ray s (x, y), as above. */
    double softening_slope(const MixedLaw &law, const double a, const double l,
                           const Reach &reach)
    {
      const double x = l * reach.opening, y = l * reach.slip, step = 1e-6;
      const auto secant = [&](const double s) {
        return (law.normal_secant(s * x, s * y) * x * x +
                law.tangential_secant(s * x, s * y) * y * y) /
               (x * x + y * y);
      };
      return a * l *
             std::max(0.,
                      (secant(1. - step) - secant(1. + step)) / (2. * step));
    }

    /**
     * dS/ds of the bound S of friction, N s, along the ray of a reach that
     * slides in contact: damage brings friction. Over @p ray, m.
     */
    template <int dim>
    double
    growth_of_friction(const OneStepProblem<dim> &problem, const std::size_t i,
                       const LocalSolution<dim> &solution, const double ray)
    {
      constexpr double step = 1e-6;
      if (!(solution.contact_impulse > 0. && ray > 0.))
        return 0.;
      const auto at = [&](const double s) {
        const Reach reach{s * solution.reach.opening, s * solution.reach.slip};
        return frozen_state<dim>(problem, i, reach, solution.contact_impulse)
            .threshold;
      };
      return std::max(0., (at(1. + step) - at(1.)) / (step * ray));
    }
  } // namespace

  template <int dim>
  double Relaxation<dim>::softening()
  {
    auto &delassus = delassus_;
    const auto &problem = problem_;
    const auto &communicator = delassus.communicator();
    const std::size_t n = problem.n_points * dim;
    // one row per point that damages: its weight and its direction
    std::vector<double> direction(n, 0.), D(n, -1.);
    bool any = false;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      const auto &solution = iterate_.solutions[i];
      const auto &interaction = problem.interactions[problem.interaction[i]];
      const double w_h2 = problem.weight[i] * iterate_.h * iterate_.h;
      if (problem.kind[i] == PointKind::prescribed) {
        for (unsigned int c = 0; c < dim; ++c)
          if (problem.mask[i] & (1u << c))
            D[i * dim + c] = 0.;
        continue;
      }
      const bool held = solution.frozen.is_rigid();
      // next to no opening the secant of an extrinsic law drowns its slope
      const double largest = solution.damages && interaction.law->extrinsic()
                                 ? 10. * support_[i] / problem.weight[i]
                                 : std::numeric_limits<double>::infinity();
      for (unsigned int c = 0; c < dim; ++c) {
        double b = held    ? 0.
                   : c > 0 ? solution.frozen.secant.tangential
                           : solution.frozen.secant.normal;
        if (c == 0 &&
            problem.jump_free[i * dim] + iterate_.h * solution.velocity[0] < 0.)
          b = problem.compression_stiffness[i];
        const bool rests =
            held || (c == 0 ? solution.contact_impulse > 0.
                            : solution.status == PointStatus::stick &&
                                  solution.frozen.threshold > 0.);
        D[i * dim + c] = rests    ? 0.
                         : b > 0. ? 1. / (w_h2 * std::min(b, largest))
                                  : -1.;
      }
      if (!solution.damages || held)
        continue;
      any = true;
      const double a = problem.strength_factor[i],
                   l = problem.opening_factor[i];
      const MixedLaw *mixed = interaction.law->mixed();
      const double d = std::hypot(solution.reach.opening, solution.reach.slip);
      const double tangential = mixed ? 1.
                                      : std::sqrt(interaction.stiffness_ratio *
                                                  interaction.shear_weight);
      const double slope =
          w_h2 * (mixed
                      ? softening_slope(*mixed, a, l, solution.reach)
                      : softening_slope(
                            *interaction.law, a, l, d,
                            std::min(largest,
                                     a * l * interaction.law->secant(l * d))));
      const double size = std::sqrt(std::max(
          0., slope - iterate_.h * growth_of_friction<dim>(problem, i, solution,
                                                           d * tangential)));
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        const double u =
            problem.jump_free[k] + iterate_.h * solution.velocity[c];
        if (D[k] > 0.)
          direction[k] = size / d * (c == 0 ? std::max(0., u) : tangential * u);
      }
    }
    if (!communicator.any(any))
      return 0.;

    // joints and contacts as stiff as the solver of the matrix can stand
    std::vector<double> least(n);
    for (std::size_t k = 0; k < n; ++k)
      least[k] = 1e-6 / (iterate_.h * iterate_.h * support_[k / dim]);
    auto *const nodes = dynamic_cast<VelocitySolver *>(&delassus);
    std::vector<double> springs; // of bodies that share nodes
    if (nodes) {
      springs.assign(n * dim, 0.);
      for (std::size_t k = 0; k < n; ++k)
        if (D[k] >= 0.)
          springs[k * dim + k % dim] = 1. / std::max(D[k], least[k]);
    } else {
      delassus.set_least_compliance(std::move(least));
      delassus.prepare_preconditioner(D);
    }
    // D (W + D)^-1 W f, the flexibility next to the springs
    const auto respond = [&](const std::vector<double> &f,
                             std::vector<double> &u) {
      if (nodes) { // to some more digits than the eigenvalue is known to
        std::vector<double> dP;
        return nodes->solve_linearised(springs, f, 1e-6, dP, u);
      }
      std::vector<double> r(n), z(n, 0.);
      for (std::size_t k = 0; k < n; ++k)
        r[k] = D[k] > 0. ? D[k] * f[k] : 0.;
      delassus.precondition(r.data(), z.data());
      for (std::size_t k = 0; k < n; ++k)
        u[k] = D[k] > 0. ? r[k] - D[k] * z[k] : 0.;
      return true;
    };
    // G^{1/2} H A^{-1} H^T G^{1/2} of what the points open by
    std::vector<double> f(n), u(n);
    const auto multiply = [&](const std::vector<double> &share,
                              std::vector<double> &next) {
      for (std::size_t k = 0; k < n; ++k)
        f[k] = direction[k] * share[k / dim];
      if (!respond(f, u))
        return false;
      next.assign(problem.n_points, 0.);
      for (std::size_t k = 0; k < n; ++k)
        if (direction[k] != 0.)
          next[k / dim] += direction[k] * u[k];
      return true;
    };
    const auto product = [&](const std::vector<double> &a,
                             const std::vector<double> &b) {
      std::vector<double> terms(problem.n_owned);
      for (std::size_t i = 0; i < problem.n_owned; ++i)
        terms[i] = a[i] * b[i];
      return communicator.sum(terms.data(), problem.n_owned);
    };
    std::vector<double> start(problem.n_points, 0.);
    for (std::size_t k = 0; k < n; ++k)
      if (direction[k] != 0.)
        start[k / dim] = 1.;
    return lanczos(std::move(start), multiply, product);
  }

  template double Relaxation<2>::softening();
  template double Relaxation<3>::softening();
} // namespace nsfd
