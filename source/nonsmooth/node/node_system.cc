#include "node_system.h"

#include "core/mix_bits.h"
#include "near_solution.h"
#include "nonsmooth/local_problem.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    template <int dim>
    Reach history(const OneStepProblem<dim> &problem, const std::size_t index)
    {
      return {problem.opening_max[index],
              problem.slip_max.empty() ? 0. : problem.slip_max[index]};
    }
  } // namespace

  template <int dim>
  void NodeSystem<dim>::reinit(const OneStepProblem<dim> &problem,
                               const std::vector<double> &frames,
                               const NodeProblem<dim> &node,
                               std::vector<double> &impulses,
                               std::vector<LocalSolution<dim>> &solutions)
  {
    problem_ = &problem;
    inverse_mass_ = &node.inverse_mass;
    n_ = 0;
    soft_ = 0.;
    free_ = node.velocity;
    velocity_ = node.velocity;
    floor_ = 0.;
    for (const auto &point : node.points) {
      const std::size_t i = point.point;
      if (problem.kind[i] == PointKind::free && !problem.contact[i]) {
        std::fill_n(&impulses[i * dim], dim, 0.);
        solutions[i] = {};
        continue;
      }
      add(point, frames);
      std::copy_n(&impulses[i * dim], dim, points_[n_ - 1].impulse.begin());
    }
    floor_ = std::sqrt(floor_);
    for (std::size_t k = 0; k < n_; ++k)
      push(points_[k], points_[k].impulse, velocity_);
  }

  template <int dim>
  void NodeSystem<dim>::add(const typename NodeProblem<dim>::Point &point,
                            const std::vector<double> &frames)
  {
    const std::size_t i = point.point;
    if (n_ == points_.size())
      points_.emplace_back();
    Point &added = points_[n_++];
    added.index = i;
    added.frame = &frames[i * dim * dim];
    added.groups = point.groups;
    added.ends = point.ends;
    added.start = point.start;
    added.solution.reach = history(*problem_, i);
    added.solution.damages = false;
    Vector sum{};
    double speed = 0.;
    for_ends(point.groups, point.ends, [&](const int g, const double share) {
      for (unsigned int c = 0; c < dim; ++c) {
        sum[c] += share * share * (*inverse_mass_)[g][c];
        speed += std::abs(free_[g][c]);
      }
    });
    Vector beside{}; // what is not on the diagonal of W
    for_matrices(point.ends, [&](const int g, const double *B) {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d) {
          sum[c] += B[c * dim + d] * B[c * dim + d] * (*inverse_mass_)[g][d];
          speed += std::abs(B[c * dim + d] * free_[g][d]);
          for (unsigned int e = 0; e < dim; ++e)
            if (e != c)
              beside[c] += std::abs(B[c * dim + d] * B[e * dim + d]) *
                           (*inverse_mass_)[g][d];
        }
    });
    for (const double U : point.start)
      speed += std::abs(U);
    // springs compute velocities from jumps
    if (problem_->kind[i] != PointKind::free)
      for (unsigned int c = 0; c < dim; ++c)
        speed += std::abs(problem_->jump_free[i * dim + c]) /
                 (problem_->time_step * problem_->theta);
    added.speed = speed;
    const auto range = std::minmax_element(sum.begin(), sum.end());
    added.R = *range.second;
    added.scalar = *range.first == added.R && added.R > 0.;
    if (point.ends && point.ends->n_matrices > 0) {
      added.scalar = false;
      for (unsigned int c = 0; c < dim; ++c)
        added.R = std::max(added.R, sum[c] + beside[c]);
    }
    if (added.R == 0.) // prescribed on both sides: any number serves
      for (const auto &group : *inverse_mass_)
        added.R =
            std::max(added.R, *std::max_element(group.begin(), group.end()));
    if (added.R == 0.)
      added.R = 1.;
    floor_ += 1.6e-5 * speed * speed / added.R;
  }

  /** v += M^-1 H^T P */
  template <int dim>
  void NodeSystem<dim>::push(const Point &point, const Vector &impulse,
                             std::vector<Vector> &velocity) const
  {
    push_groups<dim>(point.frame, point.groups, impulse.data(), *inverse_mass_,
                     velocity, point.ends);
  }

  template <int dim>
  void NodeSystem<dim>::answer(Point &point, const bool near_first) const
  {
    Vector U = relative_velocity<dim>(point.frame, point.groups, velocity_,
                                      point.ends);
    for (unsigned int c = 0; c < dim; ++c)
      U[c] += point.start[c];
    for (unsigned int c = 0; c < dim; ++c)
      point.local[c] =
          U[c] - point.R * (point.impulse[c] -
                            soft_ * (point.impulse[c] - point.rest[c]));
    LocalSolution<dim> &solution = point.solution;
    const std::size_t i = point.index;
    point.carries = problem_->kind[i] != PointKind::free ||
                    point.local[0] < problem_->target[i];
    if (!point.carries) {
      const Reach reach = solution.reach;
      solution = {};
      solution.reach = reach;
      solution.velocity = point.local;
      return;
    }
    if (near_first && problem_->kind[i] != PointKind::free &&
        solve_near<dim>(*problem_, i, point.local, point.R,
                        solution.damages
                            ? solution.reach
                            : local::end_reach<dim>(*problem_, i, U),
                        solution))
      return;
    solution = solve_point<dim>(*problem_, i, point.local, point.R, point.R,
                                solution.reach);
  }

  template <int dim>
  void NodeSystem<dim>::solve_single()
  {
    Point &point = points_[0];
    velocity_ = free_;
    point.impulse.fill(0.);
    answer(point, false); // the same bits as solve_point()
    point.impulse = point.solution.impulse;
  }

  template <int dim>
  double NodeSystem<dim>::evaluate()
  {
    double error = 0., size = floor_ * floor_;
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      answer(point);
      for (unsigned int c = 0; c < dim; ++c) {
        const double P = point.impulse[c], d = point.solution.impulse[c] - P;
        error += point.R * d * d;
        size += point.R * P * P;
      }
    }
    scale_ = std::sqrt(size);
    return std::sqrt(error);
  }

  template <int dim>
  double NodeSystem<dim>::sweep()
  {
    double error = 0., size = floor_ * floor_;
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      answer(point);
      Vector change;
      for (unsigned int c = 0; c < dim; ++c) {
        const double P = point.solution.impulse[c];
        change[c] = P - point.impulse[c];
        error += point.R * change[c] * change[c];
        size += point.R * P * P;
      }
      point.impulse = point.solution.impulse;
      push(point, change, velocity_);
    }
    scale_ = std::sqrt(size);
    return std::sqrt(error);
  }

  template <int dim>
  void NodeSystem<dim>::move(const double length)
  {
    const Kept &start = kept_[0];
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      point.solution.reach = start.points[k].solution.reach;
      point.solution.damages = start.points[k].solution.damages;
      for (unsigned int c = 0; c < dim; ++c)
        point.impulse[c] =
            start.points[k].impulse[c] + length * point.direction[c];
    }
    for (std::size_t g = 0; g < velocity_.size(); ++g)
      for (unsigned int c = 0; c < dim; ++c)
        velocity_[g][c] = start.velocity[g][c] + length * change_[g][c];
  }

  template <int dim>
  void NodeSystem<dim>::keep(const unsigned int slot)
  {
    Kept &kept = kept_[slot];
    kept.points.resize(std::max(n_, kept.points.size()));
    std::copy_n(points_.begin(), n_, kept.points.begin());
    kept.velocity = velocity_;
    kept.scale = scale_;
  }

  template <int dim>
  void NodeSystem<dim>::restore(const unsigned int slot)
  {
    const Kept &kept = kept_[slot];
    for (std::size_t k = 0; k < n_; ++k)
      static_cast<State &>(points_[k]) = kept.points[k];
    velocity_ = kept.velocity;
    scale_ = kept.scale;
  }

  template <int dim>
  void NodeSystem<dim>::scatter(std::uint64_t seed, const double spread)
  {
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      for (double &P : point.impulse) {
        seed = mixed(seed);
        P *= spread * double(seed >> 11) * 0x1p-53;
      }
      point.solution.reach = history(*problem_, point.index);
      point.solution.damages = false;
    }
    refresh_velocity();
  }

  template <int dim>
  void NodeSystem<dim>::scale_majorant(const double factor)
  {
    for (std::size_t k = 0; k < n_; ++k)
      points_[k].R *= factor;
    floor_ /= std::sqrt(factor);
  }

  template <int dim>
  void NodeSystem<dim>::soften(const double share, const bool from_here)
  {
    soft_ = share;
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      if (from_here)
        point.rest = point.impulse;
      else
        point.rest.fill(0.);
    }
  }

  template <int dim>
  void NodeSystem<dim>::refresh_velocity()
  {
    velocity_ = free_;
    for (std::size_t k = 0; k < n_; ++k)
      push(points_[k], points_[k].impulse, velocity_);
  }

  /**
   * At the strength beside points that hold, a point opens by round-off. To
   * give it a history would leave a nearly rigid spring behind.
   */
  template <int dim>
  bool NodeSystem<dim>::held_by_round_off(const Point &point) const
  {
    if (problem_->kind[point.index] != PointKind::rigid ||
        !point.solution.damages)
      return false;
    double speed = point.speed;
    for (const double P : point.impulse)
      speed += point.R * std::abs(P);
    return point.solution.reach.opening <=
           1e-12 * problem_->time_step * problem_->theta * speed;
  }

  template <int dim>
  void NodeSystem<dim>::store(const bool exact, NodeProblem<dim> &node,
                              std::vector<double> &impulses,
                              std::vector<LocalSolution<dim>> &solutions)
  {
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      LocalSolution<dim> &solution = point.solution;
      if (held_by_round_off(point)) {
        solution = {};
        solution.impulse = point.impulse;
        solution.frozen.secant = Secant::rigid();
        solution.status = PointStatus::prescribed;
      }
      for (unsigned int c = 0; c < dim; ++c) {
        double &P = point.impulse[c];
        if (exact || solution.impulse[c] == 0.)
          P = solution.impulse[c];
        impulses[point.index * dim + c] = P;
      }
      solutions[point.index] = solution;
    }
    refresh_velocity();
    node.velocity = velocity_;
  }

  template class NodeSystem<2>;
  template class NodeSystem<3>;
} // namespace nsfd
