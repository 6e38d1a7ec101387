#include "nsfd/bodies/rigid_step.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  using namespace space;

  namespace
  {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();

    /** (1 - hat(p))^{-1} z. */
    Vec3 inverse_half_turn(const Vec3 &p, const Vec3 &z)
    {
      return (1. / (1. + dot(p, p))) * (z + cross(p, z) + dot(p, z) * p);
    }

    bool positive_definite(const Mat3 &A)
    {
      const double minor = A[0][0] * A[1][1] - A[0][1] * A[1][0];
      return A[0][0] > 0. && minor > 0. && dot(A[0], cross(A[1], A[2])) > 0.;
    }
  } // namespace

  RigidInertia plane_inertia(const double mass, const double about_z)
  {
    RigidInertia body;
    body.mass = mass;
    for (unsigned int c = 0; c < 3; ++c)
      body.inertia[c][c] = about_z;
    return body;
  }

  RigidState rigid_state(const double *x)
  {
    RigidState result;
    std::copy_n(x, 3, result.centre.begin());
    std::copy_n(x + 3, 3, result.velocity.begin());
    std::copy_n(x + 6, 4, result.orientation.begin());
    std::copy_n(x + 10, 3, result.spin.begin());
    return result;
  }

  double kinetic_energy(const RigidInertia &body, const RigidState &state)
  {
    return dot(state.spin, body.inertia * state.spin) / 2. +
           body.mass * dot(state.velocity, state.velocity) / 2.;
  }

  Vec3 angular_momentum(const RigidInertia &body, const RigidState &state)
  {
    return rotation(state.orientation) * (body.inertia * state.spin);
  }

  RigidStep::RigidStep(const RigidInertia &body, const RigidState &start,
                       const double time_step, const double theta)
      : body_(body), start_(start), end_(start), time_step_(time_step),
        theta_(theta), lambda_start_(rotation(start.orientation))
  {
    end_.centre = start_.centre + time_step_ * start_.velocity;
    turn(start_.spin);
  }

  // The iteration is in the frame of the body, where its unknown is the new W:
  // no inertia has to be turned. With p = h W_theta / 2 the equation, times
  // 1 - hat(p), is quadratic in W,
  //
  //   J W - b + p x (J W + b) = 0,   b = J W_k + Lambda_k^T (h tau + m).

  struct RigidStep::Residual {
    double size, scale; ///< of the residual and of what it is summed from
    Vec3 value;
  };

  RigidStep::Residual RigidStep::residual(const Vec3 &target,
                                          const Vec3 &W) const
  {
    const Vec3 p = half_turn(W), momentum = body_.inertia * W;
    Residual r;
    r.value = momentum - target + cross(p, momentum + target);
    r.size = norm(r.value);
    r.scale = norm(momentum) + norm(target) + norm(p) * norm(momentum + target);
    return r;
  }

  Mat3 RigidStep::derivative(const Vec3 &target, const Vec3 &W) const
  {
    const Vec3 p = half_turn(W), momentum = body_.inertia * W;
    return body_.inertia + hat(p) * body_.inertia +
           (-theta_ * time_step_ / 2.) * hat(momentum + target);
  }

  bool RigidStep::newton(const Vec3 &target, Vec3 &W) const
  {
    constexpr unsigned int most_steps = 60, most_bisections = 30;
    Residual r = residual(target, W);
    for (unsigned int step = 0; step < most_steps; ++step) {
      if (!std::isfinite(r.scale))
        return false;
      if (r.size == 0.)
        return true;
      const Vec3 full = space::solve(derivative(target, W), r.value);
      Residual next = r;
      Vec3 trial = W;
      double share = 1.;
      for (unsigned int i = 0; i < most_bisections; ++i, share /= 2.) {
        trial = W - share * full;
        next = residual(target, trial);
        // at round-off shorter steps do not help either
        if (next.size < r.size || r.size <= 16. * epsilon * r.scale)
          break;
      }
      if (!(next.size < r.size))
        return r.size <= 16. * epsilon * r.scale;
      W = trial;
      r = next;
    }
    return false;
  }

  void RigidStep::stay()
  {
    start_.velocity = start_.spin = {};
    end_ = start_;
    lambda_end_ = lambda_start_;
  }

  Vec3 RigidStep::half_turn(const Vec3 &W) const
  {
    return (time_step_ / 2.) * (theta_ * W + (1. - theta_) * start_.spin);
  }

  void RigidStep::turn(const Vec3 &W)
  {
    const Vec3 p = half_turn(W);
    end_.spin = W;
    // (1, p) has the length sqrt(1 + |p|^2); to divide by that of the product
    // keeps the errors of 10^6 steps from growing, too
    end_.orientation =
        normalized(product(start_.orientation, {1., p[0], p[1], p[2]}));
    lambda_end_ = rotation(end_.orientation);
  }

  Vec3 RigidStep::target(const RigidLoad &load) const
  {
    return body_.inertia * start_.spin +
           transposed(lambda_start_) *
               (time_step_ * load.moment + load.angular_impulse);
  }

  bool RigidStep::solve(const RigidLoad &load)
  {
    const Vec3 b = target(load);
    return solve_from(load, b, space::solve(body_.inertia, b));
  }

  bool RigidStep::solve(const RigidLoad &load, const Vec3 &spin)
  {
    return solve_from(load, target(load), transposed(lambda_start_) * spin);
  }

  bool RigidStep::solve_from(const RigidLoad &load, const Vec3 &target, Vec3 W)
  {
    const Vec3 V = start_.velocity +
                   (1. / body_.mass) * (time_step_ * load.force + load.impulse);
    if (!std::isfinite(norm(V)) || !newton(target, W))
      return false;
    end_.velocity = V;
    end_.centre = start_.centre + time_step_ * theta_velocity().centre;
    turn(W);
    return true;
  }

  RigidVelocity RigidStep::velocity() const
  {
    return {end_.velocity, lambda_start_ * end_.spin};
  }

  RigidVelocity RigidStep::theta_velocity() const
  {
    return {theta_ * end_.velocity + (1. - theta_) * start_.velocity,
            lambda_start_ * (theta_ * end_.spin + (1. - theta_) * start_.spin)};
  }

  Vec3 RigidStep::a_k() const { return lambda_start_ * start_.spin; }

  Vec3 RigidStep::mid_arm(const Vec3 &r0) const
  {
    return 0.5 * (lambda_start_ * r0 + lambda_end_ * r0);
  }

  double RigidStep::dissipated() const
  {
    const Vec3 dW = end_.spin - start_.spin,
               dV = end_.velocity - start_.velocity;
    return (theta_ - 0.5) *
           (dot(dW, body_.inertia * dW) + body_.mass * dot(dV, dV));
  }

  std::array<double, 36> RigidStep::iteration_matrix() const
  {
    // at a solution C J W is the target of the quadratic equation, and the
    // derivative d(C J W)/dW is (1 - hat(p))^{-1} times that one's
    const Vec3 p = half_turn(end_.spin);
    const Vec3 b = transposed(lambda_start_) * angular_momentum(body_, end_);
    Mat3 columns = transposed(derivative(b, end_.spin));
    for (Vec3 &column : columns)
      column = inverse_half_turn(p, column);
    const Mat3 mean = 0.5 * (columns + transposed(columns));
    const Mat3 in_body = positive_definite(mean) ? mean : body_.inertia;
    const Mat3 rotational = lambda_start_ * in_body * transposed(lambda_start_);

    std::array<double, 36> matrix{};
    for (unsigned int r = 0; r < 3; ++r) {
      matrix[r * 7] = body_.mass;
      for (unsigned int c = 0; c < 3; ++c)
        matrix[(r + 3) * 6 + c + 3] =
            0.5 * (rotational[r][c] + rotational[c][r]);
    }
    return matrix;
  }
} // namespace nsfd
