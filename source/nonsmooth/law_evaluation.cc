#include "natural_map.h"
#include "solver.h"

#include "core/cost.h"
#include "core/pages_of_zeros.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** The traction of its law drops at once. */
    template <int dim>
    bool drops(const OneStepProblem<dim> &problem, const std::size_t i)
    {
      const auto &law = problem.interactions[problem.interaction[i]].law;
      return law && std::isinf(law->steepest_softening());
    }
  } // namespace

  template <int dim>
  LawEvaluation<dim>::LawEvaluation(const OneStepProblem<dim> &problem,
                                    const DelassusOperator<dim> &delassus,
                                    const double energy_scale,
                                    const double tolerance)
      : problem_(problem), delassus_(delassus)
  {
    renew(energy_scale, tolerance);
  }

  template <int dim>
  void LawEvaluation<dim>::renew(const double energy_scale,
                                 const double tolerance)
  {
    const Charge charge(Cost::laws);
    const std::size_t n = problem_.n_points;
    floor_ = std::max(1e-6, 1e-14 / tolerance) * std::sqrt(energy_scale);
    error = worst_error = 0.;
    worst_point = law_calls = 0;
    frozen_ = nullptr;
    velocity.assign(n * dim, 0.);
    // of most points there is nothing in them
    if (solutions.size() != n) {
      defect.assign(n * dim, 0.);
      solutions.assign(n, {});
      linear_.assign(n, {});
      release_pages_of_zeros(defect);
      release_pages_of_zeros(solutions);
      release_pages_of_zeros(linear_);
    } else
      for (const std::size_t i : points_) {
        std::fill_n(&defect[i * dim], dim, 0.);
        solutions[i] = {};
        linear_[i] = {};
      }
    points_ = problem_.acting;
    for (const std::size_t i : points_) {
      linear_[i] =
          linear_point<dim>(problem_, i, majorant(i, 0), majorant(i, 1));
      // local solves start from the opening without any change
      solutions[i].reach.opening = problem_.opening_max[i];
      if (!problem_.slip_max.empty())
        solutions[i].reach.slip = problem_.slip_max[i];
    }
  }

  template <int dim>
  void LawEvaluation<dim>::update(const std::vector<double> &impulse)
  {
    delassus_.apply_delassus(impulse.data(), velocity.data());
    for (std::size_t k = 0; k < velocity.size(); ++k)
      velocity[k] += problem_.free_velocity[k];
    update_laws(impulse);
  }

  template <int dim>
  std::array<double, dim>
  LawEvaluation<dim>::local_velocity(const std::vector<double> &impulse,
                                     const std::size_t i) const
  {
    std::array<double, dim> local;
    for (unsigned int c = 0; c < dim; ++c)
      local[c] = velocity[i * dim + c] - majorant(i, c) * impulse[i * dim + c];
    return local;
  }

  template <int dim>
  void LawEvaluation<dim>::update_laws(const std::vector<double> &impulse)
  {
    const Charge charge(Cost::laws);
    ++law_calls;
    for (const std::size_t i : problem_.acting) {
      const auto local = local_velocity(impulse, i);
      if (is_frozen(i))
        solutions[i] = solve_frozen_point<dim>(
            problem_, i, (*frozen_)[i], local, majorant(i, 0), majorant(i, 1));
      // what broke in this solve may stay so beside a linear solution
      else if (!linear_[i].exists() ||
               (solutions[i].damages && drops(problem_, i)) ||
               !linear_[i].solve(problem_, i, local, solutions[i]))
        solutions[i] = solve_point<dim>(problem_, i, local, majorant(i, 0),
                                        majorant(i, 1), solutions[i].reach);
      for (unsigned int c = 0; c < dim; ++c)
        defect[i * dim + c] = impulse[i * dim + c] - solutions[i].impulse[c];
    }
    const std::size_t n = owned_acting(problem_);
    terms_.assign(2 * n, 0.);
    worst_error = 0.;
    worst_point = 0;
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t i = problem_.acting[a];
      for (unsigned int c = 0; c < dim; ++c) {
        const double R = majorant(i, c), d = defect[i * dim + c],
                     P = impulse[i * dim + c];
        terms_[a] += R * d * d;
        terms_[n + a] += R * P * P;
      }
      if (!(terms_[a] <= worst_error)) {
        worst_error = terms_[a];
        worst_point = i;
      }
    }
    const auto sums = delassus_.communicator().sums(terms_.data(), 2, n);
    const double scale = std::sqrt(sums[1]) + floor_;
    const double norm = std::sqrt(sums[0]);
    error = relative_natural_map(norm, scale);
    worst_error = scale > 0. ? std::sqrt(worst_error) / scale : 0.;
  }

  template class LawEvaluation<2>;
  template class LawEvaluation<3>;
} // namespace nsfd
