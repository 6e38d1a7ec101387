#pragma once

#include "one_step_problem.h"

#include "nsfd/cohesive_laws/law_point.h"

#include <cmath>

namespace nsfd
{
  /** Where a point ended in its local problem. */
  enum class PointStatus : std::uint8_t {
    open, ///< no contact impulse
    prescribed,
    stick,
    slide
  };

  /** The secant state of a point: fixes its law to a monotone one. */
  struct FrozenPoint {
    Secant secant;
    double threshold = 0.; ///< s, friction impulse bound
    double lift = 0.;  ///< of the contact by sliding, m/s: U_N >= target + lift
    bool held = false; ///< the law is this secant wherever the step ends

    bool is_rigid() const { return std::isinf(secant.normal); }
  };

  template <int dim>
  struct LocalSolution {
    std::array<double, dim> impulse{}, velocity{};
    FrozenPoint frozen;
    Reach reach;                 ///< at the end of the step
    double contact_impulse = 0.; ///< P_c,N
    bool damages = false;        ///< a largest reach grows
    bool coupled = false;        ///< the frozen part follows the local velocity
    PointStatus status = PointStatus::open;
  };

  /**
   * The law of one point against a scaled identity: given U_loc, find (P, U)
   *
   *     U = U_loc + R P,   R = diag(R_N, R_T, R_T),   (P, U) on the law.
   *
   * Contact, friction and cohesion of the named rule, damage at the end of the
   * step included (the root next to @p opening_start where softening leaves
   * several). With R the majorant of the problem this is at once the local
   * solve of Gauss-Seidel and the map whose fixed point is the solution.
   */
  template <int dim>
  LocalSolution<dim>
  solve_point(const OneStepProblem<dim> &problem, std::size_t point,
              const std::array<double, dim> &local_velocity,
              double majorant_normal, double majorant_tangential,
              const Reach &start);

  /**
   * A two-sided spring, for the steps that do not damage it: against R = (R_N,
   * R_T, R_T), P = -kappa (y_0 + s U_loc) in each direction. What most points
   * of an intact body are, at a fraction of the cost of solve_point(); and
   * open points without any law, kappa = 0.
   */
  template <int dim>
  struct LinearPoint {
    std::array<double, dim> offset{};                      ///< y_0, m
    double slope = 0.;                                     ///< s
    double normal = 0., tangential = 0.;                   ///< kappa
    double normal_majorant = 0., tangential_majorant = 0.; ///< R
    Secant secant;
    double largest = 0.;    ///< d_m^2
    bool is_linear = false; ///< or nothing else is known here

    bool exists() const { return is_linear; }

    /** False, and nothing done, if the step would damage the point. */
    bool solve(const OneStepProblem<dim> &problem, const std::size_t point,
               const std::array<double, dim> &local,
               LocalSolution<dim> &solution) const
    {
      const double h_theta = problem.time_step * problem.theta;
      std::array<double, dim> P, U;
      double square = 0., slip = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        P[c] = -(c == 0 ? normal : tangential) * (offset[c] + slope * local[c]);
        U[c] =
            local[c] + (c == 0 ? normal_majorant : tangential_majorant) * P[c];
        const double u = problem.jump_free[point * dim + c] + h_theta * U[c];
        if (c > 0)
          slip += u * u;
        else if (u > 0.)
          square = u * u;
      }
      square +=
          problem.interactions[problem.interaction[point]].shear_weight * slip;
      if (!(square <= largest))
        return false;
      solution.impulse = P;
      solution.velocity = U;
      solution.frozen = {secant};
      solution.contact_impulse = 0.;
      solution.damages = solution.coupled = false;
      solution.status = PointStatus::open;
      return true; // the reach stays: below its history it has no say
    }
  };

  template <int dim>
  LinearPoint<dim> linear_point(const OneStepProblem<dim> &problem,
                                std::size_t point, double majorant_normal,
                                double majorant_tangential);

  /** The same with damage and friction threshold frozen: a convex problem. */
  template <int dim>
  LocalSolution<dim>
  solve_frozen_point(const OneStepProblem<dim> &problem, std::size_t point,
                     const FrozenPoint &frozen,
                     const std::array<double, dim> &local_velocity,
                     double majorant_normal, double majorant_tangential);

  /** A secant state makes the law of the point convex. */
  template <int dim>
  bool has_frozen_law(const OneStepProblem<dim> &problem, std::size_t point);

  /**
   * -dP/dU_loc of solve_frozen_point() in the frame of the point: normal and
   * tangential (in three dimensions: along and across the sliding direction).
   */
  template <int dim>
  std::array<double, dim>
  frozen_slopes(const OneStepProblem<dim> &problem, std::size_t point,
                const FrozenPoint &frozen, const LocalSolution<dim> &solution,
                double majorant_normal, double majorant_tangential);

  /**
   * U of the frozen law at the impulse @p impulse inside its domain: the
   * gradient of the conjugate potential, monotone in P.
   */
  template <int dim>
  std::array<double, dim>
  frozen_velocity(const OneStepProblem<dim> &problem, std::size_t point,
                  const FrozenPoint &frozen,
                  const std::array<double, dim> &impulse);

  /**
   * The secant state of a cohesive, free or elastic point that is open to
   * @p end at the end of the step, under the contact impulse
   * @p contact_impulse: what a fixed point on damage and friction updates.
   */
  template <int dim>
  FrozenPoint frozen_state(const OneStepProblem<dim> &problem,
                           std::size_t point, const Reach &end,
                           double contact_impulse);

  /**
   * The traction in Pa at which a rigid point is activated: R_max, or what the
   * largest opening has left of it (plateau).
   */
  template <int dim>
  double point_strength(const OneStepProblem<dim> &problem, std::size_t point);

  /**
   * A traction or impulse as point_strength() is compared with it, of a point
   * with a law: LawPoint::effective_traction().
   */
  template <int dim>
  double effective_traction(const OneStepProblem<dim> &problem,
                            std::size_t point, double normal,
                            const double *shear);

  /** Cohesive traction densities and energies of a point over a step. */
  template <int dim>
  struct PointEnergies {
    std::array<double, dim> cohesive_traction{}; ///< R_coh, with viscosity, Pa
    double viscous_traction = 0.;                ///< its viscous part
    Reach history;                ///< largest reach after the step
    double beta = 1.;             ///< after the step
    double stored = 0.;           ///< after the step, J/m^2, overlap included
    double stored_old = 0.;       ///< before
    double damage = 0.;           ///< dissipated in the step, J/m^2
    double viscous = 0.;          ///< dissipated by viscosity, J/m^2
    double overlap_released = 0.; ///< spring energy dropped at first damage
  };

  template <int dim>
  PointEnergies<dim> point_energies(const OneStepProblem<dim> &problem,
                                    std::size_t point,
                                    const std::array<double, dim> &velocity,
                                    const FrozenPoint &frozen);

  /** Stored at the start of the step, overlap included, in J/m^2. */
  template <int dim>
  double stored_energy(const OneStepProblem<dim> &problem, std::size_t point);

  /** |U_T| as friction counts it, in m/s. */
  template <int dim>
  double sliding_speed(const OneStepProblem<dim> &problem, std::size_t point,
                       const std::array<double, dim> &velocity);

  /** Effective opening sqrt(<u_N>_+^2 + r^2 |u_T|^2), or the sum of both. */
  template <int dim>
  double effective_opening(const Interaction &interaction, const double *jump);

  /** The same, or opening and slip apart, as the law asks for. */
  template <int dim>
  Reach reach_of(const Interaction &interaction, const double *jump);

  /** At the largest traction or beyond it; with two scalars, in one norm. */
  bool past_peak(const CohesiveLaw &law, double opening_factor,
                 const Reach &history);

  /** beta of a point from its largest reach. */
  double beta_of(const Interaction &interaction, PointKind kind,
                 double opening_factor, const Reach &history);
} // namespace nsfd
