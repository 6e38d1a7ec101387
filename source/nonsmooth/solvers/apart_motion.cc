#include "apart_motion.h"

#include "delassus/joined_bodies.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /// of the right-hand side, where the bodies are too many for a factor
    constexpr double of_iterations = 1e-10;
  } // namespace

  template <int dim>
  ApartMotion<dim>::ApartMotion(const DelassusOperator<dim> &delassus,
                                const double time_step)
      : delassus_(delassus), system_(delassus, time_step, delassus.bulk_theta())
  {
  }

  template <int dim>
  void ApartMotion<dim>::start(const std::vector<double> &momentum,
                               const std::vector<double> &impulse,
                               const std::vector<double> &start, const double)
  {
    if (!momentum.empty() || !impulse.empty())
      throw std::logic_error("ApartMotion: points alone act on these bodies");
    is_on_ = true;
    start_ = start;
    w_.assign(delassus_.bodies().n_dofs(), 0.);
    dw_ = residual_ = w_;
    set_residual(std::vector<double>(start.size(), 0.));
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
  void ApartMotion<dim>::set_residual(const std::vector<double> &P)
  {
    is_done_ = false;
    std::vector<double> of_bodies;
    system_.apply(w_, of_bodies);
    delassus_.generalised_impulse(P.data(), residual_.data());
    double left = 0., size = 0.;
    for (std::size_t k = 0; k < w_.size(); ++k) {
      size += residual_[k] * residual_[k];
      residual_[k] -= of_bodies[k];
      left += residual_[k] * residual_[k];
    }
    left_ = size > 0. ? std::sqrt(left / size) : (left > 0. ? 1. : 0.);
  }

  template <int dim>
  void ApartMotion<dim>::set_velocity(std::vector<double> &U) const
  {
    U.resize(start_.size());
    delassus_.relative_velocity(w_.data(), U.data());
    for (std::size_t k = 0; k < U.size(); ++k)
      U[k] += start_[k];
  }

  /** Each body by itself, exactly. */
  template <int dim>
  void ApartMotion<dim>::balance(const std::vector<double> &P, const double)
  {
    std::fill(w_.begin(), w_.end(), 0.);
    delassus_.add_velocity_change(P.data(), w_.data());
    set_residual(P);
    is_done_ = true;
  }

  template <int dim>
  bool ApartMotion<dim>::solve(const std::vector<double> &T, bool,
                               const std::vector<double> &c, const Accuracy &,
                               std::vector<double> &dP, std::vector<double> &dU)
  {
    if (!system_.factorise(T))
      return false;
    system_.respond(residual_, c, dw_, dU, dP, of_iterations);
    return std::all_of(dw_.begin(), dw_.end(),
                       [](const double x) { return std::isfinite(x); });
  }

  template <int dim>
  void ApartMotion<dim>::move(const double length, const std::vector<double> &P,
                              std::vector<double> &U)
  {
    for (std::size_t k = 0; k < w_.size(); ++k)
      w_[k] += length * dw_[k];
    set_residual(P);
    set_velocity(U);
  }

  template <int dim>
  void ApartMotion<dim>::set_motion(const std::vector<double> &w,
                                    const std::vector<double> &P,
                                    std::vector<double> &U)
  {
    const bool done = is_done_ && w == w_;
    w_ = w;
    set_residual(P);
    is_done_ = done;
    set_velocity(U);
  }

  template <int dim>
  void ApartMotion<dim>::add_to(std::vector<double> &velocity) const
  {
    for (std::size_t k = 0; k < w_.size(); ++k)
      velocity[k] += w_[k];
  }

  template <int dim>
  std::vector<double> ApartMotion<dim>::left_over() const
  {
    std::vector<double> result(w_.size());
    delassus_.apply(Operator::mass, w_.data(), result.data());
    for (std::size_t k = 0; k < w_.size(); ++k)
      result[k] += residual_[k];
    return result;
  }

  template class ApartMotion<2>;
  template class ApartMotion<3>;
} // namespace nsfd
