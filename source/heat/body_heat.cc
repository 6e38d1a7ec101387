#include "body_heat.h"

#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  std::vector<double>
  initial_temperatures(const Discretization<dim> &discretization)
  {
    std::vector<double> result;
    const auto &cells = discretization.cells();
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      for (const auto &corner : cells.corners[b])
        result.push_back(discretization.input()
                             .materials[cells.body_class(b).material]
                             .heat->initial.at(corner));
    return result;
  }

  template <int dim>
  BodyHeat<dim>::BodyHeat(const Discretization<dim> &discretization,
                          const Communicator &communicator)
      : discretization_(discretization), communicator_(communicator),
        conduction_(discretization, communicator),
        at_start_(initial_temperatures(discretization)),
        laws_(has_warm_faces(discretization.input()))
  {
  }

  template <int dim>
  void BodyHeat<dim>::start(State &state)
  {
    state.heat.temperature = at_start_;
    state.heat.conducted_until = state.time;
    set_faces(state);
    state.heat.of_laws = state.heat.at_faces;
    measure(state, 0.);
    state.heat.hottest_of_run = state.heat.hottest;
  }

  template <int dim>
  void BodyHeat<dim>::accept(State &state, const std::function<void()> &show)
  {
    HeatState &heat = state.heat;
    auto &T = heat.temperature;
    const unsigned int n = conduction_.cells().n_corners();
    conduction_.warm(heat.of_points, T);
    const auto &points = discretization_.points();
    std::vector<double> taken;
    if (!heat.of_points.empty()) // with arkode nothing is dissipated
      taken.assign(heat.of_points.begin(),
                   heat.of_points.begin() + long(points.n_owned));
    const auto &cells = discretization_.cells();
    for (std::size_t b = 0; b < heat.of_cells.size(); ++b) {
      const auto &material =
          discretization_.input().materials[cells.body_class(b).material];
      const double energy = material.heat->plastic_share * heat.of_cells[b];
      const auto &capacity = conduction_.cells().of(b).capacity;
      double whole = 0.;
      for (const double part : capacity)
        whole += part;
      for (unsigned int v = 0; v < n; ++v)
        T[b * n + v] += energy / whole;
      taken.push_back(energy);
    }
    const double waited = state.time - heat.conducted_until;
    if (conduction_.conducts() && waited >= conduction_.longest_step()) {
      show();
      const auto step = conduction_.conduct(waited, state, T);
      iterations_ += step.iterations;
      heat.given += step.given;
      heat.conducted_until = state.time;
    }
    set_faces(state);
    measure(state, communicator_.sum(taken));
  }

  /**
   * For the laws of the next step. A law that is partly open keeps its
   * temperature: its energy would change without work. What explicit steps
   * keep of their points by themselves is theirs, see LeapfrogPoints.
   */
  template <int dim>
  void BodyHeat<dim>::set_faces(State &state)
  {
    if (!laws_)
      return;
    HeatState &heat = state.heat;
    heat.at_faces = conduction_.at_faces(heat.temperature);
    for (std::size_t i = 0; i < heat.of_laws.size(); ++i)
      if ((state.kind[i] == PointKind::rigid ||
           state.kind[i] == PointKind::bonded) &&
          state.opening_max[i] == 0.)
        heat.of_laws[i] = heat.at_faces[i];
  }

  template <int dim>
  void
  BodyHeat<dim>::fill_counters(const double time,
                               std::map<std::string, double> &counters) const
  {
    counters["heat_iterations"] = double(iterations_);
    counters["cells_crossed_by_heat"] =
        conduction_.conducts()
            ? std::sqrt(0.1 * time / conduction_.longest_step())
            : 0.;
  }

  /** @p made in the step, J. */
  template <int dim>
  void BodyHeat<dim>::measure(State &state, const double made) const
  {
    HeatState &heat = state.heat;
    const auto &T = heat.temperature;
    const unsigned int n = conduction_.cells().n_corners();
    std::vector<double> stored(2 * T.size()); // and what of it moved
    double hottest = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < T.size(); ++k) {
      stored[k] =
          conduction_.cells().of(k / n).capacity[k % n] * (T[k] - at_start_[k]);
      stored[T.size() + k] = std::abs(stored[k]);
      hottest = std::max(hottest, T[k]);
    }
    heat.made += made;
    const auto sums = communicator_.sums(stored.data(), 2, T.size());
    heat.stored = sums[0];
    heat.moved = std::max(heat.moved, sums[1]);
    heat.hottest = communicator_.max(hottest);
    heat.hottest_of_run = std::max(heat.hottest_of_run, heat.hottest);
  }

  template std::vector<double> initial_temperatures(const Discretization<2> &);
  template std::vector<double> initial_temperatures(const Discretization<3> &);
  template class BodyHeat<2>;
  template class BodyHeat<3>;
} // namespace nsfd
