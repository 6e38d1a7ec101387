#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Loads that hold when a crack begins, and runs that end when it rests: a strip
// is peeled off a rigid base by its left side, and the interface holds its
// sides.

namespace end_to_end::test_events
{
  namespace
  {
    const std::string strip = R"(
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
  set broken    = x < 0.5 mm
end
subsection Boundary: left
  set displacement y = 2 m/s * t
  set hold at        = first break
end
subsection Boundary: right
  set velocity x = 0
  set velocity y = 0
end
subsection Time
  set scheme = moreau-jean
  set step   = 0.05 us
  set end    = 25 us
end
subsection Observable: side
  set type = probe
  set on   = left
end
subsection Observable: pull
  set type = reaction
  set on   = left
end
)";

    std::string in_space(std::string text)
    {
      text = replaced(text, "dimension = 2", "dimension = 3");
      text = replaced(text, "type         = rectangle", "type = brick");
      text = replaced(text, "4 mm, 1 mm", "2 mm, 0.5 mm, 1 mm");
      text = replaced(text, "cells        = 8, 2", "cells = 4, 1, 2");
      text = replaced(text, "where     = bottom", "where = back");
      text = replaced(text, "point     = 0, 0", "point = 0, 0, 0");
      text = replaced(text, "normal    = 0, 1", "normal = 0, 0, 1");
      return replaced(replaced(text, "displacement y", "displacement z"),
                      "velocity y", "velocity z");
    }

    /** With a traction in place of the displacement. */
    std::string by_force(const std::string &text)
    {
      return replaced(replaced(replaced(text, "displacement y = 2 m/s * t",
                                        "traction y = 0.4 MPa/us * t"),
                               "displacement z = 2 m/s * t",
                               "traction z = 0.4 MPa/us * t"),
                      "subsection Observable: pull\n  set type = reaction\n"
                      "  set on   = left\nend\n",
                      "");
    }

    std::vector<std::string> explicit_steps()
    {
      return {"Time/scheme=explicit", "Time/step=auto"};
    }
    std::vector<std::string> equilibria()
    {
      return {"Time/scheme=quasi-static", "Time/step=0.5 us",
              "Time/at solution jump=relax"};
    }

    History observed(const Result &result, const std::string &name)
    {
      return History(
          read_text(result.directory / "observables" / (name + ".csv")));
    }

    /** First row with something broken. */
    std::size_t first_break(const History &history)
    {
      const auto &area = history["broken_area"];
      return std::size_t(std::find_if(area.begin(), area.end(),
                                      [](const double a) { return a > 0.; }) -
                         area.begin());
    }
  } // namespace

  // A place that is held does no work, and is where the formula was at the
  // event. The theta scheme comes there by halves, its error falls by sqrt(1/2)
  // per step.
  TEST(Events, MotionsHold)
  {
    for (const bool space : {false, true})
      for (const auto &set :
           {std::vector<std::string>(), explicit_steps(), equilibria()}) {
        SCOPED_TRACE((set.empty() ? "moreau-jean" : set[0]) +
                     (space ? " in space" : ""));
        const Workspace workspace;
        const auto file = workspace.path() / "strip.prm";
        write_text(file, space ? in_space(strip) : strip);
        const Result result = good_run(workspace, "run", {file, set});
        ASSERT_TRUE(result.completed());
        const History &history = result.history;
        const std::size_t event = first_break(history);
        ASSERT_LT(event + 10, history.size());
        const double time = history["time"][event];
        EXPECT_EQ(result.counter("hold_time_left"), time);
        const double u = 2. * time;
        const std::size_t rest = event + (set.empty() ? 100 : 1);
        ASSERT_LT(rest + 5, history.size());
        for (std::size_t i = rest + 1; i < history.size(); ++i)
          EXPECT_NEAR(history["work"][i], history["work"][rest],
                      1e-11 * history["work"][rest])
              << i;
        const History side = observed(result, "side");
        EXPECT_NEAR(side[space ? "displacement_z" : "displacement_y"].back(), u,
                    1e-12 * u);
      }
  }

  // A load that is held works by its way: the mean over a uniform traction. A
  // prescribed velocity is 0 afterwards.
  TEST(Events, LoadsHold)
  {
    for (const auto &set : {std::vector<std::string>(), equilibria()}) {
      SCOPED_TRACE(set.empty() ? "moreau-jean" : set[0]);
      const Workspace workspace;
      const auto file = workspace.path() / "strip.prm";
      write_text(file, by_force(strip));
      const Result result = good_run(workspace, "run", {file, set});
      ASSERT_TRUE(result.completed());
      const auto &work = result.history["work"];
      const std::size_t event = first_break(result.history);
      ASSERT_LT(event + 10, work.size());
      const double force = 0.4e12 * result.history["time"][event] * 1e-3;
      const History side = observed(result, "side");
      for (std::size_t i = event + 1; i < work.size(); ++i) {
        const double way =
            side["displacement_y"][i] - side["displacement_y"][event];
        EXPECT_NEAR(work[i] - work[event], force * way, 1e-11 * work.back())
            << i;
      }
    }
    for (const auto &set :
         {std::vector<std::string>(), explicit_steps(), equilibria()}) {
      SCOPED_TRACE(set.empty() ? "moreau-jean" : set[0]);
      const Workspace workspace;
      const auto file = workspace.path() / "strip.prm";
      write_text(file, replaced(strip, "displacement y = 2 m/s * t",
                                "velocity y     = 2 m/s"));
      const Result result = good_run(workspace, "run", {file, set});
      ASSERT_TRUE(result.completed());
      const std::size_t event = first_break(result.history);
      const History side = observed(result, "side");
      ASSERT_LT(event + 10, side.size());
      EXPECT_NEAR(side["velocity_y"].back(), 0., 2. * 1e-8); // of the solver
      // the theta scheme goes on for half a step
      const double u = side["displacement_y"][event + 2];
      EXPECT_NEAR(side["displacement_y"].back(), u, 1e-12 * u);
    }
  }

  // The whole face, not one of its points.
  TEST(Events, FacesBreakAfterPoints)
  {
    for (const auto &more : {std::vector<std::string>(), explicit_steps()}) {
      const Workspace workspace;
      const auto file = workspace.path() / "strip.prm";
      write_text(file, strip);
      auto set = more;
      set.push_back("Boundary: left/hold at=first face");
      const Result result = good_run(workspace, "run", {file, set});
      ASSERT_TRUE(result.completed());
      const double time = result.counter("hold_time_left");
      const auto &area = result.history["broken_area"];
      const auto &times = result.history["time"];
      const auto at = std::size_t(std::find(times.begin(), times.end(), time) -
                                  times.begin());
      ASSERT_LT(at, times.size());
      EXPECT_LT(area[at - 1], area[at]);
      const double first = times[first_break(result.history)];
      if (more.empty()) { // faces of 0.5 mm have two points
        EXPECT_GE(area[at], 0.5e-3 * (1. - 1e-12));
        EXPECT_GT(time, first);
      } else // the point at 0.5 mm is the last one of its face
        EXPECT_EQ(time, first);
    }
  }

  // The same on two ranks, and over a restart before and after the event.
  TEST(Events, RanksAndRestarts)
  {
    const auto run_strip = [](const Workspace &workspace, const Launch &what) {
      write_text(what.file, strip);
      return good_run(workspace, "whole", what);
    };
    for (const std::string event : {"first break", "first face"})
      for (const auto &more :
           {std::vector<std::string>(), explicit_steps(), equilibria()}) {
        SCOPED_TRACE(event + ", " + (more.empty() ? "moreau-jean" : more[0]));
        auto set = more;
        set.push_back("Boundary: left/hold at=" + event);
        double time = 0.;
        {
          const Workspace workspace;
          Launch one = {workspace.path() / "strip.prm", set};
          const Result serial = run_strip(workspace, one);
          ASSERT_TRUE(serial.completed());
          time = serial.counter("hold_time_left");
          one.ranks = 2;
          const Result ranks = good_run(workspace, "two", one);
          EXPECT_EQ(ranks.counter("hold_time_left"), time);
          if (!more.empty() && more[0] == "Time/scheme=explicit") {
            EXPECT_EQ(serial.history_text, ranks.history_text);
          }
        }
        for (const double share : {1.1, 2.}) { // go_on() stops at 0.8 of it
          const Workspace workspace;
          Launch one = {workspace.path() / "strip.prm", set};
          one.set.push_back("Time/end=" + std::to_string(1e6 * share * time) +
                            " us");
          const Result whole = run_strip(workspace, one);
          Result resumed;
          ASSERT_NO_FATAL_FAILURE(
              go_on(workspace, storing(one, 5), one, whole, resumed));
          EXPECT_EQ(whole.history_text, resumed.history_text);
        }
      }
  }

  TEST(Events, RunsEndAtRest)
  {
    for (const auto &more : {std::vector<std::string>(), explicit_steps()}) {
      const Workspace workspace;
      const auto file = workspace.path() / "strip.prm";
      write_text(file, strip);
      auto set = more;
      set.push_back("Time/end=1 ms");
      set.push_back("Time/end at rest=150");
      const Result result = good_run(workspace, "run", {file, set});
      ASSERT_TRUE(result.completed());
      const auto &area = result.history["broken_area"];
      const std::size_t last = area.size() - 1;
      EXPECT_LT(result.number("final_time"), 1e-3);
      EXPECT_EQ(area[last], area[last - 150]);
      EXPECT_GT(area[last - 150], area[last - 151]);
      EXPECT_EQ(result.counter("last_growth_step"), double(last - 150));
    }
  }

  TEST(Events, WhatCannotBeIsRefused)
  {
    const Workspace workspace;
    const auto refused = [&](const std::string &text, const std::string &part) {
      write_text(workspace.path() / "a.prm", text);
      const Outcome outcome = nsfd(workspace, {"a.prm", "--check"});
      EXPECT_EQ(outcome.exit_code, 1);
      EXPECT_NE(outcome.err.find(part), std::string::npos)
          << "no `" << part << "` in\n"
          << outcome.err;
    };
    refused(replaced(strip, "2 m/s * t", "2 mm"), "nothing is left to hold");
    refused(replaced(strip, "first break", "first crack"), "first break");
    const std::string law = "  set law       = camacho-ortiz\n"
                            "  set strength  = 3 MPa\n"
                            "  set toughness = 10 J/m^2\n"
                            "  set broken    = x < 0.5 mm\n";
    refused(replaced(strip, law, ""), "nothing breaks");
    refused(replaced(replaced(strip, law, ""), "  set end    = 25 us\n",
                     "  set end    = 25 us\n  set end at rest = 5\n"),
            "`end at rest` does not belong here");
  }
} // namespace end_to_end::test_events
