#include "point_velocities.h"

#include "energy_safe_sliding.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    template <int dim>
    std::array<double, dim> relative_velocity(const unsigned int a,
                                              const JoinedMesh<dim> &mesh,
                                              const CornerGroups<dim> &groups,
                                              const LeapfrogChains<dim> &chains)
    {
      const auto &corners = mesh.corners(chains.point[a]);
      std::array<double, dim> v{}, U{};
      for (unsigned int side = 0; side < 2; ++side)
        if (corners[side] != JoinedMesh<dim>::none)
          for (unsigned int c = 0; c < dim; ++c)
            v[c] += (side == 0 ? -1. : 1.) *
                    groups.velocity[groups.of(corners[side]) * dim + c];
      const double *frame = &chains.frame[std::size_t(a) * dim * dim];
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          U[r] += frame[r * dim + c] * v[c];
      return U;
    }
  } // namespace

  template <int dim>
  void set_velocities(const std::vector<unsigned int> &moved,
                      const std::size_t first, const JoinedMesh<dim> &mesh,
                      const CornerGroups<dim> &groups,
                      LeapfrogChains<dim> &chains)
  {
    for (std::size_t k = first; k < moved.size(); ++k) {
      const auto U = relative_velocity<dim>(moved[k], mesh, groups, chains);
      std::copy(U.begin(), U.end(),
                &chains.velocity[std::size_t(moved[k]) * dim]);
    }
  }

  template <int dim>
  void set_old_velocity(const unsigned int a, const JoinedMesh<dim> &mesh,
                        const CornerGroups<dim> &groups,
                        LeapfrogChains<dim> &chains)
  {
    const auto U = relative_velocity<dim>(a, mesh, groups, chains);
    std::copy(U.begin(), U.end(), &chains.old_velocity[std::size_t(a) * dim]);
  }

  template <int dim>
  bool turn_friction(const std::vector<unsigned int> &moved,
                     const std::size_t first, const bool all,
                     LeapfrogChains<dim> &chains)
  {
    OneStepProblem<dim> &p = chains.problem;
    bool turned = false;
    for (std::size_t k = first; k < moved.size(); ++k) {
      const unsigned int a = moved[k];
      if (chains.solution[a].frozen.threshold <= 0. || chains.turned[a])
        continue;
      const double *P = &chains.impulse[a * dim],
                   *U = &chains.velocity[a * dim],
                   *before = &chains.old_velocity[a * dim];
      const double work =
          friction_work<dim>(p, a, chains.solution[a], P, U, before, 0.5);
      double size = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        size += std::abs(P[c]) * (std::abs(U[c]) + std::abs(before[c]));
      if (work <= 1e-9 * size && !all)
        continue;
      turned = true;
      chains.turned[a] = 1;
      for (unsigned int c = 1; c < dim; ++c)
        p.sliding_offset[a * dim + c] = chains.old_velocity[a * dim + c];
    }
    return turned;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template void set_velocities(                                                \
      const std::vector<unsigned int> &, std::size_t, const JoinedMesh<dim> &, \
      const CornerGroups<dim> &, LeapfrogChains<dim> &);                       \
  template void set_old_velocity(unsigned int, const JoinedMesh<dim> &,        \
                                 const CornerGroups<dim> &,                    \
                                 LeapfrogChains<dim> &);                       \
  template bool turn_friction(const std::vector<unsigned int> &, std::size_t,  \
                              bool, LeapfrogChains<dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
