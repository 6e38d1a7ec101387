#include "moving_bodies.h"

#include "body_energies.h"
#include "discretization/body_shape.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace space;

  template <int dim>
  MovingBodies<dim>::MovingBodies(const SceneInput &input,
                                  const Discretization<dim> &discretization,
                                  const Communicator &communicator)
      : input_(input), discretization_(discretization), all_(communicator),
        layout_(input, discretization),
        rigid_motions_(input, discretization, layout_, communicator),
        faces_(discretization, layout_, communicator),
        contacts_(discretization, layout_),
        middle_(input, discretization, layout_, communicator, motion_,
                contacts_, bodies_),
        cells_(discretization)
  {
    make_bodies();
    State rest;
    rest.displacement.assign(discretization.cells().n_nodal(), 0.);
    rest.velocity = rest.displacement;
    set_initial(rest);
    start(rest, 0., 0.5, rest.displacement, {}, {});
    set_rows({});
    set_middle();
  }

  template <int dim>
  void MovingBodies<dim>::make_bodies()
  {
    const Bodies &cells = discretization_.bodies();
    bodies_.class_of.resize(layout_.size());
    bodies_.classes.resize(layout_.size());
    bodies_.first_dof.assign(1, 0);
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      BodyClass &body = bodies_.classes[b];
      bodies_.class_of[b] = unsigned(b);
      body.bodies = {unsigned(b)};
      body.material = layout_[b].material;
      body.rigid = layout_[b].is_rigid();
      const auto &cell = cells.classes[cells.class_of[layout_[b].cells[0]]];
      body.n_dofs = body.rigid ? BodyLayout<dim>::n_rigid : cell.n_dofs;
      if (body.rigid)
        body.mass = Block(BodyLayout<dim>::n_rigid, BodyLayout<dim>::n_rigid);
      else {
        body.mass = cell.mass;
        body.rigid_motions = cell.rigid_motions;
      }
      bodies_.first_dof.push_back(bodies_.first_dof.back() + body.n_dofs);
    }
  }

  // ----------------------------------------------------------- between steps

  template <int dim>
  void MovingBodies<dim>::set_initial(State &state) const
  {
    state.material_history = cells_.begin_history();
    rigid_motions_.set_nearest(state);
  }

  template <int dim>
  double MovingBodies<dim>::largest_speed(const State &state) const
  {
    double square = 0.;
    for (std::size_t i = 0; i < layout_.rest().size() / dim; ++i)
      square = std::max(square,
                        Vector(at_node<dim>(state.velocity, i)).norm_square());
    double speed = std::sqrt(square);
    for (const MovingBody &mover : layout_.bodies())
      if (mover.radius > 0.) {
        const RigidState rigid = rigid_motions_.of(state, mover);
        speed = std::max(speed, norm(rigid.velocity) +
                                    mover.radius * norm(rigid.spin));
      }
    return all_.max(speed);
  }

  template <int dim>
  std::vector<BodyEnergies>
  MovingBodies<dim>::energies(const State &state) const
  {
    std::vector<BodyEnergies> all;
    const Bodies &cells = discretization_.bodies();
    for (const MovingBody &mover : layout_.bodies()) {
      BodyEnergies &result = all.emplace_back();
      if (mover.is_rigid())
        result.kinetic =
            kinetic_energy(mover.inertia, rigid_motions_.of(state, mover));
      else {
        const unsigned int c = mover.cells[0], k = cells.class_of[c];
        const double *v = state.velocity.data() + cells.first_dof[c];
        const Block &M = cells.classes[k].mass;
        for (unsigned int i = 0; i < M.rows; ++i)
          for (unsigned int j = 0; j < M.cols; ++j)
            result.kinetic += 0.5 * v[i] * M(i, j) * v[j];
        result.elastic = cells_.of(c)->energy(
            state.displacement.data() + cells.first_dof[c],
            state.material_history.data() + cells_.first_history(c));
      }
    }
    return all;
  }

  // ---------------------------------------------------------------- one step

  template <int dim>
  void MovingBodies<dim>::start(const State &old, const double time_step,
                                const double theta,
                                const std::vector<double> &forces,
                                const std::vector<double> &shift_old,
                                const std::vector<double> &shift_new)
  {
    motion_.time_step = time_step;
    motion_.theta = theta;
    motion_.forces = forces;
    motion_.u_old = motion_.u_new = old.displacement;
    motion_.history = old.material_history;
    motion_.shift_middle.resize(shift_old.size());
    for (std::size_t k = 0; k < shift_old.size(); ++k)
      motion_.shift_middle[k] = (shift_old[k] + shift_new[k]) / 2.;
    motion_.v_old.assign(bodies_.n_dofs(), 0.);
    motion_.rigid.clear();
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      const MovingBody &mover = layout_[b];
      double *v = motion_.v_old.data() + bodies_.first_dof[b];
      if (!mover.is_rigid()) {
        std::copy_n(old.velocity.data() +
                        discretization_.bodies().first_dof[mover.cells[0]],
                    bodies_.classes[b].n_dofs, v);
        continue;
      }
      motion_.rigid.emplace_back(mover.inertia, rigid_motions_.of(old, mover),
                                 time_step, theta);
      const Vec3 a = motion_.rigid.back().a_k();
      const RigidVelocity start = motion_.rigid.back().velocity();
      for (unsigned int d = 0; d < dim; ++d)
        v[d] = start.centre[d];
      if (dim == 2)
        v[2] = a[2];
      else
        std::copy_n(a.begin(), 3, v + dim);
    }
    motion_.v = motion_.v_old;
    for (std::size_t b = 0; b < layout_.size(); ++b)
      set_step_end(b);
  }

  template <int dim>
  CellMotion MovingBodies<dim>::motion_of(const unsigned int c) const
  {
    const std::size_t first = discretization_.bodies().first_dof[c];
    return {motion_.u_old.data() + first, motion_.u_new.data() + first,
            motion_.theta, motion_.time_step,
            motion_.history.data() + cells_.first_history(c)};
  }

  /** Displacements at the end of the step with the velocities at hand. */
  template <int dim>
  void MovingBodies<dim>::set_step_end(const std::size_t b)
  {
    const MovingBody &mover = layout_[b];
    if (mover.is_rigid()) {
      rigid_motions_.place(motion_.rigid[std::size_t(mover.rigid)].state(),
                           mover, motion_.u_new);
      return;
    }
    const std::size_t dof = bodies_.first_dof[b],
                      node = discretization_.bodies().first_dof[mover.cells[0]];
    for (unsigned int i = 0; i < bodies_.classes[b].n_dofs; ++i)
      motion_.u_new[node + i] =
          motion_.u_old[node + i] +
          motion_.time_step * (motion_.theta * motion_.v[dof + i] +
                               (1. - motion_.theta) * motion_.v_old[dof + i]);
  }

  template <int dim>
  void MovingBodies<dim>::set_middle()
  {
    middle_.set_nodes();
    faces_.set_frames(middle_.nodes(), contacts_);
    for (std::size_t b = 0; b < layout_.size(); ++b)
      set_body(b);
    middle_.place_rows();
  }

  /** Its matrices, and the traces at the points of the mesh. */
  template <int dim>
  void MovingBodies<dim>::set_body(const std::size_t b)
  {
    const MovingBody &mover = layout_[b];
    const Bodies &cells = discretization_.bodies();
    BodyClass &body = bodies_.classes[b];
    if (mover.is_rigid()) {
      const auto A = motion_.rigid[std::size_t(mover.rigid)].iteration_matrix();
      const auto entry = [](const unsigned int i) {
        return dim == 2 && i == 2 ? 5u : i;
      };
      for (unsigned int i = 0; i < BodyLayout<dim>::n_rigid; ++i)
        for (unsigned int j = 0; j < BodyLayout<dim>::n_rigid; ++j)
          body.mass(i, j) = A[entry(i) * 6 + entry(j)];
      const auto &nodes = middle_.nodes();
      const Place centre = middle_.centre(b);
      for (unsigned int s = 0; s < layout_.slots(b).size(); ++s) {
        const BodySlot &slot = layout_.slots(b)[s];
        const auto &cell = cells.classes[cells.class_of[slot.cell]];
        const std::size_t first = cells.first_dof[slot.cell];
        Place x;
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int j = 0; j < cell.n_dofs; ++j)
            x[d] += cell.trace(slot.slot * dim + d, j) * nodes[first + j];
        set_rigid_trace<dim>(x - centre, s, body.trace);
      }
      rigid_motions_.supports().project(b, body.trace);
      return;
    }
    const unsigned int c = mover.cells[0], k = cells.class_of[c];
    const BodyClass &cell = cells.classes[k];
    const unsigned int n = body.n_dofs;
    std::vector<double> tangent(std::size_t(n) * n);
    cells_.of(c)->step_tangent(motion_of(c), cells_.mass(c), tangent.data());
    body.stiffness = Block(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        body.stiffness(i, j) = tangent[std::size_t(j) * n + i] / motion_.theta;
    for (unsigned int s = 0; s < layout_.slots(b).size(); ++s)
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int j = 0; j < n; ++j)
          body.trace(s * dim + d, j) =
              cell.trace(layout_.slots(b)[s].slot * dim + d, j);
  }

  // ------------------------------------------------------------- local motion

  /** Loads of the nodes at the middle of the step. */
  template <int dim>
  RigidLoad MovingBodies<dim>::load_of(const MovingBody &mover) const
  {
    RigidLoad load;
    const std::size_t b = layout_.body_of_cell(mover.cells[0]);
    const Vec3 centre = in_space<dim>(Vector(middle_.centre(b)));
    for (const unsigned int c : mover.cells) {
      const std::size_t first = discretization_.cells().first_node[c];
      for (std::size_t i = first;
           i < first + discretization_.cells().class_shape(c).n_nodes; ++i) {
        const Vec3 f = in_space<dim>(Vector(at_node<dim>(motion_.forces, i)));
        load.force = load.force + f;
        load.moment =
            load.moment +
            cross(in_space<dim>(Vector(middle_.node_place(i))) - centre, f);
      }
    }
    for (unsigned int d = 0; d < dim; ++d)
      load.force[d] += mover.extra_weight * input_.gravity[d];
    return load;
  }

  template <int dim>
  bool MovingBodies<dim>::move(const std::vector<double> &r,
                               const std::vector<double> &v)
  {
    motion_.v = v;
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      const MovingBody &mover = layout_[b];
      const double *impulse = r.data() + bodies_.first_dof[b];
      if (!mover.is_rigid()) {
        const unsigned int c = mover.cells[0];
        const std::size_t first = discretization_.bodies().first_dof[c];
        FiniteStep step;
        step.time_step = motion_.time_step;
        step.theta = motion_.theta;
        step.mass = cells_.mass(c);
        step.displacement = motion_.u_old.data() + first;
        step.velocity = motion_.v_old.data() + bodies_.first_dof[b];
        step.load = motion_.forces.data() + first;
        step.impulse = impulse;
        step.history = motion_.history.data() + cells_.first_history(c);
        double *const now = motion_.v.data() + bodies_.first_dof[b];
        if (!cells_.of(c)->solve(step, now, scratch_)) {
          // what the tangent foretells may be turned inside out
          std::copy_n(motion_.v_old.data() + bodies_.first_dof[b],
                      bodies_.classes[b].n_dofs, now);
          if (!cells_.of(c)->solve(step, now, scratch_))
            return false;
        }
      } else {
        RigidLoad load = load_of(mover);
        for (unsigned int d = 0; d < dim; ++d)
          load.impulse[d] = impulse[d];
        Vec3 spin{};
        const double *start = v.data() + bodies_.first_dof[b];
        if (dim == 2) {
          load.angular_impulse[2] = impulse[2];
          spin[2] = start[2];
        } else {
          std::copy_n(impulse + dim, 3, load.angular_impulse.begin());
          std::copy_n(start + dim, 3, spin.begin());
        }
        RigidStep &step = motion_.rigid[std::size_t(mover.rigid)];
        if (!step.solve(load, spin))
          return false;
        const RigidVelocity now = step.velocity();
        double *end = motion_.v.data() + bodies_.first_dof[b];
        for (unsigned int d = 0; d < dim; ++d)
          end[d] = now.centre[d];
        if (dim == 2)
          end[2] = now.spin[2];
        else
          std::copy_n(now.spin.begin(), 3, end + dim);
      }
      set_step_end(b);
    }
    return true;
  }

  template <int dim>
  void MovingBodies<dim>::stay()
  {
    std::fill(motion_.v.begin(), motion_.v.end(), 0.);
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      motion_.rigid[std::size_t(layout_[b].rigid)].stay();
      set_step_end(b);
    }
  }

  template <int dim>
  void MovingBodies<dim>::finish(State &next) const
  {
    next.displacement = motion_.u_new;
    next.velocity.resize(motion_.u_new.size());
    next.rigid.resize(13 * discretization_.body_table().n_rigid);
    next.material_history.resize(motion_.history.size());
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      const MovingBody &mover = layout_[b];
      if (mover.is_rigid())
        rigid_motions_.put(motion_.rigid[std::size_t(mover.rigid)].state(),
                           mover, next);
      else {
        const unsigned int c = mover.cells[0];
        std::copy_n(
            motion_.v.data() + bodies_.first_dof[b], bodies_.classes[b].n_dofs,
            next.velocity.data() + discretization_.bodies().first_dof[c]);
        if (cells_.of(c)->n_history() > 0)
          cells_.of(c)->account(motion_of(c), next.material_history.data() +
                                                  cells_.first_history(c));
      }
    }
    rigid_motions_.share(next);
  }

  template <int dim>
  std::vector<BodyEnergies> MovingBodies<dim>::account() const
  {
    std::vector<BodyEnergies> all;
    std::vector<double> history;
    const Bodies &cells = discretization_.bodies();
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      BodyEnergies &result = all.emplace_back();
      const MovingBody &mover = layout_[b];
      const std::size_t dof = bodies_.first_dof[b];
      if (mover.is_rigid()) {
        const RigidStep &step = motion_.rigid[std::size_t(mover.rigid)];
        result.kinetic += kinetic_energy(mover.inertia, step.state());
        result.of_mass += step.dissipated();
        const RigidLoad load = load_of(mover);
        const RigidVelocity v = step.theta_velocity();
        result.work += motion_.time_step *
                       (dot(load.force, v.centre) + dot(load.moment, v.spin));
        continue;
      }
      const unsigned int c = mover.cells[0], k = cells.class_of[c];
      const std::size_t first = cells.first_dof[c];
      const Block &M = cells.classes[k].mass;
      const double *v = motion_.v.data() + dof,
                   *v_old = motion_.v_old.data() + dof;
      for (unsigned int i = 0; i < M.rows; ++i) {
        for (unsigned int j = 0; j < M.cols; ++j) {
          result.kinetic += 0.5 * v[i] * M(i, j) * v[j];
          result.of_mass += (motion_.theta - 0.5) * (v[i] - v_old[i]) *
                            M(i, j) * (v[j] - v_old[j]);
        }
        result.work += motion_.time_step * motion_.forces[first + i] *
                       (motion_.theta * v[i] + (1. - motion_.theta) * v_old[i]);
      }
      const CellMotion motion = motion_of(c);
      history.resize(cells_.of(c)->n_history());
      const CellLosses losses = cells_.of(c)->account(motion, history.data());
      result.elastic += cells_.of(c)->energy(motion.end, history.data());
      result.of_strain += losses.numerical;
      result.plastic += losses.plastic;
      result.viscous += losses.viscous;
    }
    return all;
  }

  template <int dim>
  std::vector<double>
  MovingBodies<dim>::kinetic_products(const std::vector<double> &x,
                                      const std::vector<double> &y) const
  {
    std::vector<double> result;
    for (std::size_t b = 0; b < layout_.size(); ++b) {
      double &sum = result.emplace_back();
      const Block &M = bodies_.classes[b].mass;
      const std::size_t first = bodies_.first_dof[b];
      for (unsigned int i = 0; i < M.rows; ++i)
        for (unsigned int j = 0; j < M.cols; ++j)
          sum += x[first + i] * M(i, j) * y[first + j];
    }
    return result;
  }

  template class MovingBodies<2>;
  template class MovingBodies<3>;
} // namespace nsfd
