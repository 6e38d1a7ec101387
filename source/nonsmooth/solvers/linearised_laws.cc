#include "linearised_laws.h"

#include "core/stop_request.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  std::array<double, dim * dim> LinearisedLaws<dim>::derivative(
      const OneStepProblem<dim> &problem, const LawEvaluation<dim> &evaluation,
      const std::vector<double> &impulse, const std::size_t i) const
  {
    std::array<double, dim * dim> J{};
    if (const auto *linear = evaluation.linear(i)) {
      for (unsigned int c = 0; c < dim; ++c)
        J[c * dim + c] =
            -linear->slope * (c == 0 ? linear->normal : linear->tangential);
      return J;
    }
    const auto &solution = evaluation.solutions[i];
    const double R_N = evaluation.majorant(i, 0),
                 R_T = evaluation.majorant(i, 1);
    const bool coupled = !evaluation.is_frozen(i) && solution.coupled;
    if (!coupled && (dim == 2 || solution.frozen.threshold == 0.)) {
      const auto slopes =
          frozen_slopes<dim>(problem, i, solution.frozen, solution, R_N, R_T);
      for (unsigned int c = 0; c < dim; ++c)
        J[c * dim + c] = -slopes[c];
      return J;
    }
    // difference quotients of the local solve, friction and damage in it
    const auto local = evaluation.local_velocity(impulse, i);
    double size = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      size =
          std::max({size, std::abs(local[c]),
                    evaluation.majorant(i, c) * std::abs(solution.impulse[c])});
    const double step = 1e-7 * size;
    for (unsigned int c = 0; c < dim; ++c) {
      auto moved = local;
      moved[c] += step;
      const double h = moved[c] - local[c];
      if (!(h > 0.))
        continue;
      const auto other =
          coupled
              ? solve_point<dim>(problem, i, moved, R_N, R_T, solution.reach)
              : solve_frozen_point<dim>(problem, i, solution.frozen, moved, R_N,
                                        R_T);
      for (unsigned int d = 0; d < dim; ++d)
        J[d * dim + c] = (other.impulse[d] - solution.impulse[d]) / h;
    }
    return J;
  }

  namespace
  {
    /** A^{-1} by Gauss-Jordan with pivots; A is I + J R, far from singular. */
    template <int dim>
    std::array<double, dim * dim> inverse(std::array<double, dim * dim> A)
    {
      std::array<double, dim * dim> X{};
      for (unsigned int c = 0; c < dim; ++c)
        X[c * dim + c] = 1.;
      for (unsigned int c = 0; c < dim; ++c) {
        unsigned int pivot = c;
        for (unsigned int r = c + 1; r < dim; ++r)
          if (std::abs(A[r * dim + c]) > std::abs(A[pivot * dim + c]))
            pivot = r;
        if (A[pivot * dim + c] == 0.)
          return {};
        for (unsigned int k = 0; k < dim; ++k) {
          std::swap(A[c * dim + k], A[pivot * dim + k]);
          std::swap(X[c * dim + k], X[pivot * dim + k]);
        }
        const double scale = 1. / A[c * dim + c];
        for (unsigned int k = 0; k < dim; ++k) {
          A[c * dim + k] *= scale;
          X[c * dim + k] *= scale;
        }
        for (unsigned int r = 0; r < dim; ++r) {
          const double share = A[r * dim + c];
          if (r == c || share == 0.)
            continue;
          for (unsigned int k = 0; k < dim; ++k) {
            A[r * dim + k] -= share * A[c * dim + k];
            X[r * dim + k] -= share * X[c * dim + k];
          }
        }
      }
      return X;
    }
  } // namespace

  template <int dim>
  void LinearisedLaws<dim>::update(const OneStepProblem<dim> &problem,
                                   const LawEvaluation<dim> &evaluation,
                                   const std::vector<double> &impulse,
                                   const std::vector<char> &where)
  {
    stiffness.assign(problem.n_points * dim * dim, 0.);
    change.assign(problem.n_points * dim, 0.);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (!where.empty() && !where[i])
        continue;
      const auto J = derivative(problem, evaluation, impulse, i);
      std::array<double, dim * dim> A{};
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          A[r * dim + c] = (r == c ? 1. : 0.) + J[r * dim + c] *
                                                    (1. - softening) *
                                                    evaluation.majorant(i, c);
      const auto B = inverse<dim>(A);
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int k = 0; k < dim; ++k) {
          change[i * dim + r] -=
              B[r * dim + k] * evaluation.defect[i * dim + k];
          for (unsigned int c = 0; c < dim; ++c)
            stiffness[(i * dim + r) * dim + c] -=
                B[r * dim + k] * J[k * dim + c];
        }
    }
  }

  template <int dim>
  bool newton_refinement(const OneStepProblem<dim> &problem,
                         BodySystem<dim> &system,
                         const DelassusOperator<dim> &delassus,
                         const double tolerance, const unsigned int patience,
                         double &softening, std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation, SolverReport &report)
  {
    const std::size_t n = impulse.size();
    LinearisedLaws<dim> laws;
    laws.softening = softening;
    const std::vector<double> at_rest(delassus.bodies().n_dofs(), 0.);
    std::vector<double> dy, dU, dP, best(impulse);
    double best_error = evaluation.error;
    unsigned int idle = 0, still = 0;
    while (evaluation.error > tolerance && idle <= patience && still < 2) {
      stop_request::leave_if_due();
      const double before = evaluation.error;
      laws.update(problem, evaluation, impulse);
      if (!system.factorise(laws.stiffness))
        break;
      ++report.newton;
      report.krylov += system.respond(at_rest, laws.change, dy, dU, dP);
      for (std::size_t j = 0; j < n; ++j)
        impulse[j] += dP[j];
      evaluation.update(impulse);
      const bool good = evaluation.error < 0.5 * best_error;
      if (evaluation.error < best_error) {
        best_error = evaluation.error;
        best = impulse;
      }
      if (good) {
        idle = still = 0;
        softening = laws.softening;
        laws.softening = std::max(1e-7, 0.1 * laws.softening);
        continue;
      }
      ++idle;
      still = laws.softening > 0.09 && evaluation.error < 1.05 * before &&
                      evaluation.error > 0.95 * before
                  ? still + 1
                  : 0;
      laws.softening = std::min(0.1, std::max(1e-3, 10. * laws.softening));
      if (!(evaluation.error < 10. * best_error)) {
        impulse = best;
        evaluation.update(impulse);
      }
    }
    if (!(evaluation.error <= best_error)) {
      impulse = best;
      evaluation.update(impulse);
    }
    return evaluation.error <= tolerance;
  }

  template class LinearisedLaws<2>;
  template class LinearisedLaws<3>;
  template bool newton_refinement<2>(const OneStepProblem<2> &, BodySystem<2> &,
                                     const DelassusOperator<2> &, double,
                                     unsigned int, double &,
                                     std::vector<double> &, LawEvaluation<2> &,
                                     SolverReport &);
  template bool newton_refinement<3>(const OneStepProblem<3> &, BodySystem<3> &,
                                     const DelassusOperator<3> &, double,
                                     unsigned int, double &,
                                     std::vector<double> &, LawEvaluation<3> &,
                                     SolverReport &);
} // namespace nsfd
