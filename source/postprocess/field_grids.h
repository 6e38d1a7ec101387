#pragma once

#include "bodies/fragments.h"
#include "vtu.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** Per face and side: number of the face on the local cell. */
  using FaceNumbers = std::vector<std::array<unsigned int, 2>>;

  template <int dim>
  FaceNumbers face_numbers(const Discretization<dim> &discretization);

  /** Displacement, velocity, stress, fragment, material of all cells. */
  template <int dim>
  VtuGrid volume_grid(const Discretization<dim> &discretization,
                      const State &state, const Fragments<dim> &fragments);

  /** State, jump and traction of all points: each has a piece of its face. */
  template <int dim>
  VtuGrid interface_grid(const Discretization<dim> &discretization,
                         const FaceNumbers &face_numbers, const State &state,
                         double time_step);
} // namespace nsfd
