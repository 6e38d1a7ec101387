#include "path_laws.h"

#include "linear_algebra/dense_lu.h"
#include "nonsmooth/damage.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** dk/dd of the secants of a point, Pa/m^2. */
    Secant slope_of_secant(const LawPoint &law, const double opening)
    {
      const double step = 1e-6 * opening;
      const Secant up = law.secant({opening + step, 0.}),
                   down = law.secant({opening - step, 0.});
      return {(up.normal - down.normal) / (2. * step),
              (up.tangential - down.tangential) / (2. * step)};
    }
  } // namespace

  /** T of the last round, h^2 w k; joints and contacts as stiff as the solver
      of the matrix can stand. */
  template <int dim>
  std::vector<double>
  PathLaws<dim>::springs(const std::vector<double> &support) const
  {
    constexpr double stiff = 1e6;
    const double h = iterate_.h;
    std::vector<double> T(problem_.n_points * dim * dim, 0.);
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      const PointKind kind = problem_.kind[i];
      const auto &spring = problem_.interactions[problem_.interaction[i]];
      const auto &solution = iterate_.solutions[i];
      const double w = problem_.weight[i];
      for (unsigned int c = 0; c < dim; ++c) {
        double k = 0.;
        if (kind == PointKind::prescribed)
          k = problem_.mask[i] & (1u << c) ? stiff * support[i] : 0.;
        else if (c == 0 && solution.contact_impulse > 0.)
          k = stiff * support[i];
        else if (kind == PointKind::elastic)
          k = c > 0 ? w * spring.normal_stiffness * spring.stiffness_ratio
              : problem_.jump_free[i * dim] + h * solution.velocity[0] >= 0.
                  ? w * spring.normal_stiffness
                  : w * problem_.compression_stiffness[i];
        T[(i * dim + c) * dim + c] = h * h * std::min(k, stiff * support[i]);
      }
    }
    return T;
  }

  /** Points whose springs are damaged, or which damage, in the step. */
  template <int dim>
  std::vector<std::size_t> PathLaws<dim>::growing() const
  {
    std::vector<std::size_t> points;
    for (std::size_t i = 0; i < problem_.n_points; ++i)
      if (takes_part(i) && !is_closed(i) &&
          (laws_.held(i).opening > laws_.history(i).opening ||
           dissipation_of(i, now_.load_time) > 0.))
        points.push_back(i);
    return points;
  }

  /** dd/du of the effective opening d. */
  template <int dim>
  auto PathLaws<dim>::slope_of_reach(const std::size_t i, const double s) const
      -> Vector
  {
    const Interaction &interaction = laws_.law(i);
    const Vector u = on_line(&Sample::jump, i, s);
    const double d = reach_of<dim>(interaction, u.data()).opening;
    Vector slope{};
    for (unsigned int c = 0; c < dim && d > 0.; ++c)
      slope[c] =
          c == 0 ? std::max(0., u[0]) / d : interaction.shear_weight * u[c] / d;
    return slope;
  }

  template <int dim>
  bool PathLaws<dim>::improve(VelocitySolver &nodes,
                              const std::vector<double> &support,
                              const double longest, End &end,
                              std::vector<double> &damage) const
  {
    const std::vector<std::size_t> points = growing();
    const std::size_t m = points.size();
    const double s = end.load_time, h2 = iterate_.h * iterate_.h,
                 span = now_.load_time - last_.load_time;
    if (m == 0 || communicator_.size() > 1)
      return false;
    std::vector<double> x(m), reach(m), along(m), gain(m);
    std::vector<Vector> slope(m);
    for (std::size_t j = 0; j < m; ++j) {
      const std::size_t i = points[j];
      const Interaction &interaction = laws_.law(i);
      if (interaction.law->mixed())
        return false;
      const Vector u = on_line(&Sample::jump, i, s);
      x[j] = laws_.held(i).opening;
      reach[j] = reach_of<dim>(interaction, u.data()).opening;
      slope[j] = slope_of_reach(i, s);
      for (unsigned int c = 0; c < dim; ++c)
        along[j] += slope[j][c] *
                    (now_.jump[i * dim + c] - last_.jump[i * dim + c]) / span;
    }

    // the response to the springs, one by one, and to the load time
    const std::vector<double> T = springs(support);
    DenseLU matrix;
    matrix.reinit(int(m) + 1);
    std::vector<double> right(m + 1, 0.), control(m + 1, 0.), dP, dU,
        c(problem_.n_points * dim, 0.);
    const bool by_strength = end.point != End::none && is_closed(end.point),
               by_opening = end.point != End::none && !by_strength;
    Vector force{};
    if (by_strength) {
      const Vector here = mean_of_face(end.point, now_.force),
                   there = mean_of_face(end.point, last_.force);
      for (unsigned int k = 0; k < dim; ++k)
        force[k] = here[k] + (s - now_.load_time) / span * (here[k] - there[k]);
    }
    const auto change_of_share = [&](const Vector &df) {
      double size = 0., part = 0.;
      for (unsigned int k = 0; k < dim; ++k) {
        size += force[k] * force[k];
        part += df[k] * df[k];
      }
      if (part == 0.)
        return 0.;
      const double step = 1e-6 * std::sqrt(size / part);
      Vector other = force;
      for (unsigned int k = 0; k < dim; ++k)
        other[k] += step * df[k];
      return (share_of(end.point, other) - share_of(end.point, force)) / step;
    };
    const Vector event_slope =
        by_opening ? slope_of_reach(end.point, s) : Vector{};
    for (std::size_t j = 0; j < m; ++j) {
      const std::size_t i = points[j];
      const Interaction &interaction = laws_.law(i);
      const LawPoint law(*interaction.law, problem_.strength_factor[i],
                         problem_.opening_factor[i], interaction.plateau,
                         interaction.stiffness_ratio, interaction.shear_weight);
      const Secant k = slope_of_secant(law, x[j]);
      gain[j] = -problem_.weight[i] * k.normal * x[j] * x[j] / 2.;
      const Vector u = on_line(&Sample::jump, i, s);
      for (unsigned int d = 0; d < dim; ++d)
        c[i * dim + d] =
            -h2 * problem_.weight[i] *
            (d == 0 ? k.normal * std::max(0., u[0]) : k.tangential * u[d]);
      if (!nodes.solve_linearised(T, c, 1e-6, dP, dU))
        return false;
      for (unsigned int d = 0; d < dim; ++d)
        c[i * dim + d] = 0.;
      for (std::size_t n = 0; n < m; ++n) {
        double A = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          A += slope[n][d] * dU[points[n] * dim + d];
        matrix.row(int(n))[j] = (n == j) - A;
      }
      if (by_strength) {
        Vector df = mean_of_face(end.point, dP);
        for (double &one : df)
          one /= h2;
        control[j] = change_of_share(df);
      }
      for (unsigned int d = 0; by_opening && d < dim; ++d)
        control[j] += event_slope[d] * dU[end.point * dim + d];
    }
    for (std::size_t n = 0; n < m; ++n) {
      matrix.row(int(n))[m] = -along[n] * span;
      right[n] = reach[n] - x[n];
    }
    if (end.at_longest)
      control[m] = 1.;
    else if (end.point == End::none)
      for (std::size_t n = 0; n < m; ++n) {
        for (std::size_t j = 0; j < m; ++j)
          control[j] += gain[n] * ((n == j) - matrix.row(int(n))[j]);
        control[m] += gain[n] * along[n] * span;
      }
    else {
      for (unsigned int d = 0; by_opening && d < dim; ++d) {
        const std::size_t k = end.point * dim + d;
        control[m] += event_slope[d] * (now_.jump[k] - last_.jump[k]);
      }
      if (by_strength) {
        const Vector here = mean_of_face(end.point, now_.force),
                     there = mean_of_face(end.point, last_.force);
        Vector change;
        for (unsigned int d = 0; d < dim; ++d)
          change[d] = here[d] - there[d];
        control[m] = change_of_share(change);
      }
    }
    double largest = 0.;
    for (const double one : control)
      largest = std::max(largest, std::abs(one));
    for (std::size_t k = 0; k <= m && largest > 0.; ++k)
      matrix.row(int(m))[k] = control[k] / largest;
    if (!(largest > 0.) || !matrix.factorise())
      return false;
    matrix.solve(right.data());

    // none closes, or opens by more than half of its law, at once
    if (!(std::abs(right[m] * span) <= longest))
      return false;
    double share = 1.;
    for (std::size_t j = 0; j < m; ++j) {
      if (!std::isfinite(right[j]))
        return false;
      const double most = laws_.opening_scale(points[j]) / 2.;
      if (right[j] > most)
        share = std::min(share, most / right[j]);
      if (x[j] + right[j] < x[j] / 4.)
        share = std::min(share, -0.75 * x[j] / right[j]);
    }
    for (std::size_t j = 0; j < m; ++j) {
      const std::size_t i = points[j];
      damage[2 * i] =
          std::max(laws_.history(i).opening, x[j] + share * right[j]) /
          laws_.opening_scale(i);
    }
    end.load_time += share * right[m] * span;
    return true;
  }

#define INSTANTIATE(dim)                                                       \
  template bool PathLaws<dim>::improve(VelocitySolver &,                       \
                                       const std::vector<double> &, double,    \
                                       End &, std::vector<double> &) const;    \
  template std::vector<double> PathLaws<dim>::springs(                         \
      const std::vector<double> &) const;                                      \
  template std::vector<std::size_t> PathLaws<dim>::growing() const;            \
  template std::array<double, dim> PathLaws<dim>::slope_of_reach(std::size_t,  \
                                                                 double) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
