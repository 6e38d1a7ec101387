#include "body_thickness.h"

#include "cell_geometry.h"
#include "cells.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Across which a cell is thinnest. */
    template <int dim>
    double width(const ReferenceCell &reference,
                 const std::vector<Point<dim>> &corners)
    {
      double result = std::numeric_limits<double>::infinity();
      for (unsigned int f = 0; f < reference.n_faces(); ++f) {
        const FaceGeometry<dim> face(reference, corners, f);
        Point<dim - 1> middle;
        const unsigned int n = face.corners().size();
        for (unsigned int d = 0; d < dim - 1; ++d)
          middle[d] = dim == 3 && n == 3 ? 1. / 3. : 0.5;
        Tensor<1, dim> normal = face.normal(middle);
        normal /= normal.norm();
        double height = 0.;
        for (const auto &corner : corners)
          height =
              std::max(height, -(normal * (corner - face.position(middle))));
        result = std::min(result, height);
      }
      return result;
    }

    struct BodyMeasures {
      double volume = 0., surface = 0.;
      double width = std::numeric_limits<double>::infinity(); ///< of a cell
    };

    /** Of the bodies of this rank, by their numbers. */
    template <int dim>
    std::map<unsigned int, BodyMeasures>
    measure_bodies(const Discretization<dim> &discretization)
    {
      const BodyTable &table = discretization.body_table();
      const ReferenceCell reference =
          discretization.cells().element->reference_cell();
      std::map<unsigned int, BodyMeasures> result;
      const auto number = [&](const unsigned int cell) {
        return table.body_of_global(discretization.cells().global_cell[cell]);
      };
      const auto measure = [&](const unsigned int cell, const unsigned int f) {
        return FaceGeometry<dim>(reference,
                                 discretization.cells().corners[cell], f)
            .measure();
      };
      for (unsigned int b = 0; b < discretization.bodies().size(); ++b) {
        BodyMeasures &body = result[number(b)];
        if (!discretization.input().axisymmetric) // whose cells are rings
          body.volume += discretization.cells().volume(b);
        body.width =
            std::min(body.width,
                     width<dim>(reference, discretization.cells().corners[b]));
        for (unsigned int f = 0; f < reference.n_faces(); ++f)
          body.surface += measure(b, f);
      }
      for (const InnerFace &face : discretization.inner_faces())
        result[number(face.bodies[0])].surface -=
            2. * measure(face.bodies[0], face.faces[0]);
      return result;
    }
  } // namespace

  template <int dim>
  std::map<unsigned int, double>
  body_thickness(const Discretization<dim> &discretization)
  {
    std::map<unsigned int, double> result;
    for (const auto &[body, whole] : measure_bodies(discretization))
      result[body] = std::max(whole.width, 2. * whole.volume / whole.surface);
    return result;
  }

  template std::map<unsigned int, double>
  body_thickness(const Discretization<2> &);
  template std::map<unsigned int, double>
  body_thickness(const Discretization<3> &);
} // namespace nsfd
