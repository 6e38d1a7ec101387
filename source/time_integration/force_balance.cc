#include "force_balance.h"

#include "nsfd/core/archive.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  void ForceBalance<dim>::begin(const std::vector<double> &q,
                                const std::vector<double> &force,
                                const std::vector<double> &support,
                                const std::size_t n_owned, double largest,
                                const double tolerance)
  {
    const auto &communicator = delassus_.communicator();
    const auto &bodies = delassus_.bodies();
    for (const double value : q)
      largest = std::max(largest, std::abs(value));
    // some bits of K q, seen from the goal
    const double share = 1e-14 / tolerance * communicator.max(largest);
    std::vector<double> diagonal(bodies.n_dofs(), 0.);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const BodyClass &body = bodies.classes[bodies.class_of[b]];
      for (unsigned int k = 0; k < body.n_dofs && !body.rigid; ++k)
        diagonal[bodies.first_dof[b] + k] = body.stiffness(k, k);
    }
    round_off_ =
        share * std::sqrt(communicator.dot(diagonal.data(), diagonal.data(),
                                           bodies.n_dofs()));
    std::vector<double> terms(n_owned, 0.), supports = terms;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      supports[i] = support[i];
      for (unsigned int c = 0; c < dim; ++c)
        terms[i] += force[i * dim + c] * force[i * dim + c] / support[i];
    }
    point_round_off_ = share * share * communicator.sum(supports);
    point_scale_ = std::max(point_scale_, communicator.sum(terms));
    present_ = std::max(present_, forces_present(q, force));
  }

  template <int dim>
  double ForceBalance<dim>::point_scale() const
  {
    return std::max(point_scale_, point_round_off_);
  }

  template <int dim>
  void ForceBalance<dim>::serialize(Archive &archive)
  {
    archive.numbers("largest_forces", point_scale_, present_);
  }

  /** The largest of |K q|, |F| and |H^T r|, N. */
  template <int dim>
  double
  ForceBalance<dim>::forces_present(const std::vector<double> &q,
                                    const std::vector<double> &force) const
  {
    const auto &delassus = delassus_;
    const std::size_t n = q.size();
    const auto norm = [&](const std::vector<double> &x) {
      return std::sqrt(delassus.communicator().dot(x.data(), x.data(), n));
    };
    std::vector<double> forces(n);
    delassus.apply(DelassusOperator<dim>::Operator::stiffness, q.data(),
                   forces.data());
    double present = std::max(norm(forces), norm(free_motion_.loads()));
    delassus.generalised_impulse(force.data(), forces.data());
    return std::max(present, norm(forces));
  }

  template <int dim>
  std::vector<double>
  ForceBalance<dim>::left_over(const double h,
                               const std::vector<double> &velocity) const
  {
    std::vector<double> result(velocity.size());
    delassus_.apply(DelassusOperator<dim>::Operator::mass, velocity.data(),
                    result.data());
    for (double &value : result)
      value /= h;
    return result;
  }

  template <int dim>
  void ForceBalance<dim>::measure(const std::vector<double> &q,
                                  std::vector<double> residual,
                                  const std::vector<double> &force)
  {
    const auto &communicator = delassus_.communicator();
    const std::size_t n = q.size();
    residual_ = std::move(residual);
    const double left =
        std::sqrt(communicator.dot(residual_.data(), residual_.data(), n));
    const double present =
        std::max({present_, round_off_, forces_present(q, force)});
    imbalance_ = left == 0. ? 0. : left / present;
  }

  template class ForceBalance<2>;
  template class ForceBalance<3>;
} // namespace nsfd
