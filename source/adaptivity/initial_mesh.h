#pragma once

#include <deal.II/grid/tria.h>

namespace nsfd
{
  struct SceneInput;

  /**
   * Refines a mesh of quads or hexes before anything is built on it, level by
   * level, where indicators that look at places alone ask for smaller cells.
   * Collective.
   */
  template <int dim>
  void refine_by_place(const SceneInput &input,
                       dealii::Triangulation<dim, dim> &triangulation);
} // namespace nsfd
