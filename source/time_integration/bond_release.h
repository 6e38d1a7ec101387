#pragma once

#include "delassus/bonded.h"
#include "discretization/discretization.h"
#include "state/state.h"

namespace nsfd
{
  /** What a step has done to the bonds. */
  struct BondReport {
    unsigned int released = 0; ///< points that leave the bond
    double overshoot = 0.;     ///< largest mean traction over strength, less 1
    double share = 1.; ///< of the step in which the first one reached it
  };

  /** Points of @p state that are bonded, for BondedDelassus::set_bonds(). */
  std::vector<std::uint8_t> bonded_points(const State &state);

  /**
   * {sigma n} at the bonded points of @p state, with the viscous stress, zero
   * elsewhere. Collective.
   */
  template <int dim>
  void set_bond_tractions(const BulkTraction<dim> &bulk, State &state);

  /**
   * After a step: bonded points whose mean bulk traction has reached the
   * strength of their law are left to it. What the bond had stored, w (t.u +
   * eta u^2 / 2), goes from the elastic energy to the numerical line; the
   * impulse of the next step starts from the traction, so that it is
   * continuous. A face whose bodies share its nodes lets go as a whole: where
   * the traction of a point reaches the strength, or with @p mean the mean of
   * the face (linear cells have parasitic shear); and not before its sides can
   * part, with those of other faces that have reached theirs. Collective.
   */
  template <int dim>
  BondReport release_bonds(const OneStepProblem<dim> &problem,
                           const BulkTraction<dim> &bulk,
                           BondedDelassus<dim> &bonded, bool mean,
                           const State &old, State &next);
} // namespace nsfd
