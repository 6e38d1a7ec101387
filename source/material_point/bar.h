#pragma once

#include "nonsmooth/point_law.h"

#include <optional>
#include <vector>

namespace nsfd
{
  enum class BarMode {
    quasi_static, ///< (39)-(42): in equilibrium, where there is one
    viscous,      ///< the point resists its opening, nothing has a mass
    dynamic       ///< (47)-(48): one mass between bar and point
  };

  /**
   * The uniaxial example of section 3.1 of [AM06]: an elastic bar pulls a
   * point open. Its grip moves by U, the point opens by u, and the bar carries
   *
   *     k (U - u),        k = E / L.
   */
  struct Bar {
    BarMode mode = BarMode::quasi_static;
    double stiffness = 0.; ///< k in Pa/m
    /// where the grip ends, m; if not given, beyond failure
    std::optional<double> end;
    /// shares of the final opening that one step may open the point by
    unsigned int n_steps = 400;

    double speed = 0.;     ///< of the grip, m/s; viscous: 0 for a held one
    double viscosity = 0.; ///< eta in Pa s/m
    double mass = 0.;      ///< M/S in kg/m^2
    double theta = 0.5;
    double step = 0.; ///< h in s, dynamic
    CohesionRule rule{};

    std::vector<double> speeds; ///< viscous: grips to be compared, m/s
    std::vector<double> steps;  ///< dynamic: steps to be compared, s
  };

  /** The equilibrium leaves u_a for u_b while the grip is at U_a. */
  struct BarJump {
    double grip = 0.;                            ///< U_a in m
    double opening_from = 0., opening_to = 0.;   ///< u_a, u_b in m
    double traction_from = 0., traction_to = 0.; ///< in Pa
    /// elastic energy of the bar released minus the work of cohesion, J/m^2
    double excess = 0.;
  };

  /** max |T'| over k: at most 1 where every U has one equilibrium (42). */
  double slope_ratio(const CohesiveLaw &law, double stiffness);

  /** All jumps of a grip that moves on for ever, in their order. */
  std::vector<BarJump> bar_jumps(const CohesiveLaw &law, double stiffness);

  /**
   * Below this step, in s, a step of the mass has one solution,
   *
   *     M / (S theta h^2) + theta k > chi max |T'|,
   *
   * chi = 1/2 for the exact rule and 1 for the others: (48), its sign
   * corrected. Infinite where the bar alone is stiff enough, 0 where the
   * traction jumps.
   */
  double unique_step(const CohesiveLaw &law, const Bar &bar);

  /** Slope M / (S theta h^2) + theta k that a step of the mass compares. */
  double dynamic_slope(const Bar &bar, double step);

  /**
   * State at the end of a step. Energies in J/m^2, dissipated ones and the
   * work of the grip summed since the start.
   */
  struct BarRow {
    double time = 0., grip = 0., opening = 0., velocity = 0.;
    double pull = 0.;     ///< k (U - u) in Pa
    double cohesion = 0.; ///< traction of the law at the end of the step, Pa
    double beta = 1.;
    double elastic = 0., kinetic = 0., stored = 0.; ///< bar, mass, point
    double damage = 0., viscous = 0., work = 0.;
    double excess = 0.; ///< static: left over at jumps

    /** What rule and theta dissipate; 0 for `exact` and theta = 1/2. */
    double numerical() const
    {
      return work - elastic - kinetic - stored - damage - viscous - excess;
    }
  };

  struct BarRun {
    std::vector<BarRow> rows;
    unsigned int n_steps = 0;
    /// dynamic: steps that several openings solve
    unsigned int n_ambiguous = 0;

    /** Summed up to the opening @p opening, straight between two rows. */
    double viscous_at(double opening) const;
  };

  /** The bar of this mode on the point; @p bar.end may be missing. */
  BarRun pull_bar(const Interaction &interaction, const Bar &bar);

  /** Where the grip of pull_bar() ends without an end of its own, m. */
  double default_end(const CohesiveLaw &law, double stiffness);

  /**
   * One point and the mass M/S behind it, which the bar pulls: a step of the
   * Moreau-Jean scheme of one unknown, of unit area. The local solve of the
   * point law with W = 1 / (M/S + h^2 theta^2 k) is the whole step.
   */
  class BarStep
  {
  public:
    BarStep(const Interaction &interaction, const Bar &bar);

    /**
     * Opened to @p opening, with this speed; intrinsic points not below their
     * elastic limit are damaged by it, extrinsic ones are activated.
     */
    void set_state(double opening, double velocity);

    double opening() const { return problem_.jump_old[0]; }
    double velocity() const { return velocity_; }
    double largest_opening() const { return problem_.opening_max[0]; }

    /**
     * A step of length @p h in which the grip goes to @p grip. Where several
     * openings solve it, the one next to @p start.
     */
    LocalSolution<2> solve(double h, double grip_old, double grip,
                           double start);

    /** Opening at the end of the last step that was solved, m. */
    double end_opening(const LocalSolution<2> &solution) const;

    /**
     * How many openings solve the last step: sign changes of its equation
     * between 0 and the opening of a broken point. Viscosity, which only
     * makes them fewer, is left out.
     */
    unsigned int count_solutions() const;

    /** Accept a step. @p row is the one before and becomes the one after. */
    void accept(const LocalSolution<2> &solution, double grip, BarRow &row);

  private:
    const Bar bar_;
    OneStepProblem<2> problem_;
    double velocity_ = 0.;
    double h_ = 0., grip_theta_ = 0.;

    double traction(double opening) const;
  };
} // namespace nsfd
