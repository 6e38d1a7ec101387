#include "moving_bodies.h"

#include "body_energies.h"
#include "core/gather.h"
#include "discretization/body_shape.h"

#include "discretization/cell_geometry.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;
  using namespace space;

  namespace
  {
    constexpr int tag_of_sides = 72;
  } // namespace

  template <int dim>
  MovingBodies<dim>::~MovingBodies() = default;

  // ----------------------------------------------------------- between steps

  template <int dim>
  Vec3 MovingBodies<dim>::in_space(const Vector &v) const
  {
    Vec3 result{};
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = v[d];
    return result;
  }

  template <int dim>
  RigidState MovingBodies<dim>::rigid_state(const State &state,
                                            const Mover &mover) const
  {
    return nsfd::rigid_state(state.rigid.data() + 13 * mover.rigid_number);
  }

  /** Nodal displacements of a place and turn. */
  template <int dim>
  void MovingBodies<dim>::place_rigid(const RigidState &rigid,
                                      const Mover &mover,
                                      std::vector<double> &displacement) const
  {
    const Mat3 R = rotation(rigid.orientation);
    for (const unsigned int c : mover.cells) {
      const std::size_t first = discretization_.first_node(c);
      for (std::size_t i = first; i < first + discretization_.shape(c).n_nodes;
           ++i) {
        const Vec3 X = in_space(Vector(at_nodes(rest_, i)));
        const Vec3 u = rigid.centre + R * (X - mover.centre) - X;
        for (unsigned int d = 0; d < dim; ++d)
          displacement[i * dim + d] = u[d];
      }
    }
  }

  template <int dim>
  void MovingBodies<dim>::put_rigid(const RigidState &rigid, const Mover &mover,
                                    State &state) const
  {
    double *x = state.rigid.data() + 13 * mover.rigid_number;
    std::copy_n(rigid.centre.begin(), 3, x);
    std::copy_n(rigid.velocity.begin(), 3, x + 3);
    std::copy_n(rigid.orientation.begin(), 4, x + 6);
    std::copy_n(rigid.spin.begin(), 3, x + 10);
    place_rigid(rigid, mover, state.displacement);
    const Vec3 spin = rotation(rigid.orientation) * rigid.spin;
    for (const unsigned int c : mover.cells) {
      const std::size_t first = discretization_.first_node(c);
      for (std::size_t i = first; i < first + discretization_.shape(c).n_nodes;
           ++i) {
        const Vec3 x_now = in_space(Vector(at_nodes(rest_, i)) +
                                    Vector(at_nodes(state.displacement, i)));
        const Vec3 v = rigid.velocity + cross(spin, x_now - rigid.centre);
        for (unsigned int d = 0; d < dim; ++d)
          state.velocity[i * dim + d] = v[d];
      }
    }
  }

  /** What each rank has put there, to all of them. */
  template <int dim>
  void MovingBodies<dim>::share_rigid(State &state) const
  {
    struct Motion {
      std::size_t number;
      std::array<double, 13> values;
    };
    std::vector<Motion> own;
    for (const Mover &mover : movers_)
      if (mover.rigid >= 0) {
        auto &motion = own.emplace_back();
        motion.number = mover.rigid_number;
        std::copy_n(state.rigid.data() + 13 * mover.rigid_number, 13,
                    motion.values.begin());
      }
    for (const Motion &motion : gather_all(all_, own))
      std::copy(motion.values.begin(), motion.values.end(),
                state.rigid.begin() + long(13 * motion.number));
  }

  template <int dim>
  Point<dim> MovingBodies<dim>::at_nodes(const std::vector<double> &x,
                                         const std::size_t node) const
  {
    Place result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = x[node * dim + d];
    return result;
  }

  template <int dim>
  double MovingBodies<dim>::largest_speed(const State &state) const
  {
    double square = 0.;
    for (std::size_t i = 0; i < n_nodes_; ++i)
      square =
          std::max(square, Vector(at_nodes(state.velocity, i)).norm_square());
    double speed = std::sqrt(square);
    for (const Mover &mover : movers_)
      if (mover.radius > 0.) {
        const RigidState rigid = rigid_state(state, mover);
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
    for (const Mover &mover : movers_) {
      BodyEnergies &result = all.emplace_back();
      if (mover.rigid >= 0)
        result.kinetic =
            kinetic_energy(mover.inertia, rigid_state(state, mover));
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

  template <int dim>
  unsigned int MovingBodies<dim>::body_of_pin(const unsigned int k) const
  {
    const BodyTable &table = discretization_.body_table();
    for (unsigned int b = 0; b < table.bodies.size(); ++b)
      if (table.is_rigid(b) &&
          input_.materials[table.bodies[b].material].name ==
              input_.pins[k].material)
        return b;
    throw std::logic_error("a pin without a body");
  }

  template <int dim>
  std::array<double, dim> MovingBodies<dim>::pin_drift(const unsigned int k,
                                                       const State &state) const
  {
    const Mover &mover = movers_[std::size_t(local_body_[body_of_pin(k)])];
    const RigidState rigid = rigid_state(state, mover);
    Vec3 at{};
    for (unsigned int d = 0; d < dim; ++d)
      at[d] = input_.pins[k].at[d];
    const Vec3 off =
        rigid.centre + rotation(rigid.orientation) * (at - mover.centre) - at;
    std::array<double, dim> result;
    std::copy_n(off.begin(), dim, result.begin());
    return result;
  }

  /**
   * What each side has at the points of the mesh, complete where it is that of
   * another rank; @p stride values per point.
   */
  template <int dim>
  void MovingBodies<dim>::share_sides(std::array<std::vector<double>, 2> &side,
                                      const unsigned int stride) const
  {
    const auto &neighbors = discretization_.points().neighbors;
    NeighborMessages<double> exchange;
    for (const auto &neighbor : neighbors) {
      auto &message = exchange.messages.emplace_back();
      message.rank = neighbor.rank;
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        const auto own = side[neighbor.side[j]].begin() +
                         long(std::size_t(neighbor.points[j]) * stride);
        message.out.insert(message.out.end(), own, own + stride);
      }
      message.in.resize(message.out.size());
    }
    exchange.start(all_.mpi(), tag_of_sides);
    exchange.finish();
    for (std::size_t k = 0; k < neighbors.size(); ++k)
      for (std::size_t j = 0; j < neighbors[k].points.size(); ++j)
        std::copy_n(exchange.messages[k].in.data() + j * stride, stride,
                    side[1u - neighbors[k].side[j]].data() +
                        std::size_t(neighbors[k].points[j]) * stride);
  }

  template <int dim>
  std::vector<double>
  MovingBodies<dim>::jumps(const std::vector<double> &displacement) const
  {
    const Bodies &cells = discretization_.bodies();
    std::array<std::vector<double>, 2> side;
    for (auto &values : side)
      values.assign(n_mesh_points_ * dim, 0.);
    for (const auto &slots : slots_)
      for (const Slot &slot : slots) {
        const auto &body = cells.classes[cells.class_of[slot.cell]];
        const double *u = displacement.data() + cells.first_dof[slot.cell];
        for (unsigned int d = 0; d < dim; ++d) {
          double value = 0.;
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            value += body.trace(slot.slot * dim + d, j) * u[j];
          side[slot.sign > 0][std::size_t(slot.point) * dim + d] =
              slot.sign * value;
        }
      }
    share_sides(side, dim);
    for (std::size_t k = 0; k < side[1].size(); ++k)
      side[1][k] += side[0][k];
    return side[1];
  }

  // ---------------------------------------------------------------- one step

  template <int dim>
  void MovingBodies<dim>::start(const State &old, const double time_step,
                                const double theta,
                                const std::vector<double> &forces,
                                const std::vector<double> &shift_old,
                                const std::vector<double> &shift_new)
  {
    time_step_ = time_step;
    theta_ = theta;
    forces_ = forces;
    u_old_ = u_new_ = old.displacement;
    history_ = old.material_history;
    shift_middle_.resize(shift_old.size());
    for (std::size_t k = 0; k < shift_old.size(); ++k)
      shift_middle_[k] = (shift_old[k] + shift_new[k]) / 2.;
    v_old_.assign(bodies_.n_dofs(), 0.);
    rigid_.clear();
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      const Mover &mover = movers_[b];
      double *v = v_old_.data() + bodies_.first_dof[b];
      if (mover.rigid < 0) {
        std::copy_n(old.velocity.data() +
                        discretization_.bodies().first_dof[mover.cells[0]],
                    bodies_.classes[b].n_dofs, v);
        continue;
      }
      rigid_.emplace_back(mover.inertia, rigid_state(old, mover), time_step,
                          theta);
      const Vec3 a = rigid_.back().a_k();
      const RigidVelocity start = rigid_.back().velocity();
      for (unsigned int d = 0; d < dim; ++d)
        v[d] = start.centre[d];
      if (dim == 2)
        v[2] = a[2];
      else
        std::copy_n(a.begin(), 3, v + dim);
    }
    v_ = v_old_;
    for (std::size_t b = 0; b < movers_.size(); ++b)
      set_step_end(b);
  }

  template <int dim>
  CellMotion MovingBodies<dim>::motion_of(const unsigned int c) const
  {
    const std::size_t first = discretization_.bodies().first_dof[c];
    return {u_old_.data() + first, u_new_.data() + first, theta_, time_step_,
            history_.data() + cells_.first_history(c)};
  }

  /** Displacements at the end of the step with the velocities at hand. */
  template <int dim>
  void MovingBodies<dim>::set_step_end(const std::size_t b)
  {
    const Mover &mover = movers_[b];
    if (mover.rigid >= 0) {
      place_rigid(rigid_[std::size_t(mover.rigid)].state(), mover, u_new_);
      return;
    }
    const std::size_t dof = bodies_.first_dof[b],
                      node = discretization_.bodies().first_dof[mover.cells[0]];
    for (unsigned int i = 0; i < bodies_.classes[b].n_dofs; ++i)
      u_new_[node + i] =
          u_old_[node + i] +
          time_step_ * (theta_ * v_[dof + i] + (1. - theta_) * v_old_[dof + i]);
  }

  template <int dim>
  Point<dim> MovingBodies<dim>::middle(const std::size_t node) const
  {
    return at_nodes(middle_, node);
  }

  template <int dim>
  Point<dim> MovingBodies<dim>::middle_centre(const std::size_t b) const
  {
    const RigidStep &step = rigid_[std::size_t(movers_[b].rigid)];
    const RigidVelocity v = step.theta_velocity();
    Place result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = step.state().centre[d] - time_step_ / 2. * v.centre[d];
    return result;
  }

  template <int dim>
  void MovingBodies<dim>::set_middle()
  {
    middle_.resize(rest_.size());
    for (std::size_t i = 0; i < rest_.size(); ++i)
      middle_[i] = rest_[i] + (u_old_[i] + u_new_[i]) / 2.;
    set_frames();
    for (std::size_t b = 0; b < movers_.size(); ++b)
      set_body(b);
    place_rows();
  }

  /**
   * Faces between two bodies turn with the mean of their lips: the tangents
   * are those of the mean motion, the normal is orthogonal to them.
   */
  template <int dim>
  void MovingBodies<dim>::set_frames()
  {
    const auto &rest = discretization_.points();
    const Bodies &cells = discretization_.bodies();
    constexpr unsigned int stride = dim * (dim - 1);
    std::array<std::vector<double>, 2> side;
    for (auto &values : side)
      values.assign(n_mesh_points_ * stride, 0.);
    for (const auto &slots : slots_)
      for (const Slot &slot : slots) {
        const auto k = cells.class_of[slot.cell];
        const unsigned int n = discretization_.shape(slot.cell).n_nodes;
        const Vector *g =
            slot_gradients_[k].data() + std::size_t(slot.slot) * n;
        const std::size_t first = discretization_.first_node(slot.cell);
        for (unsigned int a = 1; a < dim; ++a) {
          Vector T;
          for (unsigned int d = 0; d < dim; ++d)
            T[d] = rest.frame[(std::size_t(slot.point) * dim + a) * dim + d];
          Vector sum;
          for (unsigned int i = 0; i < n; ++i)
            sum += (g[i] * T) * Vector(middle(first + i));
          for (unsigned int d = 0; d < dim; ++d)
            side[slot.sign > 0]
                [std::size_t(slot.point) * stride + (a - 1) * dim + d] = sum[d];
        }
      }
    share_sides(side, stride);
    const auto tangent = [&](const std::size_t i, const unsigned int a) {
      Vector result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = side[0][i * stride + a * dim + d] +
                    side[1][i * stride + a * dim + d];
      return result;
    };
    for (std::size_t i = 0; i < n_mesh_points_; ++i) {
      const auto &face = points_.faces[rest.face_of[i]];
      if (face.boundary)
        continue; // rows of a support are x, y, z
      std::array<Vector, dim> frame;
      Vector t = tangent(i, 0);
      t /= t.norm();
      frame[1] = t;
      if constexpr (dim == 2) {
        frame[0][0] = t[1];
        frame[0][1] = -t[0];
      } else {
        Vector n = cross_product_3d(t, tangent(i, 1));
        n /= n.norm();
        frame[0] = n;
        frame[2] = cross_product_3d(n, t);
      }
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          points_.frame[(mesh_point(i) * dim + a) * dim + d] = frame[a][d];
    }
  }

  /** Its matrices, and the traces at the points of the mesh. */
  template <int dim>
  void MovingBodies<dim>::set_body(const std::size_t b)
  {
    const Mover &mover = movers_[b];
    const Bodies &cells = discretization_.bodies();
    BodyClass &body = bodies_.classes[b];
    if (mover.rigid >= 0) {
      const auto A = rigid_[std::size_t(mover.rigid)].iteration_matrix();
      const auto entry = [](const unsigned int i) {
        return dim == 2 && i == 2 ? 5u : i;
      };
      for (unsigned int i = 0; i < n_rigid; ++i)
        for (unsigned int j = 0; j < n_rigid; ++j)
          body.mass(i, j) = A[entry(i) * 6 + entry(j)];
      const Place centre = middle_centre(b);
      for (unsigned int s = 0; s < slots_[b].size(); ++s) {
        const Slot &slot = slots_[b][s];
        const auto &cell = cells.classes[cells.class_of[slot.cell]];
        const std::size_t first = cells.first_dof[slot.cell];
        Place x;
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int j = 0; j < cell.n_dofs; ++j)
            x[d] += cell.trace(slot.slot * dim + d, j) * middle_[first + j];
        rigid_trace(b, s, x - centre);
      }
      return;
    }
    const unsigned int c = mover.cells[0], k = cells.class_of[c];
    const BodyClass &cell = cells.classes[k];
    const unsigned int n = body.n_dofs;
    std::vector<double> tangent(std::size_t(n) * n);
    cells_.of(c)->symmetric_tangent(motion_of(c), tangent.data());
    body.stiffness = Block(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        body.stiffness(i, j) = tangent[std::size_t(j) * n + i] / theta_;
    for (unsigned int s = 0; s < slots_[b].size(); ++s)
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int j = 0; j < n; ++j)
          body.trace(s * dim + d, j) =
              cell.trace(slots_[b][s].slot * dim + d, j);
  }

  /** V + a x r. */
  template <int dim>
  void MovingBodies<dim>::rigid_trace(const std::size_t b,
                                      const unsigned int slot,
                                      const Vector &arm)
  {
    Block &trace = bodies_.classes[b].trace;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int j = 0; j < n_rigid; ++j)
        trace(slot * dim + d, j) = d == j ? 1. : 0.;
    if constexpr (dim == 2) {
      trace(slot * dim, 2) = -arm[1];
      trace(slot * dim + 1, 2) = arm[0];
    } else
      for (unsigned int a = 0; a < 3; ++a) {
        Vec3 e{};
        e[a] = 1.;
        const Vec3 w = cross(e, in_space(arm));
        for (unsigned int d = 0; d < 3; ++d)
          trace(slot * dim + d, 3 + a) = w[d];
      }
  }

  // ------------------------------------------------------------- local motion

  /** Loads of the nodes at the middle of the step. */
  template <int dim>
  RigidLoad MovingBodies<dim>::load_of(const Mover &mover) const
  {
    RigidLoad load;
    const std::size_t b = mover_of_[mover.cells[0]];
    const Vec3 centre = in_space(Vector(middle_centre(b)));
    for (const unsigned int c : mover.cells) {
      const std::size_t first = discretization_.first_node(c);
      for (std::size_t i = first; i < first + discretization_.shape(c).n_nodes;
           ++i) {
        const Vec3 f = in_space(Vector(at_nodes(forces_, i)));
        load.force = load.force + f;
        load.moment =
            load.moment + cross(in_space(Vector(middle(i))) - centre, f);
      }
    }
    for (unsigned int d = 0; d < dim; ++d)
      load.force[d] += mover.extra_weight * input_.gravity[d];
    return load;
  }

  template <int dim>
  void MovingBodies<dim>::take_rigid_velocity(const std::size_t b)
  {
    const RigidVelocity now = rigid_[std::size_t(movers_[b].rigid)].velocity();
    double *v = v_.data() + bodies_.first_dof[b];
    for (unsigned int d = 0; d < dim; ++d)
      v[d] = now.centre[d];
    if (dim == 2)
      v[2] = now.spin[2];
    else
      std::copy_n(now.spin.begin(), 3, v + dim);
  }

  template <int dim>
  bool MovingBodies<dim>::move(const std::vector<double> &r,
                               const std::vector<double> &v)
  {
    v_ = v;
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      const Mover &mover = movers_[b];
      const double *impulse = r.data() + bodies_.first_dof[b];
      if (mover.rigid < 0) {
        const unsigned int c = mover.cells[0];
        const std::size_t first = discretization_.bodies().first_dof[c];
        FiniteStep step;
        step.time_step = time_step_;
        step.theta = theta_;
        step.mass = cells_.mass(c);
        step.displacement = u_old_.data() + first;
        step.velocity = v_old_.data() + bodies_.first_dof[b];
        step.load = forces_.data() + first;
        step.impulse = impulse;
        step.history = history_.data() + cells_.first_history(c);
        if (!cells_.of(c)->solve(step, v_.data() + bodies_.first_dof[b],
                                 scratch_))
          return false;
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
        if (!rigid_[std::size_t(mover.rigid)].solve(load, spin))
          return false;
        take_rigid_velocity(b);
      }
      set_step_end(b);
    }
    return true;
  }

  template <int dim>
  void MovingBodies<dim>::finish(State &next) const
  {
    next.displacement = u_new_;
    next.velocity.resize(u_new_.size());
    next.rigid.resize(13 * discretization_.body_table().n_rigid);
    next.material_history.resize(history_.size());
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      const Mover &mover = movers_[b];
      if (mover.rigid >= 0)
        put_rigid(rigid_[std::size_t(mover.rigid)].state(), mover, next);
      else {
        const unsigned int c = mover.cells[0];
        std::copy_n(v_.data() + bodies_.first_dof[b], bodies_.classes[b].n_dofs,
                    next.velocity.data() +
                        discretization_.bodies().first_dof[c]);
        if (cells_.of(c)->n_history() > 0)
          cells_.of(c)->book(motion_of(c), next.material_history.data() +
                                               cells_.first_history(c));
      }
    }
    share_rigid(next);
  }

  template <int dim>
  std::vector<BodyEnergies> MovingBodies<dim>::book() const
  {
    std::vector<BodyEnergies> all;
    std::vector<double> history;
    const Bodies &cells = discretization_.bodies();
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      BodyEnergies &result = all.emplace_back();
      const Mover &mover = movers_[b];
      const std::size_t dof = bodies_.first_dof[b];
      if (mover.rigid >= 0) {
        const RigidStep &step = rigid_[std::size_t(mover.rigid)];
        result.kinetic += kinetic_energy(mover.inertia, step.state());
        result.of_mass += step.dissipated();
        const RigidLoad load = load_of(mover);
        const RigidVelocity v = step.theta_velocity();
        result.work +=
            time_step_ * (dot(load.force, v.centre) + dot(load.moment, v.spin));
        continue;
      }
      const unsigned int c = mover.cells[0], k = cells.class_of[c];
      const std::size_t first = cells.first_dof[c];
      const Block &M = cells.classes[k].mass;
      const double *v = v_.data() + dof, *v_old = v_old_.data() + dof;
      for (unsigned int i = 0; i < M.rows; ++i) {
        for (unsigned int j = 0; j < M.cols; ++j) {
          result.kinetic += 0.5 * v[i] * M(i, j) * v[j];
          result.of_mass +=
              (theta_ - 0.5) * (v[i] - v_old[i]) * M(i, j) * (v[j] - v_old[j]);
        }
        result.work += time_step_ * forces_[first + i] *
                       (theta_ * v[i] + (1. - theta_) * v_old[i]);
      }
      const CellMotion motion = motion_of(c);
      history.resize(cells_.of(c)->n_history());
      const CellLosses losses = cells_.of(c)->book(motion, history.data());
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
    for (std::size_t b = 0; b < movers_.size(); ++b) {
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
