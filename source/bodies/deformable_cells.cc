#include "deformable_cells.h"

#include "discretization/body_shape.h"
#include "discretization/cells.h"

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

  unsigned int n_history(const SceneInput &input, const unsigned int material)
  {
    const MaterialInput &m = input.materials[material];
    if (m.kind != MaterialKind::history_dependent)
      return 0;
    // the same in the plane and in space
    return m.model->history_dependent<3>(m, input.large_motion, false)
        ->n_history();
  }

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

#define INSTANTIATE(dim)                                                       \
  template std::vector<std::size_t> first_histories<dim>(                      \
      const Discretization<dim> &);                                            \
  template class DeformableCells<dim>

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
