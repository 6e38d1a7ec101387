#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

// Files of observables: the same on any number of ranks, continued by a
// resumed run, and in agreement with what else a run writes.

namespace end_to_end
{
  namespace fs = std::filesystem;

  namespace
  {
    /** The strip with every kind of observable, small and short. */
    Launch strip(const Workspace &workspace)
    {
      const fs::path file = workspace.path() / "strip.prm";
      write_text(file, read_text(scene("strip")) + R"(
subsection Observable: corner
  set type = probe
  set at   = 5, 0.5
end
subsection Observable: lips
  set type = probe
  set on   = plane
end
subsection Observable: grip
  set type        = reaction
  set on          = top
  set every steps = 3
end
subsection Observable: plane
  set type = contact pressure
  set on   = Interface: plane
end
)");
      return {file,
              {"Mesh/cells=40, 8", "Time/end=5", "Verification/steady from=2",
               "Observable: crack/sections=1, 2.5, 9"}};
    }

    const std::vector<std::string> files = {
        "corner.csv", "crack.csv", "grip.csv",         "lips.csv",
        "plane.csv",  "tip.csv",   "plane_profile.csv"};

    void expect_same_files(const Result &a, const Result &b)
    {
      for (const std::string &file : files) {
        const std::string text = read_text(a.directory / "observables" / file);
        EXPECT_GT(text.size(), 100u) << file;
        EXPECT_TRUE(text == read_text(b.directory / "observables" / file))
            << file;
      }
      EXPECT_EQ(a.summary["observables"], b.summary["observables"]);
      EXPECT_EQ(a.summary["errors"], b.summary["errors"]);
    }

    History observed(const Result &result, const std::string &name)
    {
      return History(
          read_text(result.directory / "observables" / (name + ".csv")));
    }
  } // namespace

  TEST(Observables, AreTheSameOnAnyNumberOfRanks)
  {
    const Workspace workspace;
    Launch launch = with(strip(workspace), {"Mesh/cells=20, 4"});
    launch.seconds = 240.;
    const Result one = good_run(workspace, "one", launch);
    for (const unsigned int ranks : {2u, 4u}) {
      launch.ranks = ranks;
      expect_same_files(one, good_run(workspace, std::to_string(ranks), launch));
    }
  }

  TEST(Observables, GoOnAfterARestart)
  {
    const Workspace workspace;
    const Launch launch = strip(workspace);
    const Result whole = good_run(workspace, "whole", launch);
    const auto steps = unsigned(0.6 * whole.number("steps"));
    const Launch stored = storing(launch, steps);
    ASSERT_TRUE(run(workspace, "resumed", stored).completed());
    fs::remove(newest(workspace.path() / "resumed"));
    const Result after = resume(workspace, "resumed", stored);
    ASSERT_TRUE(after.completed()) << after.description();
    expect_same_files(whole, after);
  }

  TEST(Observables, AgreeWithTheHistory)
  {
    const Workspace workspace;
    const Result result = good_run(workspace, "strip", strip(workspace));
    const History crack = observed(result, "crack"),
                  grip = observed(result, "grip");
    ASSERT_EQ(crack.size(), result.history.size() + 1); // with the start
    for (std::size_t k = 0; k < result.history.size(); ++k) {
      // the history counts what has broken since the start
      EXPECT_NEAR(crack["length"][k + 1],
                  2. + result.history["broken_area"][k], 1e-9)
          << k;
      ASSERT_EQ(crack["step"][k + 1], result.history["step"][k]);
    }
    ASSERT_EQ(grip.size(), 1 + result.history.size() / 3);
    for (std::size_t k = 1; k < grip.size(); ++k)
      EXPECT_EQ(grip["force_y"][k],
                result.history["reaction_top_y"][3 * k - 1]);
    // one straight crack, open to x = 2 from the start on
    EXPECT_EQ(crack["crossings_1"].front(), 1.);
    EXPECT_EQ(crack["crossings_2"].front(), 0.);
    EXPECT_EQ(crack["crossings_2"].back(), 1.);
    EXPECT_EQ(crack["crossings_3"].back(), 0.);
    EXPECT_NEAR(crack["tip_x"].front(), 2., 1e-12);
    EXPECT_NEAR(crack["tip_x"].back(), crack["length"].back(), 1e-9);
    const auto &last = result.summary["observables"]["crack"]["last"];
    EXPECT_EQ(last["length"], crack["length"].back());
  }

  // A block that lies on an incline: the floor carries its weight.
  TEST(Observables, WeighABlock)
  {
    const Workspace workspace;
    const fs::path file = workspace.path() / "block.prm";
    write_text(file, R"(# block.prm - a block lies on the floor.
set dimension = 2
subsection Mesh
  set upper corner = 4, 1
  set cells        = 8, 2
end
subsection Material: block
  set Young modulus = 1 MPa
  set Poisson ratio = 0.3
  set density       = 1000
end
subsection Interface: inside
  set law = bonded
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.5
end
subsection Loads
  set gravity = 1, -10
end
subsection Time
  set end   = 10
  set step  = 20 ms
  set theta = 1
end
subsection Observable: pressure
  set type = contact pressure
  set on   = floor
end
subsection Observable: force
  set type = reaction
  set on   = floor
end
)");
    const Result result = good_run(workspace, "block", {file, {}});
    const auto &pressure = result.summary["observables"]["pressure"]["last"];
    const auto &force = result.summary["observables"]["force"]["last"];
    const double weight = 4e3;
    for (const auto *last : {&pressure, &force}) {
      expect_below("weight",
                   std::abs((*last)["force_y"].get<double>() / weight / 10. -
                            1.), 1e-6, "at rest");
      expect_below("friction",
                   std::abs((*last)["force_x"].get<double>() / weight + 1.),
                   1e-6, "at rest");
    }
    expect_below("area", std::abs(pressure["area"].get<double>() - 4.), 1e-12);
    expect_below("mean", std::abs(pressure["mean"].get<double>() - 1e4), 1e-2,
                 "weight over area");
    // moments about the centre of the floor: F_x at half the height
    expect_below("centre",
                 std::abs(pressure["centre_x"].get<double>() - 2.05), 1e-3,
                 "0.5 * 1/10 ahead of the middle");
    const History profile = observed(result, "pressure_profile");
    double sum = 0.;
    for (std::size_t k = 0; k < profile.size(); ++k)
      if (profile["step"][k] == profile["step"].back())
        sum += profile["pressure"][k] * 0.25; // Gauss points, half a cell each
    expect_below("profile", std::abs(sum / weight / 10. - 1.), 1e-6);
  }

  TEST(Observables, CheckListsAndRefuses)
  {
    const Workspace workspace;
    const Launch launch = strip(workspace);
    const Outcome good = nsfd(workspace, {launch.file.string(), "--check"});
    EXPECT_EQ(good.exit_code, 0) << good.err;
    EXPECT_NE(good.out.find("observe    tip: energy release rate at the tip"),
              std::string::npos)
        << good.out;
    const Outcome outside =
        nsfd(workspace, {launch.file.string(), "--check", "--set",
                         "Observable: corner/at=50, 0"});
    EXPECT_EQ(outside.exit_code, 1);
    EXPECT_NE(outside.err.find("Observable: corner: at = 50, 0 is outside of "
                               "the mesh"),
              std::string::npos)
        << outside.err;
    const Outcome unknown = nsfd(workspace, {launch.file.string(), "--set",
                                             "Observable: grip/on=topp"});
    EXPECT_EQ(unknown.exit_code, 1);
    EXPECT_NE(unknown.err.find("on = topp"), std::string::npos) << unknown.err;
    EXPECT_NE(unknown.err.find("`top`"), std::string::npos) << unknown.err;
  }
} // namespace end_to_end
