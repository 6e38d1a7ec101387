#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/state/point_kind.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  enum class CohesionRule;
  enum class Sliding;

  /** What acts between the two sides of a point; shared by a face group. */
  struct Interaction {
    std::shared_ptr<const CohesiveLaw> law; ///< null: no damage
    double normal_stiffness = 0.;  ///< C_N in Pa/m of an elastic joint, else 0
    double stiffness_ratio = 1.;   ///< C_T / C_N
    double shear_weight = 1.;      ///< r^2 of the effective opening
    double friction = 0.;          ///< mu
    double friction_exponent = 1.; ///< kappa = (1-beta)^s; 0: kappa = 1
    double restitution = 0.;       ///< e
    bool plateau = false; ///< extrinsic, T(d_m) also while it closes: form (5)
    double viscous_limit =
        std::numeric_limits<double>::infinity(); ///< of viscous traction, Pa
    double wear = 0.; ///< k of d(gap)/dt = k p_N |U_T|, 1/Pa
  };

  /** What is known of U_free, of bodies that know their own NodeMotion. */
  enum class FreeVelocity : std::uint8_t {
    known,
    estimated, ///< to the digits of a scale
    unknown    ///< a step from rest
  };

  /**
   * The nonsmooth problem of one step as plain data, without bodies: find
   * impulses P (integrated, P = w p) and relative velocities U with
   *
   *     U = U_free + W P,       -P in the law of each point.
   *
   * Vectors have `dim` entries per point in the local frame (n, t1, t2), n
   * from body 1 to body 2. The jump at the end of the step is
   * u' = jump_free + h theta U with jump_free = u_k + h (1-theta) U_k.
   */
  template <int dim>
  struct OneStepProblem {
    std::size_t n_points = 0; ///< points this rank computes with
    std::size_t n_owned = 0;  ///< the first ones, counted once over all ranks
    double time_step = 0., theta = 0.5;
    CohesionRule rule{};
    /// the way of the laws to the end of the step begins at closed faces, not
    /// at u_k: the first step of an explicit scheme, see LeapfrogPoints
    bool from_closed = false;

    std::vector<Interaction> interactions;

    /// those whose impulses do something, ascending: not the points of faces
    /// that are a part of the bodies, nor points that cannot part
    std::vector<unsigned int> acting;

    // per point
    std::vector<PointKind> kind;
    std::vector<std::uint8_t> mask;        ///< bit c: component c prescribed
    std::vector<std::uint8_t> contact;     ///< forecast active
    std::vector<unsigned int> interaction; ///< index into interactions
    std::vector<double> weight;            ///< w
    std::vector<double> strength_factor;   ///< a, see CohesiveLaw; else 1
    std::vector<double> opening_factor;    ///< a / g, see CohesiveLaw; else 1
    std::vector<double> friction_factor;   ///< of mu; empty: 1
    std::vector<double> opening_max;       ///< d_m, largest effective opening,
                                           ///< or the largest <u_N>_+
    std::vector<double> slip_max; ///< largest |u_T| of laws with two damage
                                  ///< scalars; empty if there are none
    std::vector<double>
        compression_stiffness;     ///< two-sided while intact, else 0
    std::vector<double> viscosity; ///< eta of the opening, Pa s/m; empty if
                                   ///< no point has one
    std::vector<double> dilatancy; ///< slope d'(s) of u_N >= d(s), while the
                                   ///< surfaces slide; empty if nothing lifts
    std::vector<double> lift_left; ///< until d(s) saturates, m; likewise
    std::vector<double> target;    ///< U_N >= target where in contact

    // per point and component
    FreeVelocity free_motion = FreeVelocity::known;
    std::vector<double> free_velocity;  ///< U_free
    std::vector<double> given_velocity; ///< prescribed
    std::vector<double> jump_old;       ///< u_k
    std::vector<double> jump_free;      ///< u_k + h (1-theta) U_k
    std::vector<double> sliding_offset; ///< added to U_T where sliding is
                                        ///< measured by the jump increment

    // scaled identity above the diagonal block of W
    std::vector<double> majorant_normal, majorant_tangential;
  };

  /** @p n points with what points have by default. */
  template <int dim>
  void resize(OneStepProblem<dim> &problem, std::size_t n);

  /** mu of a point, whatever its damage. */
  template <int dim>
  double friction_of(const OneStepProblem<dim> &problem, const std::size_t i)
  {
    const double mu = problem.interactions[problem.interaction[i]].friction;
    return problem.friction_factor.empty() ? mu
                                           : problem.friction_factor[i] * mu;
  }

  /** How many of them, the first ones, this rank counts. */
  template <int dim>
  std::size_t owned_acting(const OneStepProblem<dim> &problem)
  {
    return std::size_t(std::lower_bound(problem.acting.begin(),
                                        problem.acting.end(), problem.n_owned) -
                       problem.acting.begin());
  }

  /**
   * Where point @p i of a discretization is among the points of a step: the
   * @p n_of_step points of the step alone are behind the first @p n_owned, see
   * MovingBodies.
   */
  inline std::size_t point_of_step(const std::size_t i,
                                   const std::size_t n_owned,
                                   const std::size_t n_of_step)
  {
    return i < n_owned ? i : i + n_of_step;
  }
} // namespace nsfd
