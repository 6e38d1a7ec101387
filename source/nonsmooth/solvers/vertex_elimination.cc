#include "vertex_elimination.h"

#include <algorithm>

namespace nsfd
{
  /** False where a point sees more than can be said, or what moves there moves
      other places. */
  template <int dim>
  bool VertexElimination<dim>::set_problem(const NodeClusters::Cluster &vertex,
                                           const std::vector<int> &place,
                                           const VertexMotion<dim> &motion,
                                           const std::vector<double> &U,
                                           const std::vector<double> &impulse)
  {
    node_.clear();
    node_.inverse_mass.resize(vertex.nodes.size());
    node_.velocity.resize(vertex.nodes.size());
    if (std::any_of(vertex.nodes.begin(), vertex.nodes.end(),
                    [&](const int k) { return motion.is_tied(k); }))
      return false;
    for (std::size_t b = 0; b < vertex.nodes.size(); ++b)
      motion.node(vertex.nodes[b], node_.inverse_mass[b], node_.velocity[b]);
    ends_.assign(vertex.points.size(), {});
    for (std::size_t k = 0; k < vertex.points.size(); ++k) {
      const std::size_t i = vertex.points[k];
      motion.sight(i, seen_, B_);
      PointEnds &ends = ends_[k];
      if (seen_.size() > ends.matrices.size())
        return false;
      ends.size = ends.n_matrices = unsigned(seen_.size());
      for (std::size_t s = 0; s < seen_.size(); ++s) {
        const int b = place[std::size_t(seen_[s])];
        ends.groups[s] = b;
        std::copy(B_[s].begin(), B_[s].end(), ends.matrices[s].begin());
        // the problem knows the groups without the impulses of the points
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; c < dim; ++c)
            node_.velocity[std::size_t(b)][c] -=
                node_.inverse_mass[std::size_t(b)][c] * B_[s][d * dim + c] *
                impulse[i * dim + d];
      }
      auto &point = node_.points.emplace_back();
      point.point = i;
      point.groups = {-1, -1};
      point.ends = &ends;
      std::copy_n(&U[i * dim], dim, point.start.begin());
    }
    return true;
  }

  template <int dim>
  bool VertexElimination<dim>::solve(const OneStepProblem<dim> &problem,
                                     VertexMotion<dim> &motion,
                                     const Communicator &communicator,
                                     const std::vector<std::size_t> &points,
                                     const std::vector<double> &U,
                                     std::vector<double> &w,
                                     std::vector<double> &impulse)
  {
    const NodeClusters &vertices = motion.vertices();
    const unsigned int n = motion.unknowns_per_node();
    std::vector<int> chosen;
    for (const std::size_t i : points)
      if (vertices.of_point[i] >= 0)
        chosen.push_back(vertices.of_point[i]);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    if (frames_.size() != problem.n_points * dim * dim) {
      frames_.assign(problem.n_points * dim * dim, 0.);
      for (std::size_t k = 0; k < frames_.size(); k += dim * dim)
        for (unsigned int c = 0; c < dim; ++c)
          frames_[k + c * (dim + 1)] = 1.;
    }
    solutions_.resize(problem.n_points);
    bool solved = false;
    for (const int v : chosen) {
      const auto &vertex = vertices.clusters[std::size_t(v)];
      if (!set_problem(vertex, vertices.place, motion, U, impulse))
        continue;
      trial_.clear();
      for (const std::size_t i : vertex.points)
        trial_.insert(trial_.end(), &impulse[i * dim], &impulse[i * dim] + dim);
      const NodeReport report =
          solver_.solve(problem, frames_, node_, impulse, solutions_);
      if (!report.converged) {
        for (std::size_t k = 0; k < vertex.points.size(); ++k)
          std::copy_n(&trial_[k * dim], dim, &impulse[vertex.points[k] * dim]);
        continue;
      }
      solved = true;
      for (std::size_t b = 0; b < vertex.nodes.size(); ++b)
        for (unsigned int c = 0; c < n; ++c)
          w[std::size_t(vertex.nodes[b]) * n + c] += node_.velocity[b][c];
    }
    return communicator.any(solved);
  }

  template class VertexElimination<2>;
  template class VertexElimination<3>;
} // namespace nsfd
