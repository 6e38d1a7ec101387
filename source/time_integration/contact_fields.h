#pragma once

#include "bodies/contact_points.h"

namespace nsfd
{
  /**
   * The contacts of a step in an array over the points of the mesh, @p width
   * numbers each: where ContactPoints has them, and away again.
   */
  template <int dim, typename Array>
  void insert_contacts(const ContactPoints<dim> &contacts, Array &array,
                       const unsigned int width,
                       const typename Array::value_type value)
  {
    array.insert(array.begin() + long(contacts.row_point(0) * width),
                 contacts.rows().size() * width, value);
  }
  template <int dim, typename Array>
  void erase_contacts(const ContactPoints<dim> &contacts, Array &array,
                      const unsigned int width)
  {
    const auto first = array.begin() + long(contacts.row_point(0) * width);
    if (!array.empty())
      array.erase(first, first + long(contacts.rows().size() * width));
  }

  /** The same of all fields that points have. */
  template <int dim>
  void insert_contacts(const SceneInput &input,
                       const ContactPoints<dim> &contacts, State &state);
  template <int dim>
  void erase_contacts(const SceneInput &input,
                      const ContactPoints<dim> &contacts, State &state);
} // namespace nsfd
