#include "small_scene.h"

#include "simulation/forecast.h"

#include <gtest/gtest.h>

// From the first steps of a run to all of them.

namespace nsfd::test_forecast
{
  namespace
  {
    using small_scene_text::read_good;
    using small_scene_text::small_scene;

    /** Steps of 0.1 ns and 0.02 s after a first one of 0.5 s. */
    FirstSteps trial_of(const unsigned int n_steps)
    {
      FirstSteps trial;
      trial.set_up = 3.;
      trial.samples.push_back({0, 0., 10.});
      for (unsigned int k = 1; k <= n_steps; ++k)
        trial.samples.push_back({k, 1e-10 * k, 10.48 + 0.02 * k});
      trial.cpu = trial.samples.back().cpu - 10.;
      trial.wall = 2. * trial.cpu;
      return trial;
    }
    const std::vector<std::string> no_pictures = {"Output/fields=false",
                                                  "Output/report=false"};
  } // namespace

  // 10 ns: 100 steps, of which the first one is dearer.
  TEST(Forecasts, StepsOfOneCost)
  {
    const auto scene = read_good(small_scene, no_pictures);
    for (const unsigned int n : {2u, 7u, 60u, 100u}) {
      const Forecast found = forecast(*scene, trial_of(n), {}, 170.);
      EXPECT_TRUE(found.known);
      EXPECT_NEAR(found.steps, 100., 1e-9);
      EXPECT_NEAR(found.seconds, 3. + 0.5 + 99 * 0.02, 1e-9);
      EXPECT_NEAR(found.step, 0.02, 1e-12);
      EXPECT_EQ(found.longest, found.seconds) << "nothing can break";
      EXPECT_EQ(found.megabytes, 170.);
      EXPECT_NEAR(found.busy, 2., 1e-12);
    }
  }

  // What steps have become counts, not what they were.
  TEST(Forecasts, ShorterSteps)
  {
    const auto scene = read_good(small_scene, no_pictures);
    FirstSteps trial = trial_of(26); // 1 s to 2.6 ns
    for (unsigned int k = 1; k <= 100; ++k)
      trial.samples.push_back({26 + k, 2.6e-9 + 1e-11 * k, 11. + 0.02 * k});
    trial.cpu = 3.;
    // 3.6 ns are done, and a nanosecond takes 100 steps of 0.02 s now
    const Forecast found = forecast(*scene, trial, {}, 170.);
    EXPECT_NEAR(found.steps, 126. + 640., 1e-6);
    EXPECT_NEAR(found.seconds, 3. + 3. + 640. * 0.02, 1e-6);
  }

  // One step of an impact is as dear as a hundred others.
  TEST(Forecasts, ADearStepPasses)
  {
    const auto scene = read_good(small_scene, no_pictures);
    FirstSteps trial = trial_of(29);
    trial.samples.push_back({30, 3e-9, trial.samples.back().cpu + 2.});
    trial.cpu += 2.;
    const Forecast found = forecast(*scene, trial, {}, 170.);
    EXPECT_NEAR(found.steps, 100., 1e-9);
    EXPECT_NEAR(found.seconds, 3. + trial.cpu + 70. * 0.02, 1e-9);
  }

  TEST(Forecasts, PicturesCost)
  {
    const auto none = read_good(small_scene, no_pictures);
    // at 0, 1, ... 10 ns
    const auto some = read_good(small_scene, {"Output/fields every=1 ns"});
    const OutputCounts counts{1e5, 2e5};
    const Forecast without = forecast(*none, trial_of(50), counts, 170.),
                   with = forecast(*some, trial_of(50), counts, 170.);
    EXPECT_EQ(without.pictures, 0.);
    EXPECT_EQ(with.pictures, 11.);
    EXPECT_NEAR(with.seconds - without.seconds, with.picturing, 1e-9);
    EXPECT_GT(with.picturing, 0.);
    EXPECT_GT(with.megabytes, without.megabytes);
  }

  // A scene with faces that may break has a range.
  TEST(Forecasts, RangeWhereFacesMayBreak)
  {
    const auto scene =
        read_good(small_scene_text::replaced(
                      small_scene, "set law = rigid",
                      "set law = camacho-ortiz\n  set strength = 300 MPa\n"
                      "  set toughness = 0.5 J/m^2"),
                  no_pictures);
    const Forecast begun = forecast(*scene, trial_of(20), {}, 170.),
                   ended = forecast(*scene, trial_of(100), {}, 170.);
    EXPECT_GT(begun.longest, begun.seconds);
    EXPECT_EQ(ended.longest, ended.seconds) << "nothing is left to come";
  }

  TEST(Forecasts, NoneWithoutASteps)
  {
    const auto scene = read_good(small_scene, no_pictures);
    FirstSteps trial = trial_of(0);
    const Forecast left = forecast(*scene, trial, {}, 170.);
    EXPECT_FALSE(left.known);
    EXPECT_NE(forecast_text(*scene, trial, left).find("not known"),
              std::string::npos);
    trial.failure = "no solution";
    EXPECT_NE(forecast_text(*scene, trial, left).find("no solution"),
              std::string::npos);
  }

  TEST(Forecasts, AsText)
  {
    const auto scene = read_good(small_scene, no_pictures);
    const FirstSteps trial = trial_of(20);
    const std::string text =
        forecast_text(*scene, trial, forecast(*scene, trial, {}, 170.4));
    EXPECT_EQ(text,
              "  time       about 5.5 s\n"
              "             set-up 3.0 s, 100 steps of 20.0 ms\n"
              "             as the first 20 steps, to t = 2.00 ns, which took "
              "0.9 s; later ones\n"
              "             may cost more or less\n"
              "             on a core of its own; now others use it as well, "
              "and it would be\n"
              "             11 s\n"
              "  memory     about 170 MB\n");
  }
} // namespace nsfd::test_forecast
