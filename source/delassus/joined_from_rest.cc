#include "joined_from_rest.h"

#include "node_values.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  void JoinedFromRest<dim>::start(const double h,
                                  const std::vector<double> &momentum,
                                  const std::vector<double> &impulse,
                                  const std::vector<double> &displacement)
  {
    is_on_ = true;
    auto &matrix = bodies_.matrix();
    bodies_.factor_.restrict_to_space(momentum, momentum_);
    v_.assign(momentum_.size(), 0.);
    dv_ = v_;
    std::vector<double> x, y;
    if (!impulse.empty()) {
      matrix.impulse(impulse.data(), y);
      for (std::size_t k = 0; k < y.size(); ++k)
        momentum_[k] += y[k];
    }
    take(bodies_.representative_, displacement.data(), x);
    matrix.apply(Operator::stiffness, x, y);
    for (std::size_t k = 0; k < y.size(); ++k)
      momentum_[k] -= h * y[k];
  }

  /** p - M_hat v + H^T P, into the rows of the bodies. */
  template <int dim>
  void JoinedFromRest<dim>::set_right_side(const std::vector<double> &P)
  {
    auto &matrix = bodies_.matrix();
    matrix.set_step(bodies_.shares(bodies_.time_step_, bodies_.theta_));
    matrix.apply_step(nullptr, v_, bodies_.columns_);
    matrix.impulse(P.data(), bodies_.rows_);
    for (std::size_t k = 0; k < v_.size(); ++k)
      bodies_.rows_[k] += momentum_[k] - bodies_.columns_[k];
  }

  template <int dim>
  bool JoinedFromRest<dim>::solve(
      const std::vector<double> &T, const bool symmetric,
      const std::vector<double> &P, const std::vector<double> &c,
      const double tolerance, std::vector<double> &dP, std::vector<double> &dU)
  {
    std::vector<double> all = P;
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] += c[k];
    set_right_side(all);
    if (!bodies_.solve_tangent(T, symmetric,
                               std::max(bodies_.tight, tolerance)))
      return false;
    dv_ = bodies_.columns_;
    dU.resize(c.size());
    bodies_.matrix().velocity(dv_, dU.data());
    answer_of_points<dim>(T, c, dU, dP);
    return true;
  }

  template <int dim>
  void JoinedFromRest<dim>::move(const double length, std::vector<double> &U)
  {
    for (std::size_t k = 0; k < v_.size(); ++k)
      v_[k] += length * dv_[k];
    bodies_.matrix().velocity(v_, U.data());
  }

  template <int dim>
  void JoinedFromRest<dim>::finish(const std::vector<double> &P,
                                   std::vector<double> &velocity,
                                   std::vector<double> &left)
  {
    velocity.assign(bodies_.bodies().n_dofs(), 0.);
    left.resize(velocity.size());
    bodies_.factor_.add(v_, velocity.data());
    set_right_side(P);
    std::vector<double> inertia;
    bodies_.matrix().apply(Operator::mass, v_, inertia);
    for (std::size_t k = 0; k < v_.size(); ++k)
      inertia[k] += bodies_.rows_[k];
    bodies_.factor_.fold(inertia);
    spread(bodies_.representative_, inertia, left.size(), left.data());
    is_on_ = false;
  }

  template class JoinedFromRest<2>;
  template class JoinedFromRest<3>;
} // namespace nsfd
