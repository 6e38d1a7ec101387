#pragma once

#include "delassus/bulk_traction.h"
#include "delassus/joined_delassus.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"
#include "state/state.h"

#include <utility>
#include <vector>

namespace nsfd
{
  /** What a step has done to the bonds. */
  struct BondReport {
    unsigned int released = 0; ///< points that leave the bond
    double overshoot = 0.;     ///< largest mean traction over strength, less 1
    double share = 1.; ///< of the step in which the first one reached it
  };

  /** Points of @p state that are bonded, for JoinedDelassus::set_bonds(). */
  std::vector<std::uint8_t> bonded_points(const State &state);

  /**
   * Points of @p state that are bonded where bodies cannot share the nodes of
   * the face have rows from now on, JoinedDelassus::sharing(). Collective.
   */
  template <int dim>
  void hold_by_rows(const OneStepProblem<dim> &problem,
                    JoinedDelassus<dim> &joined, State &state);

  /**
   * {sigma n} at the bonded points of @p state, with the viscous stress, zero
   * where nothing is bonded. Collective.
   */
  template <int dim>
  void set_bond_tractions(const BulkTraction<dim> &bulk, State &state,
                          typename BulkTraction<dim>::Where where =
                              BulkTraction<dim>::Where::everywhere);

  /** Those with a law: for BulkTraction::mark(). */
  template <int dim>
  std::vector<char> breakable_faces(const OneStepProblem<dim> &problem,
                                    const InterfacePoints<dim> &points);

  /** How far a bonded point is on its way to its strength; 1: there. */
  struct BondWay {
    double before = 0., now = 0.; ///< at the start and at the end of a step
  };

  /**
   * Bonded points of @p next that carry @p share of their strength or more and
   * can part, as release_bonds() has it, in ascending order. Collective.
   */
  template <int dim>
  std::vector<std::pair<std::size_t, BondWay>>
  points_at_share(const OneStepProblem<dim> &problem,
                  JoinedDelassus<dim> &bonded, bool mean, double share,
                  const State &old, const State &next);

  /** Of the strength that every bonded point carries, by the same rule. */
  template <int dim>
  std::vector<double> bond_shares(const OneStepProblem<dim> &problem,
                                  const JoinedDelassus<dim> &bonded, bool mean,
                                  const State &state);

  /** At which a released point enters its law: a thousand millionth of the
      toughness is taken then. */
  template <int dim>
  double opening_at_release(const OneStepProblem<dim> &problem,
                            std::size_t point);

  /**
   * After a step: faces whose mean bulk traction has reached the strength of
   * their law are left to it, as a whole: where the traction of a point reaches
   * the strength, or with @p mean the mean of the face (linear cells have
   * parasitic shear); and not before its sides can part, with those of other
   * faces that have reached theirs. The impulse of the next step starts from
   * the traction, so that it is continuous; what the laws store with that is
   * numerical. Collective.
   */
  template <int dim>
  BondReport release_bonds(const OneStepProblem<dim> &problem,
                           const BulkTraction<dim> &bulk,
                           JoinedDelassus<dim> &bonded, bool mean,
                           const State &old, State &next);
} // namespace nsfd
