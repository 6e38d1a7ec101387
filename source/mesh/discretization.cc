#include "nsfd/mesh/discretization.h"

#include "cells.h"
#include "elasticity.h"
#include "face_points.h"
#include "loads.h"

#include "../motion/cauchy_stress.h"

#include "nsfd/input/scene_input.h"
#include "nsfd/mesh/mesh_builder.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    bool is_driven(const BoundaryInput &boundary)
    {
      for (unsigned int c = 0; c < dim; ++c)
        if (boundary.velocity[c] || boundary.displacement[c])
          return true;
      return false;
    }

    /** Nodal forces of a body as generalised ones: R^T for a rigid body. */
    void add_to_unknowns(const BodyClass &body, const Block &modes,
                         const double *in, double *out)
    {
      if (!body.rigid)
        for (unsigned int i = 0; i < body.n_dofs; ++i)
          out[i] += in[i];
      else
        for (unsigned int j = 0; j < modes.cols; ++j)
          for (unsigned int i = 0; i < modes.rows; ++i)
            out[j] += modes(i, j) * in[i];
    }
  } // namespace

  template <int dim>
  Discretization<dim>::~Discretization() = default;

  template <int dim>
  Discretization<dim>::Discretization(Discretization &&) noexcept = default;

  template <int dim>
  Discretization<dim> &
  Discretization<dim>::operator=(Discretization &&) noexcept = default;

  template <int dim>
  Discretization<dim>::Discretization(
      const Communicator &communicator, const Triangulation<dim> &triangulation,
      const MeshGroups<dim> &groups, const std::vector<unsigned int> &materials,
      const SceneInput &input)
      : input_(&input),
        loads_(std::make_unique<Loads<dim>>(triangulation, groups, input)),
        extent_((groups.upper() - groups.lower()).norm())
  {
    for (unsigned int b = 0; b < input.boundaries.size(); ++b)
      if (is_driven<dim>(input.boundaries[b]))
        driven_.push_back(b);
    auto cells = std::make_unique<Cells<dim>>(triangulation, materials, input);
    auto faces = make_face_points(communicator, triangulation, groups,
                                  materials, driven_, input);
    points_ = std::move(faces.points);
    origins_ = std::move(faces.origins);
    springs_inside_ = std::move(faces.springs_inside);
    obstacle_faces_ = std::move(faces.obstacle_faces);
    inner_faces_ = std::move(faces.inner_faces);
    fill_slots(points_, *cells);
    cells_ = std::move(cells);

    double size = std::numeric_limits<double>::max(), crossing = size;
    for (std::size_t k = 0; k < cells_->shapes.size(); ++k) {
      const BodyClass &body = bodies().classes[k];
      const double height = cells_->shapes[k].height;
      size = std::min(size, height);
      if (!input.materials[body.material].rigid)
        crossing =
            std::min(crossing, height / pressure_wave_speed(body.material));
    }
    cell_size_ = communicator.min(size);
    crossing_time_ = communicator.min(crossing);
    if (crossing_time_ == std::numeric_limits<double>::max())
      crossing_time_ = 0.;
    n_global_cells_ = communicator.sum_integer(bodies().size());
  }

  template <int dim>
  const Bodies &Discretization<dim>::bodies() const
  {
    return cells_->bodies;
  }

  template <int dim>
  const FiniteElement<dim, dim> &Discretization<dim>::element() const
  {
    return *cells_->element;
  }

  template <int dim>
  bool Discretization<dim>::simplices() const
  {
    return element().reference_cell().is_simplex();
  }

  template <int dim>
  unsigned int Discretization<dim>::material_of(const unsigned int body) const
  {
    return cells_->body_class(body).material;
  }

  template <int dim>
  const BodyShape<dim> &
  Discretization<dim>::shape(const unsigned int body) const
  {
    return cells_->shape(body);
  }

  template <int dim>
  unsigned int
  Discretization<dim>::face_of_slot(const unsigned int body,
                                    const unsigned int slot) const
  {
    return cells_->shape(body).slot_faces[slot];
  }

  template <int dim>
  std::size_t Discretization<dim>::n_nodal() const
  {
    return cells_->n_nodal();
  }

  template <int dim>
  std::size_t Discretization<dim>::first_node(const unsigned int body) const
  {
    return cells_->first_node[body];
  }

  template <int dim>
  const std::array<unsigned int, 4> &
  Discretization<dim>::cell_id(const unsigned int body) const
  {
    return cells_->cell_id[body];
  }

  template <int dim>
  unsigned long long
  Discretization<dim>::global_cell(const unsigned int body) const
  {
    return cells_->global_cell[body];
  }

  template <int dim>
  std::vector<Point<dim>>
  Discretization<dim>::corners(const unsigned int body) const
  {
    return cells_->corners[body];
  }

  template <int dim>
  double Discretization<dim>::volume(const unsigned int body) const
  {
    return cells_->shape(body).volume;
  }

  template <int dim>
  Point<dim> Discretization<dim>::centre(const unsigned int body) const
  {
    return cells_->place(body, cells_->shape(body).centre);
  }

  template <int dim>
  double
  Discretization<dim>::pressure_wave_speed(const unsigned int material) const
  {
    return LinearElasticity<dim>(input_->materials[material],
                                 input_->plane_stress)
        .pressure_wave_speed();
  }

  template <int dim>
  double
  Discretization<dim>::shear_wave_speed(const unsigned int material) const
  {
    return LinearElasticity<dim>(input_->materials[material],
                                 input_->plane_stress)
        .shear_wave_speed();
  }

  template <int dim>
  std::array<double, 6>
  Discretization<dim>::stress(const unsigned int body,
                              const double *gradient) const
  {
    const auto &material = input_->materials[material_of(body)];
    if (material.rigid)
      return {};
    if (is_finite_strain(material.model))
      return cauchy_stress<dim>(material, input_->plane_stress, gradient);
    return LinearElasticity<dim>(material, input_->plane_stress)
        .stress(gradient);
  }

  template <int dim>
  bool Discretization<dim>::has_loads() const
  {
    return loads_->any();
  }

  template <int dim>
  bool Discretization<dim>::loads_depend_on_time() const
  {
    return loads_->depend_on_time();
  }

  template <int dim>
  void Discretization<dim>::add_loads(const double t,
                                      std::vector<double> &forces) const
  {
    std::vector<double> nodal(n_nodal(), 0.);
    loads_->add(*cells_, t, nodal);
    for (std::size_t b = 0; b < bodies().size(); ++b)
      add_to_unknowns(cells_->body_class(b), cells_->shape(b).modes,
                      nodal.data() + cells_->first_node[b] * dim,
                      forces.data() + bodies().first_dof[b]);
  }

  template <int dim>
  std::vector<double>
  Discretization<dim>::to_nodal(const std::vector<double> &unknowns) const
  {
    std::vector<double> nodal(n_nodal(), 0.);
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const auto &body = cells_->body_class(b);
      const double *z = unknowns.data() + bodies().first_dof[b];
      double *out = nodal.data() + cells_->first_node[b] * dim;
      if (!body.rigid) {
        std::copy_n(z, body.n_dofs, out);
        continue;
      }
      const Block &R = cells_->shape(b).modes;
      for (unsigned int i = 0; i < R.rows; ++i)
        for (unsigned int j = 0; j < R.cols; ++j)
          out[i] += R(i, j) * z[j];
    }
    return nodal;
  }

  template <int dim>
  std::vector<double> Discretization<dim>::interpolate(const Field &field) const
  {
    std::vector<double> unknowns(bodies().n_dofs(), 0.);
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const auto &body = cells_->body_class(b);
      const auto &shape = cells_->shape(b);
      std::vector<double> nodal(shape.n_nodes * dim);
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        field(cells_->place(b, shape.nodes[i]), unsigned(b),
              nodal.data() + i * dim);
      double *out = unknowns.data() + bodies().first_dof[b];
      if (!body.rigid)
        std::copy(nodal.begin(), nodal.end(), out);
      else
        for (unsigned int j = 0; j < body.n_dofs; ++j)
          for (std::size_t i = 0; i < nodal.size(); ++i)
            out[j] += shape.projection(j, unsigned(i)) * nodal[i];
    }
    return unknowns;
  }

  template <int dim>
  void Discretization<dim>::visit_quadrature(const std::vector<double> &nodal,
                                             const Visitor &visit) const
  {
    double value[dim], gradient[dim * dim];
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const auto &shape = cells_->shape(b);
      const double *u = nodal.data() + cells_->first_node[b] * dim;
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        std::fill(value, value + dim, 0.);
        std::fill(gradient, gradient + dim * dim, 0.);
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          const double N = shape.values[q * shape.n_nodes + i];
          const auto &g = shape.gradients[q * shape.n_nodes + i];
          for (unsigned int c = 0; c < dim; ++c) {
            value[c] += N * u[i * dim + c];
            for (unsigned int d = 0; d < dim; ++d)
              gradient[c * dim + d] += g[d] * u[i * dim + c];
          }
        }
        visit(unsigned(b), cells_->place(b, shape.positions[q]), shape.JxW[q],
              value, gradient);
      }
    }
  }

  template <int dim>
  std::vector<double>
  Discretization<dim>::at_corners(const unsigned int body,
                                  const std::vector<double> &nodal) const
  {
    const auto &shape = cells_->shape(body);
    const double *u = nodal.data() + cells_->first_node[body] * dim;
    std::vector<double> result(shape.corners.size() * dim, 0.);
    for (std::size_t v = 0; v < shape.corners.size(); ++v)
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          result[v * dim + c] +=
              shape.corner_values[v * shape.n_nodes + i] * u[i * dim + c];
    return result;
  }

  template class Discretization<2>;
  template class Discretization<3>;
} // namespace nsfd
