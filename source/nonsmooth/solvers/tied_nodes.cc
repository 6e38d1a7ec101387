#include "tied_nodes.h"

#include "core/disjoint_sets.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// of the largest trace: what a node that is not on a face has there, or
    /// two nodes at one place differ by
    constexpr double alike = 1e-9;
  } // namespace

  template <int dim>
  TiedNodes<dim>::TiedNodes(const DelassusOperator<dim> &delassus,
                            const std::vector<char> &held)
      : delassus_(delassus),
        places_(point_places(delassus.bodies(), delassus.points().n_points)),
        points_(delassus.points().n_points, 0)
  {
    const auto &faces = delassus.points().faces;
    const std::size_t n = delassus.bodies().n_dofs();
    DisjointSets sets(n);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto first = held.begin() + long(faces[f].first);
      Face face{faces[f].first, faces[f].count, {}, {}};
      if (face.count == 0 ||
          !std::all_of(first, first + long(face.count),
                       [](const char is_held) { return is_held != 0; }) ||
          !match(f, face))
        continue;
      for (const auto &pair : face.nodes)
        for (unsigned int c = 0; c < dim; ++c)
          sets.join(unsigned(pair[0]) + c, unsigned(pair[1]) + c);
      std::fill_n(points_.begin() + long(face.first), face.count, 1);
      faces_.push_back(std::move(face));
    }
    unknown_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const unsigned int first = sets.first(unsigned(i));
      unknown_[i] = first == i ? int(n_unknowns_++) : unknown_[first];
    }
    find_nodes();
  }

  template <int dim>
  void TiedNodes<dim>::find_nodes()
  {
    std::vector<int> node_of(n_unknowns_, -1);
    const auto cell = [](Node &node, const int first) {
      const auto at = std::find(node.cells.begin(), node.cells.end(), first);
      const auto k = unsigned(at - node.cells.begin());
      if (at == node.cells.end())
        node.cells.push_back(first);
      return k;
    };
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (std::size_t i = 0; i < faces_[f].nodes.size(); ++i) {
        const auto &pair = faces_[f].nodes[i];
        int &place = node_of[std::size_t(unknown_[std::size_t(pair[0])])];
        if (place < 0) {
          place = int(nodes_.size());
          nodes_.emplace_back();
        }
        Node &node = nodes_[std::size_t(place)];
        const unsigned int from = cell(node, pair[0]), to = cell(node, pair[1]);
        node.links.push_back({f, i, from, to});
      }
    for (Node &node : nodes_) {
      node.laplacian.reinit(int(node.cells.size()));
      node.laplacian.row(0)[0] = 1.;
      for (const auto &link : node.links) {
        const std::array<unsigned int, 2> ends{{link.from, link.to}};
        for (unsigned int s = 0; s < 2; ++s)
          if (ends[s] != 0) {
            node.laplacian.row(int(ends[s]))[ends[s]] += 1.;
            if (ends[1 - s] != 0)
              node.laplacian.row(int(ends[s]))[ends[1 - s]] -= 1.;
          }
      }
      node.laplacian.factorise(); // its cells hang together
    }
  }

  /** @p right by cell, dim components each, to the potentials of its links. */
  template <int dim>
  void TiedNodes<dim>::solve(const Node &node, std::vector<double> &right) const
  {
    const std::size_t n = node.cells.size();
    std::vector<double> x(n);
    for (unsigned int c = 0; c < dim; ++c) {
      for (std::size_t k = 0; k < n; ++k)
        x[k] = k == 0 ? 0. : right[k * dim + c];
      node.laplacian.solve(x.data());
      for (std::size_t k = 0; k < n; ++k)
        right[k * dim + c] = x[k];
    }
  }

  template <int dim>
  std::vector<double>
  TiedNodes<dim>::motion_of(const std::vector<double> &jumps) const
  {
    const auto &points = delassus_.points();
    std::vector<std::vector<double>> of_nodes(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Face &face = faces_[f];
      of_nodes[f].assign(face.nodes.size() * dim, 0.);
      for (unsigned int q = 0; q < face.count; ++q) {
        const std::size_t i = face.first + q;
        const double *const Q = points.axes(i);
        for (unsigned int d = 0; d < dim; ++d) {
          double value = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            value += Q[c * dim + d] * jumps[i * dim + c];
          for (std::size_t k = 0; k < face.nodes.size(); ++k)
            of_nodes[f][k * dim + d] +=
                face.inverse[k * face.count + q] * value;
        }
      }
    }
    std::vector<double> motion(unknown_.size(), 0.), right;
    for (const Node &node : nodes_) {
      right.assign(node.cells.size() * dim, 0.);
      for (const auto &link : node.links)
        for (unsigned int d = 0; d < dim; ++d) {
          const double jump = of_nodes[link.face][link.node * dim + d];
          right[link.to * dim + d] += jump;
          right[link.from * dim + d] -= jump;
        }
      solve(node, right);
      for (std::size_t k = 0; k < node.cells.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          motion[std::size_t(node.cells[k]) + d] = right[k * dim + d];
    }
    return motion;
  }

  template <int dim>
  std::vector<double>
  TiedNodes<dim>::impulses_of(const std::vector<double> &forces) const
  {
    const auto &points = delassus_.points();
    std::vector<double> P(points.n_points * dim, 0.), right;
    for (const Node &node : nodes_) {
      right.resize(node.cells.size() * dim);
      for (std::size_t k = 0; k < node.cells.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          right[k * dim + d] = forces[std::size_t(node.cells[k]) + d];
      solve(node, right);
      for (const auto &link : node.links) {
        const Face &face = faces_[link.face];
        for (unsigned int q = 0; q < face.count; ++q) {
          const std::size_t i = face.first + q;
          const double *const Q = points.axes(i);
          const double share = face.inverse[link.node * face.count + q];
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              P[i * dim + c] +=
                  share * Q[c * dim + d] *
                  (right[link.to * dim + d] - right[link.from * dim + d]);
        }
      }
    }
    return P;
  }

  /** The nodes of both sides that are one; false unless all are. */
  template <int dim>
  bool TiedNodes<dim>::match(const std::size_t f, Face &result) const
  {
    const auto &bodies = delassus_.bodies();
    const auto &face = delassus_.points().faces[f];
    std::array<std::vector<unsigned int>, 2> nodes;
    std::array<const BodyClass *, 2> sides;
    std::array<int, 2> body;
    double largest = 0.;
    const auto trace = [&](const unsigned int s, const unsigned int q,
                           const unsigned int node) {
      const unsigned int slot = places_[s][face.first + q].slot;
      return sides[s]->trace(slot * dim, node * dim);
    };
    for (unsigned int s = 0; s < 2; ++s) {
      body[s] = places_[s][face.first].body;
      if (body[s] < 0)
        return false;
      sides[s] = &bodies.classes[bodies.class_of[std::size_t(body[s])]];
      if (sides[s]->rigid)
        return false;
      for (unsigned int q = 0; q < face.count; ++q)
        if (places_[s][face.first + q].body != body[s])
          return false;
      for (unsigned int i = 0; i < sides[s]->n_dofs / dim; ++i)
        for (unsigned int q = 0; q < face.count; ++q)
          largest = std::max(largest, std::abs(trace(s, q, i)));
    }
    for (unsigned int s = 0; s < 2; ++s)
      for (unsigned int i = 0; i < sides[s]->n_dofs / dim; ++i)
        for (unsigned int q = 0; q < face.count; ++q)
          if (std::abs(trace(s, q, i)) > alike * largest) {
            nodes[s].push_back(i);
            break;
          }
    // as many points as nodes, or they do not hold each of these
    if (nodes[0].size() != nodes[1].size() || face.count < nodes[0].size())
      return false;
    for (const unsigned int i : nodes[0]) {
      const auto same = [&](const unsigned int j) {
        for (unsigned int q = 0; q < face.count; ++q)
          if (std::abs(trace(0, q, i) - trace(1, q, j)) > alike * largest)
            return false;
        return true;
      };
      const auto other = std::find_if(nodes[1].begin(), nodes[1].end(), same);
      if (other == nodes[1].end())
        return false;
      result.nodes.push_back(
          {{int(bodies.first_dof[std::size_t(body[0])] + i * dim),
            int(bodies.first_dof[std::size_t(body[1])] + *other * dim)}});
      nodes[1].erase(other);
    }
    // (N^T N)^-1 N^T, N the values of the shape functions at the points
    const std::size_t n = nodes[0].size();
    DenseLU normal;
    normal.reinit(int(n));
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t l = 0; l < n; ++l)
        for (unsigned int q = 0; q < face.count; ++q)
          normal.row(int(k))[l] +=
              trace(0, q, nodes[0][k]) * trace(0, q, nodes[0][l]);
    if (!normal.factorise())
      return false;
    result.inverse.resize(n * face.count);
    std::vector<double> column(n);
    for (unsigned int q = 0; q < face.count; ++q) {
      for (std::size_t k = 0; k < n; ++k)
        column[k] = trace(0, q, nodes[0][k]);
      normal.solve(column.data());
      for (std::size_t k = 0; k < n; ++k)
        result.inverse[k * face.count + q] = column[k];
    }
    return true;
  }

  template <int dim>
  void TiedNodes<dim>::fold(const std::vector<double> &forces,
                            std::vector<double> &sums) const
  {
    sums.assign(n_unknowns_, 0.);
    for (std::size_t i = 0; i < forces.size(); ++i)
      sums[std::size_t(unknown_[i])] += forces[i];
  }

  template <int dim>
  void TiedNodes<dim>::spread(const std::vector<double> &motion,
                              std::vector<double> &all) const
  {
    all.resize(unknown_.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = motion[std::size_t(unknown_[i])];
  }

  template class TiedNodes<2>;
  template class TiedNodes<3>;
} // namespace nsfd
