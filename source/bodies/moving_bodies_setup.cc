#include "moving_bodies.h"

#include "discretization/body_shape.h"

#include "discretization/cell_geometry.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>

// MovingBodies: what a scene begins with.

namespace nsfd
{
  using namespace dealii;
  using namespace space;

  namespace
  {
    constexpr double pi = 3.14159265358979323846;
    constexpr unsigned int none = ~0u;

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
  MovingBodies<dim>::MovingBodies(const SceneInput &input,
                                  const Discretization<dim> &discretization,
                                  const Communicator &communicator)
      : input_(input), discretization_(discretization), all_(communicator),
        n_nodes_(discretization.n_nodal() / dim),
        nodes_per_cell_(discretization.element().n_dofs_per_cell()),
        cells_(discretization)
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

  template <int dim>
  void MovingBodies<dim>::make_movers()
  {
    const BodyTable &table = discretization_.body_table();
    local_body_.assign(table.bodies.size(), -1);
    local_cell_.assign(table.n_cells(), none);
    int n_rigid_bodies = 0;
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      const unsigned int cell =
          table.cell_of_global[discretization_.global_cell(c)];
      const unsigned int b = table.body_of_cell[cell];
      local_cell_[cell] = c;
      if (local_body_[b] < 0) {
        local_body_[b] = int(movers_.size());
        Mover &mover = movers_.emplace_back();
        mover.number = b;
        mover.material = table.bodies[b].material;
        if (table.is_rigid(b)) {
          mover.rigid = n_rigid_bodies++;
          mover.rigid_number = std::size_t(table.bodies[b].rigid);
        }
      }
      mover_of_.push_back(unsigned(local_body_[b]));
      movers_[mover_of_[c]].cells.push_back(c);
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
      mass =
          material.density * (dim == 2 ? pi * R * R : 4. / 3. * pi * R * R * R);
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

  /** The points of the mesh with bodies as they move here, and those of the
      table instead of cells. */
  template <int dim>
  void MovingBodies<dim>::make_points()
  {
    const BodyTable &table = discretization_.body_table();
    points_ = discretization_.points();
    n_mesh_points_ = points_.n_points;
    n_own_mesh_points_ = points_.n_owned;
    n_mesh_faces_ = points_.faces.size();
    for (auto &face : points_.faces)
      for (unsigned int side = 0; side < 2; ++side) {
        if (!face.boundary)
          face.cells[side] = table.body_of_global(face.cells[side]);
        if (face.bodies[side] >= 0)
          face.bodies[side] = int(mover_of_[unsigned(face.bodies[side])]);
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

  /**
   * The turn by the polar factor of the moment sum (x - x_G) (X - X_G)^T of
   * the corners, Newton's iteration for it; the spin by least squares.
   */
  template <int dim>
  void MovingBodies<dim>::set_initial(State &state) const
  {
    state.rigid.assign(13 * discretization_.body_table().n_rigid, 0.);
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
    share_rigid(state);
  }
#define INSTANTIATE(dim)                                                       \
  template MovingBodies<dim>::MovingBodies(                                    \
      const SceneInput &, const Discretization<dim> &, const Communicator &);  \
  template void MovingBodies<dim>::set_initial(State &) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
