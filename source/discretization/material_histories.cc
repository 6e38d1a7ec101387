#include "material_histories.h"

#include "body_shape.h"
#include "cells.h"
#include "discretization.h"

#include "nsfd/materials/material_model.h"
#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  namespace
  {
    /** Numbers that a point of a material keeps; 0: none. */
    unsigned int n_history(const SceneInput &input, const unsigned int material)
    {
      const MaterialInput &m = input.materials[material];
      if (m.kind != MaterialKind::history_dependent)
        return 0;
      // the same in the plane and in space
      return m.model->history_dependent<3>(m, input.large_motion, false)
          ->n_history();
    }
  } // namespace

  template <int dim>
  std::vector<std::size_t>
  first_histories(const Discretization<dim> &discretization)
  {
    const SceneInput &input = discretization.input();
    std::vector<unsigned int> of_material;
    for (unsigned int m = 0; m < input.materials.size(); ++m)
      of_material.push_back(n_history(input, m));
    std::vector<std::size_t> first = {0};
    for (unsigned int c = 0; c < discretization.bodies().size(); ++c)
      first.push_back(
          first.back() +
          of_material[discretization.cells().body_class(c).material] *
              discretization.cells().class_shape(c).JxW.size());
    return first;
  }

  template std::vector<std::size_t>
  first_histories<2>(const Discretization<2> &);
  template std::vector<std::size_t>
  first_histories<3>(const Discretization<3> &);
} // namespace nsfd
