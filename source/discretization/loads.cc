#include "loads.h"

#include "axis.h"
#include "mesh/owned_cells.h"

#include "cell_geometry.h"
#include "mesh/mesh_builder.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/grid/tria.h>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  Loads<dim>::Loads(const Triangulation<dim> &triangulation,
                    const MeshGroups<dim> &groups, const SceneInput &input,
                    const CellSet set)
      : input_(input), any_(input.has_initial_stress()),
        absorbing_faces_(
            find_absorbing_faces(triangulation, groups, input, set))
  {
    for (unsigned int c = 0; c < dim; ++c)
      any_ |= input.gravity[c] != 0.;
    for (const auto &material : input.materials)
      for (unsigned int c = 0; c < dim; ++c) {
        any_ |= !material.body_force[c].is_zero();
        depend_on_time_ |= material.body_force[c].depends_on_time();
      }
    for (const auto &boundary : input.boundaries) {
      any_ |= boundary.has_traction || boundary.has_pressure;
      depend_on_time_ |= boundary.pressure.depends_on_time();
      for (unsigned int c = 0; c < dim; ++c)
        depend_on_time_ |= boundary.traction[c].depends_on_time();
    }

    unsigned int body = 0;
    for (const auto &cell : cells_of(triangulation, set)) {
      for (const unsigned int f : cell->face_indices())
        for (unsigned int b = 0; b < input.boundaries.size(); ++b) {
          const auto &boundary = input.boundaries[b];
          if ((boundary.has_traction || boundary.has_pressure) &&
              groups.holds_boundary_face(boundary.where, cell, f))
            faces_.push_back({body, f, b});
          if ((boundary.temperature || boundary.heat_flux) &&
              groups.holds_boundary_face(boundary.where, cell, f))
            heated_faces_.push_back({body, f, b});
        }
      ++body;
    }
  }

  template <int dim>
  void Loads<dim>::add(const Cells<dim> &cells, const double t,
                       const LoadClock &clock, std::vector<double> &nodal) const
  {
    add_volume(cells, t, nodal);
    if (initial_stress_)
      for (std::size_t k = 0; k < nodal.size(); ++k)
        nodal[k] += initial_stress_->forces()[k];
    for (const auto &load : faces_) {
      const auto &boundary = input_.boundaries[load.boundary];
      const double its_time = clock.at(load.boundary, t);
      const auto of_body = cells.shape(load.body);
      const BodyShape<dim> &shape = *of_body;
      const FaceGeometry<dim> face(shape.reference, shape.corners, load.face);
      Quadrature<dim - 1> quadrature;
      if (face.is_triangle())
        quadrature = QGaussSimplex<dim - 1>(3);
      else
        quadrature = QGauss<dim - 1>(input_.discretization.degree + 2);
      for (unsigned int q = 0; q < quadrature.size(); ++q) {
        const auto xi = quadrature.point(q);
        const Tensor<1, dim> n = // times the measure
            face.normal(xi) * radius_or_one(shape, face.position(xi));
        const double JxW = n.norm() * quadrature.weight(q);
        const Point<dim> x = cells.place(load.body, face.position(xi));
        const double p =
            boundary.has_pressure ? boundary.pressure.at(x, its_time) : 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          double f = -p * n[c] * quadrature.weight(q);
          if (boundary.has_traction)
            f += JxW * boundary.traction[c].at(x, its_time);
          for (unsigned int i = 0; i < shape.n_nodes; ++i)
            nodal[(cells.first_node[load.body] + i) * dim + c] +=
                f * cells.element->shape_value(i, face.in_reference_cell(xi));
        }
      }
    }
    if (input_.axisymmetric) // of what acts radially there nothing moves
      for (std::size_t b = 0; b < cells.bodies.size(); ++b)
        hold_nodes<dim>(cells.class_shape(b).on_axis,
                        &nodal[cells.first_node[b] * dim]);
  }

  template <int dim>
  void Loads<dim>::add_volume(const Cells<dim> &cells, const double t,
                              std::vector<double> &nodal) const
  {
    const auto is_loaded = [&](const MaterialInput &material) {
      for (unsigned int c = 0; c < dim; ++c)
        if (input_.gravity[c] != 0. || !material.body_force[c].is_zero())
          return true;
      return false;
    };
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const auto &material = input_.materials[cells.body_class(b).material];
      if (!is_loaded(material))
        continue;
      const auto of_body = cells.shape(b);
      const BodyShape<dim> &shape = *of_body;
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        const Point<dim> x = cells.place(b, shape.positions[q]);
        for (unsigned int c = 0; c < dim; ++c) {
          double f = at_place(shape.moduli, q).density * input_.gravity[c];
          if (!material.body_force[c].is_zero())
            f += material.body_force[c].at(x, t);
          if (f != 0.)
            for (unsigned int i = 0; i < shape.n_nodes; ++i)
              nodal[(cells.first_node[b] + i) * dim + c] +=
                  shape.JxW[q] * f * shape.values[q * shape.n_nodes + i];
        }
      }
    }
  }

  template class Loads<2>;
  template class Loads<3>;
} // namespace nsfd
