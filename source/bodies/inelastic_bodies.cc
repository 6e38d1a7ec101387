#include "inelastic_bodies.h"

#include "body_energies.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  InelasticBodies<dim>::InelasticBodies(
      const Discretization<dim> &discretization)
      : discretization_(discretization), cells_(discretization),
        bodies_(discretization.bodies())
  {
    for (unsigned int b = 0; b < bodies_.size(); ++b) {
      if (!cells_.of(b))
        continue;
      history_bodies_.push_back(b);
      BodyClass body = bodies_.classes[bodies_.class_of[b]];
      body.bodies = {b};
      bodies_.class_of[b] = unsigned(bodies_.classes.size());
      bodies_.classes.push_back(std::move(body));
    }
    for (const unsigned int b : history_bodies_) // nothing is left in those
      bodies_.classes[discretization.bodies().class_of[b]].bodies.clear();
  }

  template <int dim>
  void InelasticBodies<dim>::start(const State &old, const double time_step,
                                   const double theta,
                                   const std::vector<double> &forces)
  {
    old_ = &old;
    forces_ = &forces;
    time_step_ = time_step;
    theta_ = theta;
  }

  /** Displacements of the body at the end of the step. */
  template <int dim>
  void InelasticBodies<dim>::set_end(const std::vector<double> &v,
                                     const std::size_t b)
  {
    const std::size_t first = bodies_.first_dof[b];
    end_.resize(bodies_.classes[bodies_.class_of[b]].n_dofs);
    for (std::size_t i = 0; i < end_.size(); ++i)
      end_[i] = old_->displacement[first + i] +
                time_step_ * (theta_ * v[first + i] +
                              (1. - theta_) * old_->velocity[first + i]);
  }

  template <int dim>
  CellMotion InelasticBodies<dim>::motion_of(const std::size_t b,
                                             const double *end) const
  {
    return {old_->displacement.data() + bodies_.first_dof[b], end, theta_,
            time_step_,
            old_->material_history.data() + cells_.first_history(unsigned(b))};
  }

  template <int dim>
  bool InelasticBodies<dim>::set_tangents(const std::vector<double> &v)
  {
    bool changed = false;
    for (const unsigned int b : history_bodies_) {
      BodyClass &body = bodies_.classes[bodies_.class_of[b]];
      const unsigned int n = body.n_dofs;
      tangent_.resize(std::size_t(n) * n);
      set_end(v, b);
      cells_.of(b)->symmetric_tangent(motion_of(b, end_.data()),
                                      tangent_.data());
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j) {
          const double entry = tangent_[std::size_t(j) * n + i] / theta_;
          changed |= entry != body.stiffness(i, j);
          body.stiffness(i, j) = entry;
        }
    }
    return changed;
  }

  template <int dim>
  void InelasticBodies<dim>::put_old_velocities(std::vector<double> &v) const
  {
    for (const unsigned int b : history_bodies_)
      std::copy(old_->velocity.begin() + long(bodies_.first_dof[b]),
                old_->velocity.begin() + long(bodies_.first_dof[b + 1]),
                v.begin() + long(bodies_.first_dof[b]));
  }

  template <int dim>
  bool InelasticBodies<dim>::move(const std::vector<double> &r,
                                  std::vector<double> &v)
  {
    for (const unsigned int b : history_bodies_) {
      const std::size_t first = bodies_.first_dof[b];
      FiniteStep step;
      step.time_step = time_step_;
      step.theta = theta_;
      step.mass = cells_.mass(b);
      step.displacement = old_->displacement.data() + first;
      step.velocity = old_->velocity.data() + first;
      step.load = forces_->data() + first;
      step.impulse = r.data() + first;
      step.history = old_->material_history.data() + cells_.first_history(b);
      if (!cells_.of(b)->solve(step, v.data() + first, scratch_))
        return false;
    }
    return true;
  }

  template <int dim>
  std::vector<BodyEnergies> InelasticBodies<dim>::account(State &next) const
  {
    std::vector<BodyEnergies> all;
    const Bodies &cells = discretization_.bodies(); // with their moduli
    next.material_history.resize(old_->material_history.size());
    next.heat.of_cells.assign(
        discretization_.input().has_heat() ? cells.size() : 0, 0.);
    for (unsigned int b = 0; b < cells.size(); ++b) {
      BodyEnergies &result = all.emplace_back();
      const BodyClass &body = cells.classes[cells.class_of[b]];
      const std::size_t first = cells.first_dof[b];
      const auto *cell = cells_.of(b);
      const double *v = next.velocity.data() + first,
                   *v_old = old_->velocity.data() + first,
                   *u = next.displacement.data() + first,
                   *u_old = old_->displacement.data() + first;
      for (unsigned int i = 0; i < body.n_dofs; ++i) {
        for (unsigned int j = 0; j < body.n_dofs; ++j) {
          const double m = body.mass(i, j);
          result.kinetic += 0.5 * v[i] * m * v[j];
          result.of_mass +=
              (theta_ - 0.5) * (v[i] - v_old[i]) * m * (v[j] - v_old[j]);
          if (cell || body.rigid)
            continue;
          const double k = body.stiffness(i, j);
          result.elastic += 0.5 * u[i] * k * u[j];
          result.of_strain +=
              (theta_ - 0.5) * (u[i] - u_old[i]) * k * (u[j] - u_old[j]);
          if (body.damping.rows > 0)
            result.viscous +=
                time_step_ * (theta_ * v[i] + (1. - theta_) * v_old[i]) *
                body.damping(i, j) * (theta_ * v[j] + (1. - theta_) * v_old[j]);
        }
        result.work += time_step_ * (*forces_)[first + i] *
                       (theta_ * v[i] + (1. - theta_) * v_old[i]);
      }
      if (!cell)
        continue;
      double *history = next.material_history.data() + cells_.first_history(b);
      const CellLosses losses = cell->account(motion_of(b, u), history);
      result.elastic += cell->energy(u, history);
      result.of_strain += losses.numerical;
      result.plastic += losses.plastic;
      if (!next.heat.of_cells.empty())
        next.heat.of_cells[b] = losses.plastic;
      result.viscous += losses.viscous;
    }
    return all;
  }

  template class InelasticBodies<2>;
  template class InelasticBodies<3>;
} // namespace nsfd
