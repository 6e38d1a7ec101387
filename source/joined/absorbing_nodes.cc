#include "absorbing_nodes.h"

#include "hanging_nodes.h"

#include "discretization/cells.h"
#include "discretization/loads.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** C v. */
    template <int dim>
    std::array<double, dim> product(const std::array<double, dim * dim> &C,
                                    const std::array<double, dim> &v)
    {
      std::array<double, dim> result{};
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          result[c] += C[c * dim + d] * v[d];
      return result;
    }

    template <int dim>
    std::array<double, dim> mean_velocity(const std::vector<double> &before,
                                          const CornerGroups<dim> &groups,
                                          const std::size_t group)
    {
      std::array<double, dim> v;
      for (unsigned int c = 0; c < dim; ++c)
        v[c] =
            (before[group * dim + c] + groups.velocity[group * dim + c]) / 2.;
      return v;
    }

    template <int dim>
    bool has_shear(const std::array<double, dim * dim> &C)
    {
      double trace = 0., beside = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          (c == d ? trace : beside) += std::abs(C[c * dim + d]);
      return beside > 1e-12 * trace;
    }

    /** Faces that may open or slip. */
    template <int dim>
    bool may_part(const Discretization<dim> &discretization,
                  const std::size_t point)
    {
      const PointOrigin &origin = discretization.origins()[point];
      switch (origin.kind) {
      case PointOrigin::Kind::interface: {
        const auto &block = discretization.input().interfaces[origin.block];
        return block.may_open() || block.law_name == "elastic";
      }
      case PointOrigin::Kind::obstacle:
        return true;
      default:
        return false;
      }
    }
  } // namespace

  template <int dim>
  std::unique_ptr<AbsorbingNodes<dim>>
  AbsorbingNodes<dim>::make(const Discretization<dim> &discretization,
                            const JoinedMesh<dim> &mesh,
                            const HangingNodes<dim> &hanging)
  {
    if (!discretization.input().has_absorbing_sides())
      return nullptr;
    return std::make_unique<AbsorbingNodes>(discretization, mesh, hanging);
  }

  template <int dim>
  AbsorbingNodes<dim>::AbsorbingNodes(const Discretization<dim> &discretization,
                                      const JoinedMesh<dim> &mesh,
                                      const HangingNodes<dim> &hanging)
  {
    const Cells<dim> &cells = discretization.cells();
    std::map<unsigned int, Matrix> found;
    for (const auto &[body, face] : discretization.loads().absorbing_faces()) {
      const auto shape = cells.shape(body);
      const auto C = lumped_absorbing(*cells.element, *shape, face);
      for (unsigned int i = 0; i < C.size(); ++i) {
        if (std::all_of(C[i].begin(), C[i].end(),
                        [](const double value) { return value == 0.; }))
          continue;
        const auto corner = unsigned(cells.bodies.first_dof[body] / dim) + i;
        if (hanging.hangs(corner))
          fault_ = hangs;
        Matrix &sum = found.emplace(corner, Matrix{}).first->second;
        for (unsigned int k = 0; k < dim * dim; ++k)
          sum[k] += C[i][k];
      }
    }
    of_corners_.assign(found.begin(), found.end());
    std::vector<char> inclined(mesh.n_nodes(), 0);
    for (const auto &[corner, C] : of_corners_)
      if (has_shear<dim>(C))
        inclined[mesh.node(corner)] = 1;
    for (std::size_t i = 0; i < discretization.points().n_points; ++i)
      if (inclined[mesh.node_of_point(i)] && may_part(discretization, i))
        fault_ = is_inclined;
  }

  template <int dim>
  void AbsorbingNodes<dim>::check(const Communicator &communicator) const
  {
    const double worst = communicator.max(double(fault_));
    if (worst == double(hangs))
      throw std::runtime_error(
          "an absorbing side has cells of two sizes: in scheme = explicit its "
          "nodes must not hang; refine all of it, or write scheme = "
          "moreau-jean");
    if (worst == double(is_inclined))
      throw std::runtime_error(
          "faces that may open or slip meet an absorbing side that is inclined "
          "to the axes: in scheme = explicit such a side must be along them "
          "there; turn the mesh, join the faces at the side, or write scheme = "
          "moreau-jean");
  }

  template <int dim>
  void AbsorbingNodes<dim>::gather(const CornerGroups<dim> &groups)
  {
    std::map<unsigned int, Matrix> sums;
    for (const auto &[corner, C] : of_corners_) {
      Matrix &sum = sums.emplace(groups.of(corner), Matrix{}).first->second;
      for (unsigned int k = 0; k < dim * dim; ++k)
        sum[k] += C[k];
    }
    of_groups_.assign(sums.begin(), sums.end());
    kick_ = 0.;
  }

  template <int dim>
  void AbsorbingNodes<dim>::set_drag(const double kick,
                                     CornerGroups<dim> &groups)
  {
    if (kick == kick_)
      return;
    kick_ = kick;
    groups.drag.assign(groups.size() * dim, 0.);
    for (const auto &[group, C] : of_groups_)
      for (unsigned int c = 0; c < dim; ++c)
        groups.drag[group * dim + c] = kick / 2. * C[c * (dim + 1)];
  }

  /** Gauss's method for the components that are free: m 1 + k C/2 is positive
      definite. */
  template <int dim>
  void AbsorbingNodes<dim>::brake(const double kick,
                                  const std::vector<double> &before,
                                  const std::vector<std::uint8_t> &prescribed,
                                  CornerGroups<dim> &groups) const
  {
    for (const auto &[group, C] : of_groups_) {
      double *const v = &groups.velocity[std::size_t(group) * dim];
      const double m = groups.mass[group];
      if (!(m > 0.))
        continue; // of other ranks
      std::array<double, dim> old;
      std::copy_n(&before[std::size_t(group) * dim], dim, old.begin());
      const auto drag = product<dim>(C, old);
      double A[dim][dim + 1];
      for (unsigned int c = 0; c < dim; ++c) {
        const bool given = prescribed[group] & (1u << c);
        for (unsigned int d = 0; d < dim; ++d)
          A[c][d] =
              (given ? 0. : kick / 2. * C[c * dim + d]) + (c == d ? m : 0.);
        A[c][dim] = m * v[c] - (given ? 0. : kick / 2. * drag[c]);
      }
      for (unsigned int p = 0; p < dim; ++p)
        for (unsigned int c = p + 1; c < dim; ++c) {
          const double factor = A[c][p] / A[p][p];
          for (unsigned int d = p; d <= dim; ++d)
            A[c][d] -= factor * A[p][d];
        }
      for (unsigned int p = dim; p-- > 0;) {
        double value = A[p][dim];
        for (unsigned int d = p + 1; d < dim; ++d)
          value -= A[p][d] * v[d];
        if (!(prescribed[group] & (1u << p)))
          v[p] = value / A[p][p];
      }
    }
  }

  template <int dim>
  void AbsorbingNodes<dim>::add_impulses(const double kick,
                                         const std::vector<double> &before,
                                         const CornerGroups<dim> &groups,
                                         const std::vector<int> &row_of_group,
                                         std::vector<double> &rows) const
  {
    for (const auto &[group, C] : of_groups_) {
      const int row = group < row_of_group.size() ? row_of_group[group] : -1;
      if (row < 0)
        continue;
      const auto drag = product<dim>(C, mean_velocity(before, groups, group));
      for (unsigned int c = 0; c < dim; ++c)
        rows[std::size_t(row) * dim + c] -= kick * drag[c];
    }
  }

  template <int dim>
  void AbsorbingNodes<dim>::put_energy(const double kick,
                                       const std::vector<double> &before,
                                       const CornerGroups<dim> &groups,
                                       double *const terms) const
  {
    std::fill_n(terms, groups.size() * dim, 0.);
    for (const auto &[group, C] : of_groups_) {
      const auto v = mean_velocity(before, groups, group);
      const auto drag = product<dim>(C, v);
      for (unsigned int c = 0; c < dim; ++c)
        terms[std::size_t(group) * dim + c] = kick * drag[c] * v[c];
    }
  }

  template class AbsorbingNodes<2>;
  template class AbsorbingNodes<3>;
} // namespace nsfd
