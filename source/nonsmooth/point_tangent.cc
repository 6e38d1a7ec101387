#include "point_tangent.h"

#include "local_problem.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// what difference quotients leave of their digits
    constexpr double of_differences = 1e-5;

    /** A unit vector in the plane of the face; 0 where nothing slides. */
    template <int dim>
    std::array<double, dim>
    sliding_direction(const OneStepProblem<dim> &problem, const std::size_t i,
                      const LocalSolution<dim> &solution)
    {
      std::array<double, dim> direction{};
      double square = 0.;
      for (unsigned int c = 1; c < dim; ++c) {
        direction[c] =
            solution.velocity[c] + problem.sliding_offset[i * dim + c];
        square += direction[c] * direction[c];
      }
      for (double &value : direction)
        value /= square > 0. ? std::sqrt(square) : 1.;
      return direction;
    }

    /** T with damage and the friction threshold frozen. */
    template <int dim>
    void frozen_tangent(const OneStepProblem<dim> &problem, const std::size_t i,
                        const LocalSolution<dim> &solution, const double A_N,
                        const double A_T, double *T)
    {
      const auto slopes =
          frozen_slopes<dim>(problem, i, solution.frozen, solution, A_N, A_T);
      for (unsigned int c = 0; c < dim; ++c)
        T[c * dim + c] = slopes[c];
      if (problem.kind[i] == PointKind::prescribed)
        return; // component by component
      if (dim == 2 || slopes[1] == slopes[dim - 1])
        return; // the same in all directions
      const auto direction = sliding_direction(problem, i, solution);
      for (unsigned int c = 1; c < dim; ++c)
        for (unsigned int d = 1; d < dim; ++d)
          T[c * dim + d] =
              (c == d ? slopes[dim - 1] : 0.) +
              (slopes[1] - slopes[dim - 1]) * direction[c] * direction[d];
    }

    /** To T of a frozen threshold, what the contact impulse does to it. */
    template <int dim>
    void add_friction(const OneStepProblem<dim> &problem, const std::size_t i,
                      const LocalSolution<dim> &solution, const double A_N,
                      const double A_T, double *T)
    {
      if (!(solution.contact_impulse > 0.))
        return;
      const auto direction = sliding_direction(problem, i, solution);
      double along = 0.; // the slope in the direction of sliding
      for (unsigned int c = 1; c < dim; ++c)
        for (unsigned int d = 1; d < dim; ++d)
          along += direction[c] * T[c * dim + d] * direction[d];
      const double coefficient =
          solution.frozen.threshold / solution.contact_impulse;
      for (unsigned int c = 1; c < dim; ++c)
        T[c * dim] = -direction[c] * (1. - A_T * along) * coefficient / A_N;
    }

    /** T is symmetric but for what difference quotients leave. */
    template <int dim>
    bool is_symmetric(const double *T)
    {
      double largest = 0., skew = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d) {
          largest = std::max(largest, std::abs(T[c * dim + d]));
          skew = std::max(skew, std::abs(T[c * dim + d] - T[d * dim + c]));
        }
      return skew <= of_differences * largest;
    }

    /**
     * Of damage of one scalar, d = d(u'(d)): the local solve at a given d is
     * differentiated, without a search for the next d in every direction,
     *
     *     dP/dU = P_U - P_d F_U / F_d,   F = d(u'(U, d)) - d.
     *
     * False, and T is not set, where d is not such a root: at a jump of the
     * law, or at the end of what the point has been through.
     */
    template <int dim>
    bool damage_tangent(const OneStepProblem<dim> &problem, const std::size_t i,
                        const LocalSolution<dim> &solution,
                        const std::array<double, dim> &local, const double size,
                        const double A_N, const double A_T, double *T)
    {
      if ((problem.kind[i] != PointKind::cohesive &&
           problem.kind[i] != PointKind::rigid) ||
          !solution.damages)
        return false;
      const PointDamage<dim> damage(problem, i);
      const double d = solution.reach.opening;
      if (damage.plateau() || !(d > damage.history().opening) ||
          problem.interactions[problem.interaction[i]].law->mixed())
        return false;
      struct Answer {
        std::array<double, dim> impulse;
        double excess;
      };
      const auto at = [&](const std::array<double, dim> &velocity,
                          const double opening) {
        local::LocalProblem<dim> here{problem, i, velocity, A_N, A_T};
        here.solve_end(damage, {opening, 0.});
        return Answer{here.solution.impulse,
                      here.solution.reach.opening - opening};
      };
      const Answer base = at(local, d);
      const double further = d * (1. + 1e-7);
      if (!(std::abs(base.excess) <= 1e-9 * d))
        return false;
      const Answer beyond = at(local, further);
      const double F_d = (beyond.excess - base.excess) / (further - d);
      // the next root is further off than round-off could say
      if (!(F_d < -1e-6))
        return false;
      for (unsigned int c = 0; c < dim; ++c) {
        auto moved = local;
        moved[c] += 1e-7 * size;
        const double h = moved[c] - local[c];
        if (!(h > 0.))
          return false;
        const Answer other = at(moved, d);
        const double dd = -(other.excess - base.excess) / (h * F_d);
        for (unsigned int r = 0; r < dim; ++r)
          T[r * dim + c] =
              -(other.impulse[r] - base.impulse[r]) / h -
              dd * (beyond.impulse[r] - base.impulse[r]) / (further - d);
      }
      return true;
    }

    /** Friction and damage in the local solve. */
    template <int dim>
    bool difference_quotients(const OneStepProblem<dim> &problem,
                              const std::size_t i,
                              const LocalSolution<dim> &solution,
                              const std::array<double, dim> &local,
                              const double A_N, const double A_T, double *T)
    {
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        size = std::max({size, std::abs(local[c]),
                         (c == 0 ? A_N : A_T) * std::abs(solution.impulse[c])});
      if (damage_tangent<dim>(problem, i, solution, local, size, A_N, A_T, T))
        return is_symmetric<dim>(T);
      for (unsigned int c = 0; c < dim; ++c) {
        auto moved = local;
        moved[c] += 1e-7 * size;
        const double h = moved[c] - local[c];
        const auto other =
            solve_point<dim>(problem, i, moved, A_N, A_T, solution.reach);
        for (unsigned int d = 0; d < dim && h > 0.; ++d)
          T[d * dim + c] = (solution.impulse[d] - other.impulse[d]) / h;
      }
      return is_symmetric<dim>(T);
    }
  } // namespace

  template <int dim>
  bool has_difference_quotients(const OneStepProblem<dim> &problem,
                                const std::size_t i,
                                const LocalSolution<dim> &solution)
  {
    // damage that grows, sliding that lifts
    return solution.coupled &&
           (solution.damages || solution.frozen.is_rigid() ||
            !has_frozen_law<dim>(problem, i));
  }

  template <int dim>
  bool point_tangent(const OneStepProblem<dim> &problem, const std::size_t i,
                     const LocalSolution<dim> &solution,
                     const std::array<double, dim> &local, const double A_N,
                     const double A_T, double *T)
  {
    if (has_difference_quotients(problem, i, solution))
      return difference_quotients<dim>(problem, i, solution, local, A_N, A_T,
                                       T);
    frozen_tangent(problem, i, solution, A_N, A_T, T);
    if (!solution.coupled)
      return true;
    add_friction(problem, i, solution, A_N, A_T, T);
    for (unsigned int c = 1; c < dim; ++c)
      if (T[c * dim] != 0.)
        return false;
    return true;
  }

#define INSTANTIATE(dim)                                                       \
  template bool point_tangent<dim>(                                            \
      const OneStepProblem<dim> &, std::size_t, const LocalSolution<dim> &,    \
      const std::array<double, dim> &, double, double, double *);              \
  template bool has_difference_quotients<dim>(                                 \
      const OneStepProblem<dim> &, std::size_t, const LocalSolution<dim> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
