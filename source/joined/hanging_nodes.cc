#include "hanging_nodes.h"

#include "cell_forces.h"

#include "discretization/body_frequency.h"
#include "discretization/cells.h"

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** All polynomials of the nodes at @p x; at a node exactly 0 and 1. */
    std::vector<double> polynomials(const std::vector<double> &nodes,
                                    const double x)
    {
      std::vector<double> values(nodes.size(), 1.);
      for (unsigned int i = 0; i < nodes.size(); ++i)
        if (std::abs(x - nodes[i]) < 1e-12) {
          std::fill(values.begin(), values.end(), 0.);
          values[i] = 1.;
          return values;
        }
      for (unsigned int i = 0; i < nodes.size(); ++i)
        for (unsigned int j = 0; j < nodes.size(); ++j)
          if (i != j)
            values[i] *= (x - nodes[j]) / (nodes[i] - nodes[j]);
      return values;
    }

    template <int dim>
    std::vector<double> lobatto_nodes(const Cells<dim> &cells)
    {
      const dealii::QGaussLobatto<1> lobatto(cells.element->degree + 1);
      std::vector<double> nodes;
      for (const auto &x : lobatto.get_points())
        nodes.push_back(x[0]);
      return nodes;
    }

    /** Of nodes in rows along x, y(, z): @p node lies on a face. */
    bool is_on_face(unsigned int node, const unsigned int n,
                    const unsigned int face)
    {
      for (unsigned int d = 0; d < face / 2; ++d)
        node /= n;
      return node % n == (face % 2 == 0 ? 0 : n - 1);
    }
  } // namespace

  template <int dim>
  std::vector<std::pair<unsigned int, double>> trace_at(const Cells<dim> &cells,
                                                        const unsigned int cell,
                                                        const unsigned int slot)
  {
    const auto nodes = lobatto_nodes(cells);
    const auto n = unsigned(nodes.size());
    const auto &shape = cells.class_shape(cell);
    const unsigned int face = shape.slot_faces[slot];
    std::array<std::vector<double>, dim> along;
    for (unsigned int d = 0; d < dim; ++d)
      along[d] = polynomials(nodes, shape.slot_places[slot][d]);
    std::vector<std::pair<unsigned int, double>> row;
    for (unsigned int i = 0; i < shape.n_nodes; ++i) {
      if (!is_on_face(i, n, face))
        continue;
      double value = 1.;
      for (unsigned int d = 0, k = i; d < dim; ++d, k /= n)
        if (d != face / 2)
          value *= along[d][k % n];
      if (value != 0.)
        row.emplace_back(i, value);
    }
    return row;
  }

  template <int dim>
  HangingNodes<dim>::HangingNodes(const Discretization<dim> &discretization,
                                  const JoinedMesh<dim> &mesh,
                                  const GhostLayer<dim> *const layer)
      : discretization_(discretization), mesh_(mesh), layer_(layer)
  {
    const bool here = !mesh.hanging().empty();
    any_ = layer ? layer->cells().anywhere(here) : here;
    if (!any_)
      return;
    set_rows();
    set_flags();
    bool chain = false;
    for (const unsigned int corner : master_)
      chain = chain || hangs(corner);
    if (layer ? layer->cells().anywhere(chain) : chain)
      throw std::runtime_error("a mesh has neighbours whose sizes differ by "
                               "more than a factor of two");
    set_held();
    if (!layer)
      return;
    std::vector<std::size_t> wanted, beyond;
    const unsigned int n_nodes =
        discretization.cells().element->n_dofs_per_cell();
    for (const unsigned int corner : loaded_)
      if (layer->cells().is_ghost(corner / n_nodes))
        wanted.push_back(corner);
    for (std::size_t i = 0; i < flags_.size(); ++i)
      if (hangs(i) && !mesh.is_whole(mesh.node(i)))
        beyond.push_back(i);
    shares_.emplace(layer->cells(), n_nodes, std::move(wanted));
    beyond_.emplace(layer->cells(), n_nodes, std::move(beyond));
  }

  template <int dim>
  void HangingNodes<dim>::set_rows()
  {
    const Cells<dim> &cells = discretization_.cells();
    first_.push_back(0);
    for (const auto &point : mesh_.hanging()) {
      double sum = 0.;
      for (const auto &[node, value] :
           trace_at(cells, point.cell, point.slot)) {
        master_.push_back(unsigned(cells.first_node[point.cell]) + node);
        weight_.push_back(value);
        sum += std::abs(value);
      }
      first_.push_back(master_.size());
      spread_ = std::max(spread_, sum);
    }
  }

  /** Those of ghosts are what their ranks say. */
  template <int dim>
  void HangingNodes<dim>::set_flags()
  {
    const Cells<dim> &cells = discretization_.cells();
    flags_.assign(mesh_.n_corners(), 0);
    for (const auto &point : mesh_.hanging())
      for (const unsigned int corner :
           mesh_.corners_of_node(mesh_.node(point.corner)))
        flags_[corner] |= hanging;
    const unsigned int n = cells.element->degree + 1;
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      for (unsigned int f = 0; f < 2 * dim; ++f)
        for (unsigned int i = 0; i < cells.class_shape(b).n_nodes; ++i)
          if ((cells.class_shape(b).divided >> f & 1u) && is_on_face(i, n, f))
            flags_[cells.first_node[b] + i] |= loaded;
    if (layer_) {
      const unsigned int n_nodes = cells.element->n_dofs_per_cell();
      const auto &all = layer_->cells().all();
      all.start(n_nodes, [&](const std::size_t cell, double *values) {
        for (unsigned int i = 0; i < n_nodes; ++i)
          values[i] = flags_[cell * n_nodes + i];
      });
      all.finish(n_nodes, [&](const std::size_t cell, const double *values) {
        for (unsigned int i = 0; i < n_nodes; ++i)
          flags_[cell * n_nodes + i] = std::uint8_t(values[i]);
      });
    }
    for (unsigned int i = 0; i < flags_.size(); ++i)
      if ((flags_[i] & loaded) != 0 && mesh_.is_whole(mesh_.node(i)))
        loaded_.push_back(i);
  }

  /** A node within an edge lies on all faces that have what it follows. */
  template <int dim>
  void HangingNodes<dim>::set_held()
  {
    const auto &faces = discretization_.points().faces;
    const auto &face_of = discretization_.points().face_of;
    std::vector<std::uint8_t> of_face(faces.size(), 0);
    const auto n = unsigned(face_of.size());
    for (unsigned int i = 0; i < n; ++i)
      of_face[face_of[i]] |= mesh_.between_sizes(i) || hangs(mesh_.a_corner(i));
    // faces at the nodes that are followed along edges
    std::map<unsigned int, std::vector<unsigned int>> at_node;
    const auto is_edge = [&](const std::size_t k) {
      return first_[k + 1] - first_[k] <=
             discretization_.cells().element->degree + 1;
    };
    for (std::size_t k = 0; dim == 3 && k + 1 < first_.size(); ++k)
      for (std::size_t j = first_[k]; is_edge(k) && j < first_[k + 1]; ++j)
        at_node[mesh_.node(master_[j])];
    for (unsigned int i = 0; i < n && !at_node.empty(); ++i)
      for (const unsigned int corner : mesh_.corners(i)) {
        if (corner == JoinedMesh<dim>::none)
          continue;
        const auto found = at_node.find(mesh_.node(corner));
        if (found != at_node.end() &&
            (found->second.empty() || found->second.back() != face_of[i]))
          found->second.push_back(face_of[i]);
      }
    for (std::size_t k = 0; dim == 3 && k + 1 < first_.size(); ++k) {
      if (!is_edge(k))
        continue;
      for (const unsigned int face : at_node[mesh_.node(master_[first_[k]])]) {
        bool has_all = true;
        for (std::size_t j = first_[k]; j < first_[k + 1]; ++j) {
          const auto &list = at_node[mesh_.node(master_[j])];
          has_all =
              has_all && std::binary_search(list.begin(), list.end(), face);
        }
        of_face[face] |= has_all;
      }
    }
    held_.resize(n);
    for (unsigned int i = 0; i < n; ++i)
      held_[i] = of_face[face_of[i]];
    if (layer_)
      layer_->fetch_points(1, held_);
  }

  template <int dim>
  bool HangingNodes<dim>::is_own(const unsigned int corner) const
  {
    const unsigned int n_nodes =
        discretization_.cells().element->n_dofs_per_cell();
    return !layer_ || !layer_->cells().is_ghost(corner / n_nodes);
  }

  template <int dim>
  bool HangingNodes<dim>::have_parted(const Tie &one, const Tie &two,
                                      const CornerGroups<dim> &groups) const
  {
    for (std::size_t j = one.first; j < one.last; ++j) {
      bool found = !mesh_.is_whole(mesh_.node(master_[j])); // others look there
      for (std::size_t k = two.first; k < two.last; ++k)
        found |= groups.of(master_[k]) == groups.of(master_[j]);
      if (!found)
        return true;
    }
    return false;
  }

  template <int dim>
  bool HangingNodes<dim>::tie(CornerGroups<dim> &groups)
  {
    ties_.clear();
    std::vector<double> masses(mesh_.n_corners());
    for (std::size_t i = 0; i < masses.size(); ++i)
      masses[i] = mesh_.mass(i);
    std::vector<double> shares(loaded_.size(), 0.);
    std::vector<int> tie_of(groups.size(), -1);
    bool good = true;
    for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
      const unsigned int corner = mesh_.hanging()[k].corner;
      if (!mesh_.is_whole(mesh_.node(corner)))
        continue;
      Tie tie{groups.of(corner), first_[k], first_[k + 1], 0.};
      int &known = tie_of[tie.group];
      if (known >= 0) {
        good = good && !have_parted(ties_[std::size_t(known)], tie, groups);
        continue;
      }
      known = int(ties_.size());
      for (const unsigned int other : mesh_.corners_of_node(mesh_.node(corner)))
        if (groups.of(other) == tie.group)
          tie.mass += mesh_.mass(other);
      ties_.push_back(tie);
      for (std::size_t j = tie.first; is_own(tie) && j < tie.last; ++j)
        shares[place(master_[j])] += weight_[j] * tie.mass;
    }
    exchange(1, shares);
    for (std::size_t i = 0; i < masses.size(); ++i)
      if (hangs(i)) {
        good = good &&
               (!mesh_.is_whole(mesh_.node(i)) || tie_of[groups.of(i)] >= 0);
        masses[i] = 0.;
      }
    for (std::size_t l = 0; l < loaded_.size(); ++l)
      masses[loaded_[l]] += shares[l];
    groups.set_masses(std::move(masses));
    return layer_ ? !layer_->cells().anywhere(!good) : good;
  }

  template <int dim>
  double HangingNodes<dim>::mass_share() const
  {
    const unsigned int n_nodes =
        discretization_.cells().element->n_dofs_per_cell();
    std::map<unsigned int, std::vector<const Tie *>> of_cell;
    for (const Tie &tie : ties_)
      if (is_own(tie))
        of_cell[master_[tie.first] / n_nodes].push_back(&tie);
    double largest = 1.;
    for (const auto &[cell, ties] : of_cell) {
      std::map<unsigned int, unsigned int> at; // by corner
      for (const Tie *tie : ties)
        for (std::size_t j = tie->first; j < tie->last; ++j)
          at.emplace(master_[j], 0);
      unsigned int n = 0;
      for (auto &entry : at)
        entry.second = n++;
      Block B(n, n);
      std::vector<double> D(n);
      for (const auto &[corner, i] : at)
        B(i, i) = D[i] = mesh_.mass(corner);
      for (const Tie *tie : ties)
        for (std::size_t j = tie->first; j < tie->last; ++j) {
          const unsigned int one = at[master_[j]];
          D[one] += weight_[j] * tie->mass;
          for (std::size_t k = tie->first; k < tie->last; ++k)
            B(one, at[master_[k]]) += weight_[j] * tie->mass * weight_[k];
        }
      for (unsigned int i = 0; i < n; ++i) {
        if (!(D[i] > 0.))
          return std::numeric_limits<double>::infinity();
        for (unsigned int j = 0; j < n; ++j) {
          B(i, j) /= std::sqrt(D[i]);
          B(j, i) /= std::sqrt(D[i]);
        }
      }
      largest = std::max(largest, largest_eigenpair(B)[0]);
    }
    return largest > 1. + 1e-9 ? largest : 1.; // 1 is one of them
  }

  /** In loaded_. */
  template <int dim>
  std::size_t HangingNodes<dim>::place(const unsigned int corner) const
  {
    return std::size_t(
        std::lower_bound(loaded_.begin(), loaded_.end(), corner) -
        loaded_.begin());
  }

  /** Shares of the corners of ghosts are summed by their ranks. */
  template <int dim>
  void HangingNodes<dim>::exchange(const unsigned int width,
                                   std::vector<double> &shares) const
  {
    if (!shares_)
      return;
    shares_->start(width, [&](const std::size_t corner, double *values) {
      std::copy_n(&shares[place(unsigned(corner)) * width], width, values);
    });
    shares_->finish(width, [&](const std::size_t corner, const double *values) {
      std::copy_n(values, width, &shares[place(unsigned(corner)) * width]);
    });
  }

  template <int dim>
  void HangingNodes<dim>::collect(const CornerGroups<dim> &groups,
                                  std::vector<double> &forces,
                                  std::vector<double> &shares) const
  {
    if (!any_)
      return;
    shares.assign(loaded_.size() * dim, 0.);
    for (const Tie &tie : ties_) {
      double *force = &forces[std::size_t(tie.group) * dim];
      for (std::size_t j = tie.first; is_own(tie) && j < tie.last; ++j) {
        double *share = &shares[place(master_[j]) * dim];
        for (unsigned int c = 0; c < dim; ++c)
          share[c] += weight_[j] * force[c];
      }
      std::fill_n(force, dim, 0.);
    }
    exchange(dim, shares);
    for (std::size_t l = 0; l < loaded_.size(); ++l) {
      double *force = &forces[std::size_t(groups.of(loaded_[l])) * dim];
      for (unsigned int c = 0; c < dim; ++c)
        force[c] += shares[l * dim + c];
    }
  }

  template <int dim>
  void HangingNodes<dim>::set_forces(CellForces<dim> &forces,
                                     CornerGroups<dim> &groups) const
  {
    forces.set_forces(groups);
    collect(groups, groups.force, groups.shares);
  }

  template <int dim>
  void HangingNodes<dim>::add_shares(const std::size_t node,
                                     const CornerGroups<dim> &groups,
                                     const std::vector<double> &shares,
                                     std::vector<double> &forces) const
  {
    if (!any_ || shares.empty())
      return;
    for (const unsigned int corner : mesh_.corners_of_node(node)) {
      if ((flags_[corner] & loaded) == 0)
        continue;
      const std::size_t l = place(corner);
      for (unsigned int c = 0; c < dim; ++c)
        forces[std::size_t(groups.of(corner)) * dim + c] += shares[l * dim + c];
    }
  }

  template <int dim>
  void HangingNodes<dim>::follow(CornerGroups<dim> &groups) const
  {
    if (!any_)
      return;
    for (auto *values : {&groups.displacement, &groups.velocity})
      for (const Tie &tie : ties_) {
        double *mine = &(*values)[std::size_t(tie.group) * dim];
        std::fill_n(mine, dim, 0.);
        for (std::size_t j = tie.first; j < tie.last; ++j)
          for (unsigned int c = 0; c < dim; ++c)
            mine[c] += weight_[j] *
                       (*values)[std::size_t(groups.of(master_[j])) * dim + c];
      }
    if (!beyond_)
      return;
    beyond_->start(2 * dim, [&](const std::size_t corner, double *values) {
      const std::size_t first = std::size_t(groups.of(corner)) * dim;
      std::copy_n(&groups.displacement[first], dim, values);
      std::copy_n(&groups.velocity[first], dim, values + dim);
    });
    beyond_->finish(
        2 * dim, [&](const std::size_t corner, const double *values) {
          const std::size_t first = std::size_t(groups.of(corner)) * dim;
          std::copy_n(values, dim, &groups.displacement[first]);
          std::copy_n(values + dim, dim, &groups.velocity[first]);
        });
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<std::pair<unsigned int, double>> trace_at(              \
      const Cells<dim> &, unsigned int, unsigned int);                         \
  template class HangingNodes<dim>
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
