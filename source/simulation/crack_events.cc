#include "crack_events.h"

#include "nsfd/scene/scene_input.h"
#include "records/engineering.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** Area of the faces that are broken at all of their points. Collective. */
    template <int dim>
    double broken_faces(const Discretization<dim> &discretization,
                        const Communicator &communicator, const State &state)
    {
      const auto &points = discretization.points();
      std::vector<double> areas;
      for (const auto &face : points.faces) {
        if (face.first >= points.n_owned)
          continue;
        double area = 0.;
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          if (state.beta[i] > 0.) {
            area = 0.;
            break;
          }
          area += points.weight[i];
        }
        areas.push_back(area);
      }
      return communicator.sum(areas);
    }
  } // namespace

  template <int dim>
  void CrackEvents<dim>::start(const Discretization<dim> &discretization,
                               const Communicator &communicator, State &state)
  {
    const auto &boundaries = input_.boundaries;
    if (std::any_of(boundaries.begin(), boundaries.end(), [](const auto &one) {
          return one.hold_at != CrackEvent::none;
        }))
      state.clock.stopped.assign(boundaries.size(), LoadClock::runs);
    if (waits_for(CrackEvent::first_face, state))
      broken_faces_ = broken_faces(discretization, communicator, state);
  }

  template <int dim>
  bool CrackEvents<dim>::waits_for(const CrackEvent event,
                                   const State &state) const
  {
    for (unsigned int b = 0; b < state.clock.stopped.size(); ++b)
      if (input_.boundaries[b].hold_at == event &&
          state.clock.stopped[b] == LoadClock::runs)
        return true;
    return false;
  }

  template <int dim>
  std::vector<std::string>
  CrackEvents<dim>::accept(const State &previous,
                           const TimeIntegrator<dim> &integrator,
                           const Discretization<dim> &discretization,
                           const Communicator &communicator, State &state)
  {
    std::vector<std::string> news;
    state.clock = previous.clock;
    state.growth_step = previous.growth_step;
    // the sums are the same on all ranks
    if (!(state.broken_area > previous.broken_area))
      return news;
    state.growth_step = state.step;
    const auto hold = [&](const CrackEvent event, const char *const what) {
      for (unsigned int b = 0; b < state.clock.stopped.size(); ++b)
        if (input_.boundaries[b].hold_at == event &&
            state.clock.stopped[b] == LoadClock::runs) {
          state.clock.stopped[b] = state.time;
          news.push_back(fmt::format("Boundary `{}` holds from t = {} on: {}",
                                     input_.boundaries[b].name,
                                     engineering(state.time, "s", 6), what));
        }
    };
    hold(CrackEvent::first_break, "the first point has broken");
    if (waits_for(CrackEvent::first_face, state)) {
      if (integrator.keeps_motion())
        integrator.show(state);
      const double area = broken_faces(discretization, communicator, state);
      // a face is a larger part of what is broken than the round-off of sums,
      // and of halves of faces
      if (area > broken_faces_ * (1. + 1e-9))
        hold(CrackEvent::first_face, "the first face has broken");
    }
    return news;
  }

  template <int dim>
  bool CrackEvents<dim>::ends_run(const State &state) const
  {
    const unsigned int rest = input_.time.rest_steps;
    return rest > 0 && state.growth_step > 0 &&
           state.step >= state.growth_step + rest;
  }

  template <int dim>
  void
  CrackEvents<dim>::fill_counters(const State &state,
                                  std::map<std::string, double> &counters) const
  {
    for (unsigned int b = 0; b < state.clock.stopped.size(); ++b)
      if (state.clock.stopped[b] < LoadClock::runs)
        counters["hold_time_" + input_.boundaries[b].name] =
            state.clock.stopped[b];
    if (input_.time.rest_steps > 0)
      counters["last_growth_step"] = state.growth_step;
  }

  template class CrackEvents<2>;
  template class CrackEvents<3>;
} // namespace nsfd
