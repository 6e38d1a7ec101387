#include "equilibrium_springs.h"

#include "state/state.h"

#include <cmath>

namespace nsfd
{
  template <int dim>
  bool EquilibriumSprings<dim>::add(const std::vector<unsigned int> &added,
                                    const InterfacePoints<dim> &points,
                                    const FaceRelease<dim> &faces,
                                    const State &state)
  {
    for (const unsigned int i : added) {
      const double *frame = points.axes(i);
      chains_.add(i, frame, faces.factors(i), state);
      const std::size_t a = chains_.size() - 1;
      const OneStepProblem<dim> &p = chains_.problem;
      ElasticPoint<dim> law;
      bad_point_ = i;
      if (!law.reinit(p, a, chains_.beta[a]))
        return false;
      if (law.broken || law.holds)
        continue;
      Spring spring{i, {}, law.largest, &p.interactions[p.interaction[a]]};
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            spring.stiffness[c * dim + d] +=
                points.weight[i] *
                (r == 0 ? law.secant.normal : law.secant.tangential) *
                frame[r * dim + c] * frame[r * dim + d];
      springs_.push_back(spring);
    }
    return true;
  }

  /** On body 1. */
  template <int dim>
  std::array<double, dim>
  EquilibriumSprings<dim>::force(const Spring &spring,
                                 const CornerGroups<dim> &groups) const
  {
    std::array<double, dim> u{}, result{};
    const auto &corners = mesh_.corners(spring.point);
    for (unsigned int side = 0; side < 2; ++side)
      for (unsigned int c = 0;
           corners[side] != JoinedMesh<dim>::none && c < dim; ++c)
        u[c] += (side == 0 ? -1. : 1.) *
                groups.displacement[groups.of(corners[side]) * dim + c];
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        result[c] += spring.stiffness[c * dim + d] * u[d];
    return result;
  }

  template <int dim>
  void EquilibriumSprings<dim>::add_forces(CornerGroups<dim> &groups) const
  {
    for (const Spring &spring : springs_) {
      const auto pull = force(spring, groups);
      const auto &corners = mesh_.corners(spring.point);
      for (unsigned int side = 0; side < 2; ++side)
        for (unsigned int c = 0;
             corners[side] != JoinedMesh<dim>::none && c < dim; ++c)
          groups.force[groups.of(corners[side]) * dim + c] +=
              side == 0 ? pull[c] : -pull[c];
    }
  }

  template <int dim>
  void EquilibriumSprings<dim>::add_sizes(const CornerGroups<dim> &groups,
                                          std::vector<double> &sizes) const
  {
    for (const Spring &spring : springs_) {
      const auto pull = force(spring, groups);
      for (const unsigned int corner : mesh_.corners(spring.point))
        for (unsigned int c = 0; corner != JoinedMesh<dim>::none && c < dim;
             ++c)
          sizes[groups.of(corner) * dim + c] += std::abs(pull[c]);
    }
  }

  template <int dim>
  void
  EquilibriumSprings<dim>::add_diagonal(const CornerGroups<dim> &groups,
                                        std::vector<double> &diagonal) const
  {
    for (const Spring &spring : springs_)
      for (const unsigned int corner : mesh_.corners(spring.point))
        for (unsigned int c = 0; corner != JoinedMesh<dim>::none && c < dim;
             ++c)
          diagonal[groups.of(corner) * dim + c] +=
              spring.stiffness[c * (dim + 1)];
  }

  template <int dim>
  bool EquilibriumSprings<dim>::are_straight(const State &state)
  {
    for (const Spring &spring : springs_) {
      const double opening = effective_opening<dim>(
          *spring.interaction, &state.jump[std::size_t(spring.point) * dim]);
      bad_point_ = spring.point;
      if (!(opening * opening <= spring.largest))
        return false;
    }
    return true;
  }

  template class EquilibriumSprings<2>;
  template class EquilibriumSprings<3>;
} // namespace nsfd
