#pragma once

#include "../unit/make_law.h"

#include "cohesive_laws/law_contract.h"
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
  using law_contract::end_of_softening;
  using law_contract::kink_between;
  using law_contract::kinks;
  using law_contract::samples;
  using nsfd::test::entries_of;
  using nsfd::test::make_law;

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
