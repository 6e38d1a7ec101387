#include "apart_motion.h"

#include "delassus/joined_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /// of the right-hand side, where the bodies are too many for a factor
    constexpr double of_iterations = 1e-10;
  } // namespace

  template <int dim>
  ApartMotion<dim>::ApartMotion(const OneStepProblem<dim> &problem,
                                const DelassusOperator<dim> &delassus,
                                const TiedNodes<dim> &ties)
      : problem_(problem), delassus_(delassus), ties_(ties),
        system_(delassus, problem.time_step, delassus.bulk_theta(),
                largest_factor<dim>, ties.any() ? &ties : nullptr)
  {
  }

  /** H^T P of the points that are not tied. */
  template <int dim>
  void ApartMotion<dim>::impulse(const Vector &P, Vector &result) const
  {
    Vector free(P);
    for (std::size_t k = 0; k < free.size(); ++k)
      if (ties_.points()[k / dim])
        free[k] = 0.;
    result.resize(w_.size());
    delassus_.generalised_impulse(free.data(), result.data());
  }

  template <int dim>
  void ApartMotion<dim>::complete(Vector &P)
  {
    if (!ties_.any())
      return;
    Vector of_bodies, of_points;
    system_.apply(w_, of_bodies);
    impulse(P, of_points);
    for (std::size_t k = 0; k < of_bodies.size(); ++k)
      of_bodies[k] -= of_points[k];
    const Vector held = ties_.impulses_of(of_bodies);
    for (std::size_t k = 0; k < P.size(); ++k)
      if (ties_.points()[k / dim])
        P[k] = held[k];
  }

  template <int dim>
  void ApartMotion<dim>::start(const Vector &momentum, const Vector &impulse,
                               const Vector &start, const double)
  {
    if (!momentum.empty() || !impulse.empty())
      throw std::logic_error("ApartMotion: points alone act on these bodies");
    is_on_ = true;
    start_ = start;
    w_.assign(delassus_.bodies().n_dofs(), 0.);
    dw_ = residual_ = w_;
    if (ties_.any()) {
      Vector right(start.size(), 0.);
      for (std::size_t k = 0; k < right.size(); ++k)
        if (ties_.points()[k / dim])
          right[k] = problem_.given_velocity[k] - start[k];
      w_ = ties_.motion_of(right);
    }
    left_ = std::numeric_limits<double>::infinity();
    is_done_ = false;
  }

  template <int dim>
  double ApartMotion<dim>::stiffness_over_mass()
  {
    return nsfd::stiffness_over_mass(
        delassus_.bodies(),
        delassus_.shares(system_.time_step(), system_.theta()),
        delassus_.communicator());
  }

  template <int dim>
  void ApartMotion<dim>::set_residual(const Vector &P)
  {
    is_done_ = false;
    Vector of_bodies, of_points;
    system_.apply(w_, of_bodies);
    impulse(P, of_points);
    for (std::size_t k = 0; k < w_.size(); ++k)
      residual_[k] = of_points[k] - of_bodies[k];
    const auto size = [&](const Vector &x) {
      Vector sums;
      ties_.fold(x, sums);
      return std::sqrt(
          std::inner_product(sums.begin(), sums.end(), sums.begin(), 0.));
    };
    const double all = std::max(size(of_points), size(of_bodies));
    left_ = all > 0. ? size(residual_) / all : 0.;
  }

  template <int dim>
  void ApartMotion<dim>::set_velocity(Vector &U) const
  {
    U.resize(start_.size());
    delassus_.relative_velocity(w_.data(), U.data());
    for (std::size_t k = 0; k < U.size(); ++k)
      U[k] += start_[k];
  }

  /** Each body by itself, or all by one factor if nodes are tied: exactly,
      unless no more than @p tolerance is left. */
  template <int dim>
  void ApartMotion<dim>::balance(const Vector &P, const double tolerance)
  {
    if (!ties_.any()) {
      std::fill(w_.begin(), w_.end(), 0.);
      delassus_.add_velocity_change(P.data(), w_.data());
    } else {
      set_residual(P);
      if (left_ <= tolerance)
        return;
      system_.factorise(Vector(start_.size() * dim, 0.));
      Vector more;
      system_.solve(residual_, more);
      for (std::size_t k = 0; k < w_.size(); ++k)
        w_[k] += more[k];
    }
    set_residual(P);
    is_done_ = true;
  }

  template <int dim>
  bool ApartMotion<dim>::solve(const Vector &T, bool, const Vector &c,
                               const Accuracy &, Vector &dP, Vector &dU)
  {
    if (!system_.factorise(T))
      return false;
    system_.respond(residual_, c, dw_, dU, dP, of_iterations);
    return std::all_of(dw_.begin(), dw_.end(),
                       [](const double x) { return std::isfinite(x); });
  }

  template <int dim>
  void ApartMotion<dim>::move(const double length, const Vector &P, Vector &U)
  {
    for (std::size_t k = 0; k < w_.size(); ++k)
      w_[k] += length * dw_[k];
    set_residual(P);
    set_velocity(U);
  }

  template <int dim>
  void ApartMotion<dim>::set_motion(const Vector &w, const Vector &P, Vector &U)
  {
    const bool done = is_done_ && w == w_;
    w_ = w;
    set_residual(P);
    is_done_ = done;
    set_velocity(U);
  }

  template <int dim>
  void ApartMotion<dim>::add_to(Vector &velocity) const
  {
    for (std::size_t k = 0; k < w_.size(); ++k)
      velocity[k] += w_[k];
  }

  template <int dim>
  std::vector<double> ApartMotion<dim>::left_over() const
  {
    Vector result(w_.size());
    delassus_.apply(Operator::mass, w_.data(), result.data());
    for (std::size_t k = 0; k < w_.size(); ++k)
      result[k] += residual_[k];
    return result;
  }

  template class ApartMotion<2>;
  template class ApartMotion<3>;
} // namespace nsfd
