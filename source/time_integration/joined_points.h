#pragma once

#include "discretization/discretization.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct State;

  bool has_rigid_cells(const SceneInput &input);

  /**
   * By point: what is joined by common nodes before anything has let go, as
   * @p state has it, where its kind becomes `bonded`. A law between two rigid
   * cells of different materials holds them from the start instead: they have
   * no stress that would tell when it is needed. Those of one material are one
   * body, whatever law their faces have.
   */
  template <int dim>
  std::vector<std::uint8_t>
  joined_points(const Discretization<dim> &discretization, State &state);
} // namespace nsfd
