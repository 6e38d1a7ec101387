#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"

#include <string>
#include <vector>

/**
 * What cohesive_law.h promises of every law, tried on one: solvers and the
 * energy balance rest on it. Numbers only; a law that passes may still be
 * another one than its author had in mind.
 */
namespace nsfd::law_contract
{
  struct Promise {
    std::string text;    ///< "beta is 1 at first and never grows"
    std::string failure; ///< where it is broken; empty: kept
  };

  /** All promises, in an order in which the first broken one may be the reason
   * for the others. */
  std::vector<Promise> promises(const CohesiveLaw &law);

  /** Openings between which the envelope is smooth, in order. */
  std::vector<double> kinks(const CohesiveLaw &law);
  bool kink_between(const CohesiveLaw &law, double lower, double upper);

  /** An opening by which most of the energy is spent. */
  double end_of_softening(const CohesiveLaw &law);

  /** Openings in order: a fine grid, points next to the kinks, far away. */
  std::vector<double> samples(const CohesiveLaw &law);
} // namespace nsfd::law_contract
