#include "sparse_assembly.h"

#include "linear_algebra/dense_lu.h"

#include <algorithm>
#include <cmath>

// Nodes of faces that are one, and nodes that follow others.

namespace nsfd
{
  /** The largest component of that between two nodes. */
  template <int dim>
  double SparseAssembly<dim>::distance(const Place &x, const unsigned int i,
                                       const Place &y,
                                       const unsigned int j) const
  {
    double largest = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      largest = std::max(largest,
                         std::abs(coordinate(x, i + c) - coordinate(y, j + c)));
    return largest;
  }

  template <int dim>
  NodePairs SparseAssembly<dim>::node_pairs() const
  {
    NodePairs pairs;
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      const unsigned int first = points_.faces[f].first;
      std::size_t nodes = 0;
      if (!coordinates_.empty() && places_[0][first].exists() &&
          places_[1][first].exists()) {
        std::array<Side, 2> sides{side(f, 0), side(f, 1)};
        const unsigned int s = places_[0][first].body >= 0 ? 0 : 1;
        const Place &a = places_[s][first], &b = places_[1 - s][first];
        if (!sides[s].rigid && !sides[1 - s].rigid) {
          nodes = std::max(sides[0].support.size(), sides[1].support.size());
          double size = 0.;
          for (const unsigned short i : sides[s].support)
            if (i % dim == 0)
              size = std::max(size, distance(a, sides[s].support[0], a, i));
          for (const unsigned short i : sides[s].support)
            for (const unsigned short j : sides[1 - s].support)
              if (i % dim == 0 && j % dim == 0 &&
                  distance(a, i, b, j) < 1e-6 * size) {
                pairs.own.push_back(int(sides[s].first - matrix_.first_row) +
                                    i);
                pairs.other.push_back(sides[1 - s].first + j);
              }
        }
      }
      pairs.complete.push_back(
          nodes > 0 && (pairs.own.size() - pairs.start.back()) * dim == nodes);
      pairs.start.push_back(pairs.own.size());
    }
    return pairs;
  }

  template <int dim>
  Unknowns SparseAssembly<dim>::unknowns() const
  {
    Unknowns result;
    result.first = matrix_.first_row;
    result.coordinates = coordinates_;
    result.coordinates.resize(bodies_.n_dofs(), 0.);
    result.component.assign(bodies_.n_dofs(), -1);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (!bodies_.classes[bodies_.class_of[b]].rigid)
        for (std::size_t i = bodies_.first_dof[b]; i < bodies_.first_dof[b + 1];
             ++i)
          result.component[i] =
              static_cast<signed char>((i - bodies_.first_dof[b]) % dim);
    return result;
  }

  /**
   * Of the smaller cell where it has nodes and the larger one none, or of that
   * beside a rigid one. With the traces of both at the points, S x_s = L x_l,
   * which is one condition per node of the face: x_s = (S^T S)^-1 S^T L x_l.
   */
  template <int dim>
  std::vector<NodeTies::Follower>
  SparseAssembly<dim>::ties(const std::size_t face) const
  {
    std::vector<NodeTies::Follower> result;
    const auto &points = points_.faces[face];
    const unsigned int first = points.first;
    if (points.count == 0 || !places_[0][first].exists() ||
        !places_[1][first].exists())
      return result;
    const std::array<Side, 2> sides{side(face, 0), side(face, 1)};
    if (sides[0].rigid && sides[1].rigid)
      return rigid_ties(face, sides);
    const auto node = [&](const unsigned int s, const unsigned int k) {
      return (unsigned int)(sides[s].support[k * dim]);
    };
    std::array<double, 2> size{};
    for (unsigned int s = 0; s < 2; ++s)
      for (unsigned int k = 0;
           !sides[s].rigid && k * dim < sides[s].support.size(); ++k)
        size[s] = std::max(size[s], distance(places_[s][first], node(s, 0),
                                             places_[s][first], node(s, k)));
    const bool rigid = sides[0].rigid || sides[1].rigid;
    const unsigned int small = rigid ? (sides[0].rigid ? 1 : 0)
                                     : (size[0] < size[1] ? 0 : 1),
                       large = 1 - small;
    const unsigned int n = unsigned(sides[small].support.size() / dim);
    if (points.count < n ||
        (!rigid && (sides[1].support.size() != sides[0].support.size() ||
                    !(size[small] < 0.75 * size[large]))))
      return result;
    const auto at = [&](const unsigned int s, const unsigned int p,
                        const unsigned int c, const unsigned int unknown) {
      return trace(places_[s][first + p], c, unknown);
    };
    DenseLU normal;
    normal.reinit(int(n));
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        for (unsigned int p = 0; p < points.count; ++p)
          normal.row(int(i))[j] +=
              at(small, p, 0, node(small, i)) * at(small, p, 0, node(small, j));
    if (!normal.factorise())
      return result;
    // what moves component c of the other side, and by how much
    const unsigned int n_masters =
        unsigned(sides[large].support.size()) / (rigid ? 1 : dim);
    const auto master = [&](const unsigned int c, const unsigned int j) {
      return sides[large].support[rigid ? j : j * dim + c];
    };
    for (unsigned int c = 0; c < dim; ++c) {
      std::vector<double> C(std::size_t(n_masters) * n, 0.); // by master
      for (unsigned int j = 0; j < n_masters; ++j) {
        double *column = &C[std::size_t(j) * n];
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int p = 0; p < points.count; ++p)
            column[i] +=
                at(small, p, 0, node(small, i)) * at(large, p, c, master(c, j));
        normal.solve(column);
        for (unsigned int p = 0; p < points.count; ++p) {
          double left = at(large, p, c, master(c, j));
          for (unsigned int i = 0; i < n; ++i)
            left -= at(small, p, 0, node(small, i)) * column[i];
          if (!(std::abs(left) < 1e-9))
            return {}; // not the trace of the smaller one
        }
      }
      for (unsigned int i = 0; i < n; ++i) {
        bool common = false;
        for (unsigned int j = 0; j < n_masters && !rigid; ++j)
          common = common || distance(places_[small][first], node(small, i),
                                      places_[large][first],
                                      node(large, j)) < 1e-6 * size[small];
        if (common)
          continue;
        NodeTies::Follower tie{sides[small].first + node(small, i) + c,
                               sides[small].first,
                               sides[large].first,
                               {}};
        for (unsigned int j = 0; j < n_masters; ++j)
          if (std::abs(C[std::size_t(j) * n + i]) > 1e-12)
            tie.masters.emplace_back(sides[large].first + master(c, j),
                                     C[std::size_t(j) * n + i]);
        result.push_back(tie);
      }
    }
    return result;
  }

  /** Of the motions of two rigid cells, each by the other: x_s as above. */
  template <int dim>
  std::vector<NodeTies::Follower>
  SparseAssembly<dim>::rigid_ties(const std::size_t face,
                                  const std::array<Side, 2> &sides) const
  {
    std::vector<NodeTies::Follower> result;
    const auto &points = points_.faces[face];
    const unsigned int n = unsigned(sides[0].support.size());
    if (points.count < dim || sides[1].support.size() != n)
      return result;
    for (unsigned int s = 0; s < 2; ++s) {
      const auto at = [&](const unsigned int side, const unsigned int k,
                          const unsigned int j) {
        return trace(places_[side][points.first + k / dim], k % dim, j);
      };
      DenseLU normal;
      normal.reinit(int(n));
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int k = 0; k < points.count * dim; ++k)
            normal.row(int(i))[j] += at(s, k, i) * at(s, k, j);
      if (!normal.factorise())
        return {};
      for (unsigned int i = 0; i < n; ++i)
        result.push_back(
            {sides[s].first + i, sides[s].first, sides[1 - s].first, {}});
      NodeTies::Follower *const mine = &result[std::size_t(s) * n];
      std::vector<double> column(n);
      for (unsigned int j = 0; j < n; ++j) {
        std::fill(column.begin(), column.end(), 0.);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int k = 0; k < points.count * dim; ++k)
            column[i] += at(s, k, i) * at(1 - s, k, j);
        normal.solve(column.data());
        for (unsigned int k = 0; k < points.count * dim; ++k) {
          double left = at(1 - s, k, j);
          for (unsigned int i = 0; i < n; ++i)
            left -= at(s, k, i) * column[i];
          if (!(std::abs(left) < 1e-9))
            return {};
        }
        for (unsigned int i = 0; i < n; ++i)
          if (std::abs(column[i]) > 1e-12)
            mine[i].masters.emplace_back(sides[1 - s].first + j, column[i]);
      }
    }
    return result;
  }

  template <int dim>
  NodeTies SparseAssembly<dim>::node_ties() const
  {
    NodeTies result;
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      result.of_face.push_back(
          coordinates_.empty() ? std::vector<NodeTies::Follower>() : ties(f));
      result.key.push_back(points_.faces[f].key);
      const unsigned int first = points_.faces[f].first;
      unsigned int rigid = 0;
      for (unsigned int s = 0; s < 2 && points_.faces[f].count > 0; ++s)
        rigid += places_[s][first].exists() && side(f, s).rigid;
      result.kind.push_back(rigid == 0   ? NodeTies::Kind::of_sizes
                            : rigid == 1 ? NodeTies::Kind::on_rigid
                                         : NodeTies::Kind::both_rigid);
    }
    return result;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template NodePairs SparseAssembly<dim>::node_pairs() const;                  \
  template NodeTies SparseAssembly<dim>::node_ties() const;                    \
  template Unknowns SparseAssembly<dim>::unknowns() const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
