#pragma once

#include "bodies/moving_bodies.h"

namespace nsfd
{
  /**
   * The contacts of a step in an array over the points of the mesh, @p width
   * numbers each: where MovingBodies has them, and away again.
   */
  template <int dim, typename Array>
  void insert_contacts(const MovingBodies<dim> &bodies, Array &array,
                       const unsigned int width,
                       const typename Array::value_type value)
  {
    array.insert(array.begin() + long(bodies.row_point(0) * width),
                 bodies.rows().size() * width, value);
  }
  template <int dim, typename Array>
  void erase_contacts(const MovingBodies<dim> &bodies, Array &array,
                      const unsigned int width)
  {
    const auto first = array.begin() + long(bodies.row_point(0) * width);
    if (!array.empty())
      array.erase(first, first + long(bodies.rows().size() * width));
  }

  /** The same of all fields that points have. */
  template <int dim>
  void insert_contacts(const SceneInput &input, const MovingBodies<dim> &bodies,
                       State &state);
  template <int dim>
  void erase_contacts(const SceneInput &input, const MovingBodies<dim> &bodies,
                      State &state);
} // namespace nsfd
