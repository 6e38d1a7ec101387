#include "large_motion_scenes.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

namespace nsfd::large_motion_scenes::test_large_motion_refusals
{
  namespace
  {

    struct Refusal {
      std::string name;
      const std::string *base;
      std::string old_text; ///< part of the base scene
      std::string new_text;
      std::string message; ///< part of the message
      std::string advice;  ///< part of what to write instead
      std::string place;   ///< part of the line that is blamed
    };

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
        {"finite_strain_of_small_motion", &small, "set Young modulus",
         "set model = neo-hookean\n  set Young modulus",
         "model = neo-hookean is for large strains", "set motion = large",
         "set model = neo-hookean"},
        {"kirchhoff_of_small_motion", &small, "set Young modulus",
         "set model = saint-venant kirchhoff\n  set Young modulus",
         "model = saint-venant kirchhoff is for large strains",
         "set motion = large", "set model = saint-venant"},
        {"neo_hookean_plane_stress", &plane, "model = saint-venant kirchhoff",
         "model = neo-hookean", "is not available for plane = stress",
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
         "law = bonded joins bodies that turn and strain little",
         "write joined", "set law = bonded"},
        {"bonded_faces", &space, "set friction = 0.5",
         "set intact faces = bonded\n  set friction = 0.5",
         "intact faces = bonded joins bodies that turn and strain little",
         "write joined", "set intact faces = bonded"},
        {"spring_of_extrinsic", &space, "set friction = 0.5",
         "set intact faces = spring\n  set friction = 0.5",
         "the extrinsic law camacho-ortiz has none",
         "write rigid, or take an intrinsic law", "set intact faces = spring"},
        {"explicit", &space, "set step = 1 us",
         "set step = 1 us\n  set scheme = symplectic",
         "scheme = symplectic is not available for motion = large",
         "scheme = moreau-jean", "set scheme = symplectic"},
        {"quasi_static", &space, "set step = 1 us",
         "set step = 1 us\n  set scheme = quasi-static\n"
         "  set at solution jump = relax",
         "scheme = quasi-static is not available for motion = large",
         "scheme = moreau-jean", "set scheme = quasi-static"},
        {"arkode", &space, "set step = 1 us",
         "set step = 1 us\n  set scheme = arkode\n  set order = 4",
         "scheme = arkode is not available for motion = large",
         "scheme = moreau-jean", "set scheme = arkode"},
        {"equilibrium", &space, "set step = 1 us",
         "set step = 1 us\n  set start = equilibrium\n"
         "  set equilibrium tolerance = 1e-9",
         "equilibria of scenes with motion = large are not there", "given",
         "set start = equilibrium"},
        {"global_path", &space, "set path = auto", "set path = assembled",
         "path = assembled has one matrix for all steps", "auto or local",
         "set path = assembled"},
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
    EXPECT_TRUE(error.is_error());
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
} // namespace nsfd::large_motion_scenes::test_large_motion_refusals
