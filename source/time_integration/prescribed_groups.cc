#include "prescribed_groups.h"

#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** Of an axisymmetric scene. */
    template <int dim>
    std::vector<unsigned int>
    corners_on_axis(const Discretization<dim> &discretization)
    {
      std::vector<unsigned int> corners;
      const Cells<dim> &cells = discretization.cells();
      if (discretization.input().axisymmetric)
        for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
          const auto &on_axis = cells.class_shape(b).on_axis;
          for (std::size_t i = 0; i < on_axis.size(); ++i)
            if (on_axis[i])
              corners.push_back(unsigned(cells.first_node[b] + i));
        }
      return corners;
    }
  } // namespace

  template <int dim>
  PrescribedGroups<dim>::PrescribedGroups(
      const SceneInput &input, const Discretization<dim> &discretization,
      const JoinedMesh<dim> &mesh)
      : discretization_(discretization), mesh_(mesh),
        motion_(input, discretization),
        on_axis_(corners_on_axis(discretization)),
        reactions_(discretization.driven_boundaries().size() * dim, 0.)
  {
  }

  /** Each component once, by the first point that says it. */
  template <int dim>
  void PrescribedGroups<dim>::find(const CornerGroups<dim> &groups,
                                   const std::vector<std::uint8_t> &rigid)
  {
    const auto &origins = discretization_.origins();
    mask_.assign(groups.size(), 0);
    row_of_group_.assign(groups.size(), -1);
    all_.clear();
    rigid_.clear();
    int n_rows = 0;
    for (std::size_t group = 0; group < rigid.size(); ++group)
      if (rigid[group])
        row_of_group_[group] = n_rows++;
    radial_.clear();
    for (const unsigned int corner : on_axis_) {
      const unsigned int group = groups.of(corner);
      if (mask_[group] & 1u)
        continue;
      mask_[group] |= 1u;
      radial_.push_back(group);
    }
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (origins[i].kind != PointOrigin::Kind::motion)
        continue;
      const unsigned int group = groups.of(mesh_.a_corner(i));
      for (unsigned int c = 0; c < dim; ++c) {
        if ((!motion_.velocity(i, c) && !motion_.displacement(i, c)) ||
            (mask_[group] & (1u << c)))
          continue;
        mask_[group] |= std::uint8_t(1u << c);
        if (row_of_group_[group] < 0)
          row_of_group_[group] = n_rows++;
        const bool of_body = group < rigid.size() && rigid[group];
        (of_body ? rigid_ : all_).push_back({group, c, i});
      }
    }
    for (std::size_t group = 0; group < rigid.size(); ++group)
      if (rigid[group])
        mask_[group] = std::uint8_t((2u << dim) - 1u);
    rows_.assign(std::size_t(n_rows) * dim, 0.);
  }

  template <int dim>
  void PrescribedGroups<dim>::resize(const std::size_t n_groups)
  {
    mask_.resize(n_groups, 0);
    row_of_group_.resize(n_groups, -1);
  }

  template <int dim>
  void PrescribedGroups<dim>::set_velocities(const double time, const double h,
                                             const double kick,
                                             const std::vector<double> &forces,
                                             const std::vector<double> &loads,
                                             CornerGroups<dim> &groups)
  {
    for (PrescribedRow &row : all_) {
      const std::size_t k = std::size_t(row.group) * dim + row.component;
      row.given = kick * (forces[k] + (loads.empty() ? 0. : loads[k]));
      groups.velocity[k] = velocity(row, time, h, groups);
    }
    for (const unsigned int group : radial_)
      groups.velocity[std::size_t(group) * dim] = 0.;
  }

  template <int dim>
  void PrescribedGroups<dim>::set_places(const double time,
                                         CornerGroups<dim> &groups) const
  {
    for (const PrescribedRow &row : all_)
      if (const auto *place = motion_.displacement(row.point, row.component))
        groups.displacement[std::size_t(row.group) * dim + row.component] =
            motion_.place_at(*place, row.point, time, clock_);
  }

  template <int dim>
  double PrescribedGroups<dim>::velocity(const PrescribedRow &row,
                                         const double time, const double h,
                                         const CornerGroups<dim> &groups) const
  {
    if (const auto *velocity = motion_.velocity(row.point, row.component))
      return motion_.velocity_at(*velocity, row.point, time + h / 2., clock_);
    const std::size_t k = std::size_t(row.group) * dim + row.component;
    return (motion_.place_at(*motion_.displacement(row.point, row.component),
                             row.point, time + h, clock_) -
            groups.displacement[k]) /
           h;
  }

  template <int dim>
  std::size_t PrescribedGroups<dim>::boundary(const PrescribedRow &row) const
  {
    const auto &driven = discretization_.driven_boundaries();
    return std::size_t(std::find(driven.begin(), driven.end(),
                                 discretization_.origins()[row.point].block) -
                       driven.begin());
  }

  template <int dim>
  double PrescribedGroups<dim>::work(const Communicator &communicator,
                                     const double kick,
                                     const std::vector<double> &before,
                                     const CornerGroups<dim> &groups)
  {
    const std::size_t n = all_.size(), n_reactions = reactions_.size();
    terms_.assign((n_reactions + 1) * n, 0.);
    for (std::size_t k = 0; k < n; ++k) {
      const PrescribedRow &row = all_[k];
      if (!mesh_.counts(mesh_.node_of_point(row.point)))
        continue;
      const std::size_t at = std::size_t(row.group) * dim + row.component;
      const double impulse =
          groups.mass[row.group] * (groups.velocity[at] - before[at]) -
          row.given -
          rows_[std::size_t(row_of_group_[row.group]) * dim + row.component];
      terms_[k] = impulse * (groups.velocity[at] + before[at]) / 2.;
      terms_[(1 + boundary(row) * dim + row.component) * n + k] =
          impulse / kick;
    }
    const auto sums = communicator.sums(terms_.data(), n_reactions + 1, n);
    std::copy(sums.begin() + 1, sums.end(), reactions_.begin());
    return sums[0];
  }

  template class PrescribedGroups<2>;
  template class PrescribedGroups<3>;
} // namespace nsfd
