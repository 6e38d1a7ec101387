#include "absorbing_sides.h"

#include "cell_geometry.h"

#include "mesh/mesh_builder.h"
#include "mesh/owned_cells.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/grid/tria.h>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** rho c_p and rho c_s, Pa s/m. */
    template <int dim>
    std::array<double, 2> impedances(const BodyShape<dim> &shape)
    {
      std::array<double, 2> result{};
      const std::size_t n = shape.elasticity.size();
      for (std::size_t k = 0; k < n; ++k) {
        const MaterialExtremes extremes = shape.elasticity[k].extremes();
        const double density = at_place(shape.moduli, k).density;
        result[0] += density * extremes.fastest / double(n);
        result[1] += density * extremes.slowest / double(n);
      }
      return result;
    }

    /** @p visit (values of the polynomials, w (rho c_p n n + ...)). */
    template <int dim, typename Visit>
    void visit_face(const FiniteElement<dim> &element,
                    const BodyShape<dim> &shape, const unsigned int f,
                    const Visit &visit)
    {
      const auto [of_p, of_s] = impedances(shape);
      const FaceGeometry<dim> face(shape.reference, shape.corners, f);
      Quadrature<dim - 1> quadrature;
      if (face.is_triangle())
        quadrature = QGaussSimplex<dim - 1>(3);
      else
        quadrature = QGauss<dim - 1>(element.degree + 1);
      std::vector<double> values(shape.n_nodes);
      for (unsigned int q = 0; q < quadrature.size(); ++q) {
        const auto xi = quadrature.point(q);
        const Tensor<1, dim> normal = face.normal(xi); // times the measure
        const double measure = normal.norm();
        const Tensor<1, dim> n = normal / measure;
        const double w = measure * quadrature.weight(q) *
                         radius_or_one(shape, face.position(xi));
        std::array<double, dim * dim> drag;
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            drag[c * dim + d] =
                w * ((of_p - of_s) * n[c] * n[d] + (c == d ? of_s : 0.));
        for (unsigned int i = 0; i < shape.n_nodes; ++i)
          values[i] = element.shape_value(i, face.in_reference_cell(xi));
        visit(values, drag);
      }
    }
  } // namespace

  template <int dim>
  std::vector<AbsorbingFace>
  find_absorbing_faces(const Triangulation<dim> &triangulation,
                       const MeshGroups<dim> &groups, const SceneInput &input,
                       const CellSet set)
  {
    std::vector<AbsorbingFace> result;
    if (!input.has_absorbing_sides())
      return result;
    unsigned int body = 0;
    for (const auto &cell : cells_of(triangulation, set)) {
      for (const unsigned int f : cell->face_indices())
        for (const auto &boundary : input.boundaries) {
          if (!boundary.absorbs ||
              !groups.holds_boundary_face(boundary.where, cell, f))
            continue;
          result.push_back({body, f});
          break; // two blocks are no two sides
        }
      ++body;
    }
    return result;
  }

  template <int dim>
  Block absorbing_block(const FiniteElement<dim> &element,
                        const BodyShape<dim> &shape, const unsigned int face)
  {
    Block C(shape.n_nodes * dim, shape.n_nodes * dim);
    visit_face(element, shape, face,
               [&](const std::vector<double> &N, const auto &drag) {
                 for (unsigned int i = 0; i < shape.n_nodes; ++i)
                   for (unsigned int j = 0; j <= i; ++j)
                     for (unsigned int k = 0; k < dim * dim; ++k)
                       C(i * dim + k / dim, j * dim + k % dim) +=
                           N[i] * N[j] * drag[k];
               });
    // symmetric to the last bit
    for (unsigned int i = 0; i < C.rows; ++i)
      for (unsigned int j = 0; j < i; ++j)
        C(j, i) = C(i, j);
    return C;
  }

  template <int dim>
  std::vector<std::array<double, dim * dim>>
  lumped_absorbing(const FiniteElement<dim> &element,
                   const BodyShape<dim> &shape, const unsigned int face)
  {
    std::vector<std::array<double, dim * dim>> C(shape.n_nodes);
    visit_face(element, shape, face,
               [&](const std::vector<double> &N, const auto &drag) {
                 for (unsigned int i = 0; i < shape.n_nodes; ++i)
                   for (unsigned int k = 0; k < dim * dim; ++k)
                     C[i][k] += N[i] * drag[k];
               });
    return C;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<AbsorbingFace> find_absorbing_faces(                    \
      const Triangulation<dim> &, const MeshGroups<dim> &, const SceneInput &, \
      CellSet);                                                                \
  template Block absorbing_block(const FiniteElement<dim> &,                   \
                                 const BodyShape<dim> &, unsigned int);        \
  template std::vector<std::array<double, dim *(dim)>> lumped_absorbing(       \
      const FiniteElement<dim> &, const BodyShape<dim> &, unsigned int)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
