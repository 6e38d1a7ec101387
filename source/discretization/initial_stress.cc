#include "initial_stress.h"

#include "discretization.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    using Stress = std::array<double, 6>;

    /** Given components take the place of those of @p stress. */
    template <int dim>
    void take(const StressInput &given, const Point<dim> &x, Stress &stress)
    {
      // what is not finite takes note of itself, see check_formulas()
      for (unsigned int k = 0; k < 6; ++k)
        if (given.parts[k])
          stress[k] = given.parts[k]->at(x, 0.);
    }

    /** sigma n. */
    template <int dim>
    std::array<double, dim> along(const Stress &s, const double *n)
    {
      constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
      std::array<double, dim> t{};
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          t[c] += s[at[c][d]] * n[d];
      return t;
    }
  } // namespace

  template <int dim>
  std::unique_ptr<const InitialStress<dim>>
  InitialStress<dim>::make(const SceneInput &input, const Cells<dim> &cells,
                           const InterfacePoints<dim> &points,
                           const std::vector<PointOrigin> &origins)
  {
    if (!input.has_initial_stress())
      return nullptr;
    return std::make_unique<const InitialStress>(input, cells, points, origins);
  }

  template <int dim>
  InitialStress<dim>::InitialStress(const SceneInput &input,
                                    const Cells<dim> &cells,
                                    const InterfacePoints<dim> &points,
                                    const std::vector<PointOrigin> &origins)
      : traction_(points.n_points * dim, 0.), local_(points.n_points * dim, 0.),
        forces_(cells.n_nodal(), 0.)
  {
    set_tractions(input, points, origins);
    load_cells(input, cells);
    if (!beside_.empty())
      load_faces(cells, points);
  }

  template <int dim>
  Stress InitialStress<dim>::at(const MaterialInput &material,
                                const Point<dim> &x)
  {
    Stress stress{};
    take(material.initial_stress, x, stress);
    return stress;
  }

  template <int dim>
  void
  InitialStress<dim>::set_tractions(const SceneInput &input,
                                    const InterfacePoints<dim> &points,
                                    const std::vector<PointOrigin> &origins)
  {
    for (const auto &face : points.faces) {
      if (face.boundary)
        continue;
      const InterfaceInput &block = input.interfaces[origins[face.first].block];
      const bool differs = block.initial_stress.is_given();
      if (differs && beside_.empty())
        beside_.assign(traction_.size(), 0.);
      Point<dim> centre;
      for (unsigned int c = 0; c < dim; ++c)
        centre[c] = face.centre[c];
      for (unsigned int i = face.first; i < face.first + face.count; ++i) {
        // of the face, where a formula jumps at its end
        const Point<dim> x = a_little_inside(position_of(points, i), centre);
        Stress mean{};
        double n_sides = 2.; // with a stress: not of rigid cells
        for (const unsigned int m : face.materials)
          n_sides -= input.materials[m].rigid;
        for (const unsigned int m : face.materials) {
          const Stress side = at(input.materials[m], x);
          for (unsigned int k = 0; n_sides > 0. && k < 6; ++k)
            mean[k] += side[k] / n_sides;
        }
        const double *frame = points.axes(i), *normal = frame;
        Stress carried = mean;
        take(block.initial_stress, x, carried);
        const auto R = along<dim>(carried, normal);
        std::copy(R.begin(), R.end(), &traction_[i * dim]);
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c)
            local_[i * dim + r] += frame[r * dim + c] * R[c];
        if (!differs)
          continue;
        const auto of_cells = along<dim>(mean, normal);
        for (unsigned int c = 0; c < dim; ++c)
          beside_[i * dim + c] = R[c] - of_cells[c];
      }
    }
  }

  template <int dim>
  void InitialStress<dim>::load_cells(const SceneInput &input,
                                      const Cells<dim> &cells)
  {
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const auto &material = input.materials[cells.body_class(b).material];
      if (!material.initial_stress.is_given())
        continue;
      const auto of_body = cells.shape(b);
      const BodyShape<dim> &shape = *of_body;
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        const Stress stress = at(material, cells.place(b, shape.positions[q]));
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          const auto &g = shape.gradients[q * shape.n_nodes + i];
          double gradient[dim];
          for (unsigned int d = 0; d < dim; ++d)
            gradient[d] = g[d];
          auto f = along<dim>(stress, gradient);
          if (is_axisymmetric(shape)) // that along the hoops
            f[0] += stress[2] * shape.values[q * shape.n_nodes + i] /
                    radius_at(shape, shape.positions[q]);
          for (unsigned int c = 0; c < dim; ++c)
            forces_[(cells.first_node[b] + i) * dim + c] -= shape.JxW[q] * f[c];
        }
      }
    }
  }

  template <int dim>
  void InitialStress<dim>::load_faces(const Cells<dim> &cells,
                                      const InterfacePoints<dim> &points)
  {
    const Bodies &bodies = cells.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto &shape = cells.class_shape(b);
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s) {
        const unsigned int point = bodies.slot_point[s];
        if (point >= points.n_points)
          continue;
        const double w = bodies.slot_sign[s] * points.weight[point];
        const auto &place = shape.slot_places[s - bodies.first_slot[b]];
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          const double N = cells.element->shape_value(i, place);
          for (unsigned int c = 0; N != 0. && c < dim; ++c)
            forces_[(cells.first_node[b] + i) * dim + c] +=
                w * N * beside_[point * dim + c];
        }
      }
    }
  }

  template class InitialStress<2>;
  template class InitialStress<3>;
} // namespace nsfd
