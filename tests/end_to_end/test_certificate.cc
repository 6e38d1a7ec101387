#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>

// What a run says of itself when it ends.

namespace end_to_end::test_certificate
{
  namespace
  {
    std::string verdict(const Result &result, const std::string &line)
    {
      const auto &lines = result.summary.at("certificate").at("lines");
      return lines.contains(line)
                 ? lines.at(line).at("verdict").get<std::string>()
                 : "no such line";
    }

    std::filesystem::path write(const Workspace &workspace,
                                const std::string &name,
                                const std::string &text)
    {
      const auto file = workspace.path() / name;
      write_text(file, text);
      return file;
    }

    /** Something was said while it ran. */
    bool has_note(const Workspace &workspace, const std::filesystem::path &file,
                  const std::string &setting)
    {
      return nsfd(workspace, {file.string(), "--force", "--set", setting,
                              "--set", "Output/report=false"})
                 .out.find("note: at t =") != std::string::npos;
    }

    /** What a run prints from its certificate on. */
    std::string last_lines(const Workspace &workspace,
                           const std::filesystem::path &file,
                           const std::vector<std::string> &settings = {})
    {
      std::vector<std::string> arguments = {file.string(), "--set",
                                            "Output/report=false"};
      for (const std::string &setting : settings)
        arguments.insert(arguments.end(), {"--set", setting});
      const std::string out = nsfd(workspace, arguments).out;
      const std::size_t begin = out.rfind("certificate: ");
      return begin == std::string::npos ? out : out.substr(begin);
    }
  } // namespace

  TEST(Certificates, OfAGoodRun)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "ball", {scene("ball"), {}, 1, true});
    EXPECT_TRUE(result.summary.at("certificate").at("ok").get<bool>());
    for (const char *line :
         {"end", "residual", "penetration", "balance residual",
          "given by impact", "given by time scheme", "uniqueness",
          "rejected steps"})
      EXPECT_EQ(verdict(result, line), "ok") << line;
    EXPECT_EQ(verdict(result, "cohesive zone"), "none");
    const auto &residual =
        result.summary.at("certificate").at("lines").at("residual");
    EXPECT_EQ(residual.at("value"), result.summary.at("residual_max"));
    EXPECT_EQ(residual.at("bound"), 1e-8);
    const std::string last = last_lines(workspace, scene("ball"));
    EXPECT_EQ(last.substr(0, last.find('\n')), "certificate: ok");
    EXPECT_LT(last.find("rejected steps"), last.find("energy at the end"))
        << "the profile comes later\n"
        << last;
    const std::string page = read_text(result.directory / "report.html");
    EXPECT_NE(page.find("certificate: ok</p>"), std::string::npos);
  }

  TEST(Certificates, OfAStepBeyondUniqueness)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "long_steps",
                 {scene("midplane"), {"Time/step=2 courant"}, 1, true});
    ASSERT_GT(result.counter("steps_beyond_uniqueness"), 0.);
    EXPECT_EQ(verdict(result, "uniqueness"), "not ok");
    EXPECT_NE(result.summary.at("certificate")
                  .at("lines")
                  .at("uniqueness")
                  .at("remark")
                  .get<std::string>()
                  .find("set step = auto"),
              std::string::npos);
    const std::string page = read_text(result.directory / "report.html");
    EXPECT_EQ(page.find("state good"), std::string::npos);
    EXPECT_NE(page.find("<p class=\"state bad\">⚠ Completed"),
              std::string::npos);
    EXPECT_FALSE(result.summary.at("certificate").at("ok").get<bool>());
  }

  TEST(Certificates, OfEquilibria)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "static", {scene("static_crossed")});
    EXPECT_EQ(verdict(result, "imbalance"), "ok");
    EXPECT_EQ(verdict(result, "solution jumps"), "ok");
    EXPECT_EQ(verdict(result, "residual"), "no such line") << "no step in time";
  }

  TEST(Certificates, OfAnIntegrator)
  {
    const Workspace workspace;
    const Result result = good_run(
        workspace, "smooth",
        {scene("mode"),
         {"Time/scheme=arkode", "Time/pairs=explicit", "Time/step=20 us"}});
    EXPECT_EQ(verdict(result, "residual"), "not measured");
    EXPECT_FALSE(result.summary.at("certificate").at("ok").get<bool>());
    EXPECT_EQ(result.summary.at("certificate").at("verdict"),
              "ok as far as measured, 1 of 13 lines are not");
  }

  // Corners slide over the ends of bodies that turn, and off them: no point is
  // deeper than it came in by.
  TEST(Certificates, OfAFallingWall)
  {
    const Workspace workspace;
    const Result result = good_run(
        workspace, "wall", {benchmark("falling_wall"), {"Time/end=0.5 s"}});
    EXPECT_GT(result.number("penetration_max"), 1e-4);
    EXPECT_EQ(verdict(result, "penetration"), "ok");
    EXPECT_EQ(verdict(result, "balance residual"), "ok");
  }

  // ------------------------------------------------ what the method assumes

  const char *const one_body = R"(
set dimension = 2
subsection Constants
  set v = 0
  set w = 0
  set Y = 0
end
subsection Mesh
  set type         = rectangle
  set lower corner = -0.1, Y
  set upper corner = 0.1, Y + 0.04
  set cells        = 2, 1
end
subsection Material: m
  set model         = linear elastic
  set Young modulus = 3 GPa
  set Poisson ratio = 0.3
  set density       = 1200
  set initial velocity x = if(x < 0, -v, v) - w*(y - Y - 0.02)
  set initial velocity y = w*x
end
)";

  TEST(Certificates, OfABodyThatTurns)
  {
    const Workspace workspace;
    const auto file = write(workspace, "turn.prm", std::string(one_body) + R"(
subsection Interface: seam
  set law       = michel-suquet
  set stiffness = 1e12
  set strength  = 30 MPa
end
subsection Time
  set end  = 3 ms
  set step = 20 us
end
)");
    const Result turned = run(workspace, "turned", {file, {"Constants/w=100"}});
    ASSERT_TRUE(turned.completed()) << turned.description();
    EXPECT_EQ(verdict(turned, "rotation"), "not ok");
    EXPECT_NEAR(turned.summary.at("certificate")
                    .at("lines")
                    .at("rotation")
                    .at("value")
                    .get<double>(),
                0.3, 0.03)
        << "rad";
    EXPECT_TRUE(has_note(workspace, file, "Constants/w=100"));
    EXPECT_FALSE(has_note(workspace, file, "Constants/w=10"));
    const Result little = run(workspace, "little", {file, {"Constants/w=10"}});
    EXPECT_EQ(verdict(little, "rotation"), "ok");
    EXPECT_EQ(verdict(little, "strain"), "ok");
  }

  TEST(Certificates, OfABodyThatIsPulledLong)
  {
    const Workspace workspace;
    const auto file = write(workspace, "pull.prm", std::string(one_body) + R"(
subsection Interface: joined
  set law = rigid
end
subsection Boundary: right
  set displacement x = D * min(1, t / (1 ms))
end
subsection Boundary: left
  set velocity x = 0
end
subsection Time
  set end  = 1 ms
  set step = 20 us
end
)");
    const Result far = run(workspace, "far", {file, {"Constants/D=0.04"}});
    ASSERT_TRUE(far.completed()) << far.description();
    EXPECT_EQ(verdict(far, "strain"), "not ok");
    EXPECT_TRUE(has_note(workspace, file, "Constants/D=0.04"));
    const Result near = run(workspace, "near", {file, {"Constants/D=0.001"}});
    EXPECT_EQ(verdict(near, "strain"), "ok");
  }

  TEST(Certificates, OfJointsThatStartApart)
  {
    const Workspace workspace;
    const auto file = write(workspace, "joints.prm", std::string(one_body) + R"(
subsection Interface: joined
  set law = rigid
end
subsection Time
  set end  = 1 ms
  set step = 20 us
end
)");
    const Result apart = run(workspace, "apart", {file, {"Constants/v=1"}});
    EXPECT_EQ(verdict(apart, "joints"), "not ok");
    const Result one = run(workspace, "one", {file, {"Constants/w=1"}});
    EXPECT_EQ(verdict(one, "joints"), "ok");
  }

  // At rest means at rest: overlaps of the size of round-off are none.
  TEST(Certificates, OfABlockAtRest)
  {
    const Workspace workspace;
    const auto file = write(workspace, "rest.prm", R"(
set dimension = 2
subsection Constants
  set Y = 0
end
subsection Mesh
  set type         = rectangle
  set lower corner = 0, Y + 0.3
  set upper corner = 1, Y + 0.5
  set cells        = 1, 1
end
subsection Material: block
  set model   = rigid
  set density = 1000
end
subsection Interface: none
  set law = rigid
end
subsection Obstacle: floor
  set where       = bottom
  set point       = 0, 0.3 + Y
  set normal      = 0, 1
  set friction    = 0.5
  set restitution = 0.5
end
subsection Loads
  set gravity = 0, -9.81
end
subsection Time
  set end  = 0.3
  set step = 10 ms
end
)");
    for (const char *height : {"0", "0.1", "1e4", "-777.7"}) {
      const Result result = run(workspace, std::string("rest") + height,
                                {file, {std::string("Constants/Y=") + height}});
      ASSERT_TRUE(result.completed()) << result.description();
      for (const char *line :
           {"penetration", "balance residual", "given by friction",
            "given by impact", "given by time scheme"})
        EXPECT_EQ(verdict(result, line), "ok")
            << line << " at " << height << "\n"
            << result.outcome.out;
    }
  }

  TEST(Certificates, OfBodiesThatFlyFartherThanTheyAreThickInAStep)
  {
    const Workspace workspace;
    const auto file = write(workspace, "fly.prm", R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: shot
  set type         = rectangle
  set lower corner = 0, -0.05
  set upper corner = 0.1, 0.05
  set cells        = 1, 1
end
subsection Body: foil
  set type         = rectangle
  set lower corner = 0.15, -0.5
  set upper corner = 0.16, 0.5
  set cells        = 1, 1
end
subsection Material: shot
  set where   = shot
  set model   = rigid
  set density = 1000
  set initial velocity x = 10
end
subsection Material: foil
  set where   = foil
  set model   = rigid
  set density = 1000
end
subsection Interface: all
  set law = rigid
end
subsection Contact: all
  set friction = 0
end
subsection Time
  set end  = 30 ms
  set step = 3 ms
end
)");
    for (const char *const step : {"0.5 ms", "3 ms", "8.5 ms"}) {
      const Result result =
          good_run(workspace, std::string("fly ") + step,
                   {file, {std::string("Time/step=") + step}});
      ASSERT_TRUE(result.completed()) << result.description();
      // both have 10 kg per metre: 5 m/s each
      EXPECT_NEAR(result.history["kinetic"].back(), 250., 1e-6) << step;
      EXPECT_EQ(verdict(result, "penetration"), "ok") << step;
    }
    // a step that may not be cut is no result
    const Result failed =
        run(workspace, "failed",
            {file, {"Time/step=8.5 ms", "Time/maximum bisections=0"}});
    EXPECT_EQ(failed.outcome.exit_code, 3) << failed.description();
    EXPECT_NE(failed.outcome.err.find("would fly through a body of foil"),
              std::string::npos)
        << failed.outcome.err;
  }

  // explicit steps do not look for what they pass over: cells bound them, but
  // an obstacle may be thinner
  TEST(Certificates, OfExplicitStepsLongerThanAnObstacleIsThick)
  {
    const Workspace workspace;
    const auto file = write(workspace, "wire.prm", R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 0.1, 0.1
  set cells        = 1, 1
end
subsection Material: m
  set model              = neo-hookean
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.3
  set density            = 1000
  set initial velocity x = 1
end
subsection Interface: all
  set law = joined
end
subsection Obstacle: wire
  set where  = all
  set shape  = sphere
  set point  = 0.5, 0.2
  set radius = 1 um
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 10 ms
end
)");
    const Result thin = run(workspace, "thin", {file});
    ASSERT_TRUE(thin.completed()) << thin.description();
    EXPECT_EQ(verdict(thin, "way of a step"), "not ok");
    EXPECT_TRUE(has_note(workspace, file, "Time/end=10 ms"));
    const Result thick =
        run(workspace, "thick", {file, {"Obstacle: wire/radius=10 mm"}});
    EXPECT_EQ(verdict(thick, "way of a step"), "ok");
  }

  // motion = small makes a body that turns by w longer by sqrt(1 + w^2), 3.3
  // times at half a revolution, whatever the scheme
  TEST(Certificates, OfBodiesThatTurnByHalfARevolution)
  {
    const Workspace workspace;
    const auto file = write(workspace, "spin.prm", R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = -0.5, -0.5
  set upper corner = 0.5, 0.5
  set cells        = 2, 2
end
subsection Material: m
  set model              = linear elastic
  set Young modulus      = 1 GPa
  set Poisson ratio      = 0.2
  set density            = 1000
  set initial velocity x = -10 * y
  set initial velocity y = 10 * x
end
subsection Interface: all
  set law = joined
end
subsection Time
  set end  = pi / 10
  set step = 1 ms
end
)");
    for (const auto &[scheme, step] :
         std::vector<std::pair<std::string, std::string>>{
             {"moreau-jean", "1 ms"},
             {"explicit", "auto"},
             {"symplectic", "auto"},
             {"arkode", "1 ms"}}) {
      const Result result =
          run(workspace, "spin " + scheme,
              {file, {"Time/scheme=" + scheme, "Time/step=" + step}});
      ASSERT_TRUE(result.completed()) << result.description();
      EXPECT_EQ(verdict(result, "rotation"), "not ok") << scheme;
      EXPECT_EQ(verdict(result, "strain"), "ok") << scheme;
      // at 0.1 rad it is within its bound
      const Result half = run(
          workspace, "less " + scheme,
          {file,
           {"Time/scheme=" + scheme, "Time/step=" + step, "Time/end=9.9 ms"}});
      EXPECT_EQ(verdict(half, "rotation"), "ok") << scheme;
    }
  }

  TEST(Certificates, OfAFailedRun)
  {
    const Workspace workspace;
    const std::vector<std::string> too_hard = {
        "Solver/maximum iterations=1", "Solver/method=dual newton",
        "Time/maximum bisections=0", "Solver/tolerance=1e-13"};
    const Result result = run(workspace, "failed", {torn_plate(), too_hard});
    ASSERT_EQ(result.outcome.exit_code, 3) << result.description();
    EXPECT_EQ(verdict(result, "end"), "not ok");
    const std::string last = last_lines(workspace, torn_plate(), too_hard);
    EXPECT_NE(last.find("not reached: the step of"), std::string::npos) << last;
  }

  TEST(Certificates, SurviveARestart)
  {
    const Workspace workspace;
    const Launch what = {
        torn_plate(),
        {"Mesh/cells=12, 9", "Time/step=0.8 us", "Time/end=40 us"}};
    const Result whole = good_run(workspace, "whole", what);
    const Launch stored = storing(what, 20);
    good_run(workspace, "resumed", stored);
    std::filesystem::remove(newest(workspace.path() / "resumed"));
    const Result after = resume(workspace, "resumed", stored);
    ASSERT_TRUE(after.completed()) << after.description();
    EXPECT_EQ(whole.summary.at("certificate"), after.summary.at("certificate"));
  }

  TEST(Certificates, AreNotOnAQuietTerminal)
  {
    const Workspace workspace;
    const Outcome outcome = nsfd(workspace, {scene("ball").string(), "--quiet",
                                             "--set", "Time/end=0.1"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.out, "");
  }
} // namespace end_to_end::test_certificate
