#include "tensor_forces.h"

#include "hanging_nodes.h"

#include "discretization/cell_geometry.h"
#include "discretization/cells.h"
#include "discretization/point_places.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/polynomial.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// a point at no node: see `place_.between`
    constexpr std::uint16_t hangs = 0xffff;

    std::vector<double> transposed(const std::vector<double> &A,
                                   const unsigned int n)
    {
      std::vector<double> B(A.size());
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          B[i * n + j] = A[j * n + i];
      return B;
    }

    /** Component @p c of the map of a cell, of the directions in @p subset. */
    template <int dim>
    double map_entry(const BodyShape<dim> &shape, const unsigned int subset,
                     const unsigned int c)
    {
      double sum = 0.;
      for (unsigned int v = 0; v < 1u << dim; ++v)
        if ((v | subset) == subset)
          sum += (__builtin_popcount(v ^ subset) % 2 ? -1. : 1.) *
                 shape.corners[v][c];
      return sum;
    }
  } // namespace

  TensorLine::TensorLine(const unsigned int degree) : n(degree + 1)
  {
    const dealii::QGaussLobatto<1> lobatto(n);
    const dealii::QGauss<1> gauss(n);
    for (unsigned int i = 0; i < n; ++i) {
      nodes.push_back(lobatto.point(i)[0]);
      points.push_back(gauss.point(i)[0]);
      weights.push_back(gauss.weight(i));
    }
    const auto of_nodes = dealii::Polynomials::generate_complete_Lagrange_basis(
        lobatto.get_points());
    const auto of_points =
        dealii::Polynomials::generate_complete_Lagrange_basis(
            gauss.get_points());
    std::vector<double> value(2);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j) {
        of_nodes[j].value(points[i], value);
        values.push_back(value[0]);
        of_points[j].value(points[i], value);
        slopes.push_back(value[1]);
        of_nodes[j].value(nodes[i], value);
        node_slopes.push_back(value[1]);
      }
    values_transposed = transposed(values, n);
    slopes_transposed = transposed(slopes, n);
    for (const double x : nodes) {
      double sum = 0.;
      for (const auto &polynomial : of_points)
        sum += std::abs(polynomial.value(x));
      extrapolation = std::max(extrapolation, sum);
    }
  }

  template <int dim>
  bool TensorForces<dim>::fits(const Discretization<dim> &discretization)
  {
    const Cells<dim> &cells = discretization.cells();
    for (std::size_t k = 0; k < cells.shapes.size(); ++k) {
      const BodyClass &body = cells.bodies.classes[k];
      const MaterialInput &material =
          discretization.input().materials[body.material];
      if (!cells.shapes[k].reference.is_hyper_cube() ||
          !material.is_isotropic() || material.graded)
        return false;
    }
    const unsigned int degree = discretization.input().discretization.degree;
    return degree >= 1 && degree <= 8;
  }

  template <int dim>
  TensorForces<dim>::TensorForces(const Discretization<dim> &discretization,
                                  const JoinedMesh<dim> &mesh,
                                  FrontViscosity front)
      : CellForces<dim>(std::move(front)), discretization_(discretization),
        line_(discretization.input().discretization.degree),
        kernels_(tensor_kernels<dim>(line_.n - 1)),
        n_cells_(discretization.bodies().size()),
        n_nodes_(dim == 2 ? line_.n * line_.n : line_.n * line_.n * line_.n),
        forces_(mesh.n_corners() * dim)
  {
    scratch_.resize(tensor_scratch<dim>(line_.n), 0.);
    set_blocks();
    set_places(mesh);
  }

  /** Cells whose corners are those of a parallelepiped, as far as they are
      known. */
  template <int dim>
  std::vector<char> TensorForces<dim>::find_affine() const
  {
    const Cells<dim> &cells = discretization_.cells();
    std::vector<char> of_class, affine;
    for (const auto &shape : cells.shapes) {
      double size = 0., curved = 0.;
      for (unsigned int subset = 1; subset < 1u << dim; ++subset)
        for (unsigned int c = 0; c < dim; ++c) {
          double &largest = (subset & (subset - 1)) ? curved : size;
          largest = std::max(largest, std::abs(map_entry(shape, subset, c)));
        }
      of_class.push_back(curved <= 0x1p-40 * size);
    }
    for (std::size_t b = 0; b < n_cells_; ++b)
      affine.push_back(of_class[cells.bodies.class_of[b]]);
    return affine;
  }

  /** Cells in their order, as many in a block as are of one kind. */
  template <int dim>
  void TensorForces<dim>::divide(const std::vector<char> &affine)
  {
    for (std::size_t b = 0; b < n_cells_; ++b) {
      if (b == 0 || affine[b] != affine_.back() ||
          b - first_cell_.back() == lanes) {
        first_cell_.push_back(b);
        affine_.push_back(affine[b]);
      }
      block_.push_back(unsigned(first_cell_.size() - 1));
    }
    first_cell_.push_back(n_cells_);
  }

  template <int dim>
  void TensorForces<dim>::set_blocks()
  {
    divide(find_affine());
    const Cells<dim> &cells = discretization_.cells();
    const std::size_t n_blocks = affine_.size();
    maps_.resize(n_blocks * per_map, 0.);
    moduli_.resize(n_blocks * 3 * lanes, 0.);
    reference_.resize(n_blocks * dim * dim * lanes, 0.);
    bound_.assign(n_cells_ + lanes, 0.);
    tractions_of_block_.assign(n_blocks, -1);
    volume_.resize(n_cells_);
    std::vector<double> of_class;
    for (const auto &shape : cells.shapes)
      of_class.push_back(distortion(shape));
    for (std::size_t b = 0; b < n_blocks * lanes; ++b) {
      const std::size_t index = b / lanes, lane = b % lanes;
      const std::size_t cell =
          std::min(first_cell_[index] + lane, first_cell_[index + 1] - 1);
      const auto of_body = cells.shape(cell);
      const BodyShape<dim> &shape = *of_body;
      for (unsigned int subset = 1; subset < 1u << dim; ++subset)
        for (unsigned int c = 0; c < dim; ++c)
          maps_[index * per_map + ((subset - 1) * dim + c) * lanes + lane] =
              map_entry(shape, subset, c);
      double *moduli = moduli_.data() + index * 3 * lanes + lane;
      volume_[cell] = shape.volume;
      if (shape.elasticity.empty())
        continue; // rigid: no stress
      const auto &law = shape.elasticity[0];
      moduli[0] = law.lambda;
      moduli[lanes] = law.mu;
      const double norm = std::max(2. * law.mu, dim * law.lambda + 2. * law.mu);
      moduli[2 * lanes] = norm * of_class[cells.bodies.class_of[cell]];
    }
  }

  /** The largest |J(xi) J(x)^{-1} - 1|, x a node of a face: J is linear along
      every line, so xi is a corner. */
  template <int dim>
  double TensorForces<dim>::distortion(const BodyShape<dim> &shape) const
  {
    std::vector<dealii::Tensor<2, dim>> at_corners;
    for (unsigned int v = 0; v < shape.corners.size(); ++v)
      at_corners.push_back(jacobian(shape.reference, shape.corners,
                                    shape.reference.template vertex<dim>(v)));
    double largest = 0.;
    for (unsigned int i = 0; i < n_nodes_; ++i) {
      dealii::Point<dim> x;
      bool on_face = false;
      for (unsigned int d = 0, k = i; d < dim; ++d, k /= line_.n) {
        x[d] = line_.nodes[k % line_.n];
        on_face = on_face || k % line_.n == 0 || k % line_.n == line_.n - 1;
      }
      if (!on_face)
        continue;
      const auto inverse = invert(jacobian(shape.reference, shape.corners, x));
      for (const auto &J : at_corners)
        largest = std::max(
            largest,
            (J * inverse - dealii::unit_symmetric_tensor<dim>()).norm());
    }
    return largest;
  }

  template <int dim>
  void TensorForces<dim>::set_places(const JoinedMesh<dim> &mesh)
  {
    const Cells<dim> &cells = discretization_.cells();
    const std::size_t n = discretization_.points().n_points;
    place_.of_point.assign(n, {{0, 0}});
    for_all_places(
        cells.bodies, n,
        [&](const std::size_t body, const unsigned int slot,
            const std::size_t point, const unsigned int side) {
          const unsigned int corner = mesh.corners(point)[side],
                             face = cells.class_shape(body).slot_faces[slot];
          if (corner != JoinedMesh<dim>::none) {
            place_.of_point[point][side] =
                place_in_faces(corner - unsigned(cells.first_node[body]), face);
            return;
          }
          place_.of_point[point][side] = hangs;
          for (const auto &[node, value] :
               trace_at(cells, unsigned(body), slot))
            place_.between[unsigned(point)].emplace_back(
                place_in_faces(node, face), value);
        });
  }

  template <int dim>
  std::uint16_t TensorForces<dim>::place_in_faces(unsigned int node,
                                                  const unsigned int face) const
  {
    unsigned int in_face = 0, factor = 1;
    for (unsigned int d = 0; d < dim; ++d, node /= line_.n)
      if (d != face / 2) {
        in_face += factor * (node % line_.n);
        factor *= line_.n;
      }
    return std::uint16_t(face * (n_nodes_ / line_.n) + in_face);
  }

  template <int dim>
  TensorBlock TensorForces<dim>::block(const std::size_t index) const
  {
    const std::size_t first = first_cell_[index];
    return {maps_.data() + index * per_map, moduli_.data() + index * 3 * lanes,
            affine_[index] != 0,
            groups_->of_corners().data() + first * n_nodes_,
            unsigned(first_cell_[index + 1] - first)};
  }

  template <int dim>
  void TensorForces<dim>::set_forces(CornerGroups<dim> &groups)
  {
    groups_ = &groups;
    for (const unsigned int index : known_)
      tractions_of_block_[index] = -1;
    known_.clear();
    std::fill(groups.force.begin(), groups.force.end(), 0.);
    for (std::size_t index = 0; index < affine_.size(); ++index) {
      const TensorBlock cells = block(index);
      const std::size_t first = first_cell_[index];
      double dilatation[lanes], tension[lanes] = {};
      kernels_.evaluate(
          line_, cells, groups.displacement.data(), scratch_.data(), dilatation,
          reference_.data() + index * dim * dim * lanes, &bound_[first]);
      if (this->front_.acts())
        for (unsigned int l = 0; l < cells.count; ++l) {
          const std::size_t b = first + l;
          this->front_.update(b, dilatation[l] / volume_[b], volume_[b]);
          tension[l] = this->front_.tension[b];
        }
      kernels_.integrate(line_, cells, tension, scratch_.data(),
                         &forces_[first * n_nodes_ * dim], groups.force.data());
    }
  }

  template <int dim>
  std::array<double, dim>
  TensorForces<dim>::corner_force(const std::size_t corner,
                                  const CornerGroups<dim> &) const
  {
    std::array<double, dim> force;
    for (unsigned int c = 0; c < dim; ++c)
      force[c] = -forces_[corner * dim + c];
    return force;
  }

  template <int dim>
  const double *TensorForces<dim>::tractions(const std::size_t cell) const
  {
    const std::size_t per_cell = 2 * dim * dim * (n_nodes_ / line_.n),
                      size = per_cell * lanes, index = block_[cell];
    int &place = tractions_of_block_[index];
    if (place < 0) {
      place = int(known_.size());
      known_.push_back(unsigned(index));
      if (tractions_.size() < known_.size() * size)
        tractions_.resize(2 * known_.size() * size);
      kernels_.set_tractions(line_, block(index), groups_->displacement.data(),
                             scratch_.data(),
                             tractions_.data() + std::size_t(place) * size);
    }
    return tractions_.data() + std::size_t(place) * size +
           (cell - first_cell_[index]) * per_cell;
  }

  template <int dim>
  std::array<double, dim>
  TensorForces<dim>::traction(const StrengthSites<dim> &sites,
                              const std::size_t site) const
  {
    const auto &weight = discretization_.points().weight;
    std::array<double, dim> result{};
    const unsigned int first = sites[site].first_point,
                       last = first + sites[site].n_points;
    double length = 0.;
    for (unsigned int i = first; i < last; ++i)
      length += weight[i];
    for (unsigned int side = 0; side < 2; ++side) {
      const double *of_cell = tractions(sites[site].cells[side]);
      const double sign = side == 0 ? 0.5 : -0.5;
      for (unsigned int i = first; i < last; ++i) {
        const double share = sign * weight[i] / length;
        if (place_.of_point[i][side] == hangs) {
          for (const auto &[place, value] : place_.between.at(i))
            for (unsigned int c = 0; c < dim; ++c)
              result[c] += share * value * of_cell[place * dim + c];
          continue;
        }
        for (unsigned int c = 0; c < dim; ++c)
          result[c] += share * of_cell[place_.of_point[i][side] * dim + c];
      }
    }
    return result;
  }

  template <int dim>
  void TensorForces<dim>::squared_tractions(
      const StrengthSites<dim> &sites,
      typename StrengthSites<dim>::Near &near) const
  {
    constexpr double quiet = sites.looked_at * sites.looked_at;
    sites.find_by_cell(
        n_cells_,
        [this](const std::size_t cell) { return bound_[cell] * bound_[cell]; },
        near);
    for (std::size_t n = 0; n < near.site.size(); ++n) {
      const std::size_t k = near.site[n];
      const auto &cells = sites[k].cells;
      const double largest = (bound_[cells[0]] + bound_[cells[1]]) / 2.;
      if (largest * largest >= quiet * sites[k].least)
        near.square[n] = sites.square(k, traction(sites, k));
    }
  }

  template class TensorForces<2>;
  template class TensorForces<3>;
} // namespace nsfd
