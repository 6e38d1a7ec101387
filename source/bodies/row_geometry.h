#pragma once

#include "moving_row.h"

#include <deal.II/base/point.h>

#include <array>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * Where a contact holds its two bodies, at the middle of a step: nodes of
   * body 2 or its centre, the place of a pin; nodes or the centre of body 1.
   */
  template <int dim>
  struct RowEnds {
    std::array<dealii::Point<dim>, 4> of_1;
    std::array<dealii::Point<dim>, 2> of_2;
  };

  /** From body 1 to body 2. @p shifts of the obstacles, 3 each, or none. */
  template <int dim>
  dealii::Tensor<1, dim>
  row_normal(const SceneInput &input, const MovingRow<dim> &row,
             const RowEnds<dim> &ends, const std::vector<double> &shifts);

  /** Where the bodies touch. */
  template <int dim>
  dealii::Point<dim> row_place(const MovingRow<dim> &row,
                               const RowEnds<dim> &ends,
                               const dealii::Tensor<1, dim> &normal);
} // namespace nsfd
