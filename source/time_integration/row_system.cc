#include "row_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  void RowSystem<dim>::set(const std::vector<double> &D)
  {
    D_ = D;
    empty_ = !delassus_.communicator().any(std::any_of(
        D.begin(), D.end(), [](const double d) { return d >= 0.; }));
    if (!empty_)
      delassus_.prepare_preconditioner(D_);
    for (auto *vector : {&vectors_.r, &vectors_.z, &vectors_.p, &vectors_.q})
      vector->assign(D.size(), 0.);
  }

  template <int dim>
  void RowSystem<dim>::apply(const std::vector<double> &P,
                             std::vector<double> &U) const
  {
    delassus_.apply_delassus(P.data(), U.data());
    for (std::size_t k = 0; k < D_.size(); ++k)
      U[k] = D_[k] >= 0. ? U[k] + D_[k] * P[k] : 0.;
  }

  template <int dim>
  unsigned int RowSystem<dim>::solve(const std::vector<double> &b,
                                     const double goal, std::vector<double> &P)
  {
    const auto &communicator = delassus_.communicator();
    const auto dot = [&](const std::vector<double> &x,
                         const std::vector<double> &y) {
      return communicator.dot(x.data(), y.data(), n_owned_);
    };
    apply(P, vectors_.q);
    for (std::size_t k = 0; k < D_.size(); ++k)
      vectors_.r[k] = D_[k] >= 0. ? b[k] - vectors_.q[k] : 0.;
    const auto product = [&](const std::vector<double> &x,
                             std::vector<double> &y) { apply(x, y); };
    const auto precondition = [&](const std::vector<double> &r,
                                  std::vector<double> &z) {
      delassus_.precondition(r.data(), z.data());
    };
    double best = std::numeric_limits<double>::infinity();
    unsigned int stalled = 0;
    const auto is_solved = [&] {
      const double norm = std::sqrt(dot(vectors_.r, vectors_.r));
      stalled = norm < 0.99 * best ? 0 : stalled + 1;
      best = std::min(best, norm);
      return !(best > goal) || stalled >= 100;
    };
    const unsigned int most = 10000; // round-off stalls it long before
    return krylov::conjugate_gradients(product, precondition, dot, is_solved,
                                       {0., most}, vectors_, P)
        .iterations;
  }

  template class RowSystem<2>;
  template class RowSystem<3>;
} // namespace nsfd
