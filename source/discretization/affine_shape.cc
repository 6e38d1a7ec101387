#include "body_shape.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace nsfd
{
  using namespace dealii;

  /** Of a simplex of degree 1: all from the gradients of its corners. */
  template <int dim>
  void ClassBuilder<dim>::set_corners(BodyShape<dim> &shape) const
  {
    const auto &corners = shape.corners;
    std::copy(corners.begin(), corners.end(), shape.nodes.begin());
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
    shape.volume = 0.;
    shape.centre = Point<dim>();
    for (unsigned int q = 0; q < cell_rule_.size(); ++q) {
      Point<dim> x;
      for (unsigned int i = 0; i <= dim; ++i)
        x += shape.values[q * (dim + 1) + i] * corners[i];
      shape.positions[q] = x;
      shape.JxW[q] = det * cell_rule_.weight(q);
      shape.volume += shape.JxW[q];
      shape.centre += shape.JxW[q] * x;
      std::copy(gradients.begin(), gradients.end(),
                shape.gradients.begin() + q * (dim + 1));
    }
    shape.centre /= shape.volume;

    std::array<double, dim + 1> steepness; // height of a corner is its inverse
    for (unsigned int i = 0; i <= dim; ++i)
      steepness[i] = gradients[i].norm();
    shape.height = 1. / *std::max_element(steepness.begin(), steepness.end());
    const double whole_face = std::accumulate(
        face_rule_.get_weights().begin(), face_rule_.get_weights().end(), 0.);
    const std::size_t n_slots = face_rule_.size();
    for (std::size_t s = 0; s < shape.slot_places.size(); ++s) {
      shape.slot_positions[s] =
          corners[0] + J * Tensor<1, dim>(shape.slot_places[s]);
      shape.slot_normals[s] = -double(dim) * shape.volume *
                              face_rule_.weight(unsigned(s % n_slots)) /
                              whole_face *
                              gradients[opposite_[shape.slot_faces[s]]];
    }
  }

  template void ClassBuilder<2>::set_corners(BodyShape<2> &) const;
  template void ClassBuilder<3>::set_corners(BodyShape<3> &) const;
} // namespace nsfd
