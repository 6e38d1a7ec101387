#include "elastic_node.h"

#include "nonsmooth/damage.h"
#include "nonsmooth/springs.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// of velocities, over the size of those that they are differences of
    constexpr double round_off = 4e-15;
    constexpr unsigned int most_changes = 6, most_refinements = 3;
    /// of W beside points that hold: in a cycle they share what they hold
    constexpr double softening = 1e-10;

    /** Below the history the law is a spring through the origin. */
    template <int dim>
    bool is_spring(const PointDamage<dim> &damage, const Secant &secant,
                   const double largest)
    {
      for (unsigned int c = 0; c < 2; ++c) {
        double u[dim] = {};
        u[c] = 0.5 * largest;
        const double k = c == 0 ? secant.normal : secant.tangential;
        const Secant here = damage.secant(damage.reach(u));
        const double energy = k * u[c] * u[c] / 2.;
        if (!(std::abs(damage.stored(damage.history(), u) - energy) <=
              1e-13 * energy) ||
            !(std::abs(here.normal - secant.normal) <= 1e-13 * secant.normal) ||
            !(std::abs(here.tangential - secant.tangential) <=
              1e-13 * secant.tangential))
          return false;
      }
      return true;
    }
  } // namespace

  template <int dim>
  bool ElasticPoint<dim>::reinit(const OneStepProblem<dim> &problem,
                                 const std::size_t i, const double present_beta)
  {
    const PointKind kind = problem.kind[i];
    const auto &interaction = problem.interactions[problem.interaction[i]];
    if (problem.rule == CohesionRule::end_velocity || problem.mask[i] != 0 ||
        (!problem.viscosity.empty() && problem.viscosity[i] > 0.))
      return false;
    beta = present_beta;
    one_sided = problem.compression_stiffness[i] == 0.;
    broken = kind == PointKind::free;
    if (broken) {
      largest = springs::infinity;
      return one_sided;
    }
    holds = kind == PointKind::rigid;
    if (holds) {
      one_sided = false;
      largest = springs::infinity;
      return true;
    }
    if (kind == PointKind::elastic) {
      const double k = interaction.normal_stiffness;
      secant = {k, k * interaction.stiffness_ratio};
      largest = springs::infinity;
    } else if (kind == PointKind::cohesive && !interaction.law->mixed() &&
               !interaction.plateau && problem.opening_max[i] > 0.) {
      const PointDamage<dim> damage(problem, i);
      secant = damage.secant({});
      if (!is_spring(damage, secant, problem.opening_max[i]))
        return false;
      largest = springs::square(problem.opening_max[i]);
    } else
      return false;
    const double compression = problem.compression_stiffness[i];
    rubs = interaction.friction > 0. &&
           (beta < 1. || interaction.friction_exponent == 0.);
    return secant.normal > 0. && secant.tangential > 0. &&
           (one_sided ||
            std::abs(compression - secant.normal) <= 1e-13 * secant.normal);
  }

  template <int dim>
  auto ElasticPoint<dim>::energies(const OneStepProblem<dim> &problem,
                                   const std::size_t i,
                                   const double *velocity) const -> Energies
  {
    Energies result;
    const double h_theta = problem.time_step * problem.theta;
    const double *before = &problem.jump_old[i * dim],
                 *end = &problem.jump_free[i * dim];
    std::array<double, 2> square;
    for (unsigned int k = 0; k < 2; ++k) {
      double slip = 0.,
             u_N = k == 0 ? before[0] : end[0] + h_theta * velocity[0];
      if (one_sided)
        u_N = springs::positive(u_N);
      for (unsigned int c = 1; c < dim; ++c)
        slip += springs::square(k == 0 ? before[c]
                                       : end[c] + h_theta * velocity[c]);
      square[k] = secant.normal * u_N * u_N + secant.tangential * slip;
    }
    result.stored_old = square[0] / 2.;
    result.stored = square[1] / 2.;
    result.traction[0] =
        springs::normal_spring<dim>(problem, i, secant.normal).at(velocity[0]);
    const auto spring =
        springs::tangential_spring<dim>(problem, secant.tangential);
    for (unsigned int c = 1; c < dim; ++c)
      result.traction[c] =
          spring.stiffness * (springs::tangential_offset<dim>(problem, i, c) +
                              spring.slope * velocity[c]);
    return result;
  }

  namespace
  {
    /** y += factor x, of a multiple of @p lanes numbers. */
    template <std::size_t lanes>
    void add(const double factor, const double *x, double *y,
             const std::size_t n)
    {
      for (std::size_t i = 0; i < n; i += lanes)
        for (std::size_t l = 0; l < lanes; ++l)
          y[i + l] += factor * x[i + l];
    }
  } // namespace

  template <int dim>
  bool ElasticNode<dim>::reinit(const OneStepProblem<dim> &problem,
                                const std::vector<double> &frames,
                                const NodeProblem<dim> &node,
                                const std::vector<double> &beta)
  {
    has_map_ = false;
    points_.clear();
    if (node.points.size() > most_points)
      return false;
    std::size_t n = 0;
    const double slope = springs::tangential_spring<dim>(problem, 1.).slope;
    for (const auto &place : node.points) {
      const std::size_t i = place.point;
      Point point;
      if (!point.law.reinit(problem, i, beta[i]))
        return false;
      if (!point.law.holds && !point.law.broken) {
        const double w = problem.weight[i] * problem.time_step * slope;
        point.flexibility.fill(1. / (w * point.law.secant.tangential));
        point.flexibility[0] = 1. / (w * point.law.secant.normal);
      }
      if (!point.law.broken) {
        point.first = unsigned(n);
        n += dim;
      }
      points_.push_back(point);
    }
    return n <= most && set_open_map(n, node, frames);
  }

  template <int dim>
  void ElasticNode<dim>::begin(const OneStepProblem<dim> &problem,
                               const std::vector<double> &frames,
                               const std::vector<std::uint8_t> &closed,
                               const NodeProblem<dim> &node, Step &step) const
  {
    const double slope = springs::tangential_spring<dim>(problem, 1.).slope;
    const double h_theta = problem.time_step * problem.theta;
    for (const auto &velocity : node.velocity)
      for (unsigned int c = 0; c < dim; ++c)
        step.speed = std::max(step.speed, std::abs(velocity[c]));
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const auto &place = node.points[k];
      const std::size_t i = place.point;
      step.free[k] = relative_velocity<dim>(&frames[i * dim * dim],
                                            place.groups, node.velocity);
      for (unsigned int c = 0; c < dim; ++c)
        step.offset[k][c] =
            springs::tangential_offset<dim>(problem, i, c) / slope;
      for (unsigned int c = 0; c < dim; ++c)
        step.speed = std::max(
            step.speed, std::abs(problem.jump_free[i * dim + c]) / h_theta);
      if (points_[k].law.holds)
        step.offset[k].fill(0.);
      step.target[k] = problem.target[i];
      step.closed[k] = points_[k].law.one_sided && closed[i] != 0;
    }
  }

  /** With all points open: (W + 1/(kappa s)) P = -y_0/s - U_free. */
  template <int dim>
  bool ElasticNode<dim>::set_open_map(const std::size_t n,
                                      const NodeProblem<dim> &node,
                                      const std::vector<double> &frames)
  {
    lu_.reinit(int(n));
    for (std::size_t l = 0; l < points_.size(); ++l)
      for (unsigned int d = 0; d < dim && !points_[l].law.broken; ++d) {
        double P[dim] = {};
        P[d] = 1.;
        velocity_.assign(node.velocity.size(), {});
        const auto &place = node.points[l];
        push_groups<dim>(&frames[place.point * dim * dim], place.groups, P,
                         node.inverse_mass, velocity_);
        const std::size_t column = points_[l].first + d;
        for (std::size_t k = 0; k < points_.size(); ++k) {
          if (points_[k].law.broken)
            continue;
          const Vector U =
              relative_velocity<dim>(&frames[node.points[k].point * dim * dim],
                                     node.points[k].groups, velocity_);
          for (unsigned int c = 0; c < dim; ++c)
            lu_.row(int(points_[k].first + c))[column] = U[c];
        }
        double &diagonal = lu_.row(int(column))[column];
        diagonal += points_[l].law.holds ? softening * diagonal
                                         : points_[l].flexibility[d];
      }
    if (!lu_.factorise())
      return false;
    size_ = n;
    stride_ = (n + lanes - 1) / lanes * lanes;
    open_.assign(n * stride_, 0.);
    for (std::size_t j = 0; j < n; ++j) {
      open_[j * stride_ + j] = 1.;
      lu_.solve(&open_[j * stride_]);
    }
    return true;
  }

  /**
   * W P = target - U_free where points are closed: each takes its flexibility
   * from the diagonal, always from the same map and in the same order, so that
   * nothing depends on the steps before.
   */
  template <int dim>
  bool ElasticNode<dim>::set_map(const Step &step)
  {
    inverse_ = open_;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      points_[k].closed = step.closed[k];
      if (!step.closed[k])
        continue;
      const std::size_t j = points_[k].first;
      const double share = points_[k].flexibility[0];
      const double left =
          points_[k].law.broken ? 0. : 1. - share * inverse_[j * stride_ + j];
      if (!(left > 1e-12))
        return false; // closed points hold each other
      Unknowns column;
      std::copy_n(&inverse_[j * stride_], stride_, column.begin());
      for (std::size_t l = 0; l < size_; ++l)
        add<lanes>(share / left * inverse_[l * stride_ + j], column.data(),
                   &inverse_[l * stride_], stride_);
    }
    return true;
  }

  /** Impulses and velocities, refined until round-off is left. */
  template <int dim>
  bool ElasticNode<dim>::solve_map(const NodeProblem<dim> &node,
                                   const std::vector<double> &frames,
                                   Step &step)
  {
    std::fill_n(step.impulse.begin(), stride_, 0.);
    std::copy_n(step.free.begin(), points_.size(), step.velocity.begin());
    velocity_ = node.velocity;
    for (unsigned int round = 0; round <= most_refinements; ++round) {
      Unknowns rest;
      double worst = 0.;
      for (std::size_t k = 0; k < points_.size(); ++k)
        for (unsigned int c = 0; c < dim && !points_[k].law.broken; ++c) {
          const std::size_t j = points_[k].first + c;
          rest[j] = c == 0 && points_[k].closed
                        ? step.target[k] - step.velocity[k][0]
                        : -step.offset[k][c] - step.velocity[k][c] -
                              points_[k].flexibility[c] * step.impulse[j];
          worst = std::max(worst, std::abs(rest[j]));
        }
      if (!(worst > round_off * step.speed))
        return worst == worst;
      for (std::size_t j = 0; j < size_; ++j)
        add<lanes>(rest[j], &inverse_[j * stride_], step.impulse.data(),
                   stride_);
      velocity_ = node.velocity;
      for (std::size_t k = 0; k < points_.size(); ++k)
        if (!points_[k].law.broken)
          push_groups<dim>(
              &frames[node.points[k].point * dim * dim], node.points[k].groups,
              &step.impulse[points_[k].first], node.inverse_mass, velocity_);
      for (std::size_t k = 0; k < points_.size(); ++k)
        step.velocity[k] =
            relative_velocity<dim>(&frames[node.points[k].point * dim * dim],
                                   node.points[k].groups, velocity_);
    }
    return false;
  }

  /** What the normal spring of point @p k does in the step. */
  template <int dim>
  double ElasticNode<dim>::spring_impulse(const OneStepProblem<dim> &problem,
                                          const NodeProblem<dim> &node,
                                          const std::size_t k,
                                          const double velocity) const
  {
    const std::size_t i = node.points[k].point;
    return -problem.weight[i] * problem.time_step *
           springs::normal_spring<dim>(problem, i, points_[k].law.secant.normal)
               .at(velocity);
  }

  /** True if the closed points of @p step are those of its solution; else they
      are set. */
  template <int dim>
  bool ElasticNode<dim>::find_closed(const OneStepProblem<dim> &problem,
                                     const NodeProblem<dim> &node,
                                     Step &step) const
  {
    bool found = true;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (!points_[k].law.one_sided)
        continue;
      const double U = step.velocity[k][0];
      const bool closed =
          points_[k].closed
              ? step.impulse[points_[k].first] >=
                    spring_impulse(problem, node, k, step.target[k])
              : U < step.target[k] - round_off * step.speed;
      found = found && closed == points_[k].closed;
      step.closed[k] = closed;
    }
    return found;
  }

  template <int dim>
  bool ElasticNode<dim>::can_hold(const OneStepProblem<dim> &problem,
                                  const std::size_t i,
                                  const double *impulse) const
  {
    std::array<double, dim> pull;
    for (unsigned int c = 0; c < dim; ++c)
      pull[c] = -impulse[c];
    return effective_traction<dim>(problem, i, pull[0], &pull[1]) <=
           point_strength<dim>(problem, i) * problem.weight[i] *
               problem.time_step;
  }

  /** No point is open beyond its history, or rubs, or has come from an overlap,
      where the rule is no spring. */
  template <int dim>
  bool ElasticNode<dim>::is_elastic(const OneStepProblem<dim> &problem,
                                    const NodeProblem<dim> &node,
                                    const Step &step) const
  {
    const double h_theta = problem.time_step * problem.theta;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const std::size_t i = node.points[k].point;
      const auto &law = points_[k].law;
      if (points_[k].closed && law.rubs)
        return false;
      if (law.holds) {
        if (!can_hold(problem, i, &step.impulse[points_[k].first]))
          return false;
        continue;
      }
      std::array<double, dim> u;
      for (unsigned int c = 0; c < dim; ++c)
        u[c] = problem.jump_free[i * dim + c] + h_theta * step.velocity[k][c];
      double square = springs::square(springs::positive(u[0])), slip = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        slip += u[c] * u[c];
      square +=
          problem.interactions[problem.interaction[i]].shear_weight * slip;
      if (!(square <= law.largest))
        return false;
      if (law.one_sided && !law.broken && !points_[k].closed &&
          problem.jump_old[i * dim] < -round_off * step.speed * h_theta)
        return false;
    }
    return true;
  }

  template <int dim>
  bool ElasticNode<dim>::solve(const OneStepProblem<dim> &problem,
                               const std::vector<double> &frames,
                               const std::vector<std::uint8_t> &closed,
                               NodeProblem<dim> &node,
                               std::vector<double> &impulses,
                               std::vector<double> &velocities)
  {
    Step step;
    begin(problem, frames, closed, node, step);
    for (unsigned int change = 0; change < most_changes; ++change) {
      bool same = has_map_;
      for (std::size_t k = 0; k < points_.size(); ++k)
        same = same && points_[k].closed == step.closed[k];
      if (!same)
        has_map_ = set_map(step);
      if (!has_map_ || !solve_map(node, frames, step))
        return false;
      if (!find_closed(problem, node, step))
        continue;
      if (!is_elastic(problem, node, step))
        return false;
      node.velocity = velocity_;
      for (std::size_t k = 0; k < points_.size(); ++k)
        for (unsigned int c = 0; c < dim; ++c) {
          const std::size_t i = node.points[k].point * dim + c;
          impulses[i] =
              points_[k].law.broken ? 0. : step.impulse[points_[k].first + c];
          velocities[i] = step.velocity[k][c];
        }
      return true;
    }
    return false;
  }

  template struct ElasticPoint<2>;
  template struct ElasticPoint<3>;
  template class ElasticNode<2>;
  template class ElasticNode<3>;
} // namespace nsfd
