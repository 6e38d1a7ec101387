#include "cell_geometry.h"

#include <cmath>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  Tensor<1, dim> linear_gradient(const ReferenceCell &cell,
                                 const Point<dim> &xi, const unsigned int v)
  {
    if (!cell.is_simplex())
      return cell.d_linear_shape_function_gradient(xi, v);
    Tensor<1, dim> gradient;
    for (unsigned int c = 0; c < dim; ++c)
      gradient[c] = v == 0 ? -1. : (c + 1 == v ? 1. : 0.);
    return gradient;
  }

  template <int dim>
  Point<dim> map_point(const ReferenceCell &cell,
                       const std::vector<Point<dim>> &corners,
                       const Point<dim> &xi)
  {
    Point<dim> x;
    for (unsigned int v = 0; v < corners.size(); ++v)
      x += cell.d_linear_shape_function(xi, v) * corners[v];
    return x;
  }

  template <int dim>
  Tensor<2, dim> jacobian(const ReferenceCell &cell,
                          const std::vector<Point<dim>> &corners,
                          const Point<dim> &xi)
  {
    Tensor<2, dim> J;
    for (unsigned int v = 0; v < corners.size(); ++v) {
      const auto gradient = linear_gradient<dim>(cell, xi, v);
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          J[i][j] += corners[v][i] * gradient[j];
    }
    return J;
  }

  template <int dim>
  std::vector<Point<dim>> face_corners(const ReferenceCell &cell,
                                       const std::vector<Point<dim>> &corners,
                                       const unsigned int face_no)
  {
    std::vector<Point<dim>> result;
    for (unsigned int v = 0; v < cell.face_reference_cell(face_no).n_vertices();
         ++v)
      result.push_back(corners[cell.face_to_cell_vertices(face_no, v, 1)]);
    return result;
  }

  template <int dim>
  Point<dim> mean(const std::vector<Point<dim>> &points)
  {
    Point<dim> centre;
    for (const auto &point : points)
      centre += point / double(points.size());
    return centre;
  }

  template <int dim>
  FaceGeometry<dim>::FaceGeometry(const ReferenceCell &cell,
                                  const std::vector<Point<dim>> &cell_corners,
                                  const unsigned int face_no)
      : face_(cell.face_reference_cell(face_no)), inside_(mean(cell_corners))
  {
    for (unsigned int v = 0; v < face_.n_vertices(); ++v) {
      const unsigned int corner = cell.face_to_cell_vertices(face_no, v, 1);
      corners_.push_back(cell_corners[corner]);
      reference_.push_back(cell.template vertex<dim>(corner));
    }
  }

  template <int dim>
  Point<dim> FaceGeometry<dim>::centre() const
  {
    Point<dim> result;
    for (const auto &corner : corners_)
      result += corner / double(corners_.size());
    return result;
  }

  template <int dim>
  bool FaceGeometry<dim>::is_triangle() const
  {
    return face_ == ReferenceCells::Triangle;
  }

  template <int dim>
  Point<dim> FaceGeometry<dim>::at(const Corners &of,
                                   const Point<dim - 1> &xi) const
  {
    Point<dim> x;
    for (unsigned int v = 0; v < of.size(); ++v)
      x += face_.d_linear_shape_function(xi, v) * of[v];
    return x;
  }

  template <int dim>
  Tensor<1, dim> FaceGeometry<dim>::normal(const Point<dim - 1> &xi) const
  {
    std::array<Tensor<1, dim>, dim - 1> tangent;
    for (unsigned int v = 0; v < corners_.size(); ++v) {
      const auto g = linear_gradient<dim - 1>(face_, xi, v);
      for (unsigned int j = 0; j < dim - 1; ++j)
        tangent[j] += g[j] * Tensor<1, dim>(corners_[v]);
    }
    Tensor<1, dim> n;
    if constexpr (dim == 2) {
      n[0] = tangent[0][1];
      n[1] = -tangent[0][0];
    } else
      n = cross_product_3d(tangent[0], tangent[1]);
    if (n * (position(xi) - inside_) < 0.)
      n = -n;
    return n;
  }

  template <int dim>
  double FaceGeometry<dim>::measure() const
  {
    Point<dim - 1> middle;
    for (unsigned int c = 0; c < dim - 1; ++c)
      middle[c] = is_triangle() ? 1. / 3. : 0.5;
    return normal(middle).norm() * (is_triangle() ? 0.5 : 1.);
  }

  template <int dim>
  std::array<Tensor<1, dim>, dim> local_frame(const Tensor<1, dim> &n)
  {
    std::array<Tensor<1, dim>, dim> frame;
    frame[0] = n;
    if constexpr (dim == 2) {
      frame[1][0] = -n[1];
      frame[1][1] = n[0];
    } else {
      unsigned int axis = 0;
      for (unsigned int i = 1; i < 3; ++i)
        if (std::abs(n[i]) < std::abs(n[axis]) - 1e-12)
          axis = i;
      Tensor<1, 3> e;
      e[axis] = 1.;
      frame[1] = cross_product_3d(n, e);
      frame[1] /= frame[1].norm();
      frame[2] = cross_product_3d(n, frame[1]);
    }
    return frame;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template Tensor<1, dim> linear_gradient(const ReferenceCell &,               \
                                          const Point<dim> &, unsigned int);   \
  template Point<dim> map_point(const ReferenceCell &,                         \
                                const std::vector<Point<dim>> &,               \
                                const Point<dim> &);                           \
  template Tensor<2, dim> jacobian(const ReferenceCell &,                      \
                                   const std::vector<Point<dim>> &,            \
                                   const Point<dim> &);                        \
  template std::vector<Point<dim>> face_corners(                               \
      const ReferenceCell &, const std::vector<Point<dim>> &, unsigned int);   \
  template Point<dim> mean(const std::vector<Point<dim>> &);                   \
  template class FaceGeometry<dim>;                                            \
  template std::array<Tensor<1, dim>, dim> local_frame<dim>(                   \
      const Tensor<1, dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
