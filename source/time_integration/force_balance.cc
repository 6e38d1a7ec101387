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
    std::vector<double> terms(2 * n_owned, 0.);
    for (std::size_t i = 0; i < n_owned; ++i) {
      for (unsigned int c = 0; c < dim; ++c)
        terms[i] += force[i * dim + c] * force[i * dim + c] / support[i];
      terms[n_owned + i] = support[i];
    }
    const auto sums = communicator.sums(terms.data(), 2, n_owned);
    point_scale_ = std::max(point_scale_, sums[0]);
    point_round_off_ = share * share * sums[1];
    const auto [present, stiffness] = forces_present(q, force, diagonal);
    present_ = std::max(present_, present);
    round_off_ = share * stiffness;
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

  /** The largest of |K q|, |F| and |H^T r|, N, and |other|. */
  template <int dim>
  std::pair<double, double>
  ForceBalance<dim>::forces_present(const std::vector<double> &q,
                                    const std::vector<double> &force,
                                    const std::vector<double> &other) const
  {
    const std::size_t n = q.size();
    std::vector<double> terms(4 * n);
    const auto square = [n](const double *x, double *result) {
      for (std::size_t k = 0; k < n; ++k)
        result[k] = x[k] * x[k];
    };
    std::vector<double> forces(n);
    delassus_.apply(DelassusOperator<dim>::Operator::stiffness, q.data(),
                    forces.data());
    square(forces.data(), &terms[0]);
    square(free_motion_.loads().data(), &terms[n]);
    delassus_.generalised_impulse(force.data(), forces.data());
    square(forces.data(), &terms[2 * n]);
    square(other.data(), &terms[3 * n]);
    const auto sums = delassus_.communicator().sums(terms.data(), 4, n);
    return {std::sqrt(std::max({sums[0], sums[1], sums[2]})),
            std::sqrt(sums[3])};
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
    residual_ = std::move(residual);
    const auto [forces, left] = forces_present(q, force, residual_);
    const double present = std::max({present_, round_off_, forces});
    imbalance_ = left == 0. ? 0. : left / present;
  }

  template class ForceBalance<2>;
  template class ForceBalance<3>;
} // namespace nsfd
