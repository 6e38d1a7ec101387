#include "moving_bodies.h"

#include "../mesh/body_shape.h"
#include "../time/ledger.h"
#include "obstacle_shape.h"

#include "nsfd/input/scene_input.h"
#include "nsfd/mesh/cell_geometry.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace nsfd
{
  using namespace dealii;
  using namespace space;

  namespace
  {
    constexpr double pi = 3.14159265358979323846;

    /** Cells that are one rigid body: the first one of each, by cell. */
    template <int dim>
    std::vector<unsigned int>
    rigid_groups(const Discretization<dim> &discretization)
    {
      std::vector<unsigned int> first(discretization.bodies().size());
      std::iota(first.begin(), first.end(), 0u);
      const auto root = [&](unsigned int c) {
        while (first[c] != c)
          c = first[c] = first[first[c]];
        return c;
      };
      for (const InnerFace &face : discretization.inner_faces()) {
        const unsigned int i = root(face.bodies[0]), j = root(face.bodies[1]);
        first[std::max(i, j)] = std::min(i, j);
      }
      for (unsigned int c = 0; c < first.size(); ++c)
        first[c] = root(c);
      return first;
    }

    /** Quaternion of a rotation matrix, w >= 0 or the largest part positive. */
    Quaternion quaternion_of(const Mat3 &R)
    {
      const double squares[4] = {
          1. + R[0][0] + R[1][1] + R[2][2], 1. + R[0][0] - R[1][1] - R[2][2],
          1. - R[0][0] + R[1][1] - R[2][2], 1. - R[0][0] - R[1][1] + R[2][2]};
      const auto k = std::max_element(squares, squares + 4) - squares;
      const double s = std::sqrt(squares[k]), f = 1. / (2. * s);
      switch (k) {
      case 0:
        return normalized({s / 2., f * (R[2][1] - R[1][2]),
                           f * (R[0][2] - R[2][0]), f * (R[1][0] - R[0][1])});
      case 1:
        return normalized({f * (R[2][1] - R[1][2]), s / 2.,
                           f * (R[0][1] + R[1][0]), f * (R[0][2] + R[2][0])});
      case 2:
        return normalized({f * (R[0][2] - R[2][0]), f * (R[0][1] + R[1][0]),
                           s / 2., f * (R[1][2] + R[2][1])});
      default:
        return normalized({f * (R[1][0] - R[0][1]), f * (R[0][2] + R[2][0]),
                           f * (R[1][2] + R[2][1]), s / 2.});
      }
    }
  } // namespace

  template <int dim>
  MovingBodies<dim>::~MovingBodies() = default;

  template <int dim>
  MovingBodies<dim>::MovingBodies(const SceneInput &input,
                                  const Discretization<dim> &discretization)
      : input_(input), discretization_(discretization),
        n_nodes_(discretization.n_nodal() / dim), cells_(discretization)
  {
    for (unsigned int c = 0; c < discretization.bodies().size(); ++c) {
      const auto &shape = discretization.shape(c);
      const Place corner = discretization.corners(c)[0];
      for (const Place &node : shape.nodes)
        for (unsigned int d = 0; d < dim; ++d)
          rest_.push_back(corner[d] + node[d]);
    }
    make_movers();
    make_points();
    set_slot_gradients();
    State rest;
    rest.displacement.assign(discretization.n_nodal(), 0.);
    rest.velocity = rest.displacement;
    set_initial(rest);
    start(rest, 0., 0.5, rest.displacement, {}, {});
    set_rows({});
    set_middle();
  }

  // ------------------------------------------------------------------ set-up

  template <int dim>
  void MovingBodies<dim>::make_movers()
  {
    const auto group = rigid_groups(discretization_);
    mover_of_.resize(group.size());
    int n_rigid_bodies = 0;
    for (unsigned int c = 0; c < group.size(); ++c) {
      if (group[c] != c) {
        mover_of_[c] = mover_of_[group[c]];
        movers_[mover_of_[c]].cells.push_back(c);
        continue;
      }
      mover_of_[c] = unsigned(movers_.size());
      Mover &mover = movers_.emplace_back();
      mover.material = discretization_.material_of(c);
      mover.cells.push_back(c);
      if (input_.materials[mover.material].rigid)
        mover.rigid = n_rigid_bodies++;
    }
    for (Mover &mover : movers_)
      if (mover.rigid >= 0)
        set_inertia(mover);
  }

  /** Of its cells, of the ball around them, or as the input says. */
  template <int dim>
  void MovingBodies<dim>::set_inertia(Mover &mover)
  {
    const auto &material = input_.materials[mover.material];
    const auto &given = material.rigid_bodies;
    double mass = 0.;
    Vec3 centre{};
    const auto for_points = [&](const auto &visit) {
      for (const unsigned int c : mover.cells) {
        const auto &shape = discretization_.shape(c);
        const Place corner = discretization_.corners(c)[0];
        for (std::size_t q = 0; q < shape.JxW.size(); ++q)
          visit(material.density * shape.JxW[q],
                in_space(Vector(corner) + Vector(shape.positions[q])));
      }
    };
    for_points([&](const double m, const Vec3 &x) {
      mass += m;
      centre = centre + m * x;
    });
    centre = (1. / mass) * centre;
    Mat3 inertia{};
    for_points([&](const double m, const Vec3 &x) {
      const Vec3 r = x - centre;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          inertia[i][j] += m * ((i == j ? dot(r, r) : 0.) - r[i] * r[j]);
    });
    const double of_cells = mass;
    if (given.ball) {
      for (const unsigned int c : mover.cells)
        for (const Place &corner : discretization_.corners(c))
          mover.radius =
              std::max(mover.radius, norm(in_space(Vector(corner)) - centre));
      const double R = mover.radius;
      mass = material.density * (dim == 2 ? pi * R * R : 4. / 3. * pi * R * R * R);
      inertia = {};
      for (unsigned int i = 0; i < 3; ++i)
        inertia[i][i] = (dim == 2 ? 0.5 : 0.4) * mass * R * R;
    }
    if (given.mass) {
      inertia = (*given.mass / mass) * inertia;
      mass = *given.mass;
    }
    if (given.inertia) {
      inertia = {};
      for (unsigned int i = 0; i < 3; ++i)
        inertia[i][i] = (*given.inertia)[i];
    }
    mover.inertia = dim == 2 ? plane_inertia(mass, inertia[2][2])
                             : RigidInertia{mass, inertia};
    mover.centre = centre;
    mover.extra_weight = mass - of_cells;
  }

  /** The points of the mesh with bodies as they move here. */
  template <int dim>
  void MovingBodies<dim>::make_points()
  {
    points_ = discretization_.points();
    n_mesh_points_ = points_.n_points;
    n_mesh_faces_ = points_.faces.size();
    for (auto &face : points_.faces)
      for (unsigned int side = 0; side < 2; ++side)
        if (face.bodies[side] >= 0) {
          const unsigned int b = mover_of_[unsigned(face.bodies[side])];
          face.bodies[side] = int(b);
          face.cells[side] = b;
        }
    slots_.resize(movers_.size());
    const Bodies &cells = discretization_.bodies();
    const auto add = [&](const std::size_t c, const unsigned int slot,
                         const unsigned int point, const int sign) {
      if (point < n_mesh_points_)
        slots_[mover_of_[c]].push_back(
            {unsigned(c), slot, point, static_cast<signed char>(sign)});
    };
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (std::size_t s = cells.first_slot[c]; s < cells.first_slot[c + 1];
           ++s)
        add(c, unsigned(s - cells.first_slot[c]), cells.slot_point[s],
            cells.slot_sign[s]);
    for (const auto &[slot, point] : cells.extra_points) {
      const std::size_t c =
          std::size_t(std::upper_bound(cells.first_slot.begin(),
                                       cells.first_slot.end(), slot) -
                      cells.first_slot.begin()) -
          1;
      add(c, unsigned(slot - cells.first_slot[c]), point, 1);
    }
    bodies_.class_of.resize(movers_.size());
    bodies_.classes.resize(movers_.size());
    bodies_.first_dof.assign(1, 0);
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      BodyClass &body = bodies_.classes[b];
      bodies_.class_of[b] = unsigned(b);
      body.bodies = {unsigned(b)};
      body.material = movers_[b].material;
      body.rigid = movers_[b].rigid >= 0;
      const auto &cell = cells.classes[cells.class_of[movers_[b].cells[0]]];
      body.n_dofs = body.rigid ? n_rigid : cell.n_dofs;
      if (body.rigid)
        body.mass = Block(n_rigid, n_rigid);
      else {
        body.mass = cell.mass;
        body.rigid_motions = cell.rigid_motions;
      }
      bodies_.first_dof.push_back(bodies_.first_dof.back() + body.n_dofs);
    }
  }

  template <int dim>
  void MovingBodies<dim>::set_slot_gradients()
  {
    const auto &element = discretization_.element();
    for (const auto &body : discretization_.bodies().classes) {
      auto &gradients = slot_gradients_.emplace_back();
      if (body.bodies.empty())
        continue;
      const auto &shape = discretization_.shape(body.bodies[0]);
      for (const Place &place : shape.slot_places) {
        const auto inverse =
            invert(jacobian(shape.reference, shape.corners, place));
        for (unsigned int i = 0; i < shape.n_nodes; ++i)
          gradients.push_back(transpose(inverse) *
                              element.shape_grad(i, place));
      }
    }
  }

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
    return nsfd::rigid_state(state.rigid.data() + 13 * mover.rigid);
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
  void MovingBodies<dim>::put_rigid(const RigidState &rigid,
                                    const Mover &mover, State &state) const
  {
    double *x = state.rigid.data() + 13 * mover.rigid;
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
        const Vec3 x_now =
            in_space(Vector(at_nodes(rest_, i)) +
                     Vector(at_nodes(state.displacement, i)));
        const Vec3 v = rigid.velocity + cross(spin, x_now - rigid.centre);
        for (unsigned int d = 0; d < dim; ++d)
          state.velocity[i * dim + d] = v[d];
      }
    }
  }

  /**
   * The turn by the polar factor of the moment sum (x - x_G) (X - X_G)^T of
   * the corners, Newton's iteration for it; the spin by least squares.
   */
  template <int dim>
  void MovingBodies<dim>::set_initial(State &state) const
  {
    state.rigid.assign(
        13 * std::size_t(std::count_if(
                 movers_.begin(), movers_.end(),
                 [](const Mover &mover) { return mover.rigid >= 0; })),
        0.);
    state.material_history = cells_.begin_history();
    for (const Mover &mover : movers_) {
      if (mover.rigid < 0)
        continue;
      std::vector<Vec3> X, x, v;
      Vec3 mean_X{}, mean_x{}, mean_v{};
      for (const unsigned int c : mover.cells) {
        const std::size_t first = discretization_.first_node(c);
        for (std::size_t i = first;
             i < first + discretization_.shape(c).n_nodes; ++i) {
          X.push_back(in_space(Vector(at_nodes(rest_, i))));
          x.push_back(X.back() +
                      in_space(Vector(at_nodes(state.displacement, i))));
          v.push_back(in_space(Vector(at_nodes(state.velocity, i))));
          mean_X = mean_X + X.back();
          mean_x = mean_x + x.back();
          mean_v = mean_v + v.back();
        }
      }
      const double share = 1. / double(X.size());
      mean_X = share * mean_X;
      mean_x = share * mean_x;
      mean_v = share * mean_v;
      Mat3 A{}, S{};
      Vec3 moment{};
      double size = 0.;
      for (std::size_t i = 0; i < X.size(); ++i) {
        const Vec3 R = X[i] - mean_X, r = x[i] - mean_x;
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = 0; l < 3; ++l) {
            A[k][l] += r[k] * R[l];
            S[k][l] += R[k] * R[l];
          }
        size += dot(R, R);
      }
      // A S^{-1} is the mean deformation gradient; flat bodies get a third
      // direction
      if (dim == 2)
        A[2][2] = S[2][2] = size;
      const Mat3 St = transposed(S);
      Mat3 F;
      for (unsigned int k = 0; k < 3; ++k)
        F[k] = solve(St, A[k]);
      for (unsigned int k = 0; k < 100; ++k) { // R <- (R + R^{-T}) / 2
        const Mat3 T = F;
        Mat3 inverse_transposed;
        for (unsigned int l = 0; l < 3; ++l) {
          Vec3 e{};
          e[l] = 1.;
          inverse_transposed[l] = solve(T, e); // column l of T^{-1}
        }
        F = 0.5 * (T + inverse_transposed);
      }
      RigidState rigid;
      rigid.orientation = quaternion_of(F);
      const Mat3 R = rotation(rigid.orientation);
      rigid.centre = mean_x + R * (mover.centre - mean_X);
      Mat3 I{};
      for (std::size_t i = 0; i < X.size(); ++i) {
        const Vec3 r = R * (X[i] - mean_X);
        moment = moment + cross(r, v[i] - mean_v);
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = 0; l < 3; ++l)
            I[k][l] += (k == l ? dot(r, r) : 0.) - r[k] * r[l];
      }
      const Vec3 omega = solve(I, moment);
      rigid.velocity = mean_v + cross(omega, rigid.centre - mean_x);
      rigid.spin = transposed(R) * omega;
      put_rigid(rigid, mover, state);
    }
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
  std::vector<double> MovingBodies<dim>::positions(const State &state) const
  {
    std::vector<double> x(rest_);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] += state.displacement[i];
    for (std::size_t r = 0; r < state.rigid.size() / 13; ++r)
      for (unsigned int d = 0; d < dim; ++d)
        x.push_back(state.rigid[13 * r + d]);
    return x;
  }

  template <int dim>
  double MovingBodies<dim>::largest_speed(const State &state) const
  {
    double square = 0.;
    for (std::size_t i = 0; i < n_nodes_; ++i)
      square = std::max(square,
                        Vector(at_nodes(state.velocity, i)).norm_square());
    double speed = std::sqrt(square);
    for (const Mover &mover : movers_)
      if (mover.radius > 0.) {
        const RigidState rigid = rigid_state(state, mover);
        speed = std::max(speed, norm(rigid.velocity) +
                                    mover.radius * norm(rigid.spin));
      }
    return speed;
  }

  template <int dim>
  BodyEnergies MovingBodies<dim>::energies(const State &state) const
  {
    BodyEnergies result;
    const Bodies &cells = discretization_.bodies();
    for (const Mover &mover : movers_)
      if (mover.rigid >= 0)
        result.kinetic +=
            kinetic_energy(mover.inertia, rigid_state(state, mover));
      else {
        const unsigned int c = mover.cells[0], k = cells.class_of[c];
        const double *v = state.velocity.data() + cells.first_dof[c];
        const Block &M = cells.classes[k].mass;
        for (unsigned int i = 0; i < M.rows; ++i)
          for (unsigned int j = 0; j < M.cols; ++j)
            result.kinetic += 0.5 * v[i] * M(i, j) * v[j];
        result.elastic += cells_.of(c)->energy(
            state.displacement.data() + cells.first_dof[c],
            state.material_history.data() + cells_.first_history(c));
      }
    return result;
  }

  template <int dim>
  unsigned int MovingBodies<dim>::body_of_pin(const unsigned int k) const
  {
    for (unsigned int b = 0; b < movers_.size(); ++b)
      if (is_rigid(b) &&
          input_.materials[material_of(b)].name == input_.pins[k].material)
        return b;
    throw std::logic_error("a pin without a body");
  }

  template <int dim>
  Tensor<1, dim> MovingBodies<dim>::pin_drift(const unsigned int k,
                                              const State &state) const
  {
    const Mover &mover = movers_[body_of_pin(k)];
    const RigidState rigid = rigid_state(state, mover);
    Vec3 at{};
    for (unsigned int d = 0; d < dim; ++d)
      at[d] = input_.pins[k].at[d];
    const Vec3 off = rigid.centre +
                     rotation(rigid.orientation) * (at - mover.centre) - at;
    Vector result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = off[d];
    return result;
  }

  template <int dim>
  std::vector<double>
  MovingBodies<dim>::jumps(const std::vector<double> &displacement) const
  {
    const Bodies &cells = discretization_.bodies();
    std::vector<double> result(n_mesh_points_ * dim, 0.);
    for (const auto &slots : slots_)
      for (const Slot &slot : slots) {
        const auto &body = cells.classes[cells.class_of[slot.cell]];
        const double *u = displacement.data() + cells.first_dof[slot.cell];
        for (unsigned int d = 0; d < dim; ++d) {
          double value = 0.;
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            value += body.trace(slot.slot * dim + d, j) * u[j];
          result[std::size_t(slot.point) * dim + d] += slot.sign * value;
        }
      }
    return result;
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
          u_old_[node + i] + time_step_ * (theta_ * v_[dof + i] +
                                           (1. - theta_) * v_old_[dof + i]);
  }

  template <int dim>
  void MovingBodies<dim>::set_rows(std::vector<MovingRow<dim>> rows)
  {
    rows_ = std::move(rows);
    points_.n_points = points_.n_owned = n_mesh_points_ + rows_.size();
    points_.position.resize(points_.n_points * dim);
    points_.frame.resize(points_.n_points * dim * dim);
    points_.weight.resize(points_.n_points);
    points_.face_of.resize(points_.n_points);
    points_.faces.resize(n_mesh_faces_);
    std::vector<unsigned int> n_slots;
    for (const auto &slots : slots_)
      n_slots.push_back(unsigned(slots.size()));
    row_slots_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const MovingRow<dim> &row = rows_[k];
      const std::size_t i = n_mesh_points_ + k;
      typename InterfacePoints<dim>::Face face;
      face.first = unsigned(i);
      face.count = 1;
      // apart from those of the mesh, the same in every run
      face.key =
          (std::uint64_t(row.partner == MovingRow<dim>::Partner::edge
                             ? row.edge[0]
                         : row.node == row.nowhere ? n_nodes_ + row.body_2
                                                   : row.node)
           << 20) +
          k;
      face.boundary = row.body_1 < 0;
      face.bodies = {{row.body_1, int(row.body_2)}};
      face.cells = {{row.body_1 < 0 ? row.body_2 : std::size_t(row.body_1),
                     row.body_2}};
      points_.face_of[i] = unsigned(points_.faces.size());
      points_.faces.push_back(face);
      points_.weight[i] = row.weight;
      row_slots_.push_back({row.body_1 < 0 ? 0 : n_slots[row.body_1]++,
                            n_slots[row.body_2]});
      ++n_slots[row.body_2];
    }
    bodies_.first_slot.assign(1, 0);
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      BodyClass &body = bodies_.classes[b];
      body.n_slots = n_slots[b];
      body.trace = Block(n_slots[b] * dim, body.n_dofs);
      bodies_.first_slot.push_back(bodies_.first_slot.back() + n_slots[b]);
    }
    bodies_.slot_point.assign(bodies_.first_slot.back(),
                              unsigned(points_.n_points));
    bodies_.slot_sign.assign(bodies_.first_slot.back(), 1);
    for (std::size_t b = 0; b < movers_.size(); ++b)
      for (std::size_t s = 0; s < slots_[b].size(); ++s) {
        bodies_.slot_point[bodies_.first_slot[b] + s] = slots_[b][s].point;
        bodies_.slot_sign[bodies_.first_slot[b] + s] = slots_[b][s].sign;
      }
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const auto put = [&](const std::size_t b, const unsigned int slot,
                           const int sign) {
        bodies_.slot_point[bodies_.first_slot[b] + slot] =
            unsigned(n_mesh_points_ + k);
        bodies_.slot_sign[bodies_.first_slot[b] + slot] =
            static_cast<signed char>(sign);
      };
      if (rows_[k].body_1 >= 0)
        put(std::size_t(rows_[k].body_1), row_slots_[k][0], -1);
      put(rows_[k].body_2, row_slots_[k][1], 1);
    }
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
    for (std::size_t k = 0; k < rows_.size(); ++k)
      set_row(k);
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
    std::vector<Vector> tangents(n_mesh_points_ * (dim - 1));
    for (const auto &slots : slots_)
      for (const Slot &slot : slots) {
        const auto k = cells.class_of[slot.cell];
        const unsigned int n = discretization_.shape(slot.cell).n_nodes;
        const Vector *g = slot_gradients_[k].data() + std::size_t(slot.slot) * n;
        const std::size_t first = discretization_.first_node(slot.cell);
        for (unsigned int a = 1; a < dim; ++a) {
          Vector T;
          for (unsigned int d = 0; d < dim; ++d)
            T[d] = rest.frame[(std::size_t(slot.point) * dim + a) * dim + d];
          Vector &sum = tangents[std::size_t(slot.point) * (dim - 1) + a - 1];
          for (unsigned int i = 0; i < n; ++i)
            sum += (g[i] * T) * Vector(middle(first + i));
        }
      }
    for (std::size_t i = 0; i < n_mesh_points_; ++i) {
      const auto &face = points_.faces[points_.face_of[i]];
      if (face.boundary)
        continue; // rows of a support are x, y, z
      std::array<Vector, dim> frame;
      Vector t = tangents[i * (dim - 1)];
      t /= t.norm();
      frame[1] = t;
      if constexpr (dim == 2) {
        frame[0][0] = t[1];
        frame[0][1] = -t[0];
      } else {
        Vector n = cross_product_3d(t, tangents[i * 2 + 1]);
        n /= n.norm();
        frame[0] = n;
        frame[2] = cross_product_3d(n, t);
      }
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          points_.frame[(i * dim + a) * dim + d] = frame[a][d];
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

  template <int dim>
  void MovingBodies<dim>::deformable_trace(const std::size_t b,
                                           const unsigned int slot,
                                           const Place &place)
  {
    Block &trace = bodies_.classes[b].trace;
    const auto &element = discretization_.element();
    for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        trace(slot * dim + d, i * dim + d) = element.shape_value(i, place);
  }

  // -------------------------------------------------------- contacts of a step

  template <int dim>
  Tensor<1, dim>
  MovingBodies<dim>::row_normal(const MovingRow<dim> &row) const
  {
    using Partner = typename MovingRow<dim>::Partner;
    Vector n;
    if (row.partner == Partner::pin) {
      n[0] = 1.;
      return n;
    }
    if constexpr (dim == 3)
      if (row.partner == Partner::edge) {
        n = cross_product_3d(
            Vector(middle(row.edge[1]) - middle(row.edge[0])),
            Vector(middle(row.facet[1]) - middle(row.facet[0])));
        return n / n.norm();
      }
    const Place x = row.node == row.nowhere ? middle_centre(row.body_2)
                                            : middle(row.node);
    if (row.partner == Partner::obstacle)
      return ObstacleGeometry<dim>(
                 input_.obstacles[row.obstacle],
                 shift_middle_.empty() ? nullptr
                                       : &shift_middle_[3 * row.obstacle])
          .normal(x);
    if (row.partner == Partner::ball) {
      n = x - middle_centre(std::size_t(row.body_1));
      return n / n.norm();
    }
    if constexpr (dim == 2) {
      const Vector edge = middle(row.facet[1]) - middle(row.facet[0]);
      n[0] = edge[1];
      n[1] = -edge[0];
    } else {
      const unsigned int last = row.n_facet == 3 ? 2 : 3,
                         one = row.n_facet == 3 ? 0 : 1;
      n = cross_product_3d(
          Vector(middle(row.facet[row.n_facet == 3 ? 1 : 2]) -
                 middle(row.facet[0])),
          Vector(middle(row.facet[last]) - middle(row.facet[one])));
    }
    n /= n.norm();
    if (row.node != row.nowhere)
      return n;
    // a ball at an edge or a corner: across what it touches there
    std::vector<std::size_t> touched;
    for (unsigned int v = 0; v < row.n_facet; ++v)
      if (row.weights[v] > 1e-9)
        touched.push_back(row.facet[v]);
    if (touched.size() >= dim)
      return n;
    Vector away = x - middle(touched[0]);
    if (touched.size() == 2) {
      Vector edge = middle(touched[1]) - middle(touched[0]);
      edge /= edge.norm();
      away -= (away * edge) * edge;
    }
    return away.norm() > 0. ? away / away.norm() : n;
  }

  /** Where the bodies touch, at the middle of the step. */
  template <int dim>
  Point<dim> MovingBodies<dim>::row_place(const MovingRow<dim> &row,
                                          const Vector &normal) const
  {
    if (row.partner == MovingRow<dim>::Partner::pin) {
      const Mover &mover = movers_[row.body_2];
      Vec3 at{};
      for (unsigned int d = 0; d < dim; ++d)
        at[d] = input_.pins[row.pin].at[d];
      const Vec3 arm =
          rigid_[std::size_t(mover.rigid)].mid_arm(at - mover.centre);
      Place x = middle_centre(row.body_2);
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += arm[d];
      return x;
    }
    if (row.node != row.nowhere)
      return middle(row.node);
    if (row.partner == MovingRow<dim>::Partner::edge)
      return middle(row.edge[0]) +
             row.edge_weights[1] *
                 (middle(row.edge[1]) - middle(row.edge[0]));
    return middle_centre(row.body_2) - movers_[row.body_2].radius * normal;
  }

  /**
   * The place of a body that is at x at the middle of the step; a little
   * outside of its cell too, so that both bodies feel the impulse there.
   */
  template <int dim>
  Point<dim> MovingBodies<dim>::in_reference_cell(const unsigned int cell,
                                                  const std::size_t *nodes,
                                                  const double *weights,
                                                  const unsigned int n_nodes,
                                                  const Place &x) const
  {
    const auto &element = discretization_.element();
    const std::size_t first = discretization_.first_node(cell);
    Place xi;
    for (unsigned int v = 0; v < n_nodes; ++v)
      xi += weights[v] *
            Vector(element.unit_support_point(unsigned(nodes[v] - first)));
    for (unsigned int k = 0; k < 20; ++k) {
      Vector off = x - Place();
      Tensor<2, dim> J;
      for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i) {
        const Vector node = middle(first + i) - Place();
        off -= element.shape_value(i, xi) * node;
        J += outer_product(node, element.shape_grad(i, xi));
      }
      const Vector change = invert(J) * off;
      xi += change;
      if (!(change.norm() > 1e-14))
        break;
    }
    return xi;
  }

  template <int dim>
  void MovingBodies<dim>::set_row(const std::size_t k)
  {
    const MovingRow<dim> &row = rows_[k];
    const std::size_t i = n_mesh_points_ + k;
    const Vector normal = row_normal(row);
    const Place x = row_place(row, normal);
    auto frame = local_frame<dim>(normal);
    if (row.partner == MovingRow<dim>::Partner::pin)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          frame[a][d] = a == d ? 1. : 0.;
    for (unsigned int a = 0; a < dim; ++a) {
      points_.position[i * dim + a] = x[a];
      for (unsigned int d = 0; d < dim; ++d)
        points_.frame[(i * dim + a) * dim + d] = frame[a][d];
    }
    const auto [slot_1, slot_2] = row_slots_[k];
    if (is_rigid(row.body_2))
      rigid_trace(row.body_2, slot_2, x - middle_centre(row.body_2));
    else if (row.partner == MovingRow<dim>::Partner::edge)
      deformable_trace(row.body_2, slot_2,
                       in_reference_cell(row.cell, row.edge.data(),
                                         row.edge_weights.data(), 2, x));
    else
      deformable_trace(
          row.body_2, slot_2,
          discretization_.element().unit_support_point(
              unsigned(row.node - discretization_.first_node(row.cell))));
    if (row.body_1 < 0)
      return;
    const auto other = std::size_t(row.body_1);
    if (is_rigid(other))
      rigid_trace(other, slot_1, x - middle_centre(other));
    else
      deformable_trace(other, slot_1,
                       in_reference_cell(row.facet_cell, row.facet.data(),
                                         row.weights.data(), row.n_facet, x));
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
    const RigidVelocity now =
        rigid_[std::size_t(movers_[b].rigid)].velocity();
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
    next.rigid.resize(13 * rigid_.size());
    next.material_history.resize(history_.size());
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      const Mover &mover = movers_[b];
      if (mover.rigid >= 0)
        put_rigid(rigid_[std::size_t(mover.rigid)].state(), mover, next);
      else {
        const unsigned int c = mover.cells[0];
        std::copy_n(v_.data() + bodies_.first_dof[b],
                    bodies_.classes[b].n_dofs,
                    next.velocity.data() +
                        discretization_.bodies().first_dof[c]);
        if (cells_.of(c)->n_history() > 0)
          cells_.of(c)->book(motion_of(c), next.material_history.data() +
                                               cells_.first_history(c));
      }
    }
  }

  template <int dim>
  BodyEnergies MovingBodies<dim>::book() const
  {
    BodyEnergies result;
    std::vector<double> history;
    const Bodies &cells = discretization_.bodies();
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      const Mover &mover = movers_[b];
      const std::size_t dof = bodies_.first_dof[b];
      if (mover.rigid >= 0) {
        const RigidStep &step = rigid_[std::size_t(mover.rigid)];
        result.kinetic += kinetic_energy(mover.inertia, step.state());
        result.of_mass += step.dissipated();
        const RigidLoad load = load_of(mover);
        const RigidVelocity v = step.theta_velocity();
        result.work += time_step_ *
                       (dot(load.force, v.centre) + dot(load.moment, v.spin));
        continue;
      }
      const unsigned int c = mover.cells[0], k = cells.class_of[c];
      const std::size_t first = cells.first_dof[c];
      const Block &M = cells.classes[k].mass;
      const double *v = v_.data() + dof, *v_old = v_old_.data() + dof;
      for (unsigned int i = 0; i < M.rows; ++i) {
        for (unsigned int j = 0; j < M.cols; ++j) {
          result.kinetic += 0.5 * v[i] * M(i, j) * v[j];
          result.of_mass += (theta_ - 0.5) * (v[i] - v_old[i]) * M(i, j) *
                            (v[j] - v_old[j]);
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
    return result;
  }

  template <int dim>
  double
  MovingBodies<dim>::kinetic_product(const std::vector<double> &x,
                                     const std::vector<double> &y) const
  {
    double sum = 0.;
    for (std::size_t b = 0; b < movers_.size(); ++b) {
      const Block &M = bodies_.classes[b].mass;
      const std::size_t first = bodies_.first_dof[b];
      for (unsigned int i = 0; i < M.rows; ++i)
        for (unsigned int j = 0; j < M.cols; ++j)
          sum += x[first + i] * M(i, j) * y[first + j];
    }
    return sum;
  }

  template class MovingBodies<2>;
  template class MovingBodies<3>;
} // namespace nsfd
