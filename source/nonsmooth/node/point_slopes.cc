#include "point_slopes.h"

#include "nonsmooth/local_problem.h"

namespace nsfd
{
  namespace
  {
    using namespace local;

    template <int dim>
    void difference_slopes(const OneStepProblem<dim> &problem,
                           const std::size_t i,
                           const std::array<double, dim> &local, const double R,
                           const LocalSolution<dim> &solution,
                           std::array<double, dim * dim> &slopes)
    {
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        size = std::max({size, std::abs(solution.velocity[c]),
                         R * std::abs(solution.impulse[c])});
      if (size == 0.)
        size = 1.;
      const double step = 1e-7 * size;
      for (unsigned int c = 0; c < dim; ++c) {
        std::array<double, dim> moved = local;
        moved[c] += step;
        const auto other =
            solve_point<dim>(problem, i, moved, R, R, solution.reach);
        for (unsigned int r = 0; r < dim; ++r)
          slopes[r * dim + c] = (solution.impulse[r] - other.impulse[r]) / step;
      }
    }

    /** At frozen secant; the friction bound follows the contact impulse. */
    template <int dim>
    void secant_slopes(const OneStepProblem<dim> &problem, const std::size_t i,
                       const double R, const LocalSolution<dim> &solution,
                       std::array<double, dim * dim> &slopes)
    {
      const auto diagonal =
          frozen_slopes<dim>(problem, i, solution.frozen, solution, R, R);
      const double sliding = sliding_speed<dim>(problem, i, solution.velocity);
      std::array<double, dim> along{};
      for (unsigned int c = 1; c < dim; ++c)
        along[c] =
            sliding > 0.
                ? (solution.velocity[c] + problem.sliding_offset[i * dim + c]) /
                      sliding
                : 0.;
      slopes[0] = diagonal[0];
      for (unsigned int r = 1; r < dim; ++r)
        for (unsigned int c = 1; c < dim; ++c)
          slopes[r * dim + c] =
              (r == c ? diagonal[dim - 1] : 0.) +
              (diagonal[1] - diagonal[dim - 1]) * along[r] * along[c];
      for (unsigned int c = 1; c < dim; ++c) {
        slopes[c] = 0.;
        slopes[c * dim] = 0.;
        if (sliding > 0. && solution.contact_impulse > 0.)
          slopes[c * dim] = -along[c] * solution.frozen.threshold /
                            solution.contact_impulse * (1. / R - diagonal[1]);
      }
    }

    /**
     * How far beside an end d difference quotients are taken, over d: the
     * stiffer the secant @p k, the more round-off of P is in its reach.
     */
    template <int dim>
    double way_beside(const OneStepProblem<dim> &problem, const std::size_t i,
                      const double R, const double k)
    {
      const double stiffness =
          problem.weight[i] * square(problem.time_step) * problem.theta * k;
      return std::clamp(1e-8 * std::sqrt(R * stiffness), 1e-7, 1e-2);
    }

    /**
     * The end d of the step moves with the local velocity: with the point at
     * the secant of a given d, P(U_loc, d) and its reach d'(U_loc, d) = d,
     *
     *   dP = P_U dU_loc + P_d (d'_U dU_loc) / (1 - d'_d).
     */
    template <int dim>
    void add_damage(const OneStepProblem<dim> &problem, const std::size_t i,
                    const std::array<double, dim> &local, const double R,
                    const LocalSolution<dim> &solution,
                    std::array<double, dim * dim> &slopes)
    {
      const double d = solution.reach.opening;
      if (!(d > 0.))
        return;
      const double step =
          d * way_beside<dim>(problem, i, R, solution.frozen.secant.tangential);
      const PointDamage<dim> damage(problem, i);
      LocalProblem<dim> beside{problem, i, local, R, R};
      beside.solve_end(damage, {d + step, 0.});
      const double share = (beside.solution.reach.opening - d) / step;
      const double r2 =
          problem.interactions[problem.interaction[i]].shear_weight;
      const auto u = end_jump<dim>(problem, i, solution.velocity);
      std::array<double, dim> gradient{}; // of the reach, in U
      for (unsigned int c = 0; c < dim; ++c)
        gradient[c] = problem.time_step * problem.theta *
                      (c == 0 ? positive(u[0]) : r2 * u[c]) / d;
      std::array<double, dim> follows = gradient; // in U_loc
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int r = 0; r < dim; ++r)
          follows[c] -= R * gradient[r] * slopes[r * dim + c];
      for (unsigned int r = 0; r < dim; ++r) {
        const double P_d =
            (beside.solution.impulse[r] - solution.impulse[r]) / step;
        for (unsigned int c = 0; c < dim; ++c)
          slopes[r * dim + c] -= P_d * follows[c] / (1. - share);
      }
    }

    /**
     * The same with two ends, x of the opening and y of the slip, each of them
     * where it grows.
     */
    template <int dim>
    void add_mixed_damage(const OneStepProblem<dim> &problem,
                          const std::size_t i,
                          const std::array<double, dim> &local, const double R,
                          const LocalSolution<dim> &solution,
                          std::array<double, dim * dim> &slopes)
    {
      const PointDamage<dim> damage(problem, i);
      const Reach &end = solution.reach, &low = damage.history();
      const bool grows[2] = {end.opening > low.opening, end.slip > low.slip};
      const Secant &secant = solution.frozen.secant;
      const auto u = end_jump<dim>(problem, i, solution.velocity);
      const double h = problem.time_step * problem.theta;
      double follows[2][dim] = {}; // of the ends, in U_loc
      double share[2][2] = {}, P_d[2][dim] = {};
      for (unsigned int m = 0; m < 2; ++m) {
        if (!grows[m])
          continue;
        std::array<double, dim> gradient{}; // in U
        for (unsigned int c = 0; c < dim; ++c)
          if ((c == 0) == (m == 0))
            gradient[c] = h * (m == 0 ? 1. : u[c] / end.slip);
        for (unsigned int c = 0; c < dim; ++c) {
          follows[m][c] = gradient[c];
          for (unsigned int r = 0; r < dim; ++r)
            follows[m][c] -= R * gradient[r] * slopes[r * dim + c];
        }
        const double k = m == 0 ? secant.normal : secant.tangential;
        const double step =
            (end.opening + end.slip) * way_beside<dim>(problem, i, R, k);
        LocalProblem<dim> beside{problem, i, local, R, R};
        beside.solve_end(damage, {end.opening + (m == 0 ? step : 0.),
                                  end.slip + (m == 1 ? step : 0.)});
        const Reach &reach = beside.solution.reach;
        share[0][m] = (reach.opening - end.opening) / step;
        share[1][m] = (reach.slip - end.slip) / step;
        for (unsigned int r = 0; r < dim; ++r)
          P_d[m][r] = (beside.solution.impulse[r] - solution.impulse[r]) / step;
      }
      for (unsigned int m = 0; m < 2; ++m)
        if (!grows[m])
          share[m][0] = share[m][1] = 0.;
      const double a = 1. - share[0][0], b = -share[0][1], c = -share[1][0],
                   d = 1. - share[1][1], determinant = a * d - b * c;
      for (unsigned int column = 0; column < dim; ++column) {
        const double one = follows[0][column], two = follows[1][column];
        const double x = (d * one - b * two) / determinant,
                     y = (a * two - c * one) / determinant;
        for (unsigned int r = 0; r < dim; ++r)
          slopes[r * dim + column] -= P_d[0][r] * x + P_d[1][r] * y;
      }
    }
  } // namespace

  template <int dim>
  void point_slopes(const OneStepProblem<dim> &problem, const std::size_t i,
                    const std::array<double, dim> &local, const double R,
                    const LocalSolution<dim> &solution,
                    std::array<double, dim * dim> &slopes)
  {
    slopes.fill(0.);
    if (problem.kind[i] == PointKind::prescribed ||
        solution.frozen.is_rigid()) {
      const auto diagonal =
          frozen_slopes<dim>(problem, i, solution.frozen, solution, R, R);
      for (unsigned int c = 0; c < dim; ++c)
        slopes[c * (dim + 1)] = diagonal[c];
      return;
    }
    const Interaction &interaction =
        problem.interactions[problem.interaction[i]];
    const bool lifts = problem.contact[i] &&
                       (interaction.wear > 0. || !problem.dilatancy.empty());
    const bool has_law = problem.kind[i] == PointKind::cohesive ||
                         problem.kind[i] == PointKind::rigid;
    if (lifts || (has_law && interaction.law->adds_openings())) {
      difference_slopes<dim>(problem, i, local, R, solution, slopes);
      return;
    }
    secant_slopes<dim>(problem, i, R, solution, slopes);
    if (!has_law)
      return;
    if (interaction.law->mixed()) {
      if (solution.damages)
        add_mixed_damage<dim>(problem, i, local, R, solution, slopes);
    } else if (solution.damages || interaction.plateau)
      add_damage<dim>(problem, i, local, R, solution, slopes);
  }

#define INSTANTIATE(dim)                                                       \
  template void point_slopes<dim>(const OneStepProblem<dim> &, std::size_t,    \
                                  const std::array<double, dim> &, double,     \
                                  const LocalSolution<dim> &,                  \
                                  std::array<double, dim * dim> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
