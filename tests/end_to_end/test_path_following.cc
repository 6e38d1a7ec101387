#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// Equilibria through limit points and snap-back, at solution jump = arc length:
// a bar whose face softens faster than the bar unloads, a double cantilever
// under forces, a strip with two ligaments.

namespace end_to_end::test_path_following
{
  namespace
  {
    double last(const Result &run, const std::string &column)
    {
      return run.history[column].back();
    }

    double smallest_after_peak(const std::vector<double> &x)
    {
      return *std::min_element(std::max_element(x.begin(), x.end()), x.end());
    }

    void expect_no_jump(const Result &run)
    {
      EXPECT_EQ(run.counter("solution_jumps"), 0.);
      EXPECT_GT(run.counter("path_steps"), 4.);
      EXPECT_TRUE(run.summary.at("certificate").at("ok").get<bool>())
          << run.description();
    }

    /** The law R (d_f - u) / (d_f - d_0) between 2 um and 2 G/R = 20 um, and
        the bar: u + T L/E = U. */
    void follow_bar(const Launch &launch, const double d_0)
    {
      constexpr double R = 2e6, d_f = 20e-6, k = 2e9 / 0.1, height = 5e-3,
                       G = 20., pull = 120e-6; // m/s of the load time
      const Workspace workspace;
      const Result bar = good_run(workspace, "bar", launch);
      ASSERT_TRUE(bar.completed()) << bar.description();
      expect_no_jump(bar);
      const auto &s = bar.history["load_time"], &t = bar.history["time"],
                 &force = bar.history["reaction_right_x"],
                 &damage = bar.history["damage"];
      double worst = 0.;
      std::size_t softening = 0;
      for (std::size_t n = 0; n < s.size(); ++n) {
        const double T = force[n] / height, u = pull * s[n] - T / k,
                     D = damage[n] / height;
        // damage tells the branch: half of it is on the straight line
        const double d = d_0 + (d_f - d_0) * D / G;
        const double exact = D > 1e-9 * G
                                 ? std::max(0., R * (d_f - u) / (d_f - d_0))
                             : d_0 > 0. ? R * u / d_0
                                        : T;
        if (u < d_f)
          worst = std::max(worst, std::abs(T - exact) / R);
        if (D > 1e-9 * G && u < d_f)
          worst = std::max(worst, std::abs(u - d) / d_f);
        softening += D > 1e-9 * G && D < 0.999 * G;
        EXPECT_LE(s[n], t[n]);
      }
      EXPECT_GT(softening, 3u);
      expect_below("traction over R and opening over d_f", worst, 1e-7,
                   "the equations, rounds to 1e-8");
      // from R L/E + d_0 back to d_f, where nothing is left to carry
      expect_below("load time of the limit point, relative",
                   std::abs(*std::max_element(s.begin(), s.end()) /
                                ((R / k + d_0) / pull) -
                            1.),
                   1e-8, "a kink, met exactly");
      expect_below("load time of the break, relative",
                   std::abs(smallest_after_peak(s) / (d_f / pull) - 1.), 1e-6,
                   "a kink, met from behind");
      expect_below("damage over G",
                   std::abs(last(bar, "damage") / height / G - 1.), 1e-8,
                   "broken");
      expect_below("work over G", std::abs(last(bar, "work") / height / G - 1.),
                   1e-7, "all other energy is given back");
    }
  } // namespace

  TEST(PathFollowing, BarWithIntrinsicLaw)
  {
    follow_bar({benchmark("snap_back"),
                {"Interface: middle/law=geubelle-baylor",
                 "Interface: middle/stiffness=1e12 Pa/m"}},
               2e-6);
  }

  TEST(PathFollowing, BarWithExtrinsicLaw)
  {
    follow_bar({benchmark("snap_back"), {}}, 0.);
  }

  // Arms as beams: the compliance tells their crack, and that the force.
  TEST(PathFollowing, DoubleCantileverUnderForces)
  {
    constexpr double H = 0.01, E = 70e9, G = 1e3, p = 1e6;
    const double EI = E * H * H * H / 12.;
    const Workspace workspace;
    const Result run = good_run(
        workspace, "dcb",
        {benchmark("dcb_forces"), {"Mesh/cells=80, 8", "Time/end=18 s"}});
    ASSERT_TRUE(run.completed()) << run.description();
    expect_no_jump(run);
    const auto &s = run.history["load_time"],
               &area = run.history["broken_area"],
               &elastic = run.history["elastic"],
               &cohesive = run.history["cohesive"];
    double worst = 0.;
    unsigned int growing = 0;
    for (std::size_t n = 1; n < s.size(); ++n) {
      if (area[n] < 2e-3)
        continue;
      const double P = p * H * s[n],
                   C = 2. * (elastic[n] + cohesive[n]) / (P * P),
                   a = std::cbrt(1.5 * EI * C);
      worst = std::max(worst, std::abs(P * a / std::sqrt(G * EI) - 1.));
      ++growing;
    }
    EXPECT_GT(growing, 3u);
    expect_below("force over sqrt(G E I)/a, less 1", worst, 0.01, "beams");
    EXPECT_LT(s.back(), 0.98 * *std::max_element(s.begin(), s.end()))
        << "past the limit point";
  }

  TEST(PathFollowing, StripTakesTheToughnessOfItsLigament)
  {
    constexpr double G = 100.;
    const Workspace workspace;
    const Result run = good_run(
        workspace, "strip", {benchmark("perforated_strip"), {"Time/end=6 s"}});
    ASSERT_TRUE(run.completed()) << run.description();
    expect_no_jump(run);
    const double stored = last(run, "elastic") + last(run, "cohesive"),
                 damage = last(run, "damage");
    EXPECT_GT(last(run, "broken_area"), 1e-3);
    // what softens has taken a part of its toughness: damage counts it
    EXPECT_GE(damage, G * last(run, "broken_area") * (1. - 1e-6));
    expect_below("work over stored + damage, less 1",
                 std::abs(last(run, "work") / (stored + damage) - 1.), 0.01,
                 "nothing else takes energy");
    const auto &s = run.history["load_time"];
    EXPECT_LT(s.back(), 0.7 * *std::max_element(s.begin(), s.end()));
  }

  TEST(Restart, PathsGoOn)
  {
    const Workspace workspace;
    const Launch launch = {benchmark("snap_back"), {"Time/end=1 s"}};
    const Result whole = good_run(workspace, "whole", launch);
    Result resumed;
    ASSERT_NO_FATAL_FAILURE(go_on(workspace, launch, launch, whole, resumed));
    EXPECT_EQ(resumed.history_text, whole.history_text);

    const Result other =
        resume(workspace, "resumed",
               with(launch, {"Time/at solution jump=relax", "Time/end=2 s"}));
    EXPECT_EQ(other.outcome.exit_code, 1) << other.description();
    EXPECT_NE(other.outcome.err.find("at solution jump"), std::string::npos)
        << other.description();
  }

  TEST(PathFollowing, WhatItDoesNotKnowIsRefused)
  {
    const Workspace workspace;
    const auto refused = [&](const std::vector<std::string> &set,
                             const std::string &what,
                             const unsigned int ranks = 1) {
      const Result run = end_to_end::run(workspace, "refused",
                                         {benchmark("snap_back"), set, ranks});
      EXPECT_EQ(run.outcome.exit_code, 1) << run.description();
      EXPECT_NE(run.outcome.err.find(what), std::string::npos)
          << run.description();
    };
    refused({"Interface: middle/friction=0.3"},
            "arc length does not follow friction of `Interface: middle`");
    refused({"Time/quasi-static until=0.5 s", "Time/dynamic step=1 us"},
            "quasi-static until");
    refused({"Interface: middle/law=brittle"}, "drops at once");
    refused({"Solver/path=local"}, "cells that share no nodes");
    refused({}, "one rank", 2);
  }
} // namespace end_to_end::test_path_following
