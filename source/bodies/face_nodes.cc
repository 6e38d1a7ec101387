#include "face_nodes.h"

#include "discretization/cell_geometry.h"

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Node j is as if at coordinates (i_1, .., i_{dim-1}) of a lattice. */
    template <int dim>
    void sort_in_lattice(const FiniteElement<dim> &element,
                         const unsigned int constant,
                         std::vector<unsigned int> &nodes)
    {
      std::sort(nodes.begin(), nodes.end(),
                [&](const unsigned int a, const unsigned int b) {
                  const auto x = element.unit_support_point(a),
                             y = element.unit_support_point(b);
                  for (unsigned int d = dim; d-- > 0;)
                    if (d != constant && std::abs(x[d] - y[d]) > 1e-8)
                      return x[d] < y[d];
                  return false;
                });
    }

    template <int dim>
    FaceNodes<dim> on_hypercube(const FiniteElement<dim> &element,
                                const unsigned int f)
    {
      const unsigned int constant = f / 2, n = element.degree + 1;
      FaceNodes<dim> face;
      for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
        if (std::abs(element.unit_support_point(i)[constant] - double(f % 2)) <
            1e-8)
          face.nodes.push_back(i);
      sort_in_lattice(element, constant, face.nodes);
      const QGaussLobatto<1> rule(n);
      for (unsigned int j = 0; j < face.nodes.size(); ++j)
        face.weights.push_back(rule.weight(j % n) *
                               (dim == 3 ? rule.weight(j / n) : 1.));
      const unsigned int rows = dim == 3 ? n - 1 : 1;
      for (unsigned int r = 0; r < rows; ++r)
        for (unsigned int c = 0; c + 1 < n; ++c) {
          const unsigned int j = r * n + c;
          face.pieces.push_back({face.nodes[j], face.nodes[j + 1]});
          if (dim == 3)
            face.pieces.back().insert(
                face.pieces.back().end(),
                {face.nodes[j + n + 1], face.nodes[j + n]});
        }
      return face;
    }

    template <int dim>
    FaceNodes<dim> on_simplex(const FiniteElement<dim> &element,
                              const unsigned int f)
    {
      const ReferenceCell cell = element.reference_cell();
      std::vector<Point<dim>> corners;
      for (unsigned int v = 0; v < dim; ++v)
        corners.push_back(
            cell.template vertex<dim>(cell.face_to_cell_vertices(f, v, 1)));
      FaceNodes<dim> face;
      const auto find = [&](const Point<dim> &x) {
        for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
          if (element.unit_support_point(i).distance(x) < 1e-8)
            return i;
        AssertThrow(false, ExcMessage("no node on an edge of a face"));
        return 0u;
      };
      for (const auto &corner : corners)
        face.nodes.push_back(find(corner));
      if (element.degree == 1)
        face.pieces.push_back(face.nodes);
      else {
        const auto between = [&](const unsigned int a, const unsigned int b) {
          face.nodes.push_back(
              find(Point<dim>((corners[a] + Tensor<1, dim>(corners[b])) / 2.)));
          return face.nodes.back();
        };
        const unsigned int a = face.nodes[0], b = face.nodes[1];
        const unsigned int ab = between(0, 1);
        if (dim == 2)
          face.pieces = {{a, ab}, {ab, b}};
        else {
          const unsigned int c = face.nodes[2], bc = between(1, 2),
                             ca = between(2, 0);
          face.pieces = {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}};
        }
      }
      face.weights.assign(face.nodes.size(), 1. / double(face.nodes.size()));
      return face;
    }

    template <int dim>
    Tensor<1, dim> normal_of(const BodyShape<dim> &shape,
                             const std::vector<unsigned int> &piece)
    {
      const auto x = [&](const unsigned int v) {
        return shape.nodes[piece[v]];
      };
      Tensor<1, dim> n;
      if constexpr (dim == 2) {
        const Tensor<1, dim> edge = x(1) - x(0);
        n[0] = edge[1];
        n[1] = -edge[0];
      } else
        n = cross_product_3d(x(1) - x(0), x(2) - x(0));
      return n;
    }
  } // namespace

  template <int dim>
  std::vector<FaceNodes<dim>> face_nodes(const FiniteElement<dim> &element,
                                         const BodyShape<dim> &shape)
  {
    std::vector<FaceNodes<dim>> result;
    for (unsigned int f = 0; f < shape.reference.n_faces(); ++f) {
      FaceNodes<dim> face = shape.reference.is_simplex()
                                ? on_simplex(element, f)
                                : on_hypercube(element, f);
      const double measure =
          FaceGeometry<dim>(shape.reference, shape.corners, f).measure();
      for (double &w : face.weights)
        w *= measure;
      for (auto &piece : face.pieces) {
        const auto out = shape.nodes[piece[0]] - shape.centre;
        if (normal_of(shape, piece) * out < 0.)
          std::reverse(piece.begin(), piece.end());
      }
      face.normal = normal_of(shape, face.pieces[0]);
      face.normal /= face.normal.norm();
      result.push_back(std::move(face));
    }
    return result;
  }

  template std::vector<FaceNodes<2>> face_nodes(const FiniteElement<2> &,
                                                const BodyShape<2> &);
  template std::vector<FaceNodes<3>> face_nodes(const FiniteElement<3> &,
                                                const BodyShape<3> &);
} // namespace nsfd
