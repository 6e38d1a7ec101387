#include "joined_motion.h"

#include "node_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  void JoinedMotion<dim>::start(const std::vector<double> &momentum,
                                const std::vector<double> &impulse,
                                const std::vector<double> &start,
                                const double floor)
  {
    is_on_ = true;
    floor_ = floor;
    known_ = false;
    start_ = start;
    const std::size_t n = bodies_.representative_.size();
    momentum_.assign(n, 0.);
    if (!momentum.empty())
      bodies_.factor_.restrict_to_space(momentum, momentum_);
    if (!impulse.empty()) {
      std::vector<double> more;
      bodies_.matrix().impulse(impulse.data(), more);
      for (std::size_t k = 0; k < n; ++k)
        momentum_[k] += more[k];
    }
    w_.assign(n, 0.);
    dw_ = w_;
    residual_ = momentum_;
    bodies_.factor_.fold(residual_);
    left_ = std::numeric_limits<double>::infinity();
    scale_ = 1.;
    is_done_ = false;
  }

  template <int dim>
  double JoinedMotion<dim>::stiffness_over_mass()
  {
    const StepShares shares =
        bodies_.shares(bodies_.time_step_, bodies_.theta_);
    if (stiffness_over_mass_.share != shares.stiffness)
      stiffness_over_mass_ = {shares.stiffness,
                              nsfd::stiffness_over_mass(bodies_.bodies_, shares,
                                                        bodies_.communicator_)};
    return stiffness_over_mass_.value;
  }

  template <int dim>
  void JoinedMotion<dim>::set_residual(const std::vector<double> &P)
  {
    is_done_ = false;
    known_ = true;
    of_ = P;
    auto &matrix = bodies_.matrix();
    std::vector<double> of_points, of_bodies;
    matrix.impulse(P.data(), of_points);
    matrix.set_step(bodies_.shares(bodies_.time_step_, bodies_.theta_));
    matrix.apply_step(nullptr, w_, of_bodies);
    const std::size_t n = w_.size();
    for (std::size_t k = 0; k < n; ++k)
      residual_[k] = momentum_[k] + of_points[k] - of_bodies[k];
    bodies_.factor_.fold(residual_);
    std::vector<double> squares(3 * n);
    for (std::size_t k = 0; k < n; ++k) {
      squares[k] = residual_[k] * residual_[k];
      squares[n + k] = momentum_[k] * momentum_[k];
      squares[2 * n + k] = of_points[k] * of_points[k];
    }
    const auto sums = bodies_.communicator_.sums(squares.data(), 3, n);
    left_ = std::sqrt(sums[0]);
    const double size =
        std::max(floor_, std::sqrt(sums[1]) + std::sqrt(sums[2]));
    scale_ = size > 0. ? size : 1.;
  }

  template <int dim>
  void JoinedMotion<dim>::keep_residual(const std::vector<double> &P,
                                        const bool same_motion)
  {
    if (!known_ || bodies_.communicator_.any(!same_motion || P != of_))
      set_residual(P);
    else
      is_done_ = false;
  }

  template <int dim>
  void JoinedMotion<dim>::set_velocity(std::vector<double> &U) const
  {
    bodies_.matrix().velocity(w_, U.data());
    for (std::size_t k = 0; k < U.size(); ++k)
      U[k] += start_[k];
  }

  template <int dim>
  void JoinedMotion<dim>::balance(const std::vector<double> &P,
                                  const double tolerance)
  {
    keep_residual(P, true);
    if (left_ <= tolerance * scale_)
      return;
    bodies_.rows_ = residual_;
    bodies_.answer(std::clamp(tolerance * scale_ / left_, bodies_.tight, 0.1));
    for (std::size_t k = 0; k < w_.size(); ++k)
      w_[k] += bodies_.columns_[k];
    set_residual(P);
  }

  template <int dim>
  bool
  JoinedMotion<dim>::solve(const std::vector<double> &T, const bool symmetric,
                           const std::vector<double> &c,
                           const Accuracy &accuracy, std::vector<double> &dP,
                           std::vector<double> &dU)
  {
    const std::size_t n = residual_.size();
    std::vector<double> rows, of_defect;
    bodies_.matrix().impulse(c.data(), rows);
    bodies_.factor_.fold(rows);
    bodies_.matrix().impulse(accuracy.defect.data(), of_defect);
    bodies_.factor_.fold(of_defect);
    std::vector<double> squares(2 * n);
    for (std::size_t k = 0; k < n; ++k) {
      rows[k] += residual_[k];
      of_defect[k] += residual_[k];
      squares[k] = rows[k] * rows[k];
      squares[n + k] = of_defect[k] * of_defect[k];
    }
    const auto sums = bodies_.communicator_.sums(squares.data(), 2, n);
    const double enough = accuracy.tolerance * scale_,
                 first = accuracy.share * std::sqrt(sums[1]);
    asks_all_ = first <= enough;
    bodies_.rows_ = std::move(rows);
    const double size = std::sqrt(sums[0]), left = std::max(enough, first);
    if (!bodies_.solve_tangent(
            T, symmetric,
            {size > 0. ? std::clamp(left / size, bodies_.tight, 0.1) : 1.,
             left}))
      return false;
    dw_ = bodies_.columns_;
    dU.resize(c.size());
    bodies_.matrix().velocity(dw_, dU.data());
    answer_of_points<dim>(bodies_.matrix().parting_points(), T, c, dU, dP);
    return true;
  }

  template <int dim>
  void JoinedMotion<dim>::move(const double length,
                               const std::vector<double> &P,
                               std::vector<double> &U)
  {
    for (std::size_t k = 0; k < w_.size(); ++k)
      w_[k] += length * dw_[k];
    set_residual(P);
    is_done_ = asks_all_ && length == 1.;
    set_velocity(U);
  }

  template <int dim>
  void JoinedMotion<dim>::set_motion(const std::vector<double> &w,
                                     const std::vector<double> &P,
                                     std::vector<double> &U)
  {
    const bool same = w == w_;
    if (!same)
      w_ = w;
    keep_residual(P, same);
    set_velocity(U);
  }

  template <int dim>
  void JoinedMotion<dim>::add_to(std::vector<double> &velocity) const
  {
    bodies_.factor_.add(w_, velocity.data());
  }

  template <int dim>
  std::vector<double> JoinedMotion<dim>::left_over() const
  {
    std::vector<double> result(bodies_.bodies().n_dofs()), inertia;
    bodies_.matrix().apply(Operator::mass, w_, inertia);
    for (std::size_t k = 0; k < w_.size(); ++k)
      inertia[k] += residual_[k];
    bodies_.factor_.fold(inertia);
    spread(bodies_.representative_, inertia, result.size(), result.data());
    return result;
  }

  template <int dim>
  const NodeClusters &JoinedMotion<dim>::vertices()
  {
    auto &matrix = bodies_.matrix();
    matrix.set_step(bodies_.shares(bodies_.time_step_, bodies_.theta_));
    const CoarseSpace &space = bodies_.conforming_->space();
    tied_.clear();
    if (!space.ties.empty())
      tied_.resize(std::size_t(space.n_own) / matrix.size_, 0);
    for (const CoarseSpace::Tie &tie : space.ties)
      for (const long long one : {tie.number, tie.master})
        if (const long long k = one - space.first; k >= 0 && k < space.n_own)
          tied_[std::size_t(k) / matrix.size_] = 1;
    return bodies_.jacobi_.vertices(matrix);
  }

  template <int dim>
  unsigned int JoinedMotion<dim>::unknowns_per_node() const
  {
    return bodies_.matrix().size_;
  }

  template <int dim>
  void JoinedMotion<dim>::node(const int k,
                               std::array<double, dim> &inverse_mass,
                               std::array<double, dim> &velocity) const
  {
    const unsigned int n = unknowns_per_node();
    inverse_mass = velocity = {};
    for (unsigned int c = 0; c < n; ++c) {
      inverse_mass[c] = 1. / bodies_.jacobi_.diagonal(std::size_t(k), c);
      velocity[c] = inverse_mass[c] * residual_[std::size_t(k) * n + c];
    }
  }

  template <int dim>
  void JoinedMotion<dim>::sight(
      const std::size_t point, std::vector<int> &nodes,
      std::vector<std::array<double, std::size_t(dim) * dim>> &B) const
  {
    const auto &sights = bodies_.matrix().sights_;
    const unsigned int n = unknowns_per_node();
    nodes.clear();
    B.clear();
    for (std::size_t k = sights.first[point]; k < sights.first[point + 1];
         ++k) {
      nodes.push_back(sights.entries[k].block);
      auto &full = B.emplace_back();
      full = {};
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int c = 0; c < n; ++c)
          full[d * dim + c] = sights.entries[k].all[d * n + c];
    }
  }

  template class JoinedMotion<2>;
  template class JoinedMotion<3>;
} // namespace nsfd
