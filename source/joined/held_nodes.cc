#include "held_nodes.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  HeldNodes<dim>::HeldNodes(OneStepProblem<dim> &problem)
      : problem_(problem), n_interactions_(problem.interactions.size())
  {
  }

  template <int dim>
  void HeldNodes<dim>::hold(const NodeProblem<dim> &node)
  {
    auto &problem = problem_;
    for (const auto &place : node.points) {
      const std::size_t i = place.point;
      const PointKind kind = problem.kind[i];
      const unsigned int interaction = problem.interaction[i];
      if ((kind != PointKind::rigid && kind != PointKind::cohesive) ||
          problem.interactions[interaction].plateau)
        continue; // no spring: it carries a traction at no opening
      points_.push_back({i, kind, problem.mask[i], interaction});
      if (kind == PointKind::rigid) {
        problem.kind[i] = PointKind::prescribed;
        problem.mask[i] = std::uint8_t((1u << dim) - 1u);
        continue;
      }
      const Reach history = {problem.opening_max[i], problem.slip_max.empty()
                                                         ? 0.
                                                         : problem.slip_max[i]};
      // at a contact force of 1
      const FrozenPoint frozen = frozen_state<dim>(problem, i, history, 1.);
      Interaction spring = problem.interactions[interaction];
      spring.law = nullptr;
      spring.friction = frozen.threshold;
      spring.friction_exponent = 0.;
      spring.normal_stiffness = frozen.secant.normal;
      problem.kind[i] = PointKind::free;
      if (spring.normal_stiffness > 0.) {
        problem.kind[i] = PointKind::elastic;
        spring.stiffness_ratio =
            frozen.secant.tangential / spring.normal_stiffness;
      }
      problem.interaction[i] = unsigned(problem.interactions.size());
      problem.interactions.push_back(std::move(spring));
    }
  }

  template <int dim>
  HeldNodes<dim>::~HeldNodes()
  {
    for (const Point &point : points_) {
      problem_.kind[point.index] = point.kind;
      problem_.mask[point.index] = point.mask;
      problem_.interaction[point.index] = point.interaction;
    }
    problem_.interactions.resize(n_interactions_);
  }

  template <int dim>
  void HeldNodes<dim>::mark(std::vector<LocalSolution<dim>> &solutions) const
  {
    for (const Point &point : points_)
      solutions[point.index].frozen.held = true;
  }

  template <int dim>
  double HeldNodes<dim>::excess(const std::vector<double> &impulses) const
  {
    double result = 0.;
    for (const Point &point : points_) {
      if (point.kind != PointKind::rigid)
        continue;
      const std::size_t i = point.index;
      const double *P = &impulses[i * dim];
      const double traction =
          effective_traction<dim>(problem_, i, -P[0], P + 1) /
          (problem_.weight[i] * problem_.time_step);
      result =
          std::max(result, traction / point_strength<dim>(problem_, i) - 1.);
    }
    return result;
  }

  template class HeldNodes<2>;
  template class HeldNodes<3>;
} // namespace nsfd
