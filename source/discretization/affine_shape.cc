#include "body_shape.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace nsfd
{
  using namespace dealii;

  /** Of a simplex of degree 1: all from the gradients of its corners. */
  template <int dim>
  std::unique_ptr<const BodyShape<dim>>
  ClassBuilder<dim>::with_corners(const BodyShape<dim> &of_class,
                                  const std::vector<Point<dim>> &corners) const
  {
    auto shape = std::make_unique<BodyShape<dim>>();
    shape->reference = of_class.reference;
    shape->n_nodes = of_class.n_nodes;
    shape->values = of_class.values;
    shape->slot_places = of_class.slot_places;
    shape->slot_faces = of_class.slot_faces;
    shape->corner_values = of_class.corner_values;
    shape->moduli = of_class.moduli;
    shape->elasticity = of_class.elasticity;
    shape->extremes = of_class.extremes;
    shape->corners = corners;
    shape->nodes = corners;

    Tensor<2, dim> J;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int i = 0; i < dim; ++i)
        J[c][i] = corners[i + 1][c] - corners[0][c];
    const auto inverse = invert(J);
    const double det = determinant(J);
    std::array<Tensor<1, dim>, dim + 1> gradients; // of linear functions
    for (unsigned int i = 0; i < dim; ++i) {
      gradients[i + 1] = inverse[i];
      gradients[0] -= inverse[i];
    }
    for (unsigned int q = 0; q < cell_rule_.size(); ++q) {
      Point<dim> x;
      for (unsigned int i = 0; i <= dim; ++i)
        x += shape->values[q * (dim + 1) + i] * corners[i];
      shape->positions.push_back(x);
      shape->JxW.push_back(det * cell_rule_.weight(q));
      shape->volume += shape->JxW.back();
      shape->centre += shape->JxW.back() * x;
      shape->gradients.insert(shape->gradients.end(), gradients.begin(),
                              gradients.end());
    }
    shape->centre /= shape->volume;

    std::array<double, dim + 1> steepness; // height of a corner is its inverse
    for (unsigned int i = 0; i <= dim; ++i)
      steepness[i] = gradients[i].norm();
    shape->height = 1. / *std::max_element(steepness.begin(), steepness.end());
    const double whole_face = std::accumulate(
        face_rule_.get_weights().begin(), face_rule_.get_weights().end(), 0.);
    const std::size_t n_slots = face_rule_.size();
    for (std::size_t s = 0; s < shape->slot_places.size(); ++s) {
      const Point<dim> &xi = shape->slot_places[s];
      shape->slot_positions.push_back(corners[0] + J * Tensor<1, dim>(xi));
      // the corner that the face does not have
      unsigned int opposite = dim * (dim + 1) / 2;
      for (unsigned int v = 0; v < dim; ++v)
        opposite -=
            shape->reference.face_to_cell_vertices(shape->slot_faces[s], v, 1);
      shape->slot_normals.push_back(-double(dim) * shape->volume *
                                    face_rule_.weight(unsigned(s % n_slots)) /
                                    whole_face * gradients[opposite]);
    }
    return shape;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::unique_ptr<const BodyShape<dim>>                               \
  ClassBuilder<dim>::with_corners(const BodyShape<dim> &,                      \
                                  const std::vector<Point<dim>> &) const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
