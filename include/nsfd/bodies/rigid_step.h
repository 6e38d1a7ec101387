#pragma once

#include "nsfd/core/space.h"

namespace nsfd
{
  /** In the plane: per length across, kg/m and kg m. */
  struct RigidInertia {
    double mass = 0.; ///< kg
    Mat3 inertia{};   ///< J about the centre of mass, body frame, kg m^2
  };

  /**
   * Of a body that turns about z only. What it has about x and y never enters,
   * but must be positive.
   */
  RigidInertia plane_inertia(double mass, double about_z);

  struct RigidState {
    Vec3 centre{}, velocity{};                ///< of mass, m and m/s
    Quaternion orientation{{1., 0., 0., 0.}}; ///< Lambda: body to space, unit
    Vec3 spin{}; ///< W, the angular velocity in the body frame, rad/s
  };

  /** From the 13 numbers of a state, in the order of the members above. */
  RigidState rigid_state(const double *numbers);

  /** W.J W / 2 + m |V|^2 / 2. */
  double kinetic_energy(const RigidInertia &body, const RigidState &state);

  /** Lambda J W: in space, about the centre of mass. */
  Vec3 angular_momentum(const RigidInertia &body, const RigidState &state);

  /** What acts in a step; arms of angular ones are those of mid_arm(). */
  struct RigidLoad {
    Vec3 force{}, moment{};            ///< N, N m: means over the step
    Vec3 impulse{}, angular_impulse{}; ///< N s, N m s
  };

  /** The generalized velocity of a step, in space. */
  struct RigidVelocity {
    Vec3 centre{}; ///< V
    Vec3 spin{};   ///< a = Lambda_k W, Lambda_k of the start of the step
  };

  /**
   * One step of a rigid body (Simo and Wong 1991, with the Cayley map). With
   * a_k = Lambda_k W_k, a_theta = theta a + (1 - theta) a_k and
   *
   *   C = cay(h a_theta) = (1 - A/2)^{-1} (1 + A/2),  A = hat(h a_theta),
   *
   * Lambda_{k+1} = C Lambda_k and, with I = Lambda_k J Lambda_k^T,
   *
   *   m (V - V_k) = h f + p,    C I a - I a_k = h tau + m.
   *
   * The second one is the change of Lambda J W, the spatial angular momentum,
   * so this is exact whatever theta. From (1 - A/2) C = 1 + A/2 follows
   * C - 1 = A (C + 1) / 2, hence of a point at r0 in the body
   *
   *   x_{k+1} - x_k = h (V_theta + a_theta x r_mid),  r_mid = mid_arm(r0).
   *
   * As C^T a_theta = a_theta, the work a_theta.(h tau + m) is that of
   * I (a - a_k): the change of W.J W / 2 and (theta - 1/2) dW.J dW, exactly.
   */
  class RigidStep
  {
  public:
    /** Until solve(), the result is that of an unchanged velocity. */
    RigidStep(const RigidInertia &body, const RigidState &start,
              double time_step, double theta);

    /**
     * To round-off; false if the iteration does not get there, with the result
     * left as it was. Begins where W is as if the axes of the body stood still.
     */
    bool solve(const RigidLoad &load);

    /** Begins at a = @p spin, say that of the last solution. */
    bool solve(const RigidLoad &load, const Vec3 &spin);

    /** As if it had been without a velocity, and went on so. */
    void stay();

    const RigidState &state() const { return end_; }

    /** (V, a) and, theta-weighted, what moves points in the step. */
    RigidVelocity velocity() const;
    RigidVelocity theta_velocity() const;

    Vec3 a_k() const;

    /** (Lambda_k + Lambda_{k+1}) r0 / 2: H v = V + a x r_mid. */
    Vec3 mid_arm(const Vec3 &r0) const;

    /** What theta > 1/2 takes of the kinetic energy, J. */
    double dissipated() const;

    /**
     * d(p, m)/d(V, a): 6 x 6, row-major, symmetric positive definite. The
     * symmetric part of the derivative at the solution, or its limit for
     * h -> 0 where that is not definite.
     */
    std::array<double, 36> iteration_matrix() const;

  private:
    struct Residual;

    /** Of the body frame, for the angular momentum @p target at the end. */
    Residual residual(const Vec3 &target, const Vec3 &W) const;
    Mat3 derivative(const Vec3 &target, const Vec3 &W) const;
    bool newton(const Vec3 &target, Vec3 &W) const;
    bool solve_from(const RigidLoad &load, const Vec3 &target, Vec3 W);
    Vec3 target(const RigidLoad &load) const;

    /** h W_theta / 2. */
    Vec3 half_turn(const Vec3 &W) const;
    void turn(const Vec3 &W);

    RigidInertia body_;
    RigidState start_, end_;
    double time_step_, theta_;
    Mat3 lambda_start_, lambda_end_;
  };
} // namespace nsfd
