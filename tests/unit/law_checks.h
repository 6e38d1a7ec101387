#pragma once

#include "make_law.h"

#include "nsfd/cohesive_laws/cohesive_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace nsfd
{
  namespace test
  {
    inline void expect_relative(const double value, const double reference,
                                const double tolerance = 1e-12)
    {
      EXPECT_NEAR(value, reference, tolerance * std::abs(reference));
    }

    /** Composite Gauss rule with 2 points: the ends, where T may jump, are not
     * used. */
    inline double integral(const std::function<double(double)> &f,
                           const double lower, const double upper,
                           const unsigned int n = 20000)
    {
      const double h = (upper - lower) / n, x = 0.5 / std::sqrt(3.);
      double sum = 0.;
      for (unsigned int i = 0; i < n; ++i) {
        const double middle = lower + (i + 0.5) * h;
        sum += f(middle - x * h) + f(middle + x * h);
      }
      return 0.5 * h * sum;
    }

    /** G as the area under the envelope, smooth between the @p kinks. */
    inline void expect_toughness(const CohesiveLaw &law,
                                 const std::vector<double> &kinks)
    {
      const auto T = [&law](const double d) { return law.traction(d); };
      double area = 0.;
      for (std::size_t i = 0; i + 1 < kinks.size(); ++i)
        area += integral(T, kinks[i], kinks[i + 1]);
      expect_relative(area, law.toughness(), 1e-10);
      EXPECT_EQ(law.energy(1e6 * kinks.back()), law.toughness());
    }

    /** dT/dd and dI/dd by centred differences, @p h on both sides. */
    inline void expect_slope(const CohesiveLaw &law, const double d,
                             const double slope, const double h)
    {
      expect_relative((law.traction(d + h) - law.traction(d - h)) / (2. * h),
                      slope, 1e-6);
      expect_relative(law.energy_increment(d - h, d + h) / (2. * h),
                      law.traction(d), 1e-6);
    }

    /** Finite and broken, also 1e6 openings beyond separation. */
    inline void expect_broken_beyond(const CohesiveLaw &law,
                                     const double final_opening)
    {
      for (const double factor : {1. + 1e-12, 2., 1e3, 1e6, 1e12}) {
        const double d = factor * final_opening;
        EXPECT_EQ(law.beta(d), 0.);
        EXPECT_EQ(law.traction(d), 0.);
        EXPECT_EQ(law.secant(d), 0.);
        EXPECT_EQ(law.energy(d), law.toughness());
        EXPECT_EQ(law.energy_increment(d, 1.05 * d), 0.);
        expect_relative(law.energy_increment(0., d), law.toughness());
      }
    }

    /** Stored when the point unloads from d to the origin. */
    inline double stored(const CohesiveLaw &law, const double d)
    {
      return 0.5 * law.secant(d) * d * d;
    }

    inline void expect_error(const std::string &name, const LawEntries &entries,
                             const std::string &part)
    {
      const std::string errors = law_errors(name, entries);
      EXPECT_NE(errors.find(part), std::string::npos)
          << "expected '" << part << "' in: " << errors;
    }
  } // namespace test
} // namespace nsfd
