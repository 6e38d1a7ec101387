#include "heat_cells.h"

#include "discretization/cell_geometry.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe.h>
#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Quadrature<dim> cell_rule(const ReferenceCell &cell)
    {
      if (cell.is_simplex())
        return QGaussSimplex<dim>(2);
      return QGauss<dim>(2);
    }

    /** Of linear functions at a place of the reference cell, 1/m. */
    template <int dim>
    std::vector<Tensor<1, dim>> gradients(const BodyShape<dim> &shape,
                                          const Point<dim> &xi,
                                          const Tensor<2, dim> &J)
    {
      const auto inverse = transpose(invert(J));
      std::vector<Tensor<1, dim>> result;
      for (unsigned int v = 0; v < shape.corners.size(); ++v)
        result.push_back(inverse * linear_gradient(shape.reference, xi, v));
      return result;
    }

    /** kg/m^3, the mean over the cell. */
    template <int dim>
    double mean_density(const MaterialInput &material,
                        const BodyShape<dim> &shape)
    {
      if (!material.graded)
        return material.density;
      double mass = 0.;
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        mass += lumped_mass(shape, i);
      return mass / shape.volume;
    }

    template <int dim>
    void add_cell(const BodyShape<dim> &shape, const double c, const double k,
                  HeatCell &cell)
    {
      const unsigned int n = cell.n_corners;
      const auto rule = cell_rule<dim>(shape.reference);
      for (unsigned int q = 0; q < rule.size(); ++q) {
        const Point<dim> xi = rule.point(q);
        const auto J = jacobian(shape.reference, shape.corners, xi);
        const auto place = map_point(shape.reference, shape.corners, xi);
        const double JxW = rule.weight(q) * std::abs(determinant(J)) *
                           radius_or_one(shape, place);
        const auto grad = gradients(shape, xi, J);
        for (unsigned int i = 0; i < n; ++i) {
          cell.capacity[i] +=
              c * JxW * shape.reference.d_linear_shape_function(xi, i);
          for (unsigned int j = 0; j < n; ++j)
            cell.conduction[i * n + j] += k * JxW * (grad[i] * grad[j]);
        }
      }
    }

    template <int dim>
    void add_slots(const BodyShape<dim> &shape, const double k, HeatCell &cell)
    {
      for (unsigned int s = 0; s < cell.n_slots; ++s) {
        const Point<dim> &xi = shape.slot_places[s];
        const auto J = jacobian(shape.reference, shape.corners, xi);
        const auto grad = gradients(shape, xi, J);
        const auto normal =
            shape.slot_normals[s] / shape.slot_normals[s].norm();
        for (unsigned int i = 0; i < cell.n_corners; ++i) {
          cell.values.push_back(shape.reference.d_linear_shape_function(xi, i));
          cell.fluxes.push_back(k * (grad[i] * normal));
        }
      }
    }

    /**
     * The trace of K^-1 F, where corner 0 is at zero: its eigenvalues are the
     * ratios, and none is negative. F = sum over slots w flux flux^T.
     */
    template <int dim>
    double flux_bound(const BodyShape<dim> &shape, const HeatCell &cell)
    {
      const unsigned int n = cell.n_corners;
      FullMatrix<double> K(n - 1, n - 1), F(n - 1, n - 1);
      for (unsigned int i = 1; i < n; ++i)
        for (unsigned int j = 1; j < n; ++j) {
          K(i - 1, j - 1) = cell.conduction[i * n + j];
          for (unsigned int s = 0; s < cell.n_slots; ++s)
            F(i - 1, j - 1) += slot_area(shape, s) * cell.fluxes[s * n + i] *
                               cell.fluxes[s * n + j];
        }
      K.gauss_jordan();
      FullMatrix<double> product(n - 1, n - 1);
      K.mmult(product, F);
      return product.trace();
    }

    template <int dim>
    HeatCell make_cell(const MaterialInput &material,
                       const BodyShape<dim> &shape)
    {
      const double rho = mean_density(material, shape),
                   k = material.heat->conductivity,
                   c = rho * material.heat->capacity;
      HeatCell cell;
      const unsigned int n = cell.n_corners = unsigned(shape.corners.size());
      cell.n_slots = unsigned(shape.slot_places.size());
      cell.capacity.assign(n, 0.);
      cell.conduction.assign(n * n, 0.);
      add_cell(shape, c, k, cell);
      add_slots(shape, k, cell);
      if (k == 0.)
        return cell;
      cell.effusivity = std::sqrt(k * c);
      cell.flux_bound = flux_bound(shape, cell);
      for (unsigned int i = 0; i < n; ++i)
        cell.rate += cell.conduction[i * n + i] / cell.capacity[i];
      return cell;
    }
  } // namespace

  template <int dim>
  HeatCells<dim>::HeatCells(const Discretization<dim> &discretization)
      : discretization_(discretization),
        n_corners_(
            discretization.cells().element->reference_cell().n_vertices()),
        differ_(discretization.cells().differ())
  {
    const auto &cells = discretization.cells();
    const auto &materials = discretization.input().materials;
    if (differ_)
      for (std::size_t b = 0; b < cells.bodies.size(); ++b)
        tables_.push_back(make_cell(materials[cells.body_class(b).material],
                                    *cells.shape(b)));
    else
      for (std::size_t k = 0; k < cells.shapes.size(); ++k)
        tables_.push_back(make_cell(materials[cells.bodies.classes[k].material],
                                    cells.shapes[k]));
  }

  template <int dim>
  double HeatCells<dim>::fastest() const
  {
    double rate = 0.;
    for (const HeatCell &cell : tables_)
      rate = std::max(rate, cell.rate);
    return rate;
  }

  template class HeatCells<2>;
  template class HeatCells<3>;
} // namespace nsfd
