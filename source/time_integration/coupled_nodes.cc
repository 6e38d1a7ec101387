#include "coupled_nodes.h"

#include "core/gather_sums.h"
#include "linear_algebra/dense_lu.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  CoupledNodes<dim>::CoupledNodes(const Communicator &communicator,
                                  RigidGroups<dim> &rigid,
                                  NodeSolver<dim> &solver,
                                  LeapfrogChains<dim> &chains,
                                  CornerGroups<dim> &groups,
                                  std::vector<Node> nodes)
      : communicator_(communicator), rigid_(rigid), solver_(solver),
        chains_(chains), groups_(groups), nodes_(std::move(nodes)),
        n_(rigid.n_free()), floor_(4e-3 * std::sqrt(rigid.sizes().motion))
  {
    for (const Node &node : nodes_) {
      Start &start = starts_.emplace_back();
      start.velocity = node.problem->velocity;
      for (std::size_t k = 0; k < node.groups->size(); ++k)
        if (rigid.takes((*node.groups)[k])) {
          Place &place = start.places.emplace_back();
          place.local = int(k);
          place.group = (*node.groups)[k];
          place.columns = rigid.columns(place.group, place.first);
        }
    }
  }

  template <int dim>
  std::array<double, dim> CoupledNodes<dim>::impulse_on(const Node &node,
                                                        const int local) const
  {
    std::array<double, dim> sum{};
    for (const auto &point : node.problem->points)
      for (unsigned int side = 0; side < 2; ++side)
        if (point.groups[side] == local)
          for (unsigned int r = 0; r < dim; ++r)
            for (unsigned int c = 0; c < dim; ++c)
              sum[c] += (side == 0 ? -1. : 1.) *
                        chains_.impulse[point.point * dim + r] *
                        chains_.frame[(point.point * dim + r) * dim + c];
    return sum;
  }

  template <int dim>
  void CoupledNodes<dim>::add_impulses(const std::size_t k)
  {
    if (!nodes_[k].counts)
      return;
    for (const Place &place : starts_[k].places) {
      const auto P = impulse_on(nodes_[k], place.local);
      for (std::size_t i = 0; i < place.columns.size(); ++i) {
        double along = 0., size = 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          along += place.columns[i][c] * P[c];
          size += std::abs(place.columns[i][c] * P[c]);
        }
        own_[place.first + i].add(along);
        own_[n_ + place.first + i].add(size);
      }
    }
  }

  template <int dim>
  void CoupledNodes<dim>::add_response(const std::size_t k)
  {
    const auto &places = starts_[k].places;
    std::vector<int> local;
    for (const Place &place : places)
      local.push_back(place.local);
    if (!solver_.respond(local, response_) || !nodes_[k].counts)
      return;
    const std::size_t size = local.size() * dim;
    for (std::size_t a = 0; a < places.size(); ++a)
      for (std::size_t b = 0; b < places.size(); ++b)
        for (std::size_t i = 0; i < places[a].columns.size(); ++i)
          for (std::size_t j = 0; j < places[b].columns.size(); ++j) {
            double sum = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                sum += places[a].columns[i][c] *
                       response_[(a * dim + c) * size + b * dim + d] *
                       places[b].columns[j][d];
            own_[(2 + places[a].first + i) * n_ + places[b].first + j].add(sum);
          }
  }

  /** The nodes at @p y, and | y - E^T R^T P |. */
  template <int dim>
  double CoupledNodes<dim>::evaluate(const std::vector<double> &y)
  {
    rigid_.move(y, groups_);
    own_.assign((2 + n_) * n_, {});
    ++report_.rounds;
    report_.inexact = 0;
    report_.residual = 0.;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      NodeProblem<dim> &problem = *nodes_[k].problem;
      problem.velocity = starts_[k].velocity;
      for (const Place &place : starts_[k].places)
        std::copy_n(&groups_.velocity[std::size_t(place.group) * dim], dim,
                    problem.velocity[std::size_t(place.local)].begin());
      const NodeReport node =
          solver_.solve(chains_.problem, chains_.frame, problem,
                        chains_.impulse, chains_.solution);
      if (nodes_[k].counts) {
        report_.sweeps += node.sweeps;
        report_.newton += node.newton;
        report_.inexact += !node.converged;
      }
      if (!(node.residual <= report_.residual)) {
        report_.residual = node.residual;
        report_.worst = problem.points[0].point;
      }
      add_impulses(k);
      add_response(k);
    }
    sums_ = gather_sums(communicator_, own_);
    double error = 0., size = 0.;
    for (std::size_t i = 0; i < n_; ++i) {
      error += (y[i] - sums_[i]) * (y[i] - sums_[i]);
      size += sums_[n_ + i] * sums_[n_ + i];
    }
    scale_ = std::sqrt(size) + floor_;
    return std::sqrt(error);
  }

  /** One step of Newton's method, shortened until it makes things better; then
      the nodes are solved at the new y. */
  template <int dim>
  bool CoupledNodes<dim>::advance(std::vector<double> &y)
  {
    DenseLU matrix;
    matrix.reinit(int(n_));
    std::vector<double> step(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t j = 0; j < n_; ++j)
        matrix.row(int(i))[j] = (i == j ? 1. : 0.) - sums_[(2 + i) * n_ + j];
      step[i] = sums_[i] - y[i];
    }
    if (!matrix.factorise())
      return false;
    matrix.solve(step.data());
    const std::vector<double> start = y;
    for (double length = 1.; length > 1e-3; length /= 2.) {
      for (std::size_t i = 0; i < n_; ++i)
        y[i] = start[i] + length * step[i];
      const double next = evaluate(y);
      if (next <= aim * scale_ || next < (1. - 0.2 * length) * error_) {
        error_ = next;
        return true;
      }
    }
    y = start;
    evaluate(y);
    return false;
  }

  template <int dim>
  auto CoupledNodes<dim>::solve() -> Report
  {
    report_ = {};
    own_.assign((2 + n_) * n_, {});
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      add_impulses(k); // those of the step before
    sums_ = gather_sums(communicator_, own_);
    std::vector<double> y(sums_.begin(), sums_.begin() + long(n_));
    error_ = evaluate(y);
    while (error_ > aim * scale_ && report_.rounds < most_rounds)
      if (!advance(y))
        break;
    report_.converged = error_ <= aim * scale_;
    if (scale_ > 0. && !report_.converged)
      report_.residual = std::max(report_.residual, error_ / scale_);
    // momenta to the last digit: y is what the impulses say
    y.assign(sums_.begin(), sums_.begin() + long(n_));
    rigid_.move(y, groups_);
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      for (std::size_t j = 0; j < nodes_[k].groups->size(); ++j) {
        const unsigned int group = (*nodes_[k].groups)[j];
        if (!rigid_.takes(group))
          std::copy_n(nodes_[k].problem->velocity[j].begin(), dim,
                      &groups_.velocity[std::size_t(group) * dim]);
      }
    return report_;
  }

  template class CoupledNodes<2>;
  template class CoupledNodes<3>;
} // namespace nsfd
