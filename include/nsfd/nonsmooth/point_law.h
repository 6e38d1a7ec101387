#pragma once

#include "nsfd/nonsmooth/one_step_problem.h"

namespace nsfd
{
  /** Where a point ended in its local problem. */
  enum class PointStatus : std::uint8_t
  {
    prescribed,
    open,   ///< no contact impulse
    stick,
    slide
  };

  /** The secant state of a point: fixes its law to a monotone one. */
  struct FrozenPoint
  {
    double secant = 0.;     ///< b in Pa/m; infinity: rigid
    double threshold = 0.;  ///< s, friction impulse bound
  };

  template <int dim>
  struct LocalSolution
  {
    std::array<double, dim> impulse{}, velocity{};
    FrozenPoint frozen;
    double opening = 0.; ///< effective opening d' at the end of the step
    double contact_impulse = 0.; ///< P_c,N
    bool damages = false;        ///< d' beyond d_m
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
  LocalSolution<dim> solve_point(const OneStepProblem<dim> &problem,
                                 std::size_t point,
                                 const std::array<double, dim> &local_velocity,
                                 double majorant_normal,
                                 double majorant_tangential,
                                 double opening_start);

  /** The same with damage and friction threshold frozen: a convex problem. */
  template <int dim>
  LocalSolution<dim>
  solve_frozen_point(const OneStepProblem<dim> &problem,
                     std::size_t point,
                     const FrozenPoint &frozen,
                     const std::array<double, dim> &local_velocity,
                     double majorant_normal,
                     double majorant_tangential);

  /**
   * -dP/dU_loc of solve_frozen_point() in the frame of the point: normal and
   * tangential (in three dimensions: along and across the sliding direction).
   */
  template <int dim>
  std::array<double, dim>
  frozen_slopes(const OneStepProblem<dim> &problem,
                std::size_t point,
                const FrozenPoint &frozen,
                const LocalSolution<dim> &solution,
                double majorant_normal,
                double majorant_tangential);

  /**
   * U of the frozen law at the impulse @p impulse inside its domain: the
   * gradient of the conjugate potential, monotone in P.
   */
  template <int dim>
  std::array<double, dim>
  frozen_velocity(const OneStepProblem<dim> &problem,
                  std::size_t point,
                  const FrozenPoint &frozen,
                  const std::array<double, dim> &impulse);

  /**
   * The secant state of a cohesive, free or elastic point whose effective
   * opening is @p opening at the end of the step, under the contact impulse
   * @p contact_impulse: what a fixed point on damage and friction updates.
   */
  template <int dim>
  FrozenPoint frozen_state(const OneStepProblem<dim> &problem,
                           std::size_t point,
                           double opening,
                           double contact_impulse);

  /** Cohesive traction densities and energies of a point over a step. */
  template <int dim>
  struct PointEnergies
  {
    std::array<double, dim> cohesive_traction{}; ///< R_coh, with viscosity, Pa
    double viscous_traction = 0.; ///< its viscous part
    double opening_max = 0., beta = 1.;          ///< after the step
    double stored = 0.;          ///< after the step, J/m^2, overlap included
    double stored_old = 0.;      ///< before
    double damage = 0.;          ///< dissipated in the step, J/m^2
    double viscous = 0.;         ///< dissipated by viscosity, J/m^2
    double overlap_released = 0.; ///< spring energy dropped at first damage
  };

  template <int dim>
  PointEnergies<dim>
  point_energies(const OneStepProblem<dim> &problem,
                 std::size_t point,
                 const std::array<double, dim> &velocity,
                 const FrozenPoint &frozen);

  /** Effective opening sqrt(<u_N>_+^2 + r^2 |u_T|^2). */
  template <int dim>
  double effective_opening(const Interaction &interaction,
                           const double *jump);

  /** beta of a point from its largest opening. */
  double beta_of(const Interaction &interaction, PointKind kind,
                 double opening_factor, double opening_max);
} // namespace nsfd
