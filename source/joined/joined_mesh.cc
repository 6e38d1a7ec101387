#include "joined_mesh.h"

#include "core/disjoint_sets.h"
#include "discretization/cells.h"
#include "discretization/point_places.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** The node of a cell at a place on its surface, or -1. */
    template <int dim>
    int node_at(const BodyShape<dim> &shape, const dealii::Point<dim> &place)
    {
      const double tolerance = 1e-9 * shape.height;
      for (std::size_t i = 0; i < shape.nodes.size(); ++i)
        if (shape.nodes[i].distance(place) < tolerance)
          return int(i);
      return -1;
    }
  } // namespace

  template <int dim>
  JoinedMesh<dim>::JoinedMesh(const Discretization<dim> &discretization,
                              const GhostCells *ghosts)
  {
    const Cells<dim> &cells = discretization.cells();
    node_.resize(cells.first_node.back());
    mass_.resize(node_.size());
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const std::size_t first = cells.first_node[b];
      const auto shape = cells.shape(b);
      for (std::size_t i = first; i < cells.first_node[b + 1]; ++i)
        mass_[i] = lumped_mass(*shape, unsigned(i - first));
    }
    find_corners(discretization, ghosts);
    const auto own =
        ghosts ? near_own(cells, *ghosts) : std::vector<std::uint8_t>();
    find_nodes(own);
    sort_corners();
    if (!own.empty())
      share_nodes(own);
    sort_links();
  }

  template <int dim>
  void JoinedMesh<dim>::find_corners(const Discretization<dim> &discretization,
                                     const GhostCells *ghosts)
  {
    const Cells<dim> &cells = discretization.cells();
    const std::size_t n = discretization.points().n_points;
    corners_.assign(n, {{none, none}});
    // the node of every slot of a class, found once
    std::vector<std::vector<int>> nodes(cells.bodies.classes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const BodyShape<dim> &shape = cells.shapes[k];
      for (const auto &place : shape.slot_positions)
        nodes[k].push_back(node_at(shape, place));
    }
    bool at_nodes = true;
    for_all_places(
        cells.bodies, n,
        [&](const std::size_t body, const unsigned int slot,
            const std::size_t point, const unsigned int side) {
          const int i = nodes[cells.bodies.class_of[body]][slot];
          const auto &shape = cells.class_shape(body);
          if (shape.divided >> shape.slot_faces[slot] & 1u) {
            between_sizes_.resize(n, 0);
            between_sizes_[point] = 1;
            if (i < 0) {
              hanging_.push_back({unsigned(point), none, unsigned(body), slot});
              return;
            }
          }
          at_nodes = at_nodes && i >= 0;
          corners_[point][side] =
              unsigned(cells.first_node[body] + std::size_t(i));
        });
    if (ghosts ? ghosts->anywhere(!at_nodes) : !at_nodes)
      throw std::runtime_error(
          "joined cells share nodes, and some points of faces are at none: "
          "they need `interface quadrature = gauss lobatto` with one point "
          "more than the degree");
    for (Hanging &point : hanging_)
      point.corner = corners_[point.point][0];
    std::sort(hanging_.begin(), hanging_.end(),
              [](const Hanging &a, const Hanging &b) {
                return std::pair(a.cell, a.slot) < std::pair(b.cell, b.slot);
              });
  }

  /** By corner: 1 of a cell of this rank; 2 of a ghost, where it hangs from
      one of them. */
  template <int dim>
  std::vector<std::uint8_t>
  JoinedMesh<dim>::near_own(const Cells<dim> &cells,
                            const GhostCells &ghosts) const
  {
    std::vector<std::uint8_t> own;
    for (std::size_t b = 0; b < ghosts.size(); ++b)
      own.insert(own.end(), cells.first_node[b + 1] - cells.first_node[b],
                 !ghosts.is_ghost(b));
    for (const Hanging &point : hanging_)
      if (!own[point.corner] && !ghosts.is_ghost(point.cell))
        own[point.corner] = 2;
    return own;
  }

  /** Corners that links connect, numbered by their first one; @p own as
      near_own(), empty if there are no ghosts. */
  template <int dim>
  void JoinedMesh<dim>::find_nodes(const std::vector<std::uint8_t> &own)
  {
    DisjointSets nodes(n_corners());
    for (const auto &sides : corners_)
      if (sides[0] != none && sides[1] != none)
        nodes.join(sides[0], sides[1]);
    std::vector<std::uint8_t> whole; // by the first corner of a node
    if (!own.empty()) {
      whole = own;
      for (unsigned int i = 0; i < n_corners(); ++i)
        whole[nodes.first(i)] |= own[i];
    }
    unsigned int n = 0;
    for (unsigned int i = 0; i < n_corners(); ++i) {
      const unsigned int first = nodes.first(i);
      const bool alone = !whole.empty() && !whole[first];
      node_[i] = alone || first == i ? n++ : node_[first];
    }
    first_corner_.assign(n + 1, 0);
  }

  template <int dim>
  void JoinedMesh<dim>::sort_corners()
  {
    for (const unsigned int node : node_)
      ++first_corner_[node + 1];
    std::partial_sum(first_corner_.begin(), first_corner_.end(),
                     first_corner_.begin());
    corner_.resize(n_corners());
    auto next = first_corner_;
    for (unsigned int i = 0; i < n_corners(); ++i)
      corner_[next[node_[i]]++] = i;
  }

  /** The rank of the first corner counts. */
  template <int dim>
  void JoinedMesh<dim>::share_nodes(const std::vector<std::uint8_t> &own)
  {
    share_.assign(n_nodes(), Share::part);
    for (std::size_t node = 0; node < n_nodes(); ++node)
      for (const unsigned int corner : corners_of_node(node))
        if (own[corner]) {
          share_[node] =
              corner == *corners_of_node(node).begin() && own[corner] == 1
                  ? Share::counted
                  : Share::whole;
          break;
        }
  }

  template <int dim>
  void JoinedMesh<dim>::sort_links()
  {
    first_link_.assign(n_nodes() + 1, 0);
    const auto is_link = [&](const std::size_t i) {
      return corners_[i][0] != none && corners_[i][1] != none &&
             node_[corners_[i][0]] == node_[corners_[i][1]];
    };
    for (std::size_t i = 0; i < corners_.size(); ++i)
      if (is_link(i))
        ++first_link_[node_of_point(i) + 1];
    std::partial_sum(first_link_.begin(), first_link_.end(),
                     first_link_.begin());
    link_.resize(first_link_.back());
    auto next = first_link_;
    for (std::size_t i = 0; i < corners_.size(); ++i)
      if (is_link(i))
        link_[next[node_of_point(i)]++] = unsigned(i);
  }

  template class JoinedMesh<2>;
  template class JoinedMesh<3>;
} // namespace nsfd
