#include "input/read_scene.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include "simulation/motion_report.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

// Entries of scenes with motion = large, and everything that does not fit to
// it. Every wrong case changes one place of a scene that is right, and gives
// one error, at its line.

namespace nsfd::test_large_motion_input
{
  namespace
  {
    const std::string space = R"(# drum - a ball and a soft block in a drum
set dimension = 3
set motion = large
subsection Mesh
  set type = brick
  set upper corner = 3 mm, 1 mm, 1 mm
  set cells = 3, 1, 1
end
subsection Material: stone
  set where = x < 1 mm
  set model = rigid
  set density = 2 g/cm^3
  set bodies = connected
  set surface = ball
  set mass = 3 mg
  set principal inertia = 1 g*mm^2, 2 g*mm^2, 3 g*mm^2
end
subsection Material: rubber
  set where = x < 2 mm
  set model = neo-hookean
  set Young modulus = 1 MPa
  set Poisson ratio = 0.45
  set density = 1 g/cm^3
end
subsection Material: steel
  set model = saint-venant kirchhoff
  set Young modulus = 200 GPa
  set Poisson ratio = 0.3
  set density = 7.8 g/cm^3
end
subsection Interface: seam
  set law = camacho-ortiz
  set strength = 1 MPa
  set toughness = 1 J/m^2
  set friction = 0.5
  set dilatancy = 0.1
  set opening viscosity = 1 Pa*s/m
  set crack pressure = 1 kPa
end
subsection Boundary: right
  set pressure = 1 kPa
end
subsection Obstacle: floor
  set point = 0, 0, -1 mm
  set normal = 0, 3, 4
end
subsection Obstacle: drum
  set shape = cylinder
  set point = 0, 0, 1 mm
  set axis = 0, 0, 2
  set radius = 1 cm
  set hollow = true
end
subsection Obstacle: hammer
  set shape = sphere
  set point = 9 mm, 1 mm, 2 mm
  set radius = 2 mm
  set velocity x = -3 m/s * cos(t / 1 ms)
  set velocity z = 1 m/s
  set restitution = 0.5
end
subsection Contact: stone on rubber
  set between = [stone, rubber]
  set friction = 0.7
  set wear coefficient = 1e-6 1/MPa
end
subsection Contact: others
  set restitution = 0.25
end
subsection Pin: hinge
  set material = stone
  set at = 1 mm, 2 mm, 3 mm
end
subsection Time
  set end = 1 ms
  set step = 1 us
end
subsection Solver
  set path = auto
end
)";

    const std::string plane = R"(# disc - a disc beside a strip
set dimension = 2
set plane = stress
set motion = large
subsection Mesh
  set upper corner = 2 km, 1 km
  set cells = 2, 1
end
subsection Material: rock
  set where = x < 1 km
  set model = rigid
  set density = 2 g/cm^3
end
subsection Material: ice
  set model = saint-venant kirchhoff
  set Young modulus = 9 GPa
  set Poisson ratio = 0.3
  set density = 0.9 g/cm^3
end
subsection Interface: all
  set law = contact
end
subsection Obstacle: hill
  set shape = sphere
  set point = 1 km, -5 km
  set radius = 4 km
end
subsection Time
  set end = 1 s
end
)";

    const std::string small = R"(# still - small motions
set dimension = 2
subsection Mesh
  set upper corner = 2, 1
  set cells = 2, 1
end
subsection Material: rock
  set where = x < 1
  set model = rigid
  set density = 1
end
subsection Material: ice
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density = 1
end
subsection Interface: all
  set law = rigid
end
subsection Obstacle: floor
  set shape = plane
  set point = 0, 0
  set normal = 0, 1
end
subsection Time
  set end = 1
end
)";

    std::string replaced(std::string text, const std::string &from,
                         const std::string &to)
    {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << "no `" << from << "`";
      return at == std::string::npos ? text : text.replace(at, from.size(), to);
    }

    std::unique_ptr<SceneInput>
    read_good(const std::string &text,
              const std::vector<std::string> &overrides = {})
    {
      InputErrors errors;
      auto scene = read_scene_text(text, "good.prm", overrides, errors);
      EXPECT_EQ(errors.report(), "");
      return scene;
    }

    struct Refusal {
      std::string name;
      const std::string *base;
      std::string old_text; ///< part of the base scene
      std::string new_text;
      std::string message; ///< part of the message
      std::string advice;  ///< part of what to write instead
      std::string place;   ///< part of the line that is blamed
    };

    const std::string rigid_stone = "set bodies = connected";
    const std::string inertia =
        "set principal inertia = 1 g*mm^2, 2 g*mm^2, 3 g*mm^2";
    const std::string pair = "set between = [stone, rubber]";

    const std::vector<Refusal> refusals = {
        {"misspelt_motion", &space, "motion = large", "motion = lrage",
         "motion = lrage is neither small nor large", "did you mean `large`?",
         "set motion = lrage"},
        {"another_motion", &space, "motion = large", "motion = finite",
         "motion = finite is neither small nor large", "", "set motion"},
        {"misspelt_small", &small, "dimension = 2\n",
         "dimension = 2\nset motion = smal\n",
         "motion = smal is neither small nor large", "did you mean `small`?",
         "set motion = smal"},

        // --- materials
        {"linear_elastic", &space, "model = neo-hookean",
         "model = linear elastic", "model = linear elastic is for bodies that",
         "saint-venant kirchhoff or neo-hookean", "set model = linear"},
        {"linear_elastic_by_default", &plane,
         "  set model = saint-venant kirchhoff\n", "",
         "model = linear elastic is for bodies that",
         "saint-venant kirchhoff or neo-hookean", "subsection Material: ice"},
        {"finite_strain_of_small_motion", &small, "set Young modulus",
         "set model = neo-hookean\n  set Young modulus",
         "model = neo-hookean is for large strains", "set motion = large",
         "set model = neo-hookean"},
        {"kirchhoff_of_small_motion", &small, "set Young modulus",
         "set model = saint-venant kirchhoff\n  set Young modulus",
         "model = saint-venant kirchhoff is for large strains",
         "set motion = large", "set model = saint-venant"},
        {"neo_hookean_plane_stress", &plane, "model = saint-venant kirchhoff",
         "model = neo-hookean", "is not there for plane = stress",
         "plane = strain, or model = saint-venant kirchhoff",
         "set model = neo-hookean"},
        {"misspelt_model", &space, "neo-hookean", "neo-hokean",
         "model = neo-hokean is not one of", "did you mean `neo-hookean`?",
         "set model = neo-hokean"},
        {"young_of_rigid", &plane, "set model = rigid",
         "set model = rigid\n  set Young modulus = 1 Pa",
         "the material is rigid", "remove", "set Young modulus = 1 Pa"},

        // --- rigid bodies
        {"bodies_word", &space, rigid_stone, "set bodies = joined",
         "bodies = joined is not one of: cells, connected", "",
         "set bodies = joined"},
        {"surface_word", &space, "surface = ball", "surface = sphere",
         "surface = sphere is not one of: mesh, ball", "",
         "set surface = sphere"},
        {"ball_of_cells", &space, rigid_stone, "set bodies = cells",
         "surface = ball is for bodies of several cells",
         "set bodies = connected", "set surface = ball"},
        {"mass_zero", &space, "mass = 3 mg", "mass = 0",
         "mass = 0 must be positive", "2 kg", "set mass = 0"},
        {"mass_in_space", &space, "mass = 3 mg", "mass = 3 kg/m",
         "`3 kg/m` is a mass per length; `mass` must be a mass", "2 kg",
         "set mass"},
        {"mass_in_the_plane", &plane, "set density = 2",
         "set mass = 3 kg\n  set density = 2",
         "`3 kg` is a mass; `mass` must be a mass per length", "2 kg/m",
         "set mass"},
        {"inertia_count", &space, inertia, "set principal inertia = 1, 2",
         "has 2 values, 3 are needed", "", "set principal inertia"},
        {"inertia_count_in_the_plane", &plane, "set density = 2",
         "set principal inertia = 1, 2, 3\n  set density = 2",
         "has 3 values, 1 are needed", "", "set principal inertia"},
        {"inertia_unit", &space, inertia,
         "set principal inertia = 1 kg, 2 kg*m^2, 3 kg*m^2",
         "`principal inertia` must be a moment of inertia", "kg*m^2",
         "set principal inertia"},
        {"inertia_unit_in_the_plane", &plane, "set density = 2",
         "set principal inertia = 3 kg*m^2\n  set density = 2",
         "must be a moment of inertia per length", "kg*m^2/m",
         "set principal inertia"},
        {"inertia_zero", &space, inertia, "set principal inertia = 1, 1, 0",
         "principal inertia = 0 must be positive", "", "set principal inertia"},
        {"inertia_above_the_others", &space, inertia,
         "set principal inertia = 1e-30, 2e-30, 3.0000001e-30",
         "about z is above 3e-30", "write at most 3e-30",
         "set principal inertia"},
        {"inertia_of_the_first_axis", &space, inertia,
         "set principal inertia = 9, 2, 3", "9 about x is above 5",
         "write at most 5", "set principal inertia"},
        {"bodies_of_small_motion", &small, "model = rigid",
         "model = rigid\n  set bodies = connected", "it needs motion = large",
         "remove", "set bodies"},
        {"surface_of_small_motion", &small, "model = rigid",
         "model = rigid\n  set surface = mesh", "it needs motion = large",
         "remove", "set surface"},
        {"mass_of_small_motion", &small, "model = rigid",
         "model = rigid\n  set mass = 1", "it needs motion = large", "remove",
         "set mass"},
        {"inertia_of_small_motion", &small, "model = rigid",
         "model = rigid\n  set principal inertia = 1",
         "it needs motion = large", "remove", "set principal inertia"},
        {"bodies_of_rubber", &space, "Poisson ratio = 0.45",
         "Poisson ratio = 0.45\n  set bodies = cells",
         "the material is not rigid", "remove", "set bodies = cells"},
        {"surface_of_rubber", &space, "Poisson ratio = 0.45",
         "Poisson ratio = 0.45\n  set surface = mesh",
         "the material is not rigid", "remove", "set surface = mesh"},
        {"mass_of_rubber", &space, "Poisson ratio = 0.45",
         "Poisson ratio = 0.45\n  set mass = 1", "the material is not rigid",
         "remove", "set mass = 1"},
        {"inertia_of_rubber", &space, "Poisson ratio = 0.45",
         "Poisson ratio = 0.45\n  set principal inertia = 1, 1, 1",
         "the material is not rigid", "remove", "set principal inertia = 1, 1"},
        {"mass_of_elastic_small_motion", &small, "set Young modulus",
         "set mass = 1\n  set Young modulus", "the material is not rigid",
         "remove", "set mass = 1"},

        // --- obstacles
        {"misspelt_shape", &space, "shape = sphere", "shape = spere",
         "shape = spere is not one of: plane, sphere, cylinder",
         "did you mean `sphere`?", "set shape = spere"},
        {"sphere_of_small_motion", &small, "shape = plane", "shape = sphere",
         "shape = sphere needs motion = large", "set motion = large",
         "set shape = sphere"},
        {"cylinder_in_the_plane", &plane, "shape = sphere", "shape = cylinder",
         "shape = cylinder needs dimension = 3", "write sphere",
         "set shape = cylinder"},
        {"sphere_without_radius", &plane, "  set radius = 4 km\n", "",
         "`radius` is missing in section `Obstacle: hill`",
         "set radius = ", "subsection Obstacle: hill"},
        {"radius_zero", &plane, "radius = 4 km", "radius = 0 km",
         "radius = 0 km must be positive", "", "set radius = 0 km"},
        {"radius_of_plane", &space, "set normal = 0, 3, 4",
         "set normal = 0, 3, 4\n  set radius = 1", "the obstacle is a plane",
         "remove", "set radius = 1"},
        {"axis_of_plane", &space, "set normal = 0, 3, 4",
         "set normal = 0, 3, 4\n  set axis = 1, 0, 0",
         "the obstacle is a plane", "remove", "set axis = 1, 0, 0"},
        {"hollow_plane", &space, "set normal = 0, 3, 4",
         "set normal = 0, 3, 4\n  set hollow = false",
         "the obstacle is a plane", "remove", "set hollow = false"},
        {"normal_of_sphere", &plane, "set radius = 4 km",
         "set radius = 4 km\n  set normal = 0, 1", "only a plane has one",
         "remove", "set normal = 0, 1"},
        {"normal_of_cylinder", &space, "set axis = 0, 0, 2",
         "set axis = 0, 0, 2\n  set normal = 0, 1, 0", "only a plane has one",
         "remove", "set normal = 0, 1, 0"},
        {"axis_of_sphere", &plane, "set radius = 4 km",
         "set radius = 4 km\n  set axis = 0, 1", "the obstacle is a sphere",
         "remove", "set axis = 0, 1"},
        {"cylinder_without_axis", &space, "  set axis = 0, 0, 2\n", "",
         "`axis` is missing in section `Obstacle: drum`",
         "set axis = ", "subsection Obstacle: drum"},
        {"axis_zero", &space, "axis = 0, 0, 2", "axis = 0, 0, 0",
         "axis = 0 has no direction", "0, 0, 1", "set axis = 0, 0, 0"},
        {"hollow_word", &space, "hollow = true", "hollow = inside",
         "hollow = inside is neither true nor false", "true or false",
         "set hollow = inside"},
        {"velocity_of_small_motion", &small, "set normal = 0, 1",
         "set normal = 0, 1\n  set velocity y = 1",
         "obstacles move only in scenes with motion = large", "remove",
         "set velocity y = 1"},
        {"velocity_of_the_place", &space, "velocity z = 1 m/s",
         "velocity z = 1 m/s * cos(y / 1 mm)", "an obstacle moves as a whole",
         "an expression of t", "set velocity z"},
        {"velocity_unit", &space, "velocity z = 1 m/s", "velocity z = 1 mm",
         "`velocity z` must be a velocity", "m/s", "set velocity z = 1 mm"},
        {"velocity_z_in_the_plane", &plane, "set radius = 4 km",
         "set radius = 4 km\n  set velocity z = 1", "dimension = 2 has no z",
         "remove", "set velocity z = 1"},

        // --- contacts
        {"contact_of_small_motion", &small, "subsection Time",
         "subsection Contact: any\n  set friction = 1\nend\nsubsection Time",
         "section `Contact: any` needs motion = large", "set motion = large",
         "subsection Contact: any"},
        {"contact_without_name", &space, "Contact: others", "Contact",
         "section `Contact` needs a name", "Contact: first",
         "subsection Contact"},
        {"misspelt_contact", &space, "Contact: others", "Contct: others",
         "`Contct: others` is not the name of a section",
         "did you mean `Contact: others`?", "subsection Contct"},
        {"contact_of_nothing", &space, pair, "set between = [stone, ruber]",
         "there is no material `ruber`", "did you mean `rubber`?",
         "set between = [stone, ruber]"},
        {"contact_of_one", &space, pair, "set between = stone",
         "between = stone does not name two materials", "[a, b]",
         "set between = stone"},
        {"contact_of_three", &space, pair,
         "set between = [stone, rubber, steel]", "does not name two materials",
         "[a, b]", "set between"},
        {"contact_friction", &space, "friction = 0.7", "friction = -0.7",
         "friction = -0.7 must not be negative", "", "set friction = -0.7"},
        {"contact_restitution", &space, "restitution = 0.25",
         "restitution = 1.25",
         "restitution = 1.25 must be at least 0 and at "
         "most 1",
         "", "set restitution = 1.25"},
        {"contact_wear", &space, "1e-6 1/MPa", "-1e-6 1/MPa",
         "must not be negative", "", "set wear coefficient"},
        {"contact_dilatancy", &space, "set restitution = 0.25",
         "set dilatancy = 0.1", "dilatancy is of the two sides of one face",
         "remove", "set dilatancy = 0.1"},
        {"contact_saturation", &space, "set restitution = 0.25",
         "set dilatancy saturation = 1 um",
         "dilatancy is of the two sides of one face", "remove",
         "set dilatancy saturation"},
        {"contact_after_the_same", &space, "set restitution = 0.25",
         "set between = [rubber, stone]",
         "section `Contact: others` never holds: `Contact: stone on rubber` "
         "comes first for rubber and stone",
         "remove it, or move it up", "set between = [rubber, stone]"},
        {"contact_after_all", &space, pair, "set between = all",
         "section `Contact: others` never holds: `Contact: stone on rubber` "
         "comes first for",
         "remove it, or move it up", "subsection Contact: others"},

        // --- pins
        {"pin_of_small_motion", &small, "subsection Time",
         "subsection Pin: nail\n  set material = rock\nend\nsubsection Time",
         "section `Pin: nail` needs motion = large", "set motion = large",
         "subsection Pin: nail"},
        {"pin_of_nothing", &space, "material = stone", "material = stne",
         "there is no material `stne`", "did you mean `stone`?",
         "set material = stne"},
        {"pin_of_rubber", &space, "material = stone", "material = rubber",
         "material `rubber` is neo-hookean", "model = rigid",
         "set material = rubber"},
        {"pin_without_material", &space, "  set material = stone\n", "",
         "`material` is missing in section `Pin: hinge`",
         "set material = ", "subsection Pin: hinge"},
        {"pin_without_place", &space, "  set at = 1 mm, 2 mm, 3 mm\n", "",
         "`at` is missing in section `Pin: hinge`",
         "set at = ", "subsection Pin: hinge"},
        {"pin_in_two_numbers", &space, "at = 1 mm, 2 mm, 3 mm",
         "at = 1 mm, 2 mm", "has 2 values, 3 are needed", "", "set at = 1 mm"},
        {"pin_unit", &space, "at = 1 mm,", "at = 1 s,",
         "`1 s` is a time; `at` must be a length", "", "set at = 1 s"},

        // --- parts that follow small motions only
        {"bonded_law", &plane, "law = contact", "law = bonded",
         "law = bonded joins bodies that turn and strain little", "write rigid",
         "set law = bonded"},
        {"bonded_faces", &space, "set friction = 0.5",
         "set intact faces = bonded\n  set friction = 0.5",
         "intact faces = bonded joins bodies that turn and strain little",
         "write rigid", "set intact faces = bonded"},
        {"spring_of_extrinsic", &space, "set friction = 0.5",
         "set intact faces = spring\n  set friction = 0.5",
         "the extrinsic law camacho-ortiz has none",
         "write rigid, or take an intrinsic law", "set intact faces = spring"},
        {"symplectic", &space, "set step = 1 us",
         "set step = 1 us\n  set scheme = symplectic",
         "scheme = symplectic is not there for motion = large",
         "scheme = moreau-jean", "set scheme = symplectic"},
        {"quasi_static", &space, "set step = 1 us",
         "set step = 1 us\n  set scheme = quasi-static\n"
         "  set at solution jump = relax",
         "scheme = quasi-static is not there for motion = large",
         "scheme = moreau-jean", "set scheme = quasi-static"},
        {"arkode", &space, "set step = 1 us",
         "set step = 1 us\n  set scheme = arkode\n  set order = 4",
         "scheme = arkode is not there for motion = large",
         "scheme = moreau-jean", "set scheme = arkode"},
        {"equilibrium", &space, "set step = 1 us",
         "set step = 1 us\n  set start = equilibrium\n"
         "  set equilibrium tolerance = 1e-9",
         "equilibria of scenes with motion = large are not there", "given",
         "set start = equilibrium"},
        {"global_path", &space, "set path = auto", "set path = global",
         "path = global has one matrix for all steps", "auto or element-wise",
         "set path = global"},
        {"adaptivity", &space, "subsection Solver",
         "subsection Adaptivity\n  set levels = 1\nend\n"
         "subsection Indicator: front\n  set type = process zone\nend\n"
         "subsection Solver",
         "the mesh of scenes with motion = large does not change",
         "remove the section Adaptivity", "set levels = 1"},
    };

    void PrintTo(const Refusal &refusal, std::ostream *stream)
    {
      *stream << refusal.name;
    }

    class LargeMotionRefusal : public testing::TestWithParam<Refusal>
    {
    };
  } // namespace

  TEST_P(LargeMotionRefusal, IsOneErrorAtItsLine)
  {
    const Refusal &bad = GetParam();
    InputErrors errors;
    EXPECT_EQ(read_scene_text(replaced(*bad.base, bad.old_text, bad.new_text),
                              "bad.prm", {}, errors),
              nullptr);
    ASSERT_EQ(errors.n_errors(), 1u) << errors.report();
    const Diagnostic &error = errors.diagnostics().front();
    EXPECT_TRUE(error.is_error);
    EXPECT_NE(error.message.find(bad.message), std::string::npos)
        << errors.report();
    EXPECT_NE(error.advice.find(bad.advice), std::string::npos)
        << errors.report();
    EXPECT_NE(error.location.text.find(bad.place), std::string::npos)
        << errors.report();
  }

  INSTANTIATE_TEST_SUITE_P(Table, LargeMotionRefusal,
                           testing::ValuesIn(refusals),
                           [](const testing::TestParamInfo<Refusal> &refusal) {
                             return refusal.param.name;
                           });

  TEST(LargeMotionInput, SmallMotionIsTheDefault)
  {
    const auto scene = read_good(small);
    ASSERT_NE(scene, nullptr);
    EXPECT_FALSE(scene->large_motion);
    EXPECT_EQ(scene->materials[0].model, BulkModel::rigid);
    EXPECT_EQ(scene->materials[1].model, BulkModel::linear_elastic);
    EXPECT_EQ(scene->obstacles[0].shape, ObstacleShape::plane);
    EXPECT_FALSE(scene->obstacles[0].moves());
    EXPECT_TRUE(motion_report(*scene).empty());
    EXPECT_FALSE(read_good(small, {"motion=small"})->large_motion);
  }

  TEST(LargeMotionInput, Materials)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    EXPECT_TRUE(scene->large_motion);
    ASSERT_EQ(scene->materials.size(), 3u);
    EXPECT_EQ(scene->materials[0].model, BulkModel::rigid);
    EXPECT_EQ(scene->materials[1].model, BulkModel::neo_hookean);
    EXPECT_EQ(scene->materials[2].model, BulkModel::saint_venant_kirchhoff);
    EXPECT_TRUE(scene->materials[0].rigid);
    EXPECT_FALSE(scene->materials[1].rigid || scene->materials[2].rigid);
    EXPECT_EQ(scene->materials[1].young, 1e6);
    EXPECT_EQ(scene->materials[2].poisson, 0.3);
    EXPECT_TRUE(read_good(plane)->plane_stress);
    const auto strain =
        read_good(replaced(plane, "model = saint-venant kirchhoff",
                           "model = neo-hookean"),
                  {"plane=strain"});
    ASSERT_NE(strain, nullptr);
    EXPECT_EQ(strain->materials[1].model, BulkModel::neo_hookean);
  }

  TEST(LargeMotionInput, RigidBodies)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    const RigidInput &stone = scene->materials[0].rigid_bodies;
    EXPECT_TRUE(stone.connected && stone.ball);
    EXPECT_DOUBLE_EQ(stone.mass.value(), 3e-6);
    ASSERT_TRUE(stone.inertia.has_value());
    EXPECT_DOUBLE_EQ((*stone.inertia)[0], 1e-9);
    EXPECT_DOUBLE_EQ((*stone.inertia)[1], 2e-9);
    EXPECT_DOUBLE_EQ((*stone.inertia)[2], 3e-9);

    const auto cells = read_good(plane);
    ASSERT_NE(cells, nullptr);
    const RigidInput &rock = cells->materials[0].rigid_bodies;
    EXPECT_FALSE(rock.connected || rock.ball);
    EXPECT_FALSE(rock.mass.has_value() || rock.inertia.has_value());

    const auto weighed =
        read_good(plane, {"Material: rock/mass=3 kg/m",
                          "Material: rock/principal inertia=5 kg*m^2/m",
                          "Material: rock/bodies=connected",
                          "Material: rock/surface=mesh"});
    ASSERT_NE(weighed, nullptr);
    const RigidInput &heavy = weighed->materials[0].rigid_bodies;
    EXPECT_TRUE(heavy.connected);
    EXPECT_FALSE(heavy.ball);
    EXPECT_EQ(heavy.mass.value(), 3.);
    EXPECT_EQ(heavy.inertia.value(), (std::array<double, 3>{0., 0., 5.}));
  }

  TEST(LargeMotionInput, InertiaOfAFlatBodyIsTakenAtAnySize)
  {
    // one moment is the sum of the others, up to the last digits
    for (const std::string scale : {"1e-40", "1", "1e40"})
      for (const std::string moments :
           {"{0} * 0.1, {0} * 0.2, {0} * 0.3",
            "{0} * 0.3, {0} * 0.1, {0} * 0.2", "{0} / 3, {0}, {0} * 2 / 3"}) {
        std::string value = moments;
        for (std::size_t at; (at = value.find("{0}")) != std::string::npos;)
          value.replace(at, 3, scale);
        EXPECT_NE(
            read_good(space, {"Material: stone/principal inertia=" + value}),
            nullptr)
            << value;
      }
  }

  TEST(LargeMotionInput, Obstacles)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->obstacles.size(), 3u);
    const ObstacleInput &floor = scene->obstacles[0];
    EXPECT_EQ(floor.shape, ObstacleShape::plane);
    EXPECT_DOUBLE_EQ(floor.normal[1], 0.6);
    EXPECT_DOUBLE_EQ(floor.normal[2], 0.8);
    EXPECT_EQ(floor.point[2], -1e-3);
    EXPECT_FALSE(floor.moves() || floor.hollow);

    const ObstacleInput &drum = scene->obstacles[1];
    EXPECT_EQ(drum.shape, ObstacleShape::cylinder);
    EXPECT_EQ(drum.normal, (std::array<double, 3>{0., 0., 1.}));
    EXPECT_EQ(drum.point, (std::array<double, 3>{0., 0., 1e-3}));
    EXPECT_EQ(drum.radius, 1e-2);
    EXPECT_TRUE(drum.hollow);
    EXPECT_FALSE(drum.moves());

    const ObstacleInput &hammer = scene->obstacles[2];
    EXPECT_EQ(hammer.shape, ObstacleShape::sphere);
    EXPECT_EQ(hammer.point, (std::array<double, 3>{9e-3, 1e-3, 2e-3}));
    EXPECT_EQ(hammer.radius, 2e-3);
    EXPECT_FALSE(hammer.hollow);
    EXPECT_TRUE(hammer.moves());
    EXPECT_DOUBLE_EQ((*hammer.velocity[0])(0., 0., 0., 0.), -3.);
    EXPECT_FALSE(hammer.velocity[1].has_value());
    EXPECT_EQ((*hammer.velocity[2])(0., 0., 0., 0.), 1.);
    EXPECT_EQ(hammer.restitution, 0.5);
  }

  TEST(LargeMotionInput, ObstaclesInThePlane)
  {
    const auto scene = read_good(
        plane, {"Obstacle: hill/velocity y=1 m/s", "Obstacle: hill/hollow=true",
                "Obstacle: wall/point=0, 0", "Obstacle: wall/normal=1, 0",
                "Obstacle: wall/velocity x=2 m/s"});
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->obstacles.size(), 2u);
    EXPECT_EQ(scene->obstacles[0].shape, ObstacleShape::sphere);
    EXPECT_EQ(scene->obstacles[0].radius, 4e3);
    EXPECT_TRUE(scene->obstacles[0].hollow);
    EXPECT_EQ((*scene->obstacles[0].velocity[1])(0., 0., 0.), 1.);
    EXPECT_EQ(scene->obstacles[1].shape, ObstacleShape::plane);
    EXPECT_TRUE(scene->obstacles[1].moves());
  }

  TEST(LargeMotionInput, Contacts)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->contacts.size(), 2u);
    const ContactInput &first = scene->contacts[0];
    EXPECT_EQ(first.name, "stone on rubber");
    EXPECT_EQ(first.materials, (std::array<std::string, 2>{"stone", "rubber"}));
    EXPECT_EQ(first.friction, 0.7);
    EXPECT_EQ(first.restitution, 0.);
    EXPECT_DOUBLE_EQ(first.sliding.wear, 1e-12);
    EXPECT_EQ(first.sliding.dilatancy, 0.);
    const ContactInput &others = scene->contacts[1];
    EXPECT_EQ(others.materials, (std::array<std::string, 2>{}));
    EXPECT_EQ(others.friction, 0.);
    EXPECT_EQ(others.restitution, 0.25);
    EXPECT_FALSE(others.sliding.lifts());
  }

  TEST(LargeMotionInput, AContactMayNameOneMaterialTwice)
  {
    const auto scene =
        read_good(replaced(space, pair, "set between = stone, stone"));
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->contacts[0].materials,
              (std::array<std::string, 2>{"stone", "stone"}));
  }

  TEST(LargeMotionInput, AContactThatGetsOnlyTheLastPairIsTaken)
  {
    // three pairs of two materials: with the third one named, `all` is left
    // with nothing
    const std::string named =
        replaced(plane, "subsection Time",
                 "subsection Contact: a\n  set between = [rock, rock]\nend\n"
                 "subsection Contact: b\n  set between = [ice, rock]\nend\n"
                 "subsection Contact: c\n  set between = all\nend\n"
                 "subsection Time");
    const auto scene = read_good(named);
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->contacts.size(), 3u);
    InputErrors errors;
    read_scene_text(replaced(named, "subsection Contact: c",
                             "subsection Contact: d\n"
                             "  set between = [ice, ice]\nend\n"
                             "subsection Contact: c"),
                    "bad.prm", {}, errors);
    EXPECT_EQ(errors.n_errors(), 1u) << errors.report();
    EXPECT_NE(errors.report().find("section `Contact: c` never holds"),
              std::string::npos)
        << errors.report();
  }

  TEST(LargeMotionInput, RestitutionOfContactsWarnsOfTheta)
  {
    InputErrors errors;
    EXPECT_NE(read_scene_text(
                  space, "warn.prm",
                  {"Time/theta=0.9", "Contact: others/restitution=1"}, errors),
              nullptr);
    EXPECT_NE(errors.report().find("1/(1 + e) = 0.5"), std::string::npos)
        << errors.report();
  }

  TEST(LargeMotionInput, Pins)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->pins.size(), 1u);
    EXPECT_EQ(scene->pins[0].name, "hinge");
    EXPECT_EQ(scene->pins[0].material, "stone");
    EXPECT_EQ(scene->pins[0].at, (std::array<double, 3>{1e-3, 2e-3, 3e-3}));
    const auto flat = read_good(
        plane, {"Pin: nail/material=rock", "Pin: nail/at=1 km, 2 km"});
    ASSERT_NE(flat, nullptr);
    EXPECT_EQ(flat->pins[0].at, (std::array<double, 3>{1e3, 2e3, 0.}));
  }

  TEST(LargeMotionInput, ExtrinsicLawsEverywhereStartRigid)
  {
    const auto large = read_good(space);
    ASSERT_NE(large, nullptr);
    ASSERT_TRUE(large->interfaces[0].law->extrinsic());
    EXPECT_EQ(large->interfaces[0].where.kind, Where::Kind::all);
    EXPECT_EQ(large->interfaces[0].intact, IntactFaces::rigid);
    EXPECT_FALSE(large->has_bonded_faces());
    EXPECT_NE(read_good(space, {"Interface: seam/intact faces=rigid"}),
              nullptr);
    const auto still =
        read_good(replaced(small, "set law = rigid",
                           "set law = camacho-ortiz\n  set strength = 1\n"
                           "  set toughness = 1"));
    ASSERT_NE(still, nullptr);
    EXPECT_EQ(still->interfaces[0].intact, IntactFaces::bonded);
  }

  TEST(LargeMotionInput, InterfacesKeepWhatTheyHave)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    const InterfaceInput &seam = scene->interfaces[0];
    EXPECT_EQ(seam.sliding.dilatancy, 0.1);
    EXPECT_EQ(seam.opening_viscosity, 1.);
    EXPECT_TRUE(seam.crack_pressure.has_value());
  }

  TEST(LargeMotionInput, TheTextOfAPressureSaysThatItIsDead)
  {
    EXPECT_NE(read_good(space)->echo.find("a dead load"), std::string::npos);
    EXPECT_EQ(read_good(small, {"Boundary: right/pressure=1"})
                  ->echo.find("a dead load"),
              std::string::npos);
  }

  TEST(LargeMotionInput, EchoReadsBackTheSame)
  {
    for (const std::string *text : {&space, &plane, &small}) {
      const auto first = read_good(*text);
      ASSERT_NE(first, nullptr);
      const auto second = read_good(first->echo);
      ASSERT_NE(second, nullptr);
      EXPECT_EQ(second->echo, first->echo);
      EXPECT_EQ(second->large_motion, first->large_motion);
      EXPECT_EQ(second->contacts.size(), first->contacts.size());
      EXPECT_EQ(second->pins.size(), first->pins.size());
    }
  }

  TEST(LargeMotionInput, ListNamesEveryModel)
  {
    std::vector<std::string> names;
    for (const NamedPart &part : named_parts())
      if (part.kind == "material model")
        names.push_back(part.name);
    EXPECT_EQ(names, (std::vector<std::string>{
                         "linear elastic", "transversely isotropic", "rigid",
                         "saint-venant kirchhoff", "neo-hookean", "j2 plastic",
                         "viscoplastic"}));
  }

  TEST(LargeMotionInput, PartsAreNamed)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    std::string text;
    for (const auto &[keyword, sentence] : motion_report(*scene))
      text += keyword + " - " + sentence + "\n";
    EXPECT_EQ(text,
              "rigid bodies - stone: cells that touch are one, its surface a "
              "ball, mass 3e-06, inertia 1e-09, 2e-09, 3e-09\n"
              "finite strain - rubber: neo-hookean\n"
              "finite strain - steel: saint-venant kirchhoff\n"
              "contact search - stone on rubber: stone and rubber, friction "
              "0.7, restitution 0, wear coefficient 1e-12\n"
              "contact search - others: all surfaces, friction 0, restitution "
              "0.25\n"
              "pin - hinge: of stone\n");
    const auto alone = read_good(plane, {"Material: rock/mass=3 kg/m"});
    ASSERT_NE(alone, nullptr);
    EXPECT_EQ(motion_report(*alone)[0].text, "rock: each cell is one, mass 3");
    EXPECT_EQ(motion_report(*alone).back().text,
              "no Contact block: surfaces pass through each other");
    const auto &obstacles = scene->obstacles;
    EXPECT_EQ(describe_obstacle(obstacles[0], 3), "plane");
    EXPECT_EQ(describe_obstacle(obstacles[1], 3), "hollow cylinder");
    EXPECT_EQ(describe_obstacle(obstacles[2], 3), "moving sphere");
    EXPECT_EQ(describe_obstacle(obstacles[2], 2), "moving disc");
  }

  TEST(LargeMotionInput, FormulasKnowWhetherTheyDependOnThePlace)
  {
    const auto scene = read_good(small, {"Boundary: left/velocity x=t * 2",
                                         "Boundary: left/velocity y=y + t",
                                         "Boundary: right/velocity x=3"});
    ASSERT_NE(scene, nullptr);
    EXPECT_FALSE(scene->boundaries[0].velocity[0]->depends_on_position());
    EXPECT_TRUE(scene->boundaries[0].velocity[1]->depends_on_position());
    EXPECT_FALSE(scene->boundaries[1].velocity[0]->depends_on_position());
    EXPECT_FALSE(Expression(3.).depends_on_position());
  }
} // namespace nsfd::test_large_motion_input
