#include "viewed_motion.h"

#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  template <int dim>
  ViewedMotion<dim>::ViewedMotion(const SceneInput &input,
                                  const Discretization<dim> &discretization)
      : input_(input), discretization_(discretization), row_(&no_row_)
  {
  }

  template <int dim>
  void ViewedMotion<dim>::show(const State &state, const State *previous,
                               const HistoryRow &row)
  {
    state_ = &state;
    // equilibria do not move; a mesh that has changed has no step behind it
    previous_ = previous && state.point_force.empty() &&
                        previous->velocity.size() == state.velocity.size()
                    ? previous
                    : nullptr;
    row_ = &row;
    middle_.reset();
    displacement_.reset();
    velocity_.reset();
    stresses_.reset();
  }

  template <int dim>
  void ViewedMotion<dim>::forget()
  {
    state_ = previous_ = nullptr;
    row_ = &no_row_;
    middle_.reset();
    displacement_.reset();
    velocity_.reset();
    stresses_.reset();
  }

  template <int dim>
  const std::vector<double> &ViewedMotion<dim>::displacement() const
  {
    if (!displacement_)
      displacement_ = discretization_.to_nodal(state_->displacement);
    return *displacement_;
  }

  template <int dim>
  const std::vector<double> &ViewedMotion<dim>::velocity() const
  {
    if (!velocity_)
      velocity_ = discretization_.to_nodal(state_->velocity);
    return *velocity_;
  }

  template <int dim>
  CellStresses<dim> &ViewedMotion<dim>::stresses() const
  {
    if (!stresses_)
      stresses_ = std::make_unique<CellStresses<dim>>(discretization_, *state_);
    return *stresses_;
  }

  template <int dim>
  const typename ViewedMotion<dim>::Middle &ViewedMotion<dim>::middle() const
  {
    if (middle_)
      return *middle_;
    middle_.emplace();
    std::vector<double> q = state_->displacement, v = state_->velocity,
                        a(v.size(), 0.);
    middle_->time = state_->time;
    if (previous_ && row_->time_step > 0.) {
      const double h = row_->time_step, theta = input_.time.theta;
      const bool is_explicit = input_.time.scheme.explicit_forces;
      middle_->time -= (1. - theta) * h;
      for (std::size_t k = 0; k < q.size(); ++k) {
        const double v_old = previous_->velocity[k],
                     q_old = previous_->displacement[k];
        a[k] = (v[k] - v_old) / h;
        v[k] = theta * v[k] + (1. - theta) * v_old;
        // where the forces are taken
        q[k] = is_explicit ? q_old + h * theta * v_old
                           : theta * q[k] + (1. - theta) * q_old;
      }
    }
    middle_->displacement = discretization_.to_nodal(q);
    middle_->velocity = discretization_.to_nodal(v);
    middle_->acceleration = discretization_.to_nodal(a);
    return *middle_;
  }

  template <int dim>
  RunView::Vector ViewedMotion<dim>::traction(const std::size_t i) const
  {
    const auto &points = discretization_.points();
    const double *frame = points.axes(i);
    RunView::Vector result{};
    const auto add = [&](const double factor, const double *local) {
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          result[c] += factor * local[r] * frame[r * dim + c];
    };
    if (state_->kind[i] == PointKind::bonded)
      add(1., &state_->bond_traction[i * dim]);
    else if (!state_->point_force.empty())
      add(-1. / points.weight[i], &state_->point_force[i * dim]);
    else if (row_->time_step > 0.)
      add(-1. / (points.weight[i] * row_->time_step),
          &state_->impulse[i * dim]);
    if (!state_->pressure.empty())
      for (unsigned int c = 0; c < dim; ++c)
        result[c] -= state_->pressure[i] * frame[c];
    return result;
  }

  template class ViewedMotion<2>;
  template class ViewedMotion<3>;
} // namespace nsfd
