#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Extreme scenes: hardly anything in them, or more than a step can solve.

namespace end_to_end::test_extremes
{
  namespace fs = std::filesystem;

  namespace
  {
    const char *const flight = R"(# flight.prm - one cell that nothing holds.
set dimension = 2

subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 1 m, 0.5 m
  set cells        = 1, 1
end
subsection Material: cell
  set model              = linear elastic
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.3
  set density            = 1000 kg/m^3
  set initial velocity x = 3 m/s
  set initial velocity y = 4 m/s
end
subsection Interface: none
  set where = all
  set law   = contact
end
subsection Loads
  set gravity = 0, -10 m/s^2
end
subsection Time
  set end   = 0.8 s
  set step  = 10 ms
  set theta = 0.5
end
)";

    /** u = v_0 t + g t^2 / 2, v = v_0 + g t at every point of the body. */
    void expect_free_flight(const Result &result)
    {
      const auto fields = snapshots(result.directory, "fields");
      ASSERT_GE(fields.size(), 2u);
      const Snapshot &last = fields.back();
      const double t = 0.8, u[] = {3. * t, 4. * t - 5. * t * t, 0.},
                   v[] = {3., 4. - 10. * t, 0.};
      double error_u = 0., error_v = 0., stress = 0.;
      const auto &displacement = last.at("displacement");
      ASSERT_GE(displacement.size(), 12u);
      for (std::size_t i = 0; i < displacement.size(); ++i) {
        error_u = std::max(error_u, std::abs(displacement[i] - u[i % 3]));
        error_v =
            std::max(error_v, std::abs(last.at("velocity")[i] - v[i % 3]));
      }
      for (const double sigma : last.at("stress"))
        stress = std::max(stress, std::abs(sigma));
      expect_below("displacement, m", error_u, 1e-11, "80 steps of round-off");
      expect_below("velocity, m/s", error_v, 1e-11, "80 steps of round-off");
      expect_below("stress over E", stress / 1e6, 1e-11, "none");

      const History &history = result.history;
      double error_kinetic = 0., error_work = 0.;
      for (std::size_t i = 0; i < history.size(); ++i) {
        const double time = history["time"][i], w = 4. - 10. * time;
        // 500 kg; what gravity does is the change
        const double kinetic = 250. * (9. + w * w);
        error_kinetic =
            std::max(error_kinetic, std::abs(history["kinetic"][i] - kinetic));
        error_work = std::max(error_work,
                              std::abs(history["work"][i] - (kinetic - 6250.)));
      }
      expect_below("kinetic energy", error_kinetic / 6250., 1e-11);
      expect_below("work of gravity", error_work / 6250., 1e-11);
    }

    Result fly(const Workspace &workspace,
               const std::vector<std::string> &set = {})
    {
      write_text(workspace.path() / "flight.prm", flight);
      return good_run(workspace, "flight",
                      {workspace.path() / "flight.prm", set});
    }
  } // namespace

  TEST(Extremes, SingleCellFliesExactly)
  {
    const Workspace workspace;
    const Result result = fly(workspace);
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.number("cells"), 1);
    EXPECT_EQ(result.number("interface_points"), 0);
    EXPECT_EQ(result.number("fragments"), 1);
    expect_free_flight(result);
  }

  TEST(Extremes, SingleCellFliesExactlyOnFourRanks)
  {
    const Workspace workspace;
    write_text(workspace.path() / "flight.prm", flight);
    const Result one = good_run(workspace, "1 rank",
                                {workspace.path() / "flight.prm"}),
                 four = good_run(workspace, "4 ranks",
                                 {workspace.path() / "flight.prm", {}, 4});
    ASSERT_TRUE(one.completed() && four.completed());
    EXPECT_EQ(one.history_text, four.history_text) << "three ranks are empty";
  }

  TEST(Extremes, BrokenCellsFlyTogether)
  {
    const Workspace workspace;
    const Result result = fly(workspace, {"Mesh/cells=2, 2"});
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.number("fragments"), 4);
    expect_free_flight(result);
  }

  // mu = 0: no tangential impulse at all, not a small one.
  TEST(Extremes, NoFrictionOnTheIncline)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "incline",
                 {scene("incline"),
                  {"Obstacle: plane/friction=0", "Output/fields every=0.1 s"}});
    ASSERT_TRUE(result.completed());
    for (const double friction : result.history["friction"])
      EXPECT_EQ(friction, 0.);
    EXPECT_EQ(result.counter("friction_points"), 0.);
    for (const char *key : {"velocity", "position", "normal_reaction"})
      expect_below(key, result.error(key), 1e-10, "slides with g sin a");
    // the plane is level: traction in x is tangential
    double normal = 0.;
    for (const Snapshot &snapshot : snapshots(result.directory, "interfaces")) {
      const auto &traction = snapshot.at("traction");
      for (std::size_t i = 0; i < traction.size(); i += 3) {
        EXPECT_EQ(traction[i], 0.);
        normal = std::max(normal, std::abs(traction[i + 1]));
      }
    }
    EXPECT_GT(normal, 0.) << "there is contact";
  }

  // The same where cracks open and close: contact without friction.
  TEST(Extremes, NoFrictionBetweenFragments)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "torn_plate",
                 {torn_plate(),
                  {"Mesh/cells=12, 9", "Time/step=0.4 us",
                   "Constants/turn=70 us", "Constants/pull=4 m/s",
                   "Interface: all/friction=0", "Output/fields=false"}});
    ASSERT_TRUE(result.completed());
    for (const double friction : result.history["friction"])
      EXPECT_EQ(friction, 0.);
    EXPECT_GT(result.dissipated("damage"), 0.);
    EXPECT_GT(result.dissipated("impact"), 0.);
    EXPECT_EQ(result.counter("friction_points"), 0.);
  }

  // One Newton step, no other method, no shorter step: the first impact with
  // friction is too much. The state before it is kept and the face is named.
  TEST(Extremes, UnsolvedStepSavesTheLastState)
  {
    const Workspace workspace;
    Launch what{scene("ball"),
                {"Obstacle: floor/friction=0.5", "Time/end=1 s",
                 "Material: ball/initial velocity x=2 m/s",
                 "Solver/method=dual newton", "Solver/maximum iterations=1",
                 "Time/maximum bisections=0"}};
    what.report = true;
    const Result result = run(workspace, "unsolved", what);
    EXPECT_EQ(result.outcome.exit_code, 3) << result.description();
    ASSERT_TRUE(result.summary.is_object());
    EXPECT_FALSE(result.summary["completed"].get<bool>());
    ASSERT_TRUE(result.summary["failure"].is_string());
    const std::string failure = result.summary["failure"];
    EXPECT_NE(failure.find("`Obstacle: floor`"), std::string::npos) << failure;
    EXPECT_NE(result.outcome.err.find(failure), std::string::npos)
        << result.outcome.err;
    for (const char *name :
         {"parameters.prm", "run.json", "history.csv", "summary.json",
          "fields.pvd", "interfaces.pvd", "report.html"})
      EXPECT_TRUE(fs::exists(result.directory / name)) << name;

    // up to the impact at 0.45 s
    ASSERT_GT(result.history.size(), 100u);
    EXPECT_EQ(result.number("steps") + 1., double(result.history.size()));
    const double last = result.history["time"].back();
    EXPECT_NEAR(last, 0.4515, 0.005);
    EXPECT_EQ(result.number("final_time"), last);
    const auto fields = snapshots(result.directory, "fields");
    ASSERT_EQ(fields.size(), 2u) << "the start and the last good state";
    expect_below(
        "fall at the last good state",
        std::abs(fields[1].at("displacement")[1] + 0.5 * 9.81 * last * last),
        1e-10);
  }

  // The same without a limit is solved.
  TEST(Extremes, ImpactWithFrictionIsSolved)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "ball",
                 {scene("ball"),
                  {"Obstacle: floor/friction=0.5", "Time/end=1 s",
                   "Material: ball/initial velocity x=2 m/s"}});
    ASSERT_TRUE(result.completed());
    EXPECT_GT(result.dissipated("friction"), 0.);
    EXPECT_GT(result.dissipated("impact"), 0.);
  }

  // A motion that stops being a number in the middle of a run.
  TEST(Extremes, MotionThatIsNoNumberEndsTheRun)
  {
    const Workspace workspace;
    const Result result = run(
        workspace, "nan",
        {scene("midplane"),
         {"Mesh/cells=4, 4", "Interface: midline/where=abs(x - 5 um) < 1 nm",
          // at the start and the end it is one: these are asked before the run
          "Boundary: left/velocity x=if(abs(t - 6 ns) > 1 ns, -2 m/s, 1 m/s * "
          "log(-t / 1 ns))"}});
    EXPECT_EQ(result.outcome.exit_code, 3) << result.description();
    // the loads of the whole run are looked at before the first step
    ASSERT_GE(result.history.size(), 1u);
    for (const std::string &name : result.history.names())
      for (const double value : result.history[name])
        EXPECT_TRUE(std::isfinite(value)) << name;
    EXPECT_LT(result.number("final_time"), 5.1e-9);
  }

  /** Two cells pulled apart at a face with the law of @p entries. */
  std::string pull(const std::string &entries, const std::string &toughness)
  {
    return R"(# pull.prm - two cells are pulled apart.
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 20 um, 10 um
  set cells        = 2, 1
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
end
subsection Interface: middle
  set where     = abs(x - 10 um) < 1 nm
  set strength  = 300 MPa
  set toughness = )" +
           toughness + "\n" + entries + R"(end
subsection Boundary: left
  set velocity x = -2 m/s
end
subsection Boundary: right
  set velocity x = 2 m/s
end
subsection Time
  set end  = 40 ns
  set step = auto
end
)";
  }

  // Tractions that jump, or fall infinitely fast at separation: no step is
  // below the uniqueness bound. They do not shorten `step = auto`; the steps
  // in which they soften are counted.
  TEST(Extremes, InfiniteSofteningDoesNotShortenSteps)
  {
    const Workspace workspace;
    for (const auto &[name, entries] : std::map<std::string, std::string>{
             {"brittle", "  set law = brittle\n"},
             {"dugdale", "  set law = dugdale\n"},
             {"ppr", "  set law = ppr-extrinsic\n  set alpha = 1.5\n"}}) {
      SCOPED_TRACE(name);
      const fs::path file = workspace.path() / (name + ".prm");
      write_text(file, pull(entries, "0.5 J/m^2"));
      const Outcome check = nsfd(workspace, {file.string(), "--check"});
      EXPECT_EQ(check.exit_code, 0) << check.err;
      EXPECT_NE(check.out.find("softens infinitely fast"), std::string::npos)
          << check.out;
      EXPECT_EQ(check.out.find("sure below"), std::string::npos) << check.out;

      const Result result = good_run(workspace, name, {file});
      ASSERT_TRUE(result.completed());
      EXPECT_NEAR(result.dissipated("damage"), 5e-6,
                  5e-6 * 1e-6); // G times height
      const auto &time = result.history["time"];
      ASSERT_GT(time.size(), 10u);
      EXPECT_EQ(result.counter("rejected_steps"), 0.);
      for (std::size_t i = 1; i + 1 < time.size(); ++i)
        EXPECT_NEAR(time[i + 1] - time[i], time[1] - time[0], 1e-9 * time[1]);
      EXPECT_GE(result.counter("steps_beyond_uniqueness"), 1.);
    }
  }

  // An extrinsic face is activated in a step far above its bound, which nothing
  // announces: with `step = auto` that step is repeated in shorter ones.
  TEST(Extremes, AutomaticStepsAreRedoneWhereAFaceLetsGo)
  {
    const Workspace workspace;
    const fs::path file = workspace.path() / "pull.prm";
    write_text(file, pull("  set law = camacho-ortiz\n", "0.1 J/m^2"));
    const Result result = good_run(workspace, "auto", {file});
    ASSERT_TRUE(result.completed());
    EXPECT_NEAR(result.dissipated("damage"), 1e-6, 1e-6 * 1e-6);
    EXPECT_EQ(result.counter("steps_beyond_uniqueness"), 0.);
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
    EXPECT_EQ(result.counter("redone_steps"), 1.);
    // short until the face is broken, long again soon after
    const auto &steps = result.history["time_step"];
    const double shortest = *std::min_element(steps.begin() + 1, steps.end());
    EXPECT_LT(shortest, 0.26 * steps[1]);
    EXPECT_EQ(steps.back(), steps[1]);
  }

  // Explicit steps of large motions are stable and yet far too long for forces
  // that change as much in one: no step is accepted that gives by them what the
  // certificate does not allow the whole run, on any number of ranks. Where
  // shorter steps help they are taken, else the run fails.
  TEST(Extremes, ForcesThatChangeTooMuchInAStep)
  {
    const Workspace workspace;
    const fs::path file = workspace.path() / "torn.prm";
    write_text(file, R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 0.4, 0.2
  set cells        = 4, 2
end
subsection Material: rubber
  set model              = neo-hookean
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.3
  set density            = 1000 kg/m^3
  set initial velocity x = 300 * x
end
subsection Interface: all
  set law = joined
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 0.02 s
end
)");
    for (const unsigned int n : {1u, 2u}) {
      const std::string ranks = std::to_string(n);
      const Result good =
          good_run(workspace, "shorter " + ranks, {file, {}, n});
      ASSERT_TRUE(good.completed());
      EXPECT_GT(good.counter("rejected_steps"), 0.);
      EXPECT_EQ(good.summary["certificate"]["lines"]["given by large motion"]
                            ["verdict"],
                "ok");
      // a stiffer law, ten times as fast
      const Result failed =
          run(workspace, "failed " + ranks,
              {file,
               {"Material: rubber/model=saint-venant kirchhoff",
                "Material: rubber/initial velocity x=3000 * x"},
               n});
      EXPECT_EQ(failed.outcome.exit_code, 3) << failed.description();
      EXPECT_NE(failed.outcome.err.find("J to `large motion`"),
                std::string::npos)
          << failed.outcome.err;
      EXPECT_EQ(failed.summary["certificate"]["lines"]["given by large motion"]
                              ["verdict"],
                "ok");
    }
  }

  // Half of a bar flows and it tears: half of the step in which forces change
  // most would give, by its length alone, more than what the step misses.
  TEST(Extremes, StepsAreNotHalvedWhereThatGivesMore)
  {
    const Workspace workspace;
    const fs::path file = workspace.path() / "two.prm";
    write_text(file, R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 0.4, 0.2
  set cells        = 8, 4
end
subsection Material: plastic
  set where                       = x < 0.09
  set model                       = j2 plastic
  set Young modulus               = 1 MPa
  set Poisson ratio               = 0.3
  set density                     = 1000 kg/m^3
  set yield stress                = 20 kPa
  set isotropic hardening modulus = 10 kPa
  set initial velocity x          = 10 * x
end
subsection Material: rubber
  set where              = all
  set model              = neo-hookean
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.3
  set density            = 1000 kg/m^3
  set initial velocity x = 10 * x
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 50 kPa
  set toughness = 10
end
subsection Contact: all
  set friction = 0.3
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 0.05 s
end
)");
    // on four ranks one has no cell that flows
    const Result one = good_run(workspace, "1 rank", {file}),
                 four = good_run(workspace, "4 ranks", {file, {}, 4});
    ASSERT_TRUE(one.completed());
    EXPECT_EQ(
        one.summary["certificate"]["lines"]["given by large motion"]["verdict"],
        "ok");
    EXPECT_TRUE(one.history_text == four.history_text);
  }
} // namespace end_to_end::test_extremes
