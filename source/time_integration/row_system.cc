#include "row_system.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  void RowSystem<dim>::set(const std::vector<double> &D)
  {
    D_ = D;
    empty_ = !dynamics_.communicator().any(std::any_of(
        D.begin(), D.end(), [](const double d) { return d >= 0.; }));
    if (!empty_)
      dynamics_.prepare_preconditioner(D_);
    for (auto *vector : {&r_, &z_, &p_, &Wp_})
      vector->assign(D.size(), 0.);
  }

  template <int dim>
  void RowSystem<dim>::apply(const std::vector<double> &P,
                             std::vector<double> &U) const
  {
    dynamics_.apply_delassus(P.data(), U.data());
    for (std::size_t k = 0; k < D_.size(); ++k)
      U[k] = D_[k] >= 0. ? U[k] + D_[k] * P[k] : 0.;
  }

  template <int dim>
  unsigned int RowSystem<dim>::solve(const std::vector<double> &b,
                                     const double goal, std::vector<double> &P)
  {
    const auto &communicator = dynamics_.communicator();
    const std::size_t n = D_.size();
    const auto dot = [&](const std::vector<double> &x,
                         const std::vector<double> &y) {
      return communicator.dot(x.data(), y.data(), n_owned_);
    };
    apply(P, Wp_);
    for (std::size_t k = 0; k < n; ++k)
      r_[k] = D_[k] >= 0. ? b[k] - Wp_[k] : 0.;
    unsigned int iterations = 0;
    double rz = 0.;
    const unsigned int most = 10000; // round-off stalls it long before
    double best = std::sqrt(dot(r_, r_));
    for (unsigned int stalled = 0;
         best > goal && iterations < most && stalled < 100;) {
      dynamics_.precondition(r_.data(), z_.data());
      const double next = dot(r_, z_);
      for (std::size_t k = 0; k < n; ++k)
        p_[k] = z_[k] + (iterations > 0 ? next / rz : 0.) * p_[k];
      rz = next;
      apply(p_, Wp_);
      const double pWp = dot(p_, Wp_);
      if (!(pWp > 0.))
        break;
      for (std::size_t k = 0; k < n; ++k) {
        P[k] += rz / pWp * p_[k];
        r_[k] -= rz / pWp * Wp_[k];
      }
      ++iterations;
      const double norm = std::sqrt(dot(r_, r_));
      stalled = norm < 0.99 * best ? 0 : stalled + 1;
      best = std::min(best, norm);
    }
    return iterations;
  }

  template class RowSystem<2>;
  template class RowSystem<3>;
} // namespace nsfd
