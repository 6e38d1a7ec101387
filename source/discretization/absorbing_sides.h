#pragma once

#include "cells.h"

#include "mesh/cell_set.h"

#include <array>
#include <vector>

namespace nsfd
{
  template <int dim>
  class MeshGroups;

  /** A face of a body through which waves leave. */
  struct AbsorbingFace {
    unsigned int body, face;
  };

  /** Of the cells of a set, in their order. */
  template <int dim>
  std::vector<AbsorbingFace>
  find_absorbing_faces(const dealii::Triangulation<dim, dim> &triangulation,
                       const MeshGroups<dim> &groups, const SceneInput &input,
                       CellSet set);

  /**
   * The dashpots of Lysmer and Kuhlemeyer (1969) on face @p face of a cell,
   *
   *   C_ij = int N_i N_j (rho c_p n n + rho c_s (1 - n n)),
   *
   * with the speeds of the fastest and the slowest plane wave; their means over
   * a cell of graded constants. Exact for plane waves along the normal of an
   * isotropic body. Symmetric and positive semi-definite, N s/m by unknown.
   */
  template <int dim>
  Block absorbing_block(const dealii::FiniteElement<dim, dim> &element,
                        const BodyShape<dim> &shape, unsigned int face);

  /** The sums of its rows over the nodes: dim x dim values by node. */
  template <int dim>
  std::vector<std::array<double, dim * dim>>
  lumped_absorbing(const dealii::FiniteElement<dim, dim> &element,
                   const BodyShape<dim> &shape, unsigned int face);
} // namespace nsfd
