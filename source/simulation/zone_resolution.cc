#include "zone_resolution.h"

#include "advice.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    constexpr double unknown = std::numeric_limits<double>::infinity();

    /** Of the elastic bodies on this rank beside a face, at an average point.
     */
    template <int dim>
    double length_at(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const typename InterfacePoints<dim>::Face &face,
                     const CohesiveLaw &law)
    {
      double length = unknown;
      for (const int body : face.bodies) {
        if (body < 0)
          continue;
        const unsigned int material =
            discretization.cells().body_class(unsigned(body)).material;
        const auto &soft = discretization.extremes(material).softest;
        if (!input.materials[material].rigid)
          length =
              std::min(length, cohesive_length(soft.young, soft.poisson, law));
      }
      return length;
    }
  } // namespace

  template <int dim>
  std::optional<ZoneResolution>
  zone_resolution(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const OneStepProblem<dim> &problem, const State &state,
                  const Communicator &communicator)
  {
    bool any = false;
    double worst = unknown; // points on the length
    ZoneResolution zone;
    unsigned int block = 0;
    const auto &points = discretization.points();
    for (const auto &face : points.faces) {
      const PointOrigin origin = discretization.origins()[face.first];
      if (origin.kind != PointOrigin::Kind::interface ||
          !input.interfaces[origin.block].law)
        continue;
      const CohesiveLaw &law = *input.interfaces[origin.block].law;
      double factor = 0.; // strength^2 over toughness, relative to the law
      double measure = 0.;
      for (unsigned int i = face.first; i < face.first + face.count; ++i) {
        measure += points.measure(i);
        // what is broken from the start has no history
        if (state.beta[i] < 1. && state.opening_max[i] > 0.)
          factor = std::max(factor, problem.strength_factor[i] *
                                        problem.opening_factor[i]);
      }
      if (factor == 0.)
        continue;
      any = true;
      const double length =
          length_at<dim>(input, discretization, face, law) / factor;
      const double spacing = std::pow(measure, 1. / (dim - 1)) /
                             input.discretization.interface_points;
      if (length / spacing < worst) {
        worst = length / spacing;
        zone.length = length;
        zone.spacing = spacing;
        block = origin.block;
      }
    }
    if (!communicator.any(any))
      return {};
    const double least = communicator.min(worst);
    if (!std::isfinite(least))
      return zone;
    // of equal ones the first block and the shortest length
    const auto among_worst = [&](const double value) {
      return communicator.min(worst == least ? value : unknown);
    };
    block = unsigned(among_worst(block));
    zone.length = among_worst(zone.length);
    zone.spacing = zone.length / least;
    zone.interface = input.interfaces[block].name;
    return zone;
  }

  template std::optional<ZoneResolution>
  zone_resolution(const SceneInput &, const Discretization<2> &,
                  const OneStepProblem<2> &, const State &,
                  const Communicator &);
  template std::optional<ZoneResolution>
  zone_resolution(const SceneInput &, const Discretization<3> &,
                  const OneStepProblem<3> &, const State &,
                  const Communicator &);
} // namespace nsfd
