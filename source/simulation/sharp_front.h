#pragma once

#include "discretization/discretization.h"
#include "records/motion_limits.h"

#include <optional>

namespace nsfd
{
  struct State;

  /**
   * The largest stress that loads and prescribed motions bring into bodies with
   * breakable faces within the transit time of their largest cell, at any time
   * of the run; a velocity v brings density x wave speed x v. Nothing if no
   * face may break or no cell deforms. Collective.
   */
  template <int dim>
  std::optional<SharpFront>
  sharp_front(const SceneInput &input,
              const Discretization<dim> &discretization,
              const Communicator &communicator);

  /**
   * The same with what meets at t = 0: bodies at faces and obstacles that
   * approach each other in @p state. Collective.
   */
  template <int dim>
  void add_impacts(const SceneInput &input,
                   const Discretization<dim> &discretization,
                   const State &state, const Communicator &communicator,
                   SharpFront &front);
} // namespace nsfd
