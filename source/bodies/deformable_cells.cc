#include "deformable_cells.h"

#include "discretization/body_shape.h"
#include "discretization/cells.h"
#include "discretization/material_histories.h"

#include "finite_cell.h"
#include "history_cell.h"
#include "nsfd/materials/material_model.h"
#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  namespace
  {
    template <int dim>
    std::unique_ptr<const DeformableCell<dim>>
    make_cell(const SceneInput &input, const unsigned int material_index,
              const BodyShape<dim> &shape)
    {
      const MaterialInput &material = input.materials[material_index];
      std::vector<double> gradients;
      for (const auto &g : shape.gradients)
        for (unsigned int d = 0; d < dim; ++d)
          gradients.push_back(g[d]);
      if (material.kind == MaterialKind::history_dependent)
        return std::make_unique<const HistoryCell<dim>>(
            material.model->history_dependent<dim>(material, input.large_motion,
                                                   input.plane_stress),
            input.large_motion, shape.JxW, gradients);
      if (material.kind == MaterialKind::finite_strain)
        return std::make_unique<const FiniteCell<dim>>(
            material.model->hyperelastic<dim>(material, input.plane_stress),
            shape.JxW, gradients);
      return nullptr;
    }
  } // namespace

  template <int dim>
  DeformableCells<dim>::DeformableCells(
      const Discretization<dim> &discretization)
      : class_of_(discretization.bodies().class_of),
        first_(first_histories(discretization))
  {
    for (const BodyClass &body : discretization.bodies().classes) {
      cells_.push_back(
          body.bodies.empty()
              ? nullptr
              : make_cell<dim>(
                    discretization.input(), body.material,
                    discretization.cells().class_shape(body.bodies[0])));
      auto &mass = masses_.emplace_back();
      if (cells_.back())
        for (unsigned int j = 0; j < body.n_dofs; ++j)
          for (unsigned int i = 0; i < body.n_dofs; ++i)
            mass.push_back(body.mass(i, j));
    }
  }

  template <int dim>
  DeformableCells<dim>::~DeformableCells() = default;

  template <int dim>
  std::vector<double> DeformableCells<dim>::begin_history() const
  {
    std::vector<double> history(n_history());
    for (unsigned int c = 0; c < class_of_.size(); ++c)
      if (of(c))
        of(c)->begin_history(history.data() + first_[c]);
    return history;
  }

#define INSTANTIATE(dim) template class DeformableCells<dim>

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
