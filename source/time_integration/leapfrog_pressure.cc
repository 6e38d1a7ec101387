#include "leapfrog_pressure.h"

#include "step_data.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <numeric>

namespace nsfd
{
  template <int dim>
  std::unique_ptr<LeapfrogPressure<dim>>
  LeapfrogPressure<dim>::make(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              const JoinedMesh<dim> &mesh)
  {
    return has_crack_pressure(input)
               ? std::make_unique<LeapfrogPressure>(input, discretization, mesh)
               : nullptr;
  }

  template <int dim>
  void LeapfrogPressure<dim>::set(const double time,
                                  const LeapfrogChains<dim> &chains,
                                  const CornerGroups<dim> &groups)
  {
    of_groups_.assign(groups.size() * dim, 0.);
    of_points_.clear();
    if (order_.size() != chains.size()) {
      order_.resize(chains.size());
      std::iota(order_.begin(), order_.end(), 0u);
      std::sort(order_.begin(), order_.end(),
                [&chains](const unsigned int a, const unsigned int b) {
                  return chains.point[a] < chains.point[b];
                });
    }
    for (const std::size_t a : order_) {
      const std::size_t i = chains.point[a];
      const PointOrigin &origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::interface)
        continue;
      const auto &block = input_.interfaces[origin.block];
      if (!block.crack_pressure)
        continue;
      const double n_open = (chains.beta[a] <= block.pressure_threshold) +
                            (chains.other.beta[a] <= block.pressure_threshold);
      if (n_open == 0.)
        continue;
      const double pressure =
          n_open / 2. *
          block.crack_pressure->at(position_of(discretization_.points(), i),
                                   time);
      of_points_.emplace_back(unsigned(i), pressure);
      const double force = 2. * chains.problem.weight[a] * pressure;
      const auto &corners = mesh_.corners(i);
      for (unsigned int side = 0; side < 2; ++side)
        if (corners[side] != JoinedMesh<dim>::none)
          for (unsigned int c = 0; c < dim; ++c)
            of_groups_[std::size_t(groups.of(corners[side])) * dim + c] +=
                (side == 0 ? -force : force) * chains.frame[a * dim * dim + c];
    }
  }

  template <int dim>
  void LeapfrogPressure<dim>::show(const std::vector<unsigned int> &place,
                                   State &state) const
  {
    state.pressure.assign(state.beta.size(), 0.);
    for (const auto &[i, pressure] : of_points_) {
      const unsigned int at = place.empty() ? i : place[i];
      if (at != unsigned(-1))
        state.pressure[at] = pressure;
    }
  }

  template class LeapfrogPressure<2>;
  template class LeapfrogPressure<3>;
} // namespace nsfd
