#pragma once

#include <limits>
#include <optional>
#include <string>

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

  /** What the other parts of a scene ask about its time integrator. */
  struct SchemeTraits {
    /// a theta scheme in the bodies: the energy balance of a step is exact
    bool theta_scheme = true;
    /// the forces of the bodies are those after half a step with the old
    /// velocity: the step is bounded
    bool explicit_forces = false;
    /// joined cells share nodes with lumped mass, and the points are at nodes;
    /// explicit, too
    bool at_nodes = false;
    /// nothing opens, closes or slips: there is no contact problem
    bool smooth = false;

    bool has_stable_step() const { return explicit_forces || at_nodes; }
  };

  /** Runge-Kutta pairs of smooth motion. */
  struct SmoothInput {
    bool implicit = false; ///< SDIRK, else explicit pairs
    unsigned int order = 5;
    double tolerance = 1e-9; ///< error of a step over the largest motion
  };

  struct TimeInput {
    std::string scheme_name = "moreau-jean"; ///< as the file writes it
    SchemeTraits scheme;
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
    /// after which the run ends, without a point that breaks and after the
    /// first one that has; 0: never
    unsigned int rest_steps = 0;
    /// of a bonded point over its strength
    double largest_overshoot = std::numeric_limits<double>::infinity();
    /// of scheme = explicit: nothing is `auto`
    std::optional<double> front_viscosity;
    SmoothInput smooth; ///< of scheme = arkode

    /** Weight of the change of velocity in the forces of the bodies: those at
        q_k + h theta (v_k + bulk_theta (v - v_k)). */
    double bulk_theta() const { return scheme.explicit_forces ? 0. : theta; }
  };
} // namespace nsfd
