#pragma once

#include <optional>

namespace nsfd
{
  enum class CohesionRule { exact, end_point, end_velocity };
  enum class ContactTarget { energy_safe, velocity, position };
  /** The velocity that friction opposes. */
  enum class Sliding {
    velocity,   ///< of the end of the step
    increment,  ///< the mean of the step
    energy_safe ///< that of the end, the mean where friction would give energy
  };
  enum class StepKind { time, courant, automatic };

  enum class Scheme {
    moreau_jean,
    explicit_moreau_jean, ///< with the forces of the bodies at t_k
    leapfrog, ///< explicit, joined cells share nodes with lumped mass
    arkode    ///< smooth scenes, by SUNDIALS
  };

  struct TimeInput {
    Scheme scheme = Scheme::moreau_jean;
    double end = 0.;
    StepKind step_kind = StepKind::courant;
    /// s, or Courant number h c_p / L; the largest step for `auto`
    double step = 0.5;
    double theta = 0.5;
    double forecast_gamma1 = 0.5, forecast_gamma2 = 0.;
    CohesionRule cohesion_rule = CohesionRule::exact;
    ContactTarget contact_target = ContactTarget::energy_safe;
    Sliding sliding = Sliding::energy_safe;
    unsigned int maximum_bisections = 10;
    double largest_overshoot = 0.05; ///< of the strength of a bonded point
    /// of scheme = arkode: implicit (SDIRK) or explicit Runge-Kutta pairs,
    /// their order and the error per step relative to the largest motion
    /// of scheme = explicit: nothing is `auto`
    std::optional<double> front_viscosity;
    bool implicit_pairs = false;
    unsigned int order = 5;
    double tolerance = 1e-9;

    /** Weight of the new velocity in the forces of the bodies. */
    double bulk_theta() const
    {
      return scheme == Scheme::explicit_moreau_jean ? 0. : theta;
    }

    /**
     * How long the forces of the bodies act in a step of length @p h behind one
     * of @p last (0: none). Explicit velocities are those of the middle of a
     * step, from one middle to the next; otherwise every change of the step
     * would move the energy that the scheme keeps, by as much as there is in
     * the fastest modes.
     */
    double kick(const double h, const double last) const
    {
      return scheme == Scheme::explicit_moreau_jean && last > 0.
                 ? (h + last) / 2.
                 : h;
    }

    /** Weight of the new velocity in the work of impulses and loads. */
    double work_theta() const
    {
      return scheme == Scheme::explicit_moreau_jean ? 0.5 : theta;
    }
  };
} // namespace nsfd
