#include "compare/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

// Numbers and curves of runs that are made up, so that their differences are
// known.

namespace nsfd::test_comparison
{
  namespace
  {
    /** kinetic = factor t^2 at n times up to @p end. */
    RunFolder made_run(const double factor, const unsigned int n,
                       const double end)
    {
      RunFolder run;
      run.name = "run";
      run.completed = true;
      std::vector<double> time, kinetic, fragments;
      for (unsigned int k = 1; k <= n; ++k) {
        time.push_back(end * k / n);
        kinetic.push_back(factor * time.back() * time.back());
        fragments.push_back(1.);
      }
      run.history = {
          {"time", time}, {"kinetic", kinetic}, {"fragments", fragments}};
      run.numbers = {{"final_time", end},
                     {"energy/kinetic", kinetic.back()},
                     {"counters/newton", 3. * n}};
      run.parameters =
          "subsection Time\n  set end = 1\n  set step = " + std::to_string(n) +
          "\nend\n";
      return run;
    }

    const ComparedCurve &curve_of(const Comparison &comparison,
                                  const std::string &name)
    {
      for (const ComparedCurve &curve : comparison.curves)
        if (curve.name == name)
          return curve;
      throw std::out_of_range(name);
    }
  } // namespace

  TEST(Comparison, OfCurvesOnTheSameTimes)
  {
    // 2 t^2 and 2.1 t^2 up to t = 1: relative to 2.1, at the end
    const Comparison comparison =
        compare_runs({made_run(2., 1000, 1.), made_run(2.1, 1000, 1.)});
    const ComparedCurve &kinetic = curve_of(comparison, "kinetic");
    EXPECT_NEAR(kinetic.largest, 0.1 / 2.1, 1e-14);
    EXPECT_EQ(kinetic.time, 1.);
    // the mean of t^2 is 1/3, by trapezoids
    EXPECT_NEAR(kinetic.mean, 0.1 / 2.1 / 3., 1e-4);
    EXPECT_EQ(curve_of(comparison, "fragments").largest, 0.);
    EXPECT_EQ(comparison.largest().name, "energy/kinetic");
    EXPECT_NEAR(comparison.largest().difference, 0.1 / 2.1, 1e-14);
    EXPECT_TRUE(comparison.parameters.empty());
    EXPECT_EQ(comparison.n_parameters, 2u);
  }

  TEST(Comparison, InterpolatesBetweenSteps)
  {
    // a parabola and its chords over 0.1: (0.1)^2 / 4 apart in the middle
    const Comparison comparison =
        compare_runs({made_run(2., 10, 1.), made_run(2., 20, 1.)});
    const ComparedCurve &kinetic = curve_of(comparison, "kinetic");
    EXPECT_NEAR(kinetic.largest, 2. * 0.01 / 4. / 2., 1e-12);
    ASSERT_EQ(comparison.parameters.size(), 1u);
    EXPECT_EQ(comparison.parameters[0].section, "Time");
    EXPECT_EQ(comparison.parameters[0].name, "step");
    EXPECT_EQ(comparison.parameters[0].values,
              (std::vector<std::string>{"10", "20"}));
    // other counts are no other results
    EXPECT_EQ(comparison.numbers.back().name, "counters/newton");
    EXPECT_NEAR(comparison.numbers.back().differences[1], 0.5, 1e-15);
    EXPECT_NEAR(comparison.largest().difference, 0.0025, 1e-12);
  }

  TEST(Comparison, IsOverCommonTimes)
  {
    const Comparison comparison =
        compare_runs({made_run(2., 100, 1.), made_run(2., 100, 2.)});
    EXPECT_EQ(comparison.begin, 0.02);
    EXPECT_EQ(comparison.end, 1.);
    EXPECT_LT(curve_of(comparison, "kinetic").largest, 1e-4);
    EXPECT_EQ(comparison.largest().name, "energy/kinetic") << "8 and 2";
    EXPECT_NEAR(comparison.largest().difference, 0.75, 1e-14);
  }

  TEST(Comparison, OfWhatIsNotThereIsBeyondEveryTolerance)
  {
    RunFolder a = made_run(2., 10, 1.), b = a;
    b.numbers[1].second = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(compare_runs({a, b}).largest().difference));
    b = a;
    b.numbers.erase(b.numbers.begin() + 1);
    EXPECT_TRUE(std::isnan(compare_runs({a, b}).largest().difference));
    b = a;
    b.history[1].second[4] = std::numeric_limits<double>::quiet_NaN();
    const Comparison broken = compare_runs({a, b});
    EXPECT_TRUE(std::isnan(broken.largest().difference));
    EXPECT_EQ(broken.largest().name, "kinetic over time");
    const std::string text = comparison_text(broken);
    EXPECT_NE(text.find("n/a"), std::string::npos);
  }

  TEST(Comparison, InterpolatesLinearly)
  {
    const std::vector<double> x = {1., 2., 4.}, y = {10., 20., 0.};
    const auto found = interpolated(x, y, {0.5, 1., 1.5, 3., 4., 5.});
    EXPECT_TRUE(std::isnan(found[0]));
    EXPECT_EQ(found[1], 10.);
    EXPECT_EQ(found[2], 15.);
    EXPECT_EQ(found[3], 10.);
    EXPECT_EQ(found[4], 0.);
    EXPECT_TRUE(std::isnan(found[5]));
  }
} // namespace nsfd::test_comparison
