#pragma once

#include "../unit/make_law.h"

#include "nonsmooth/point_law.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/scene/time_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <unistd.h>
#include <vector>

// What every registered cohesive law must satisfy, whatever its shape.

namespace every_law
{
  using namespace nsfd;
  using nsfd::test::entries_of;
  using nsfd::test::make_law;

  /** Kinks of the envelope, in order. */
  inline std::vector<double> kinks(const CohesiveLaw &law)
  {
    std::vector<double> result{0., law.elastic_limit(), law.peak_opening()};
    if (std::isfinite(law.final_opening()))
      result.push_back(law.final_opening());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /** An opening by which most of the energy is spent. */
  inline double end_of_softening(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening())
               ? law.final_opening()
               : law.peak_opening() + 30. * law.toughness() / law.strength();
  }

  /** Openings in order: a fine grid, points next to the kinks, far away. */
  inline std::vector<double> samples(const CohesiveLaw &law)
  {
    const double end = end_of_softening(law);
    std::vector<double> result;
    for (unsigned int i = 0; i <= 4000; ++i)
      result.push_back(1.5 * end * i / 4000.);
    for (const double kink : kinks(law))
      for (const double offset : {-1e-4, -1e-9, 0., 1e-9, 1e-4})
        result.push_back(std::max(0., kink + offset * end));
    for (const double factor : {1e1, 1e2, 1e4, 1e6, 1e9})
      result.push_back(factor * end);
    std::sort(result.begin(), result.end());
    return result;
  }

  inline bool kink_between(const CohesiveLaw &law, double lower, double upper)
  {
    for (const double kink : kinks(law))
      if (lower < kink && kink < upper)
        return true;
    return false;
  }

  /** Work of the traction on the straight way from (u_N, u_T) to (v_N, v_T). */

  /** Every registered law, with each of the examples it registers. */
  inline void
  expect_for_all_laws(const std::function<void(const CohesiveLaw &)> &check)
  {
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        check(*make_law(name, entries_of(example)));
      }
  }
} // namespace every_law
