#include "loose_node.h"

#include "elastic_node.h"
#include "nonsmooth/springs.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  void LooseNode<dim>::clear()
  {
    held_.clear();
    broken_.clear();
  }

  template <int dim>
  void LooseNode<dim>::add_held(const std::size_t index,
                                const ElasticPoint<dim> &law)
  {
    held_.push_back({unsigned(index), law.surely_held});
  }

  template <int dim>
  bool LooseNode<dim>::add_broken(const OneStepProblem<dim> &problem,
                                  const std::size_t index,
                                  const std::array<int, 2> &groups)
  {
    broken_.push_back({unsigned(index), groups});
    return problem.interactions[problem.interaction[index]].restitution == 0.;
  }

  /** Impulses of what holds, below the strength. */
  template <int dim>
  bool LooseNode<dim>::carry(const std::vector<double> &frames,
                             const MergedGroups<dim> &merged,
                             const NodeProblem<dim> &node, const Vector *moving,
                             std::vector<double> &impulses) const
  {
    std::array<Vector, MergedGroups<dim>::most> change;
    for (std::size_t g = 0; g < node.velocity.size(); ++g) {
      change[g].fill(0.);
      if (!merged.is_held(g))
        continue;
      const auto at = std::size_t(merged.of(int(g)));
      for (unsigned int c = 0; c < dim; ++c)
        change[g][c] =
            merged.mass(g, c) * (moving[at][c] - node.velocity[g][c]);
    }
    for (std::size_t k = 0; k < held_.size(); ++k) {
      const std::size_t i = held_[k].index;
      const Vector P = merged.carried(k, change.data());
      const double *frame = &frames[i * dim * dim];
      double square = 0.;
      for (unsigned int r = 0; r < dim; ++r) {
        double &part = impulses[i * dim + r];
        part = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          part += frame[r * dim + c] * P[c];
        square += part * part;
      }
      if (!(square <= held_[k].surely_held))
        return false;
    }
    return true;
  }

  /** Velocities of what is broken, none of which overlaps at the end. */
  template <int dim>
  bool LooseNode<dim>::stay_apart(const OneStepProblem<dim> &problem,
                                  const std::vector<double> &frames,
                                  const std::vector<double> &released_overlap,
                                  const NodeProblem<dim> &node,
                                  const Vector *moving,
                                  std::vector<double> &velocities) const
  {
    const double h_theta = problem.time_step * problem.theta;
    double speed = 0., way = 0., least_inside = springs::infinity;
    for (const Broken &point : broken_) {
      const std::size_t i = point.index;
      const double *jump = &problem.jump_free[i * dim];
      double *velocity = &velocities[i * dim];
      for (unsigned int c = 0; c < dim; ++c)
        way = std::max(way, std::abs(jump[c]));
      // see LeapfrogPoints::set_point()
      const double target = -(jump[0] + released_overlap[i]) / h_theta;
      if (point.groups[0] == point.groups[1]) {
        std::fill_n(velocity, dim, 0.);
        least_inside = std::min(least_inside, -target);
      } else {
        const Vector U =
            jump_velocity<dim>(&frames[i * dim * dim], point.groups, moving);
        std::copy(U.begin(), U.end(), velocity);
      }
      if (!(velocity[0] >= target) ||
          -(jump[0] + h_theta * velocity[0]) - released_overlap[i] > 0.)
        return false;
    }
    if (std::isinf(least_inside))
      return true;
    for (const auto &v : node.velocity)
      for (unsigned int c = 0; c < dim; ++c)
        speed = std::max(speed, std::abs(v[c]));
    speed = std::max(speed, way / h_theta);
    return least_inside > 8. * ElasticNode<dim>::round_off * speed;
  }

  template <int dim>
  bool LooseNode<dim>::solve(const OneStepProblem<dim> &problem,
                             const std::vector<double> &frames,
                             const std::vector<double> &released_overlap,
                             const MergedGroups<dim> &merged,
                             NodeProblem<dim> &node,
                             std::vector<double> &impulses,
                             std::vector<double> &velocities) const
  {
    std::array<Vector, MergedGroups<dim>::most> moving;
    if (!merged.merge(node.velocity, moving.data()) ||
        !stay_apart(problem, frames, released_overlap, node, moving.data(),
                    velocities) ||
        (!held_.empty() &&
         !carry(frames, merged, node, moving.data(), impulses)))
      return false;
    for (std::size_t g = 0; g < node.velocity.size(); ++g)
      node.velocity[g] = moving[std::size_t(merged.of(int(g)))];
    return true;
  }

  template class LooseNode<2>;
  template class LooseNode<3>;
} // namespace nsfd
