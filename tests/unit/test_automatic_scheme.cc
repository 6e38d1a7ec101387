#include "input/read_scene.h"
#include "simulation/choose_scheme.h"

#include <gtest/gtest.h>

#include <string>

// `scheme = auto`: what is predicted to come to the end at less cost.

namespace nsfd::test_automatic_scheme
{
  namespace
  {
    std::string plate(const std::string &material, const std::string &time)
    {
      return R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 1 m, 1 m
  set cells        = 4, 4
end
subsection Material: plate
  set Young modulus = 1 Pa
  set Poisson ratio = 0
  set density       = 1 kg/m^3
)" + material +
             R"(end
subsection Interface: all
  set law = joined
end
subsection Time
  set scheme = auto
)" + time + "end\n";
    }

    std::unique_ptr<SceneInput> read(const std::string &text)
    {
      InputErrors errors;
      auto scene = read_scene_text(text, "test.prm", {}, errors);
      EXPECT_NE(scene, nullptr) << errors.report();
      return scene;
    }

    SceneInput chosen(const std::string &text)
    {
      const auto scene = read(text);
      return *choose_scheme(*scene, false, Communicator(MPI_COMM_SELF)).scene;
    }
  } // namespace

  // A cell of 1/4 m is crossed in 1/4 s: explicit steps have the same length.
  TEST(AutomaticScheme, WavesAreFollowedByExplicitSteps)
  {
    const SceneInput scene = chosen(plate("", "  set end = 10 s\n"));
    EXPECT_EQ(scene.time.scheme_name, "explicit");
    EXPECT_EQ(scene.time.step_kind, StepKind::automatic);
    EXPECT_NE(scene.echo.find("explicit #"), std::string::npos)
        << "a run of the echo takes the same steps";
    EXPECT_EQ(scene.scheme_choice.find("explicit: "), 0u);
  }

  TEST(AutomaticScheme, LongStepsAreImplicit)
  {
    // some 10 explicit steps in 1 s
    EXPECT_EQ(chosen(plate("", "  set end = 200 s\n  set step = 1 s\n"))
                  .time.scheme_name,
              "explicit");
    const SceneInput scene =
        chosen(plate("", "  set end = 20000 s\n  set step = 100 s\n"));
    EXPECT_EQ(scene.time.scheme_name, "moreau-jean");
    EXPECT_DOUBLE_EQ(scene.time.step, 100.);
    EXPECT_NE(scene.echo.find("moreau-jean #"), std::string::npos);
  }

  TEST(AutomaticScheme, ShorterStepsThanNeededAreTakenAsGiven)
  {
    const SceneInput scene =
        chosen(plate("", "  set end = 1 s\n  set step = 1 ms\n"));
    EXPECT_EQ(scene.time.scheme_name, "explicit");
    EXPECT_EQ(scene.time.step_kind, StepKind::time);
    EXPECT_DOUBLE_EQ(scene.time.step, 1e-3);
  }

  // What explicit steps are refused for has implicit ones, and says why.
  TEST(AutomaticScheme, WhatIsNotExplicitIsImplicit)
  {
    const std::string law = "  set law = joined\n";
    std::string text = plate("", "  set end = 1 s\n");
    text.replace(text.find(law), law.size(),
                 "  set law = rcc\n  set stiffness = 1 Pa/m\n"
                 "  set adhesion energy = 1 J/m^2\n  set friction = 0.3\n"
                 "  set dilatancy = 0.1\n");
    const SceneInput scene = chosen(text);
    EXPECT_EQ(scene.time.scheme_name, "moreau-jean");
    EXPECT_NE(scene.scheme_choice.find("dilatancy"), std::string::npos)
        << scene.scheme_choice;
  }

  // No wave says how long explicit steps of rigid bodies may be: they are those
  // of the scene.
  TEST(AutomaticScheme, RigidBodiesTakeTheStepsOfTheScene)
  {
    const std::string text = R"(
set motion = large
subsection Mesh
  set type         = rectangle
  set upper corner = 1, 1
  set cells        = 2, 2
end
subsection Material: stone
  set model   = rigid
  set bodies  = connected
  set density = 1 kg/m^3
end
subsection Interface: all
  set law = joined
end
subsection Time
  set scheme = auto
  set step   = 0.1 s
  set end    = 1 s
end
)";
    const SceneInput scene = chosen(text);
    EXPECT_EQ(scene.time.scheme_name, "explicit");
    EXPECT_EQ(scene.time.step, 0.1);
    EXPECT_NE(scene.scheme_choice.find("all bodies are rigid"),
              std::string::npos)
        << scene.scheme_choice;
  }

  TEST(AutomaticScheme, WhatIsNotImplicitIsExplicit)
  {
    const auto scene =
        read(plate("", "  set end = 1 s\n  set front viscosity = 0.1\n"));
    EXPECT_EQ(scene->time.scheme_name, "explicit");
    EXPECT_EQ(scene->automatic, nullptr);
  }

  TEST(AutomaticScheme, IsPrintedAsItWasWritten)
  {
    const auto scene = read(plate("", "  set end = 1 s\n"));
    EXPECT_NE(scene->echo.find("= auto # moreau-jean"), std::string::npos)
        << scene->echo;
  }

  // Who gives neither a scheme nor a step leaves both to the program.
  TEST(AutomaticScheme, IsTheDefaultWhereNoStepIsGiven)
  {
    const auto chosen = [](const std::string &time) {
      std::string text = plate("", time);
      text.erase(text.find("  set scheme = auto\n"),
                 std::string("  set scheme = auto\n").size());
      return choose_scheme(*read(text), false, Communicator(MPI_COMM_SELF))
          .scene->time.scheme_name;
    };
    EXPECT_EQ(chosen("  set end = 1 s\n"), "explicit");
    EXPECT_EQ(chosen("  set end = 1 s\n  set theta = 0.6\n"), "moreau-jean");
  }

  // Who gives a step has implicit ones, and is told what others cost.
  TEST(AutomaticScheme, IsAdvisedWhereNoSchemeIsNamed)
  {
    const auto advice = [](const std::string &time, const bool check) {
      std::string text = plate("", time);
      text.erase(text.find("  set scheme = auto\n"),
                 std::string("  set scheme = auto\n").size());
      const SceneInput scene =
          *choose_scheme(*read(text), check, Communicator(MPI_COMM_SELF)).scene;
      EXPECT_EQ(scene.time.scheme_name, "moreau-jean");
      return scene.scheme_choice;
    };
    const std::string start = "moreau-jean, as `step` is given; scheme = auto ";
    const std::string as_long = "  set end = 10 s\n  set step = 0.5 courant\n";
    EXPECT_EQ(advice(as_long, false).find(start), 0u);
    const std::string checked = advice(as_long, true);
    EXPECT_EQ(checked.find(start), 0u);
    EXPECT_NE(checked.find("explicit steps of"), std::string::npos);
    const std::string steps = "  set end = 20000 s\n  set step = 100 s\n";
    EXPECT_EQ(advice(steps, true), "");
    EXPECT_EQ(advice(steps, false), "");
  }

  TEST(AutomaticScheme, ErrorsAreSaidOnce)
  {
    InputErrors errors;
    EXPECT_EQ(read_scene_text(plate("", "  set end = -1 s\n"), "test.prm", {},
                              errors),
              nullptr);
    EXPECT_EQ(errors.n_errors(), 1u) << errors.report();
  }
} // namespace nsfd::test_automatic_scheme
