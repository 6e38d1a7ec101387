#include "leapfrog_loads.h"

#include "bodies/rigid_places.h"
#include "discretization/loads.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  auto
  LeapfrogLoads<dim>::extra_weights(const SceneInput &input,
                                    const Discretization<dim> &discretization)
      -> Forces
  {
    Forces result;
    if (!input.large_motion ||
        std::none_of(input.materials.begin(), input.materials.end(),
                     [](const auto &material) { return material.rigid; }))
      return result;
    const BodyLayout<dim> layout(input, discretization);
    const RigidPlaces<dim> places(layout, discretization.cells());
    for (const MovingBody &body : layout.bodies())
      if (body.extra_weight != 0.)
        for (const auto &[corner, share] : places.centre(body.number)) {
          auto &force =
              result.emplace_back(corner, std::array<double, dim>()).second;
          for (unsigned int c = 0; c < dim; ++c)
            force[c] = share * body.extra_weight * input.gravity[c];
        }
    return result;
  }

  template <int dim>
  void LeapfrogLoads<dim>::start(const double time, const LoadClock &clock,
                                 const CornerGroups<dim> &groups)
  {
    clock_ = clock;
    if (discretization_.loads().any())
      set(time, groups);
    if (absorbing_)
      absorbing_->gather(groups);
  }

  template <int dim>
  void LeapfrogLoads<dim>::move_to(const double time, const LoadClock &clock,
                                   const CornerGroups<dim> &groups)
  {
    // what a clock stops goes on to have the load of the step before
    clock_ = clock;
    if (discretization_.loads().depend_on_time() && time != time_)
      set(time, groups);
  }

  template <int dim>
  void LeapfrogLoads<dim>::set(const double time,
                               const CornerGroups<dim> &groups)
  {
    time_ = time;
    of_corners_.assign(mesh_.n_corners() * dim, 0.);
    discretization_.add_loads(time, of_corners_, clock_);
    for (const auto &[corner, force] : extra_weights_)
      for (unsigned int c = 0; c < dim; ++c)
        of_corners_[corner * dim + c] += force[c];
    of_groups_.assign(groups.force.size(), 0.);
    for (std::size_t i = 0; i < mesh_.n_corners(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        of_groups_[groups.of(i) * dim + c] += of_corners_[i * dim + c];
    hanging_.collect(groups, of_groups_, shares_);
  }

  template <int dim>
  void LeapfrogLoads<dim>::gather(const std::size_t node,
                                  const CornerGroups<dim> &groups)
  {
    if (absorbing_)
      absorbing_->gather(groups);
    if (of_corners_.empty())
      return;
    of_groups_.resize(groups.force.size());
    for (const unsigned int corner : mesh_.corners_of_node(node))
      for (unsigned int c = 0; c < dim; ++c)
        of_groups_[groups.of(corner) * dim + c] = 0.;
    for (const unsigned int corner : mesh_.corners_of_node(node))
      for (unsigned int c = 0; c < dim; ++c)
        of_groups_[groups.of(corner) * dim + c] +=
            of_corners_[corner * dim + c];
    hanging_.add_shares(node, groups, shares_, of_groups_);
  }

  template <int dim>
  const std::vector<double> &
  LeapfrogLoads<dim>::sum(const double time, const ViscousForces<dim> *viscous,
                          const LeapfrogChains<dim> &chains,
                          const CornerGroups<dim> &groups)
  {
    if (!viscous && !cracks_)
      return of_groups_;
    sum_ = of_groups_;
    sum_.resize(groups.force.size(), 0.);
    const auto add = [this](const std::vector<double> &more) {
      for (std::size_t k = 0; k < more.size(); ++k)
        sum_[k] += more[k];
    };
    if (viscous)
      add(viscous->of_groups());
    if (cracks_) {
      cracks_->set(time, chains, groups);
      add(cracks_->of_groups());
    }
    return sum_;
  }

  template class LeapfrogLoads<2>;
  template class LeapfrogLoads<3>;
} // namespace nsfd
