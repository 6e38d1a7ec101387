#include "elastic_node.h"

#include "linear_algebra/small_inverse.h"
#include "nonsmooth/springs.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// of a row: less is left only where closed points hold each other
    constexpr double independent = 1e-10;
    constexpr unsigned int most_changes = 6, most_refinements = 3;

    /** y += factor x, of a multiple of @p lanes numbers. */
    template <std::size_t lanes>
    void add(const double factor, const double *x, double *y,
             const std::size_t n)
    {
      for (std::size_t i = 0; i < n; i += lanes)
        for (std::size_t l = 0; l < lanes; ++l)
          y[i + l] += factor * x[i + l];
    }

    /** F^T P: in the axes of space. */
    template <int dim>
    std::array<double, dim> in_space(const double *frame,
                                     const std::array<double, dim> &P)
    {
      std::array<double, dim> result{};
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          result[c] += frame[r * dim + c] * P[r];
      return result;
    }
  } // namespace

  template <int dim>
  bool ElasticNode<dim>::reinit(const OneStepProblem<dim> &problem,
                                const NodeProblem<dim> &node,
                                const std::vector<double> &beta)
  {
    has_map_ = any_held_ = is_loose_ = false;
    points_.clear();
    loose_.clear();
    if (node.points.size() > most_points ||
        node.inverse_mass.size() > most_points)
      return false;
    const double slope = springs::tangential_spring<dim>(problem, 1.).slope;
    std::vector<std::uint8_t> holds;
    int n_held = 0;
    for (const auto &place : node.points) {
      const std::size_t i = place.point;
      Placed point;
      auto &law = point.own.law;
      if (!law.reinit(problem, i, beta[i]))
        return false;
      if (!law.holds && !law.broken) {
        const double w = problem.weight[i] * problem.time_step * slope;
        point.own.flexibility.fill(1. / (w * law.secant.tangential));
        point.own.flexibility[0] = 1. / (w * law.secant.normal);
      }
      holds.push_back(law.holds);
      if (law.holds)
        point.held = n_held++;
      points_.push_back(point);
    }
    any_held_ = n_held > 0;
    merged_.reinit(node, holds);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Placed &point = points_[k];
      for (unsigned int s = 0; s < 2; ++s)
        point.groups[s] = merged_.of(node.points[k].groups[s]);
      point.is_inside = point.held < 0 && point.groups[0] == point.groups[1];
    }
    is_loose_ = std::all_of(points_.begin(), points_.end(), [](const auto &x) {
      return x.own.law.holds || x.own.law.broken;
    });
    for (std::size_t k = 0; is_loose_ && k < points_.size(); ++k) {
      const std::size_t i = node.points[k].point;
      if (points_[k].held >= 0)
        loose_.add_held(i, points_[k].own.law);
      else
        is_loose_ = loose_.add_broken(problem, i, points_[k].groups);
    }
    return true;
  }

  template <int dim>
  bool ElasticNode<dim>::begin(const OneStepProblem<dim> &problem,
                               const std::vector<std::uint8_t> &closed,
                               const NodeProblem<dim> &node, Step &step) const
  {
    if (!merged_.merge(node.velocity, step.free.data()))
      return false;
    const double slope = springs::tangential_spring<dim>(problem, 1.).slope;
    const double h_theta = problem.time_step * problem.theta;
    for (const auto &velocity : node.velocity)
      for (unsigned int c = 0; c < dim; ++c)
        step.speed = std::max(step.speed, std::abs(velocity[c]));
    double way = 0.;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Placed &point = points_[k];
      const auto &law = point.own.law;
      step.closed[k] = false;
      if (law.holds)
        continue;
      const std::size_t i = node.points[k].point;
      for (unsigned int c = 0; c < dim; ++c) {
        way = std::max(way, std::abs(problem.jump_free[i * dim + c]));
        step.offset[k][c] =
            law.broken ? 0.
                       : springs::tangential_offset<dim>(problem, i, c) / slope;
      }
      step.target[k] = problem.target[i];
      step.closed[k] = law.one_sided && closed[i] != 0;
    }
    step.speed = std::max(step.speed, way / h_theta);
    return true;
  }

  /** Rows of closed points last: of these some may follow from others. @return
      their number, with @p row_of dim times the point plus the direction. */
  template <int dim>
  std::size_t ElasticNode<dim>::number_rows(const Step &step,
                                            std::array<int, most> &row_of)
  {
    std::size_t n = 0;
    for (const bool contact : {false, true})
      for (std::size_t k = 0; k < points_.size(); ++k) {
        Placed &point = points_[k];
        if (!contact) {
          point.rows.fill(-1);
          point.follows = false;
          point.own.closed = step.closed[k];
        }
        if (point.held >= 0 || point.is_inside)
          continue;
        for (unsigned int c = 0; c < dim; ++c) {
          const bool is_contact = c == 0 && step.closed[k];
          if (is_contact != contact || (!is_contact && point.own.law.broken))
            continue;
          if (n < most)
            row_of[n] = int(k * dim + c);
          point.rows[c] = int(n++);
        }
      }
    return n;
  }

  /** The inverse of W + 1/(kappa s), of W alone where a point is closed. */
  template <int dim>
  bool ElasticNode<dim>::set_map(const NodeProblem<dim> &node,
                                 const std::vector<double> &frames,
                                 const Step &step)
  {
    std::array<int, most> row_of;
    const std::size_t n = number_rows(step, row_of);
    if (n > most)
      return false;
    size_ = n;
    stride_ = (n + lanes - 1) / lanes * lanes;
    inverse_.assign(n * stride_, 0.);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = std::size_t(row_of[i]) / dim;
      const unsigned int c = unsigned(row_of[i]) % dim;
      const Placed &one = points_[k];
      const double *normal = &frames[(node.points[k].point * dim + c) * dim];
      for (std::size_t j = 0; j <= i; ++j) {
        const std::size_t l = std::size_t(row_of[j]) / dim;
        const double *other =
            &frames[(node.points[l].point * dim + unsigned(row_of[j]) % dim) *
                    dim];
        double sum = 0.;
        for (unsigned int s = 0; s < 2; ++s)
          for (unsigned int t = 0; t < 2; ++t) {
            const int g = one.groups[s];
            if (g < 0 || g != points_[l].groups[t])
              continue;
            const Vector &inverse = merged_.inverse_mass()[std::size_t(g)];
            double part = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              part += normal[d] * inverse[d] * other[d];
            sum += s == t ? part : -part;
          }
        inverse_[i * stride_ + j] = inverse_[j * stride_ + i] = sum;
      }
      if (c > 0 || !one.own.closed)
        inverse_[i * stride_ + i] += one.own.flexibility[c];
    }
    bool possible = true;
    invert_in_place<most>(
        inverse_.data(), n, stride_, independent, [&](const std::size_t i) {
          Placed &point = points_[std::size_t(row_of[i]) / dim];
          possible = possible && row_of[i] % dim == 0 && point.own.closed;
          point.rows[0] = -1;
          point.follows = true;
        });
    return possible;
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
           springs::normal_spring<dim>(problem, i,
                                       points_[k].own.law.secant.normal)
               .at(velocity);
  }

  /** Those that do not depend on the map: of springs whose motion is known. */
  template <int dim>
  void ElasticNode<dim>::begin_impulses(const OneStepProblem<dim> &problem,
                                        const NodeProblem<dim> &node,
                                        Step &step) const
  {
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Placed &point = points_[k];
      step.impulse[k].fill(0.);
      if (point.follows)
        step.impulse[k][0] = spring_impulse(problem, node, k, step.target[k]);
      if (point.is_inside && !point.own.law.broken)
        for (unsigned int c = 0; c < dim; ++c)
          step.impulse[k][c] =
              c == 0 ? spring_impulse(problem, node, k, 0.)
                     : -step.offset[k][c] / point.own.flexibility[c];
    }
  }

  /** Velocities of the merged groups with the impulses between them. */
  template <int dim>
  void ElasticNode<dim>::move(const NodeProblem<dim> &node,
                              const std::vector<double> &frames,
                              Step &step) const
  {
    const auto &inverse_mass = merged_.inverse_mass();
    std::copy_n(step.free.begin(), merged_.size(), step.moving.begin());
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Placed &point = points_[k];
      if (!point.has_rows() && !point.follows)
        continue;
      const Vector P = in_space<dim>(&frames[node.points[k].point * dim * dim],
                                     step.impulse[k]);
      for (unsigned int s = 0; s < 2; ++s)
        if (const int g = point.groups[s]; g >= 0)
          for (unsigned int c = 0; c < dim; ++c)
            step.moving[std::size_t(g)][c] +=
                (s == 0 ? -P[c] : P[c]) * inverse_mass[std::size_t(g)][c];
    }
  }

  /** Impulses and velocities, refined until round-off is left. */
  template <int dim>
  bool ElasticNode<dim>::solve_map(const NodeProblem<dim> &node,
                                   const std::vector<double> &frames,
                                   Step &step) const
  {
    for (unsigned int round = 0; round <= most_refinements; ++round) {
      Unknowns rest, change;
      std::fill_n(rest.begin(), size_, 0.); // rows that follow from others
      double worst = 0.;
      move(node, frames, step);
      for (std::size_t k = 0; k < points_.size(); ++k) {
        const Placed &point = points_[k];
        Vector &U = step.velocity[k];
        if (point.held >= 0 || point.is_inside) {
          U.fill(0.);
          continue;
        }
        U = jump_velocity<dim>(&frames[node.points[k].point * dim * dim],
                               point.groups, step.moving.data());
        for (unsigned int c = 0; c < dim; ++c) {
          const int row = point.rows[c];
          if (row < 0)
            continue;
          rest[std::size_t(row)] =
              c == 0 && point.own.closed
                  ? step.target[k] - U[0]
                  : -step.offset[k][c] - U[c] -
                        point.own.flexibility[c] * step.impulse[k][c];
          worst = std::max(worst, std::abs(rest[std::size_t(row)]));
        }
      }
      if (!(worst > round_off * step.speed))
        return worst == worst;
      std::fill_n(change.begin(), stride_, 0.);
      for (std::size_t j = 0; j < size_; ++j)
        add<lanes>(rest[j], &inverse_[j * stride_], change.data(), stride_);
      for (std::size_t k = 0; k < points_.size(); ++k)
        for (unsigned int c = 0; c < dim; ++c)
          if (const int row = points_[k].rows[c]; row >= 0)
            step.impulse[k][c] += change[std::size_t(row)];
    }
    return false;
  }

  /** True if the closed points of @p step are those of its solution; else they
      are set. */
  template <int dim>
  auto ElasticNode<dim>::find_closed(const OneStepProblem<dim> &problem,
                                     const NodeProblem<dim> &node, Step &step)
      -> Found
  {
    const double little = round_off * step.speed;
    Found found = Found::yes;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Placed &point = points_[k];
      if (!point.own.law.one_sided)
        continue;
      const double U = step.velocity[k][0], short_by = step.target[k] - U;
      if (point.is_inside || point.follows) {
        // the sum of a few velocities
        if (short_by > 8. * little)
          return Found::impossible;
        const bool closed = short_by >= -8. * little;
        if (point.follows && !closed)
          found = Found::no;
        step.closed[k] = closed;
        if (point.is_inside)
          point.own.closed = closed;
        continue;
      }
      const bool closed =
          point.own.closed
              ? step.impulse[k][0] >=
                    spring_impulse(problem, node, k, step.target[k])
              : short_by > little;
      if (closed != point.own.closed)
        found = Found::no;
      step.closed[k] = closed;
    }
    return found;
  }

  /** What the points that hold carry. */
  template <int dim>
  void ElasticNode<dim>::carry(const NodeProblem<dim> &node,
                               const std::vector<double> &frames,
                               Step &step) const
  {
    for (std::size_t g = 0; g < node.velocity.size(); ++g) {
      step.change[g].fill(0.);
      if (!merged_.is_held(g))
        continue;
      const auto at = std::size_t(merged_.of(int(g)));
      for (unsigned int c = 0; c < dim; ++c)
        step.change[g][c] =
            merged_.mass(g, c) * (step.moving[at][c] - node.velocity[g][c]);
    }
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (points_[k].held >= 0 || step.impulse[k] == Vector{})
        continue;
      const Vector P = in_space<dim>(&frames[node.points[k].point * dim * dim],
                                     step.impulse[k]);
      for (unsigned int s = 0; s < 2; ++s)
        if (const int g = node.points[k].groups[s]; g >= 0)
          for (unsigned int c = 0; c < dim; ++c)
            step.change[std::size_t(g)][c] -= s == 0 ? -P[c] : P[c];
    }
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (points_[k].held < 0)
        continue;
      const Vector P =
          merged_.carried(std::size_t(points_[k].held), step.change.data());
      const double *frame = &frames[node.points[k].point * dim * dim];
      for (unsigned int r = 0; r < dim; ++r) {
        step.impulse[k][r] = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          step.impulse[k][r] += frame[r * dim + c] * P[c];
      }
    }
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
      const auto &law = points_[k].own.law;
      if (points_[k].own.closed && law.rubs)
        return false;
      if (law.holds) {
        if (!law.can_hold(problem, i, step.impulse[k].data()))
          return false;
        continue;
      }
      if (law.broken)
        continue;
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
      if (law.one_sided && !points_[k].own.closed &&
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
    if (!begin(problem, closed, node, step))
      return false;
    for (unsigned int change = 0; change < most_changes; ++change) {
      bool same = has_map_;
      for (std::size_t k = 0; k < points_.size(); ++k)
        same = same && (points_[k].is_inside ||
                        points_[k].own.closed == step.closed[k]);
      if (!same)
        has_map_ = set_map(node, frames, step);
      if (!has_map_)
        return false;
      begin_impulses(problem, node, step);
      if (!solve_map(node, frames, step))
        return false;
      const Found found = find_closed(problem, node, step);
      if (found == Found::impossible)
        return false;
      if (found == Found::no)
        continue;
      if (any_held_)
        carry(node, frames, step);
      const bool elastic = is_elastic(problem, node, step);
      for (std::size_t k = 0; k < points_.size(); ++k)
        std::copy_n(step.impulse[k].begin(), dim,
                    &impulses[node.points[k].point * dim]);
      if (!elastic)
        return false;
      for (std::size_t g = 0; g < node.velocity.size(); ++g)
        node.velocity[g] = step.moving[std::size_t(merged_.of(int(g)))];
      for (std::size_t k = 0; k < points_.size(); ++k)
        std::copy_n(step.velocity[k].begin(), dim,
                    &velocities[node.points[k].point * dim]);
      return true;
    }
    return false;
  }

  template class ElasticNode<2>;
  template class ElasticNode<3>;
} // namespace nsfd
