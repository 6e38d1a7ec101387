#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Scenes of prm/reference against what their papers say, and cohesion on
// obstacles against formulas.

namespace end_to_end::test_reference
{
  namespace
  {
    std::filesystem::path reference(const std::string &name)
    {
      return std::filesystem::path(NSFD_SOURCE_DIR) / "prm" / "reference" /
             (name + ".prm");
    }

    History observed(const Result &result, const std::string &name)
    {
      return History(
          read_text(result.directory / "observables" / (name + ".csv")));
    }

    /** A block on a rigid base; its top is torn off, or pushed aside. */
    const std::string block = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 4 mm, 1 mm
  set cells        = 8, 2
end
subsection Material: PMMA
  set Young modulus = 3 GPa
  set Poisson ratio = 0.3
  set density       = 1200 kg/m^3
end
subsection Interface: all
  set law = bonded
end
subsection Obstacle: base
  set where     = bottom
  set point     = 0, 0
  set normal    = 0, 1
  set law       = camacho-ortiz
  set strength  = 3 MPa
  set toughness = 10 J/m^2
end
subsection Boundary: top
  set velocity y = 1 m/s
end
subsection Time
  set scheme = moreau-jean
  set step   = 0.05 us
  set end    = 25 us
end
)";

    std::string in_space(std::string text)
    {
      text = replaced(text, "dimension = 2", "dimension = 3");
      text = replaced(text, "type         = rectangle", "type = brick");
      text = replaced(text, "4 mm, 1 mm", "2 mm, 1 mm, 1 mm");
      text = replaced(text, "cells        = 8, 2", "cells = 4, 2, 2");
      text = replaced(text, "where     = bottom", "where = back");
      text = replaced(text, "point     = 0, 0", "point = 0, 0, 0");
      text = replaced(text, "normal    = 0, 1", "normal = 0, 0, 1");
      text = replaced(text, "Boundary: top", "Boundary: front");
      return replaced(text, "velocity y", "velocity z");
    }
  } // namespace

  /**
   * Collins-Craft, Bourrier and Acary (2024): with u_T = t/2, back and on, of
   * beta s u_T/|u_T| + mu (r_N + beta s) v_T/|v_T| a step has the mean; in a
   * step beta s falls by 2.5 kPa, on a side of 1 mm.
   */
  TEST(Reference, OnePoint)
  {
    const Workspace workspace;
    const Result result = good_run(workspace, "run", {reference("one_point")});
    ASSERT_TRUE(result.completed());
    const History base = observed(result, "base");
    double off = 0.;
    for (std::size_t i = 1; i < base.size(); ++i) {
      const double t = 1e3 * base["time"][i]; // ms
      const double beta = t <= 1. ? 1. - t / 2. : t <= 3. ? 0.5 : 2. - t / 2.;
      const double forward = t > 1. + 1e-9 && t <= 2. + 1e-9 ? -1. : 1.;
      const double force = 500. * beta + forward * 0.5 * (1000. + 500. * beta);
      off = std::max(off, std::abs(base["force_x"][i] + force));
      // the block is pressed when the run begins, and settles by 0.5 nm
      EXPECT_NEAR(base["force_y"][i], 1000., 0.2);
    }
    expect_below("reaction", off, 1.5 * 2.5 / 2. * 1.01,
                 "N/m, the mean over a step");
    // s delta / 2 once, and mu (r_N + beta s) along 2 mm; the block shears by
    // a millionth of delta
    EXPECT_NEAR(result.history["damage"].back(), 0.25, 2e-6 * 0.25);
    EXPECT_NEAR(result.history["friction"].back(), 1.25, 1e-4);
  }

  /**
   * Acary and Collins-Craft (2025): at the first impact the classical rule
   * creates 7.07e-4 J by friction, the mean velocity takes 6.77e-4 J.
   */
  TEST(Reference, ImpactingStick)
  {
    const auto first = [](const Result &result) {
      for (const double work : result.history["friction"])
        if (work != 0.)
          return work;
      return 0.;
    };
    const auto smallest = [](const Result &result) {
      const auto &friction = result.history["friction"];
      double least = 0.;
      for (std::size_t i = 1; i < friction.size(); ++i)
        least = std::min(least, friction[i] - friction[i - 1]);
      return least;
    };
    const Workspace workspace;
    const auto stick = [&](const std::string &sliding) {
      return good_run(workspace, sliding,
                      {reference("impacting_stick"),
                       {"Time/sliding=" + sliding, "Time/end=0.3"}});
    };
    const Result usual = stick("energy safe"), velocity = stick("velocity"),
                 increment = stick("increment");
    EXPECT_EQ(smallest(usual), 0.);
    EXPECT_EQ(smallest(increment), 0.);
    EXPECT_NEAR(first(velocity), -7.07e-4, 0.005e-4);
    EXPECT_NEAR(first(increment), 6.77e-4, 0.005e-4);
  }

  /**
   * Collins-Craft, Bourrier and Acary (2022): work is strain, kinetic and
   * surface energy, 140 J/m^2 on what has broken and at most that beside it,
   * and the front slows down.
   */
  TEST(Reference, DoubleCantilever)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "run", {reference("double_cantilever")});
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
    const double work = result.history["work"].back(),
                 broken = result.history["broken_area"].back();
    expect_below("numerical",
                 std::abs(result.history["numerical"].back()) / work, 1e-8,
                 "tolerance of the solver");
    EXPECT_GE(result.history["damage"].back(), 140. * broken);
    EXPECT_LE(result.history["damage"].back(), 140. * 1.6e-3);
    const History front = observed(result, "front");
    const auto tip = [&](const double time) {
      double last = 0.;
      for (std::size_t i = 0; i < front.size(); ++i)
        if (front["time"][i] <= time)
          last = front["tip_x"][i];
      return last;
    };
    double way = tip(0.15e-3) - 0.4e-3;
    for (unsigned int k = 1; k < 4; ++k) {
      const double next = tip((k + 1) * 0.15e-3) - tip(k * 0.15e-3);
      EXPECT_LT(next, way) << k;
      EXPECT_GT(next, 0.) << k;
      way = next;
    }
  }

  /**
   * The same by force: 10 N/ms until one element has gone. Bending of the arm
   * alone gives F = sqrt(2 E I G w)/a = 1.77 N for G = 140 J/m^2 on a crack of
   * a = 0.4 mm; shear of the arm, as high as a half of a, lowers it. The held
   * force takes the whole base, G on 1.6 mm.
   */
  TEST(Reference, DoubleCantileverByForce)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "run", {reference("double_cantilever_force")});
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
    const double force = 10. * 1e3 * result.counter("hold_time_left");
    EXPECT_LT(force, 1.77);
    EXPECT_GT(force, 0.85 * 1.77);
    EXPECT_NEAR(result.history["broken_area"].back(), 1.6e-3, 1e-12);
    EXPECT_NEAR(result.history["damage"].back(), 140. * 1.6e-3,
                1e-9 * 140. * 1.6e-3);
    EXPECT_LT(result.number("final_time"), 0.2e-3); // it has come to rest
  }

  // The force falls with the angle of the corner, and the crack gets farther;
  // the loads hold in the equilibrium in which it has begun.
  TEST(Reference, RhombusHole)
  {
    double force = 0., length = 0.;
    for (const std::string angle : {"80", "110"}) {
      const Workspace workspace;
      const Result result = good_run(
          workspace, "run",
          {reference("rhombus"), {with_mesh("rhombus_" + angle + ".geo")}});
      ASSERT_TRUE(result.completed());
      const auto &reaction = result.history["reaction_top_y"];
      const double strongest =
          -*std::min_element(reaction.begin(), reaction.end());
      const double broken = result.history["broken_area"].back();
      EXPECT_GT(broken, length);
      if (force > 0.) {
        EXPECT_LT(strongest, force);
      }
      force = strongest;
      length = broken;
      const auto &time = result.history["time"];
      EXPECT_EQ(result.counter("hold_time_top"), time[time.size() - 2]);
      EXPECT_NEAR(reaction.back(), reaction[reaction.size() - 2],
                  1e-9 * strongest);
    }
  }

  // The whole base lets go, and takes G on its area: 4 mm, or 2 mm^2.
  TEST(Reference, TornOffAnObstacle)
  {
    for (const bool space : {false, true})
      for (const std::string law : {"camacho-ortiz", "collins-craft"})
        for (const std::string scheme : {"moreau-jean", "explicit"}) {
          SCOPED_TRACE(law + ", " + scheme + (space ? " in space" : ""));
          const Workspace workspace;
          const auto file = workspace.path() / "block.prm";
          write_text(file, space ? in_space(block) : block);
          std::vector<std::string> set = {"Obstacle: base/law=" + law,
                                          "Time/scheme=" + scheme};
          if (scheme == "explicit")
            set.push_back("Time/step=auto");
          const Result result = good_run(workspace, "run", {file, set});
          ASSERT_TRUE(result.completed());
          const double area = space ? 2e-6 : 4e-3;
          EXPECT_NEAR(result.history["broken_area"].back(), area, 1e-9 * area);
          EXPECT_NEAR(result.history["damage"].back(), 10. * area,
                      1e-9 * 10. * area);
        }
  }

  // What is pushed aside slides and rubs, on any number of ranks and over a
  // restart.
  TEST(Reference, PushedAlongAnObstacle)
  {
    const std::vector<std::string> pushed = {
        "Obstacle: base/law=collins-craft", "Obstacle: base/friction=0.3",
        "Boundary: top/velocity x=2 m/s", "Boundary: top/velocity y=-0.1 m/s"};
    for (const std::string scheme : {"moreau-jean", "explicit"}) {
      SCOPED_TRACE(scheme);
      const Workspace workspace;
      const auto file = workspace.path() / "block.prm";
      write_text(file, block);
      std::vector<std::string> set = pushed;
      set.push_back("Time/scheme=" + scheme);
      if (scheme == "explicit")
        set.push_back("Time/step=auto");
      const Result one = good_run(workspace, "one", {file, set});
      ASSERT_TRUE(one.completed());
      EXPECT_GT(one.history["damage"].back(), 0.01);
      EXPECT_GT(one.history["friction"].back(), 0.);
      Launch two = {file, set};
      two.ranks = 2;
      const Result ranks = good_run(workspace, "two", two);
      if (scheme == "explicit") {
        EXPECT_EQ(one.history_text, ranks.history_text);
      } else {
        expect_below("of two ranks",
                     energy_difference(one.history, ranks.history), 1e-6,
                     "tolerance of the solver");
      }
      Result resumed;
      ASSERT_NO_FATAL_FAILURE(go_on(workspace, storing({file, set}, 20),
                                    {file, set}, one, resumed));
      EXPECT_EQ(one.history_text, resumed.history_text);
    }
  }
} // namespace end_to_end::test_reference
