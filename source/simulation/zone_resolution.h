#pragma once

#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"
#include "records/certificate.h"

#include <optional>

namespace nsfd
{
  struct SceneInput;
  struct State;

  /**
   * The smallest cohesive length (50) over the spacing of points, of all points
   * that have softened by @p state: of the material on either side, with the
   * strength and toughness of the point. Spacing: the length of the face (the
   * root of its area) over its points per direction. Nothing if no point has;
   * length 0 if there are rigid bodies on both sides of all of them.
   * Collective.
   */
  template <int dim>
  std::optional<ZoneResolution>
  zone_resolution(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const OneStepProblem<dim> &problem, const State &state,
                  const Communicator &communicator);
} // namespace nsfd
