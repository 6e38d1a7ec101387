#include "finite_forces.h"
#include "finite_algebra.h"
#include "small_strain.h"

#include "discretization/axis.h"
#include "discretization/cells.h"
#include "discretization/point_places.h"
#include "discretization/slot_gradients.h"
#include "materials/strain.h"
#include "nsfd/materials/material_model.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// stresses at a face are at most this times those at the points of the
    /// cell quadrature, of cells whose strain is not constant
    constexpr double beyond_quadrature = 3.;

    template <int dim>
    bool is_rigid(const Discretization<dim> &discretization,
                  const std::size_t cell)
    {
      return discretization.cells().body_class(cell).undeformed;
    }

    template <int dim, int sdim>
    FiniteTables make_tables(const BodyShape<dim> &shape,
                             const dealii::FiniteElement<dim> &element,
                             const bool any_histories)
    {
      FiniteTables here;
      const unsigned int n = here.n_nodes = shape.n_nodes;
      here.on_axis = shape.on_axis;
      const bool constant = shape.reference.is_simplex() && n == dim + 1 &&
                            shape.elasticity.size() <= 1;
      const auto put = [&](const dealii::Tensor<1, dim> &g,
                           const unsigned int i,
                           const dealii::Point<dim> &place, const double value,
                           std::vector<double> &gradients) {
        for (unsigned int d = 0; d < dim; ++d)
          gradients.push_back(g[d]);
        if constexpr (sdim > dim)
          gradients.push_back(
              shape.on_axis[i] ? 0. : hoop_of_node(shape, place, value, g));
      };
      for (unsigned int q = 0; q < (constant ? 1 : shape.JxW.size()); ++q) {
        here.JxW.push_back(constant ? shape.volume : shape.JxW[q]);
        for (unsigned int i = 0; i < n; ++i)
          put(shape.gradients[q * n + i], i,
              constant ? shape.centre : shape.positions[q],
              constant ? 1. / (dim + 1) : shape.values[q * n + i],
              here.gradients);
      }
      if (any_histories)
        for (const auto &place : shape.slot_positions) {
          unsigned int nearest = 0;
          for (unsigned int q = 1; !constant && q < shape.JxW.size(); ++q)
            if (place.distance_square(shape.positions[q]) <
                place.distance_square(shape.positions[nearest]))
              nearest = q;
          here.slot_points.push_back(nearest);
        }
      here.n_same = constant ? unsigned(shape.JxW.size()) - 1 : 0;
      if (constant)
        return here;
      const auto of_slots = slot_gradients(shape, element);
      for (std::size_t k = 0; k < of_slots.size(); ++k) {
        const auto s = unsigned(k / n), i = unsigned(k % n);
        put(of_slots[k], i, shape.slot_positions[s],
            element.shape_value(i, shape.slot_places[s]), here.slot_gradients);
      }
      return here;
    }
  } // namespace

  template <int dim, int sdim>
  FiniteForces<dim, sdim>::FiniteForces(
      const Discretization<dim> &discretization, const JoinedMesh<dim> &mesh,
      FrontViscosity front, const GhostCells *ghosts, const GhostCells *divided)
      : NonlinearForces<dim>(std::move(front)), discretization_(discretization),
        mesh_(mesh), ghosts_(ghosts), divided_(divided),
        differ_(discretization.cells().differ()),
        small_(!discretization.input().large_motion),
        sides_(discretization.points().n_points),
        displacement_(mesh.n_corners() * dim), forces_(mesh.n_corners() * dim),
        stored_(discretization.bodies().size()),
        peaks_(discretization.bodies().size()), histories_(discretization)
  {
    const Cells<dim> &cells = discretization.cells();
    const SceneInput &input = discretization.input();
    for (const MaterialInput &m : input.materials)
      materials_.push_back(
          m.kind == MaterialKind::finite_strain
              ? m.model->template hyperelastic<sdim>(m, input.plane_stress)
              : nullptr);
    const std::size_t n =
        differ_ ? cells.bodies.size() : cells.bodies.classes.size();
    for (std::size_t k = 0; k < n; ++k) {
      if (!differ_ && cells.bodies.classes[k].bodies.empty()) {
        tables_.emplace_back();
        continue;
      }
      const std::size_t one = differ_ ? k : cells.bodies.classes[k].bodies[0];
      FiniteTables &here = tables_.emplace_back(make_tables<dim, sdim>(
          *cells.shape(one), *cells.element, histories_.any()));
      here.one_dilatation = here.n_nodes == 1u << dim && histories_.of(one) &&
                            !input.plane_stress;
    }
    for_all_places(cells.bodies, sides_.size(),
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, const unsigned int side) {
                     sides_[point][side] = {int(body) + 1, slot};
                   });
    for (auto &sides : sides_)
      for (auto &side : sides)
        --side.first; // -1: none
    if (this->front_.acts())
      front_forces_.assign(forces_.size(), 0.);
    if (divided_)
      volumes_.resize(stored_.size());
    if (input.has_history()) {
      dilatations_.resize(stored_.size());
      taken_.resize(2 * stored_.size());
    }
  }

  template <int dim, int sdim>
  FiniteForces<dim, sdim>::~FiniteForces() = default;

  template <int dim, int sdim>
  const Hyperelastic<sdim> &
  FiniteForces<dim, sdim>::material(const std::size_t cell) const
  {
    return *materials_[discretization_.cells().body_class(cell).material];
  }

  template <int dim, int sdim>
  auto FiniteForces<dim, sdim>::deformation(const std::size_t cell,
                                            const double *gradients) const
      -> Matrix
  {
    Matrix F = finite::unit<sdim>();
    const unsigned int n = tables(cell).n_nodes;
    const double *u = &displacement_[discretization_.bodies().first_dof[cell]];
    for (unsigned int i = 0; i < n; ++i) {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          F[c * sdim + d] += u[i * dim + c] * gradients[i * sdim + d];
      if constexpr (sdim > dim) // along the hoops
        F.back() += u[i * dim] * gradients[i * sdim + dim];
    }
    return F;
  }

  template <int dim, int sdim>
  std::array<double, 2>
  FiniteForces<dim, sdim>::set_elastic_cell(const std::size_t cell, double *f)
  {
    const FiniteTables &here = tables(cell);
    const unsigned int n = here.n_nodes, n_q = unsigned(here.JxW.size());
    double volume = 0., now = 0.;
    for (unsigned int q = 0; q < n_q; ++q) {
      const double *g = &here.gradients[std::size_t(q) * n * sdim],
                   JxW = here.JxW[q];
      const Matrix F = deformation(cell, g);
      const double J = jacobian<sdim>(F.data());
      const auto C = symmetric_product<sdim>(F.data(), F.data());
      Voigt<sdim> S;
      if (!(J > 0.) || !material(cell).stress(C, S)) {
        inverted_ = int(cell);
        break;
      }
      volume += JxW;
      now += JxW * J;
      stored_[cell] += JxW * material(cell).energy(C);
      const Matrix P = finite::first_piola<sdim>(F, S);
      peaks_[cell] = std::max(peaks_[cell], finite::square<sdim>(P));
      finite::subtract_forces<dim, sdim>(P, JxW, g, n, f);
    }
    return {volume, now};
  }

  template <int dim, int sdim>
  void FiniteForces<dim, sdim>::set_cell(const std::size_t cell)
  {
    const FiniteTables &here = tables(cell);
    const std::size_t first = discretization_.bodies().first_dof[cell];
    const unsigned int n = here.n_nodes, n_q = unsigned(here.JxW.size());
    double *f = &forces_[first];
    std::fill_n(f, n * dim, 0.);
    stored_[cell] = peaks_[cell] = 0.;
    if (is_rigid(discretization_, cell))
      return;
    const auto [volume, now] = small_ ? set_small_cell(cell, f)
                               : histories_.any() && histories_.of(cell)
                                   ? set_flowing_cell(cell, f)
                                   : set_elastic_cell(cell, f);
    if (divided_)
      volumes_[cell] = {volume, now};
    if (!this->front_.acts() || inverted_ == int(cell))
      return;
    this->front_.update(cell, now / volume - 1., volume);
    const double tension = this->front_.tension[cell];
    double *more = &front_forces_[first];
    std::fill_n(more, n * dim, 0.);
    for (unsigned int q = 0; q < n_q && tension != 0.; ++q) {
      const double *g = &here.gradients[std::size_t(q) * n * sdim];
      const Matrix C = finite::cofactors<sdim>(small_ ? finite::unit<sdim>()
                                                      : deformation(cell, g));
      finite::subtract_forces<dim, sdim>(C, here.JxW[q] * tension, g, n, more);
    }
    for (unsigned int k = 0; k < n * dim; ++k)
      f[k] += more[k];
  }

  template <int dim, int sdim>
  void FiniteForces<dim, sdim>::set_forces(CornerGroups<dim> &groups)
  {
    inverted_ = -1;
    groups.scatter(groups.displacement, displacement_);
    for (std::size_t cell = 0; cell < stored_.size(); ++cell)
      if (!divided_ || !divided_->is_ghost(cell)) {
        set_cell(cell);
        const std::size_t first = discretization_.bodies().first_dof[cell];
        hold_nodes<dim>(tables(cell).on_axis, &forces_[first]);
        if (!front_forces_.empty())
          hold_nodes<dim>(tables(cell).on_axis, &front_forces_[first]);
      }
    if (divided_)
      share_cells();
    histories_.end_step();
    const std::size_t n_cells = stored_.size();
    for (std::size_t cell = 0; ghosts_ && cell < n_cells; ++cell)
      if (ghosts_->is_ghost(cell)) {
        stored_[cell] = 0.;
        if (!taken_.empty())
          taken_[cell] = taken_[n_cells + cell] = 0.;
      }
    std::fill(groups.force.begin(), groups.force.end(), 0.);
    for (std::size_t i = 0; i < mesh_.n_corners(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        groups.force[groups.of(i) * dim + c] += forces_[i * dim + c];
  }

  template <int dim, int sdim>
  std::array<double, dim>
  FiniteForces<dim, sdim>::corner_force(const std::size_t corner,
                                        const CornerGroups<dim> &) const
  {
    std::array<double, dim> force;
    std::copy_n(&forces_[corner * dim], dim, force.begin());
    return force;
  }

  template <int dim, int sdim>
  std::vector<double> FiniteForces<dim, sdim>::front_powers(
      const CornerGroups<dim> &groups,
      const std::vector<const std::vector<double> *> &velocities) const
  {
    std::vector<std::size_t> acting;
    const auto &first = discretization_.bodies().first_dof;
    for (std::size_t cell = 0; cell < stored_.size(); ++cell)
      if (!ghosts_ || !ghosts_->is_ghost(cell))
        for (std::size_t k = first[cell]; k < first[cell + 1]; ++k)
          if (front_forces_[k] != 0.)
            acting.push_back(k);
    std::vector<double> terms;
    terms.reserve(acting.size() * velocities.size());
    for (const auto *velocity : velocities)
      for (const std::size_t k : acting)
        terms.push_back(front_forces_[k] *
                        (*velocity)[groups.of(k / dim) * dim + k % dim]);
    return terms;
  }

  template <int dim, int sdim>
  const double *FiniteForces<dim, sdim>::at_slot(const std::size_t cell,
                                                 const unsigned int slot) const
  {
    const FiniteTables &here = tables(cell);
    return here.slot_gradients.empty()
               ? here.gradients.data()
               : &here.slot_gradients[std::size_t(slot) * here.n_nodes * sdim];
  }

  template <int dim, int sdim>
  auto FiniteForces<dim, sdim>::stress_at(const std::size_t cell,
                                          const unsigned int slot) const
      -> Matrix
  {
    if (is_rigid(discretization_, cell))
      return {};
    if (small_)
      return small_stress_beside(
          discretization_, histories_, cell, tables(cell).slot_points[slot],
          slot,
          small_gradient<sdim>(deformation(cell, at_slot(cell, slot)),
                               tables(cell).one_dilatation ? &dilatations_[cell]
                                                           : nullptr));
    const Matrix F = deformation(cell, at_slot(cell, slot));
    if (histories_.any() && histories_.of(cell))
      return flowing_stress(cell, tables(cell).slot_points[slot], F);
    Voigt<sdim> S;
    if (!(jacobian<sdim>(F.data()) > 0.) ||
        !material(cell).stress(symmetric_product<sdim>(F.data(), F.data()), S))
      return {};
    return finite::first_piola<sdim>(F, S);
  }

  template <int dim, int sdim>
  std::array<double, dim * dim>
  FiniteForces<dim, sdim>::frame(const std::size_t point) const
  {
    const double *rest = discretization_.points().axes(point);
    finite::Matrix<dim> axes;
    std::copy_n(rest, dim * dim, axes.begin());
    if (small_)
      return axes;
    finite::Matrix<dim> F{};
    for (const auto &[cell, slot] : sides_[point])
      if (cell >= 0) {
        const auto of_side = finite::in_plane<dim, sdim>(
            deformation(std::size_t(cell), at_slot(std::size_t(cell), slot)));
        for (unsigned int k = 0; k < dim * dim; ++k)
          F[k] += of_side[k] / 2.;
      }
    // two sides that have turned far from each other have no mean normal
    if (!(jacobian<dim>(F.data()) > 0.))
      return axes;
    const auto put = [&](const unsigned int row, std::array<double, dim> x) {
      for (unsigned int other = 0; other < row; ++other) {
        double dot = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          dot += x[c] * axes[other * dim + c];
        for (unsigned int c = 0; c < dim; ++c)
          x[c] -= dot * axes[other * dim + c];
      }
      double length = 0.;
      for (const double of_x : x)
        length += of_x * of_x;
      for (unsigned int c = 0; c < dim; ++c)
        axes[row * dim + c] = x[c] / std::sqrt(length);
    };
    put(0, finite::multiply<dim>(finite::cofactors<dim>(F), rest));
    for (unsigned int row = 1; row < dim; ++row)
      put(row, finite::multiply<dim>(F, rest + row * dim));
    return axes;
  }

  template <int dim, int sdim>
  std::array<double, dim>
  FiniteForces<dim, sdim>::traction(const StrengthSites<dim> &sites,
                                    const std::size_t site) const
  {
    const auto &points = discretization_.points();
    const unsigned int first = sites[site].first_point,
                       last = first + sites[site].n_points;
    double length = 0.;
    for (unsigned int i = first; i < last; ++i)
      length += points.weight[i];
    std::array<double, dim> result{};
    for (unsigned int i = first; i < last; ++i) {
      const double *rest = points.axes(i);
      std::array<double, dim> t{};
      for (const auto &[cell, slot] : sides_[i]) {
        const auto P =
            finite::in_plane<dim, sdim>(stress_at(std::size_t(cell), slot));
        const auto of_side = finite::multiply<dim>(P, rest);
        for (unsigned int c = 0; c < dim; ++c)
          t[c] += of_side[c] / 2.;
      }
      const auto local = finite::multiply<dim>(frame(i), t.data());
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          result[c] += points.weight[i] / length * rest[r * dim + c] * local[r];
      if (tables(std::size_t(sides_[i][0].first)).slot_gradients.empty() &&
          tables(std::size_t(sides_[i][1].first)).slot_gradients.empty()) {
        for (double &x : result) // the same along the face
          x *= length / points.weight[i];
        break;
      }
    }
    return result;
  }

  template <int dim, int sdim>
  void FiniteForces<dim, sdim>::squared_tractions(
      const StrengthSites<dim> &sites,
      typename StrengthSites<dim>::Near &near) const
  {
    constexpr double quiet = sites.looked_at * sites.looked_at;
    const auto bound = [this](const std::size_t cell) {
      const bool constant = tables(cell).slot_gradients.empty();
      return peaks_[cell] *
             (constant ? 1. : beyond_quadrature * beyond_quadrature);
    };
    sites.find_by_cell(peaks_.size(), bound, near);
    for (std::size_t n = 0; n < near.site.size(); ++n) {
      const std::size_t k = near.site[n];
      const auto &cells = sites[k].cells;
      if (!(std::max(bound(cells[0]), bound(cells[1])) <
            quiet * sites[k].least))
        near.square[n] = sites.square(k, traction(sites, k));
    }
  }

  template <int dim, int sdim>
  double FiniteForces<dim, sdim>::stiffening() const
  {
    const auto norm = [](const auto &values) {
      double sum = 0.;
      for (const double x : values)
        sum += x * x;
      return std::sqrt(sum);
    };
    std::vector<double> at_rest;
    Voigt<sdim> unit{}, S;
    for (unsigned int c = 0; c < sdim; ++c)
      unit[c] = 1.;
    VoigtBlock<sdim> tangent;
    for (const auto &material : materials_) {
      at_rest.push_back(1.);
      if (material && material->stress(unit, S, &tangent))
        at_rest.back() = norm(tangent);
    }
    double most = 1.;
    for (std::size_t cell = 0; !small_ && cell < stored_.size(); ++cell) {
      const FiniteTables &here = tables(cell);
      if (is_rigid(discretization_, cell) ||
          (divided_ && divided_->is_ghost(cell)))
        continue;
      if (histories_.any() && histories_.of(cell)) {
        most = std::max(most, flowing_stiffening(cell));
        continue;
      }
      const double rest =
          at_rest[discretization_.cells().body_class(cell).material];
      for (std::size_t q = 0; q < here.JxW.size(); ++q) {
        const Matrix F =
            deformation(cell, &here.gradients[q * here.n_nodes * sdim]);
        if (!material(cell).stress(symmetric_product<sdim>(F.data(), F.data()),
                                   S, &tangent))
          continue;
        most = std::max(most,
                        norm(tangent) / rest * finite::square<sdim>(F) / sdim +
                            norm(S) / material(cell).modulus());
      }
    }
    return divided_ ? divided_->largest(most) : most;
  }

  template class FiniteForces<2>;
  template class FiniteForces<2, 3>;
  template class FiniteForces<3>;
} // namespace nsfd
