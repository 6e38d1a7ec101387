#include "rigid_motions.h"

#include "core/gather.h"
#include "discretization/body_shape.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  using namespace space;

  namespace
  {
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
  void RigidMotions<dim>::place(const RigidState &rigid, const MovingBody &body,
                                std::vector<double> &displacement) const
  {
    const Mat3 R = rotation(rigid.orientation);
    for (const unsigned int c : body.cells) {
      const std::size_t first = discretization_.cells().first_node[c];
      for (std::size_t i = first;
           i < first + discretization_.cells().class_shape(c).n_nodes; ++i) {
        const Vec3 X = in_space<dim>(Vector(at_node<dim>(layout_.rest(), i)));
        const Vec3 u = rigid.centre + R * (X - body.centre) - X;
        for (unsigned int d = 0; d < dim; ++d)
          displacement[i * dim + d] = u[d];
      }
    }
  }

  template <int dim>
  void RigidMotions<dim>::put(const RigidState &rigid, const MovingBody &body,
                              State &state) const
  {
    double *x = state.rigid.data() + 13 * body.rigid_number;
    std::copy_n(rigid.centre.begin(), 3, x);
    std::copy_n(rigid.velocity.begin(), 3, x + 3);
    std::copy_n(rigid.orientation.begin(), 4, x + 6);
    std::copy_n(rigid.spin.begin(), 3, x + 10);
    place(rigid, body, state.displacement);
    const Vec3 spin = rotation(rigid.orientation) * rigid.spin;
    for (const unsigned int c : body.cells) {
      const std::size_t first = discretization_.cells().first_node[c];
      for (std::size_t i = first;
           i < first + discretization_.cells().class_shape(c).n_nodes; ++i) {
        const Vec3 x_now =
            in_space<dim>(Vector(at_node<dim>(layout_.rest(), i)) +
                          Vector(at_node<dim>(state.displacement, i)));
        const Vec3 v = rigid.velocity + cross(spin, x_now - rigid.centre);
        for (unsigned int d = 0; d < dim; ++d)
          state.velocity[i * dim + d] = v[d];
      }
    }
  }

  template <int dim>
  void RigidMotions<dim>::share(State &state) const
  {
    struct Motion {
      std::size_t number;
      std::array<double, 13> values;
    };
    std::vector<Motion> own;
    for (const MovingBody &body : layout_.bodies())
      if (body.is_rigid()) {
        auto &motion = own.emplace_back();
        motion.number = body.rigid_number;
        std::copy_n(state.rigid.data() + 13 * body.rigid_number, 13,
                    motion.values.begin());
      }
    for (const Motion &motion : gather_all(all_, own))
      std::copy(motion.values.begin(), motion.values.end(),
                state.rigid.begin() + long(13 * motion.number));
  }

  /**
   * The turn by the polar factor of the moment sum (x - x_G) (X - X_G)^T of
   * the corners, Newton's iteration for it; the spin by least squares.
   */
  template <int dim>
  RigidState RigidMotions<dim>::nearest(const State &state,
                                        const MovingBody &body) const
  {
    std::vector<Vec3> X, x, v;
    Vec3 mean_X{}, mean_x{}, mean_v{};
    for (const unsigned int c : body.cells) {
      const std::size_t first = discretization_.cells().first_node[c];
      for (std::size_t i = first;
           i < first + discretization_.cells().class_shape(c).n_nodes; ++i) {
        X.push_back(in_space<dim>(Vector(at_node<dim>(layout_.rest(), i))));
        x.push_back(X.back() +
                    in_space<dim>(Vector(at_node<dim>(state.displacement, i))));
        v.push_back(in_space<dim>(Vector(at_node<dim>(state.velocity, i))));
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
    rigid.centre = mean_x + R * (body.centre - mean_X);
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
    return rigid;
  }

  template <int dim>
  void RigidMotions<dim>::set_nearest(State &state) const
  {
    state.rigid.assign(13 * discretization_.body_table().n_rigid, 0.);
    for (const MovingBody &body : layout_.bodies())
      if (body.is_rigid())
        put(nearest(state, body), body, state);
    share(state);
  }

  template <int dim>
  unsigned int RigidMotions<dim>::body_of_pin(const unsigned int k) const
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
  auto RigidMotions<dim>::pinned(const unsigned int k, const State &state) const
      -> Pinned
  {
    const MovingBody &body =
        layout_[std::size_t(layout_.own_body(body_of_pin(k)))];
    Vec3 at{};
    for (unsigned int d = 0; d < dim; ++d)
      at[d] = input_.pins[k].at[d];
    return {of(state, body), at, at - body.centre};
  }

  template <int dim>
  std::array<double, dim> RigidMotions<dim>::pin_drift(const unsigned int k,
                                                       const State &state) const
  {
    const auto [rigid, at, arm] = pinned(k, state);
    const Vec3 off = rigid.centre + rotation(rigid.orientation) * arm - at;
    std::array<double, dim> result;
    std::copy_n(off.begin(), dim, result.begin());
    return result;
  }

  template <int dim>
  std::array<double, dim>
  RigidMotions<dim>::pin_velocity(const unsigned int k,
                                  const State &state) const
  {
    const Pinned pin = pinned(k, state);
    const RigidState &rigid = pin.rigid;
    const Vec3 v = rigid.velocity +
                   rotation(rigid.orientation) * cross(rigid.spin, pin.arm);
    std::array<double, dim> result;
    std::copy_n(v.begin(), dim, result.begin());
    return result;
  }

  template class RigidMotions<2>;
  template class RigidMotions<3>;
} // namespace nsfd
