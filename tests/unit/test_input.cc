#include "nonsmooth/solver.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "small_scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace nsfd::test_input
{
  using small_scene_text::read_good;
  using small_scene_text::replaced;
  using small_scene_text::report_of;
  using small_scene_text::small_scene;

  // --- scenes

  TEST(Scene, DefaultsOfASmallFile)
  {
    const auto scene = read_good(small_scene);
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->title, "small");
    EXPECT_EQ(scene->description, "the least that runs");
    EXPECT_EQ(scene->output.directory, "output/small");
    EXPECT_EQ(scene->mesh.type, "rectangle");
    EXPECT_EQ(scene->mesh.lower, (std::vector<double>{0., 0.}));
    EXPECT_EQ(scene->mesh.upper, (std::vector<double>{1e-5, 2e-5}));
    EXPECT_EQ(scene->mesh.cells, (std::vector<unsigned int>{2, 4}));
    EXPECT_EQ(scene->discretization.interface_points, 2u);
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_EQ(scene->materials[0].name, "bulk");
    EXPECT_EQ(scene->materials[0].young, 135e9);
    EXPECT_EQ(scene->materials[0].where.kind, Where::Kind::all);
    ASSERT_EQ(scene->interfaces.size(), 1u);
    EXPECT_EQ(scene->interfaces[0].law_name, "rigid");
    EXPECT_EQ(scene->interfaces[0].law, nullptr);
    EXPECT_EQ(scene->time.end, 10e-9);
    EXPECT_EQ(scene->time.step_kind, StepKind::courant);
    EXPECT_EQ(scene->time.step, 0.5);
    EXPECT_EQ(scene->solver.tolerance, 1e-8);
    EXPECT_EQ(scene->verification, nullptr);
  }

  TEST(Scene, ReadsWhatIsWritten)
  {
    const auto scene = read_good(R"(set dimension = 3
subsection Constants
  set L = 1 mm
  set half = L / 2
  set v0 = 2 m/s
end
subsection Mesh
  set type = notched plate
  set upper corner = 2 * L, L, L
  set cells = 4, 2, 2
  set notch length = half
  set notch height = L / 2
end
subsection Discretization
  set degree = 2
  set interface quadrature = gauss lobatto
  set interface points = degree + 1
end
subsection Material: hammer
  set where = x < half
  set model = rigid
  set density = 8 g/cm^3
  set initial velocity z = -v0
end
subsection Material: bulk
  set Young modulus = 1
  set Poisson ratio = 0
  set density = 1
  set body force y = 3 N/cm^3
end
subsection Interface: joint
  set where = between materials [bulk, hammer]
  set law = contact
  set friction = 0.3
  set restitution = 0.5
end
subsection Interface: glue
  set where = between materials
  set law = elastic
  set normal stiffness = 2 GPa/um
  set intact faces = unilateral
end
subsection Interface: weak
  set where = x > half
  set law = tvergaard
  set strength = 10 MPa
  set toughness = 10 J/m^2
  set friction exponent = 0
  set broken = x < 0.7 mm
  set strength factor = 1 + x / (4 * L)
  set strength scatter = 0.1
  set toughness scatter = 0.2
  set seed = 7
end
subsection Boundary: left
  set velocity x = v0 * sin(t / 1 us)
  set displacement y = 0
end
subsection Boundary: pushed
  set where = right
  set traction z = -1 MPa
end
subsection Obstacle: floor
  set where = back
  set point = 0, 0, -1 um
  set normal = 0, 3, 4
end
subsection Loads
  set gravity = 0, 0, -9.81 m/s^2
end
subsection Time
  set end = 3 * L / 1 km/s
  set step = 5 ns
  set theta = 0.6
  set cohesion rule = end point
  set contact target = velocity
  set sliding = increment
end
subsection Solver
  set method = gauss seidel
  set path = local
end
subsection Output
  set directory = here
  set fields = no
  set fields every steps = 3
end
)",
                                 {"Boundary: pushed/pressure=0.2 MPa"});
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->mesh.notch_length, 0.5e-3);
    EXPECT_EQ(scene->discretization.interface_points, 3u);
    EXPECT_TRUE(scene->materials[0].rigid);
    EXPECT_EQ(scene->materials[0].where.kind, Where::Kind::expression);
    EXPECT_DOUBLE_EQ(scene->materials[0].density, 8000.);
    EXPECT_EQ(scene->materials[0].initial_velocity[2](0., 0., 0.), -2.);
    EXPECT_DOUBLE_EQ(scene->materials[1].body_force[1](0., 0., 0.), 3e6);
    EXPECT_EQ(scene->interfaces[0].where.materials,
              (std::array<std::string, 2>{"bulk", "hammer"}));
    EXPECT_EQ(scene->interfaces[0].restitution, 0.5);
    EXPECT_EQ(scene->interfaces[1].where.kind, Where::Kind::between_materials);
    EXPECT_EQ(scene->interfaces[1].where.materials[0], "");
    EXPECT_EQ(scene->interfaces[1].tangential_stiffness, 2e15);
    EXPECT_EQ(scene->interfaces[1].intact, IntactFaces::unilateral);
    ASSERT_NE(scene->interfaces[2].law, nullptr);
    EXPECT_DOUBLE_EQ(scene->interfaces[2].law->strength(), 10e6);
    EXPECT_EQ(scene->interfaces[2].friction_exponent, 0.);
    EXPECT_TRUE(scene->interfaces[2].has_broken);
    EXPECT_EQ(scene->interfaces[2].seed, 7u);
    EXPECT_GT(scene->interfaces[2].strength_factor(1., 0., 0.), 1.);
    EXPECT_EQ(scene->interfaces[2].toughness_factor(1., 0., 0.), 1.);
    EXPECT_EQ(scene->interfaces[2].strength_scatter.kind,
              Scatter::Kind::uniform);
    EXPECT_EQ(scene->interfaces[2].strength_scatter.parameter, 0.1);
    EXPECT_EQ(scene->interfaces[2].toughness_scatter.parameter, 0.2);
    EXPECT_EQ(scene->boundaries[0].where.kind, Where::Kind::side);
    EXPECT_EQ(scene->boundaries[0].where.name, "left");
    EXPECT_TRUE(scene->boundaries[0].velocity[0].has_value());
    EXPECT_TRUE(scene->boundaries[0].displacement[1]->is_zero());
    EXPECT_FALSE(scene->boundaries[0].has_traction);
    EXPECT_TRUE(scene->boundaries[1].has_traction);
    EXPECT_EQ(scene->boundaries[1].pressure(0., 0., 0.), 2e5);
    EXPECT_DOUBLE_EQ(scene->obstacles[0].normal[1], 0.6);
    EXPECT_DOUBLE_EQ(scene->obstacles[0].normal[2], 0.8);
    EXPECT_EQ(scene->gravity[2], -9.81);
    EXPECT_DOUBLE_EQ(scene->time.end, 3e-6);
    EXPECT_EQ(scene->time.step_kind, StepKind::time);
    EXPECT_EQ(scene->time.step, 5e-9);
    EXPECT_EQ(scene->time.cohesion_rule, CohesionRule::end_point);
    EXPECT_EQ(scene->time.contact_target, ContactTarget::velocity);
    EXPECT_EQ(scene->time.sliding, Sliding::increment);
    EXPECT_EQ(scene->solver.method, "gauss seidel");
    EXPECT_EQ(scene->output.directory, "here");
    EXPECT_FALSE(scene->output.fields);
  }

  TEST(Scene, SeveralBodiesAndGroups)
  {
    const std::string text = replaced(
        replaced(small_scene,
                 "  set upper corner = 10 um, 20 um\n  set cells = 2, 4\nend\n",
                 "  set type = bodies\n  set refinements = 1\nend\n"
                 "subsection Body: lower\n  set upper corner = 1, 1\n"
                 "  set cells = 1, 1\nend\n"
                 "subsection Body: upper block\n  set lower corner = 0, 1\n"
                 "  set upper corner = 1, 2\n  set cells = 2, 2\nend\n"),
        "subsection Material: bulk\n",
        "subsection Material: bulk\n  set where = upper block\n");
    const auto scene = read_good(text);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->bodies.size(), 2u);
    EXPECT_EQ(scene->mesh.refinements, 1u);
    EXPECT_EQ(scene->bodies[1].name, "upper block");
    EXPECT_EQ(scene->bodies[1].mesh.cells, (std::vector<unsigned int>{2, 2}));
    EXPECT_EQ(scene->materials[0].where.kind, Where::Kind::group);
    EXPECT_EQ(scene->materials[0].where.name, "upper block");
    EXPECT_NE(report_of(replaced(text, "where = upper block", "where = uper"))
                  .find("has no such group"),
              std::string::npos);
  }

  TEST(Scene, StepKinds)
  {
    const auto step = [](const std::string &value) {
      return read_good(small_scene, {"Time/step=" + value})->time;
    };
    EXPECT_EQ(step("auto").step_kind, StepKind::automatic);
    EXPECT_EQ(step("2 courant").step, 2.);
    EXPECT_EQ(step("0.6courant").step_kind, StepKind::courant);
    EXPECT_EQ(step("1e-9").step_kind, StepKind::time);
    EXPECT_EQ(step("2e-3 ns").step, 2e-12);
  }

  TEST(Scene, ExplicitStepsAreAutomaticUnlessTheyAreGiven)
  {
    const std::string text = R"(
set dimension = 2
subsection Mesh
  set type = rectangle
  set upper corner = 1, 1
  set cells = 2, 2
end
subsection Material: bulk
  set Young modulus = 1e9
  set Poisson ratio = 0.3
  set density = 1000
end
subsection Interface: all
  set law = joined
end
subsection Time
  set end = 1e-3
  set scheme = moreau-jean
end
)";
    EXPECT_EQ(read_good(text)->time.step_kind, StepKind::courant);
    const std::vector<std::string> scheme = {"Time/scheme=explicit"};
    EXPECT_EQ(read_good(text, scheme)->time.step_kind, StepKind::automatic);
    EXPECT_EQ(
        read_good(text, {scheme[0], "Time/step=0.1 courant"})->time.step_kind,
        StepKind::courant);
  }

  TEST(Scene, EveryRegisteredSolverCanBeNamed)
  {
    for (const std::string &name : SolverRegistry<2>::instance().names())
      EXPECT_EQ(
          read_good(small_scene, {"Solver/method=" + name})->solver.method,
          name);
  }

  TEST(Scene, WarningsDoNotStopARun)
  {
    InputErrors errors;
    const auto scene =
        read_scene_text(replaced(small_scene, "set law = rigid",
                                 "set law = contact\n  set restitution = 1"),
                        "small.prm", {"Time/theta=0.8"}, errors);
    EXPECT_NE(scene, nullptr);
    EXPECT_FALSE(errors.has_errors());
    EXPECT_NE(errors.report().find("--set: warning: theta = 0.8 is above "
                                   "1/(1 + e) = 0.5"),
              std::string::npos)
        << errors.report();
  }

  TEST(Scene, EchoIsCompleteAndReadsBackTheSame)
  {
    const auto first =
        read_good(small_scene, {"Discretization/degree=3",
                                "Boundary: left/velocity x=2 m/s * cos(t)",
                                "Constants/unused=3 um"});
    ASSERT_NE(first, nullptr);
    for (const char *line :
         {"# small - the least that runs", "set dimension  = 2",
          "set theta              = 0.5", "  set degree               = 3",
          "  set velocity x       = 2 m/s * cos(t)", "subsection Solver",
          "  # set pressure"})
      EXPECT_NE(first->echo.find(line), std::string::npos) << line << "\n"
                                                           << first->echo;

    const auto second = read_good(first->echo);
    ASSERT_NE(second, nullptr);
    EXPECT_EQ(second->echo, first->echo);
    EXPECT_EQ(second->discretization.degree, 3u);
    EXPECT_EQ(second->title, "small");
  }

  TEST(Overrides, ReplaceAddAndCreate)
  {
    const auto scene = read_good(
        small_scene, {"Time/end=20 ns", "Material: bulk/Poisson ratio = 0.1",
                      "Interface:all/law=contact", "plane=stress",
                      "Boundary: right/velocity x=1", "Mesh/refinements=2"});
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->time.end, 20e-9);
    EXPECT_EQ(scene->materials[0].poisson, 0.1);
    EXPECT_EQ(scene->interfaces[0].law_name, "contact");
    EXPECT_TRUE(scene->plane_stress);
    EXPECT_EQ(scene->boundaries.size(), 1u);
    EXPECT_EQ(scene->mesh.refinements, 2u);
  }

  TEST(Overrides, FaultsNameTheOption)
  {
    EXPECT_EQ(report_of(small_scene, {"Time/theta=0.2"}),
              "--set: error: theta = 0.2 must be at least 0.5: below it every "
              "step grows, as forward Euler does\n"
              "     | Time/theta=0.2\n"
              "     |            ^~~\n"
              "  write for example: 0.5\n"
              "1 error, nothing was run\n");
    const auto fails = [](const std::string &assignment,
                          const std::string &message) {
      const std::string report = report_of(small_scene, {assignment});
      EXPECT_NE(report.find(message), std::string::npos) << report;
    };
    fails("Tme/theta=0.5", "did you mean `Time`?");
    fails("Time/teta=0.5", "did you mean `theta`?");
    // the file gives `cells`, and --set may replace it
    fails("Mesh/cels=4, 4", "did you mean `cells`?");
    fails("Interfce: all/law=rigid", "did you mean `Interface: all`?");
    fails("Material: steel/density=3", "`Young modulus` is missing");
    fails("Mesh: big/cells=3, 3", "section `Mesh` takes no name");
    fails("nonsense", "assigns nothing");
    fails("=3", "assigns nothing");
    fails("Time/=3", "assigns nothing");
    fails("Time/theta=0.5 # comment", "cannot hold a comment");
    EXPECT_NE(report_of(small_scene, {"Time/theta=0.5", "Time/theta=0.6"})
                  .find("set twice on the command line"),
              std::string::npos);
  }
} // namespace nsfd::test_input
