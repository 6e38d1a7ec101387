#include "point_tangent.h"

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
      for (unsigned int c = 0; c < dim; ++c) {
        auto moved = local;
        moved[c] += 1e-7 * size;
        const double h = moved[c] - local[c];
        const auto other =
            solve_point<dim>(problem, i, moved, A_N, A_T, solution.reach);
        for (unsigned int d = 0; d < dim && h > 0.; ++d)
          T[d * dim + c] = (solution.impulse[d] - other.impulse[d]) / h;
      }
      double largest = 0., skew = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d) {
          largest = std::max(largest, std::abs(T[c * dim + d]));
          skew = std::max(skew, std::abs(T[c * dim + d] - T[d * dim + c]));
        }
      return skew <= of_differences * largest;
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
