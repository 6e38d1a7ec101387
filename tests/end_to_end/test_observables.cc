#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

// Files of observables: the same on any number of ranks, continued by a
// resumed run, and in agreement with what else a run writes.

namespace end_to_end::test_observables
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
      expect_same_files(one,
                        good_run(workspace, std::to_string(ranks), launch));
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
    ASSERT_EQ(crack.size(), result.history.size());
    for (std::size_t k = 0; k < result.history.size(); ++k) {
      // the history counts what has broken since the start
      EXPECT_NEAR(crack["length"][k], 2. + result.history["broken_area"][k],
                  1e-9)
          << k;
      ASSERT_EQ(crack["step"][k], result.history["step"][k]);
    }
    ASSERT_EQ(grip.size(), 1 + (result.history.size() - 1) / 3);
    for (std::size_t k = 1; k < grip.size(); ++k)
      EXPECT_EQ(grip["force_y"][k], result.history["reaction_top_y"][3 * k]);
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
      expect_below(
          "weight",
          std::abs((*last)["force_y"].get<double>() / weight / 10. - 1.), 1e-6,
          "at rest");
      expect_below("friction",
                   std::abs((*last)["force_x"].get<double>() / weight + 1.),
                   1e-6, "at rest");
    }
    expect_below("area", std::abs(pressure["area"].get<double>() - 4.), 1e-12);
    expect_below("mean", std::abs(pressure["mean"].get<double>() - 1e4), 1e-2,
                 "weight over area");
    // moments about the centre of the floor: F_x at half the height
    expect_below("centre", std::abs(pressure["centre_x"].get<double>() - 2.05),
                 1e-3, "0.5 * 1/10 ahead of the middle");
    const History profile = observed(result, "pressure_profile");
    double sum = 0.;
    for (std::size_t k = 0; k < profile.size(); ++k)
      if (profile["step"][k] == profile["step"].back())
        sum += profile["pressure"][k] * 0.25; // Gauss points, half a cell each
    expect_below("profile", std::abs(sum / weight / 10. - 1.), 1e-6);
  }

  // The same where places meet others in every step: a rigid slab on an elastic
  // one on a floor.
  TEST(Observables, WeighAStackInLargeMotions)
  {
    const Workspace workspace;
    const fs::path file = workspace.path() / "stack.prm";
    write_text(
        file,
        R"(# stack.prm - a rigid slab on an elastic one on a floor that is not quite level.
set dimension = 2
set motion    = large

subsection Mesh
  set upper corner = 4, 3
  set cells        = 8, 6
end
subsection Material: lower
  set where         = y < 1
  set model         = saint-venant kirchhoff
  set Young modulus = 10 MPa
  set Poisson ratio = 0.3
  set density       = 1000
end
subsection Material: upper
  set model   = rigid
  set bodies  = connected
  set density = 500
end
subsection Interface: inside
  set where = between materials [lower, lower]
  set law   = rigid
end
subsection Interface: joint
  set law      = contact
  set friction = 0.5
end
subsection Contact: slabs
  set between  = lower, upper
  set friction = 0.5
end
subsection Obstacle: floor
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.5
end
subsection Loads
  set gravity = 1, -10
end
subsection Time
  set end   = 1.2
  set step  = 20 ms
  set theta = 1
end
subsection Observable: pressure
  set type = contact pressure
  set on   = floor
end
subsection Observable: floor force
  set type = reaction
  set on   = floor
end
subsection Observable: joint force
  set type = reaction
  set on   = slabs
end
)");
    Launch launch{file, {}};
    const Result result = good_run(workspace, "one", launch);
    const auto last = [&](const std::string &name, const std::string &column) {
      return result.summary["observables"][name]["last"][column].get<double>();
    };
    const double lower = 4e3, upper = 4e3; // kg/m
    for (const auto &[name, mass] : {std::pair("pressure", lower + upper),
                                     std::pair("floor force", lower + upper),
                                     std::pair("joint force", upper)}) {
      expect_below("weight", std::abs(last(name, "force_y") / mass / 10. - 1.),
                   1e-6, name);
      expect_below("friction", std::abs(last(name, "force_x") / mass + 1.),
                   1e-6, name);
    }
    expect_below("area", std::abs(last("pressure", "area") / 4. - 1.), 1e-12,
                 "all of the slab");
    expect_below("mean", std::abs(last("pressure", "mean") / 2e4 - 1.), 1e-6,
                 "weight over area");
    // moments of the loads along the floor, at heights of 0.5 and 2
    expect_below("centre", std::abs(last("pressure", "centre_x") - 2.125), 1e-3,
                 "strains of 0.2 %");
    const History profile = observed(result, "pressure_profile");
    double sum = 0.;
    for (std::size_t k = 0; k < profile.size(); ++k)
      if (profile["step"][k] == profile["step"].back())
        sum += profile["pressure"][k] * 0.25; // nodes, half a side each
    expect_below("profile", std::abs(sum / (lower + upper) / 10. - 1.), 1e-6);
    // joints and long steps are solved on the assembled path, where round-off
    // knows the ranks
    launch.ranks = 2;
    const Result two = good_run(workspace, "two", launch);
    for (const std::string name : {"pressure", "floor force", "joint force"}) {
      const History a = observed(result, name), b = observed(two, name);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t k = 0; k < a.size(); ++k)
        for (const std::string column : {"force_x", "force_y"})
          EXPECT_NEAR(a[column][k], b[column][k], 1e-9 * 8e4) << name << k;
    }
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
    const Outcome unknown = nsfd(
        workspace, {launch.file.string(), "--set", "Observable: grip/on=topp"});
    EXPECT_EQ(unknown.exit_code, 1);
    EXPECT_NE(unknown.err.find("on = topp"), std::string::npos) << unknown.err;
    EXPECT_NE(unknown.err.find("`top`"), std::string::npos) << unknown.err;
  }
} // namespace end_to_end::test_observables
