#pragma once

#include "nonsmooth/one_step_problem.h"
#include "path.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * A point at the end of a step. Tractions in Pa: cohesion pulls the sides
   * together, contact presses them apart, friction opposes the slip, so that
   * what moves the point is (cohesive_normal - contact, cohesive_tangential +
   * friction). Energies in J/m^2, dissipated ones summed since the start.
   */
  struct CurveRow {
    double path = 0., opening = 0., slip = 0., beta = 1.;
    double cohesive_normal = 0., cohesive_tangential = 0.;
    double contact = 0., friction = 0.;
    double stored = 0., damage = 0., friction_work = 0.;
    double work = 0.; ///< of the tractions, as the cohesion rule counts it

    double normal() const { return cohesive_normal - contact; }
    double tangential() const { return cohesive_tangential + friction; }

    /** What the rule dissipates by itself; 0 for `exact`. */
    double numerical() const { return work - stored - damage - friction_work; }
  };

  /** What acts at a point of this law; no restitution. */
  Interaction interaction_of(std::shared_ptr<const CohesiveLaw> law,
                             double friction = 0.,
                             double friction_exponent = 1.);

  /**
   * Drive a point of unit area along a path, one step of the point law
   * (solve_point) from each place to the next. Quasi-static: theta = 1, and
   * the time step does not matter. Where the traction turns without motion (a
   * rigid joint about to open, slip about to reverse), the place has two rows.
   */
  std::vector<CurveRow> drive_point(const Interaction &interaction,
                                    const std::vector<PathPoint> &points,
                                    CohesionRule rule);

  /**
   * The points, and where they first reach a kink of the law; both sides of a
   * drop of its traction.
   */
  std::vector<PathPoint> with_kinks(const std::vector<PathPoint> &points,
                                    const CohesiveLaw &law);

  /** final_opening(), or where 99 % of G are gone in an endless tail. */
  double opening_scale(const CohesiveLaw &law);

  /** The slip that damages as much. */
  double slip_scale(const CohesiveLaw &law);
} // namespace nsfd
