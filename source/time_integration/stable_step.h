#pragma once

#include "delassus/delassus_operator.h"

#include <limits>

namespace nsfd
{
  /**
   * The longest step of the explicit scheme on free bodies of this rank,
   * 2 / omega_max, in s; infinite if all are rigid. Joints, springs and
   * contacts are implicit in it and leave it as it is.
   */
  double stable_step(const Bodies &bodies);

  /**
   * The same of bodies that are joined by explicit bonds: the largest frequency
   * of M^{-1} K from above, by Lanczos' method to a thousandth. @p delassus is
   * prepared for explicit bodies and has its bonds. As soon as steps of
   * @p enough are known to be stable the search ends with what is known.
   * Collective.
   */
  template <int dim>
  double stable_step(const DelassusOperator<dim> &delassus,
                     double enough = std::numeric_limits<double>::infinity());
} // namespace nsfd
