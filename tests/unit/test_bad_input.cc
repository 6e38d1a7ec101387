#include "changed_scene.h"

namespace nsfd::changed_scene::test_bad_input
{
  namespace
  {

    const std::string mesh_and_degree = "set type = rectangle\n"
                                        "  set lower corner = 0, 0\n"
                                        "  set upper corner = size, 10 um\n"
                                        "  set cells = 4, 4\n"
                                        "end\n"
                                        "subsection Discretization\n"
                                        "  set degree = 1\n";

    const std::string with_triangles = "set type = crossed triangles\n"
                                       "  set upper corner = size, 10 um\n"
                                       "  set cells = 4, 4\n"
                                       "end\n"
                                       "subsection Discretization\n";

    const std::vector<BadInput> cases = {
        // --- syntax
        {"misspelt_entry", "set strength", "set strenght",
         "`strenght` is not an entry of section `Interface: midline`",
         "set strenght = 300 MPa"},
        {"misspelt_entry_advice", "set strength", "set strenght",
         "did you mean `strength`?", "set strenght = 300 MPa"},
        {"wrong_case", "set theta", "set Theta", "did you mean `theta`?",
         "set Theta = 0.5"},
        {"shape_of_a_law", "set law = camacho-ortiz", "set law = linear",
         "softening along a line is `camacho-ortiz` without elasticity before",
         "set law = linear"},
        {"misspelt_section", "subsection Solver", "subsection Slover",
         "did you mean `Solver`?", "subsection Slover"},
        {"misspelt_block", "subsection Boundary: left",
         "subsection Boundry: left", "did you mean `Boundary: left`?",
         "subsection Boundry: left"},
        {"block_without_name", "subsection Boundary: left",
         "subsection Boundary", "section `Boundary` needs a name",
         "subsection Boundary"},
        {"name_without_block", "subsection Time", "subsection Time: first",
         "section `Time` takes no name", "subsection Time: first"},
        {"doubled_entry", "set degree = 1", "set degree = 1\n  set degree = 2",
         "`degree` is given twice in section `Discretization`",
         "set degree = 2"},
        {"doubled_entry_place", "set degree = 1",
         "set degree = 1\n  set degree = 2", "it stands in bad.prm:15 already",
         "set degree = 2"},
        {"doubled_section", "subsection Interface: elsewhere",
         "subsection Interface:  midline",
         "there are two sections `Interface: midline`",
         "subsection Interface:  midline"},
        {"unclosed_section", "set cells = 4, 4\nend", "set cells = 4, 4",
         "section `Mesh` is not closed before this line",
         "subsection Discretization"},
        {"unclosed_at_the_end", "0.5 ns\nend", "0.5 ns",
         "section `Output` is not closed", "subsection Output"},
        {"extra_end", "subsection Time", "end\nsubsection Time",
         "there is no section to end here", "end"},
        {"text_after_end", "set cells = 4, 4\nend",
         "set cells = 4, 4\nend Mesh", "`Mesh` after `end`", "end Mesh"},
        {"no_equals", "set degree = 1", "set degree 1",
         "there is no `=` in this line", "set degree 1"},
        {"no_name", "set degree = 1", "set = 1", "there is no name before `=`",
         "set = 1"},
        {"no_value", "set theta = 0.5", "set theta =", "`theta` has no value",
         "set theta ="},
        {"no_keyword", "set degree = 1", "degree = 1",
         "write for example: set degree = 1", "degree = 1"},
        {"misspelt_keyword", "set degree = 1", "sett degree = 1",
         "did you mean `set`?", "sett degree = 1"},
        {"include_missing", "set dimension = 2", "include nowhere.prm",
         "`nowhere.prm` cannot be read", "include nowhere.prm"},
        {"entry_missing", "  set end = 10 ns\n", "",
         "`end` is missing in section `Time`", "subsection Time"},
        {"entry_missing_example", "  set density = 7800 kg/m^3\n", "",
         "write for example: set density = 7800 kg/m^3",
         "subsection Material: bulk"},

        // --- numbers and units
        {"unknown_unit", "135 GPa", "135 Gpa", "`Gpa` is not a unit",
         "set Young modulus = 135 Gpa"},
        {"unknown_unit_advice", "135 GPa", "135 Gpa", "did you mean `GPa`?",
         "set Young modulus = 135 Gpa"},
        {"wrong_dimension", "set end = 10 ns", "set end = 5 GPa",
         "`5 GPa` is a pressure; `end` must be a time", "set end = 5 GPa"},
        {"unit_where_none_fits", "set friction = 0", "set friction = 1 m",
         "`1 m` is a length; `friction` must be a plain number",
         "set friction = 1 m"},
        {"dimension_in_list", "set cells = 4, 4", "set cells = 4, 4 um",
         "`4 um` is a length; `cells` must be a plain number",
         "set cells = 4, 4 um"},
        {"nan", "set theta = 0.5", "set theta = nan",
         "`nan` is not a finite number", "set theta = nan"},
        {"infinity", "set end = 10 ns", "set end = inf",
         "`inf` is not a finite number", "set end = inf"},
        {"division_by_zero", "set end = 10 ns", "set end = 1 / 0",
         "`1 / 0` is not a finite number", "set end = 1 / 0"},
        {"overflow", "set end = 10 ns", "set end = 1e999", "is too large",
         "set end = 1e999"},
        {"decimal_comma", "set theta = 0.5", "set theta = 0,5",
         "`,` is not expected here", "set theta = 0,5"},
        {"not_a_number", "set theta = 0.5", "set theta = a half",
         "`a` is not known", "set theta = a half"},
        {"position_in_number", "set theta = 0.5", "set theta = x",
         "`x` cannot stand here", "set theta = x"},
        {"unit_and_constant", "set stiffness = 2\n",
         "set h = 2\n  set stiffness = 2 um/h\n",
         "`h` is a unit and one of the constants", "set stiffness = 2 um/h"},
        {"constant_name", "set stiffness = 2", "set pi = 3",
         "`pi` has a meaning in every formula", "set pi = 3"},
        {"too_few_values", "set cells = 4, 4", "set cells = 4",
         "cells = 4 has 1 value, 2 are needed", "set cells = 4"},
        {"half_a_cell", "set cells = 4, 4", "set cells = 4, 4.5",
         "cells = 4.5 must be a whole number", "set cells = 4, 4.5"},
        {"negative_count", "set cells = 4, 4", "set cells = 4, -4",
         "cells = -4 must be at least 1", "set cells = 4, -4"},

        // --- expressions
        {"unknown_variable", "abs(x - 5 um)", "abs(X1 - 5 um)",
         "`X1` is not known", "set where = abs(X1 - 5 um) < 1 nm"},
        {"unknown_function", "abs(x - 5 um)", "abz(x - 5 um)",
         "did you mean `abs`?", "set where = abz(x - 5 um) < 1 nm"},
        {"unknown_constant", "abs(x - 5 um)", "abs(x - sise / 2)",
         "did you mean `size`?", "set where = abs(x - sise / 2) < 1 nm"},
        {"open_bracket", "abs(x - 5 um) < 1 nm", "abs(x - 5 um < 1 nm",
         "this bracket is not closed", "set where = abs(x - 5 um < 1 nm"},
        {"missing_operand", "abs(x - 5 um) < 1 nm", "abs(x - ) < 1 nm",
         "a value is missing before `)`", "set where = abs(x - ) < 1 nm"},
        {"single_equals", "abs(x - 5 um) < 1 nm", "x = 5 um",
         "write == to compare", "set where = x = 5 um"},
        {"word_and", "abs(x - 5 um) < 1 nm", "x > 4 um and x < 6 um",
         "write && for `and`", "set where = x > 4 um and x < 6 um"},
        {"chained_comparison", "abs(x - 5 um) < 1 nm", "4 um < x < 6 um",
         "comparisons cannot be chained", "set where = 4 um < x < 6 um"},
        {"length_and_pressure", "abs(x - 5 um) < 1 nm", "abs(x - 5 GPa) < 1 nm",
         "`5 GPa` is a pressure and cannot be subtracted from `x`",
         "set where = abs(x - 5 GPa) < 1 nm"},
        {"dimension_of_product", "set velocity x = -2 m/s",
         "set velocity x = -2 GPa * sin(3 * t)",
         "`-2 GPa * sin(3 * t)` is a pressure; `velocity x` must be a velocity",
         "set velocity x = -2 GPa"},
        {"dimension_of_constant_expression", "set velocity x = -2 m/s",
         "set velocity x = 2 * size + 5 GPa", "cannot be added",
         "set velocity x = 2 * size + 5 GPa"},
        {"velocity_in_pascal", "set velocity x = -2 m/s",
         "set velocity x = 2 GPa", "`velocity x` must be a velocity",
         "set velocity x = 2 GPa"},
        {"where_with_time", "abs(x - 5 um) < 1 nm", "x < t * 1 m/s",
         "depends on t", "set where = x < t * 1 m/s"},

        // --- ranges
        {"young", "135 GPa", "-3 GPa",
         "Young modulus = -3 GPa must be positive",
         "set Young modulus = -3 GPa"},
        {"young_zero", "135 GPa", "0", "Young modulus = 0 must be positive",
         "set Young modulus = 0"},
        {"density", "7800 kg/m^3", "-1", "density = -1 must be positive",
         "set density = -1"},
        {"poisson", "0.32", "0.5",
         "Poisson ratio = 0.5 must be greater than -1 and less than 0.5",
         "set Poisson ratio = 0.5"},
        {"poisson_low", "0.32", "-1", "Poisson ratio = -1 must be greater",
         "set Poisson ratio = -1"},
        {"strength", "300 MPa", "0", "strength = 0 must be positive",
         "set strength = 0"},
        {"toughness", "0.5 J/m^2", "-1 J/m^2",
         "toughness = -1 J/m^2 must be positive", "set toughness = -1 J/m^2"},
        {"friction", "set friction = 0", "set friction = -0.1",
         "friction = -0.1 must not be negative", "set friction = -0.1"},
        {"strength_factor", "set friction = 0", "set strength factor = -1",
         "strength factor = -1 must be positive", "set strength factor"},
        {"factor_of_time", "set friction = 0", "set toughness factor = 1 + t",
         "t", "set toughness factor"},
        {"scatter", "set friction = 0", "set scatter = normal", "uniform",
         "set scatter = normal"},
        {"scatter_of_uniform", "set friction = 0", "set strength modulus = 8",
         "the scatter is uniform: write scatter = weibull",
         "set strength modulus"},
        {"scatter_without_modulus", "set friction = 0", "set scatter = weibull",
         "scatter = weibull without a modulus", "set scatter = weibull"},
        {"scatter_of_weibull", "set friction = 0",
         "set scatter = weibull\n  set toughness modulus = 5\n"
         "  set toughness scatter = 0.1",
         "the scatter is weibull: write `toughness modulus`",
         "set toughness scatter"},
        {"weibull_modulus", "set friction = 0",
         "set scatter = weibull\n  set strength modulus = 0.5",
         "strength modulus = 0.5 must be at least 1", "set strength modulus"},
        {"crack_pressure_of_rigid", "set law = rigid",
         "set law = rigid\n  set crack pressure = 1 MPa",
         "faces of the law `rigid` never open", "set crack pressure"},
        {"crack_pressure_unit", "set friction = 0", "set crack pressure = 1 m",
         "crack pressure", "set crack pressure"},
        {"pressure_threshold", "set friction = 0", "set pressure threshold = 0",
         "pressure threshold", "set pressure threshold"},
        {"viscosity_of_contact", "set law = rigid",
         "set law = contact\n  set opening viscosity = 1 Pa*s/m",
         "faces of the law `contact` carry no cohesion",
         "set opening viscosity"},
        {"viscosity_unit", "set friction = 0", "set opening viscosity = 1 Pa*s",
         "a pressure per velocity", "set opening viscosity"},
        {"scatter_of_rigid", "set law = rigid",
         "set law = rigid\n  set strength factor = 2",
         "faces of the law `rigid` never open", "set strength factor"},
        {"restitution", "set restitution = 0.5", "set restitution = 1.2",
         "restitution = 1.2 must be at least 0 and at most 1",
         "set restitution = 1.2"},
        {"theta", "set theta = 0.5", "set theta = 0.4",
         "theta = 0.4 must be at least 0.5", "set theta = 0.4"},
        {"theta_high", "set theta = 0.5", "set theta = 1.5",
         "theta = 1.5 must be at most 1", "set theta = 1.5"},
        {"end", "set end = 10 ns", "set end = 0 ns",
         "end = 0 ns must be positive", "set end = 0 ns"},
        {"step", "0.6 courant", "-0.6 courant", "step = -0.6 must be positive",
         "set step = -0.6 courant"},
        {"quasi_static_courant", "set theta = 0.5", "set scheme = quasi-static",
         "a quasi-static step is a time of the load", "0.6 courant"},
        {"quasi_static_given", "set theta = 0.5",
         "set scheme = quasi-static\n  set start = given",
         "quasi-static steps go from one equilibrium to the next",
         "set start = given"},
        {"dynamic_step_without_dynamics", "set step = 0.6 courant",
         "set scheme = quasi-static\n  set step = 1 ns\n"
         "  set dynamic step = 1 ps",
         "no step of this scene is dynamic", "set dynamic step = 1 ps"},
        {"until_beyond_the_end", "set step = 0.6 courant",
         "set scheme = quasi-static\n  set step = 1 ns\n"
         "  set quasi-static until = 11 ns",
         "quasi-static until", "set quasi-static until = 11 ns"},
        {"jump_without_quasi_static", "set theta = 0.5",
         "set at solution jump = relax", "it belongs to scheme = quasi-static",
         "set at solution jump = relax"},
        {"tolerance_without_equilibrium", "set theta = 0.5",
         "set equilibrium tolerance = 1e-9",
         "no equilibrium is computed in this scene",
         "set equilibrium tolerance = 1e-9"},
        {"equilibrium_at_speed", "set density = 7800 kg/m^3",
         "set density = 7800 kg/m^3\n  set initial velocity x = 1 m/s\nend\n"
         "subsection Time\n  set start = equilibrium",
         "an equilibrium is at rest", "set start = equilibrium"},
        {"step_unit", "0.6 courant", "5 um",
         "`5 um` is a length; `step` must be a time", "set step = 5 um"},
        {"step_misspelt", "0.6 courant", "0.6 crosings",
         "did you mean `courant`?", "set step = 0.6 crosings"},
        {"step_auto_misspelt", "0.6 courant", "atuo", "did you mean `auto`?",
         "set step = atuo"},
        {"empty_mesh", "set cells = 4, 4", "set cells = 0, 4",
         "cells = 0 must be at least 1", "set cells = 0, 4"},
        {"huge_mesh", "set cells = 4, 4", "set cells = 100000, 100000",
         "the mesh would have 1e+10 cells", "set cells = 100000, 100000"},
        {"inverted_corners", "set upper corner = size, 10 um",
         "set upper corner = -size, 10 um",
         "upper corner: x = -1e-05 must be greater than 0",
         "set upper corner = -size, 10 um"},
        {"zero_normal", "set normal = 0, 1", "set normal = 0, 0",
         "normal = 0 has no direction", "set normal = 0, 0"},
        {"dimension", "set dimension = 2", "set dimension = 4",
         "dimension = 4 must be at most 3", "set dimension = 4"},
        {"degree_zero", "set degree = 1", "set degree = 0",
         "degree = 0 must be at least 1", "set degree = 0"},
        {"degree", "set degree = 1", "set degree = 9",
         "degree = 9 must be at most 8", "set degree = 9"},

        // --- words
        {"misspelt_choice", "set mass = consistent", "set mass = consistant",
         "did you mean `consistent`?", "set mass = consistant"},
        {"method", "set method = auto", "set method = magic",
         "method = magic is not one of: auto, admm, anderson, cascade, dual "
         "newton, fixed point, frictional contact, gauss seidel, interior "
         "point, multipliers, projected gradient, proximal",
         "set method = magic"},
        {"unknown_law", "camacho-ortiz", "camacho-ortis",
         "did you mean `camacho-ortiz`?", "set law = camacho-ortis"},
        {"bonded_friction", "set law = rigid",
         "set law = bonded\n  set friction = 0.1",
         "faces of the law `bonded` never open", "set friction = 0.1"},
        {"scheme", "set theta = 0.5", "set scheme = newmark",
         "scheme = newmark is not one of: moreau-jean, explicit, symplectic, "
         "arkode, quasi-static",
         "set scheme = newmark"},
        {"mesh_type", "set type = rectangle", "set type = rectangel",
         "did you mean `rectangle`?", "set type = rectangel"},
        {"mesh_unknown", "set type = rectangle", "set type = box",
         "write one of rectangle, ", "set type = box"},
        {"mesh_voronoi", "set type = rectangle", "set type = voronoi",
         "`grains` is missing in section `Mesh`", "subsection Mesh"},
        {"mesh_file", "set type = rectangle", "set type = file",
         "`file` is missing in section `Mesh`", "subsection Mesh"},
        {"mesh_dimension", "set type = rectangle", "set type = brick",
         "type = brick needs dimension = 3, not 2", "set type = brick"},
        {"generator_dimension", "set type = rectangle", "set type = torus",
         "type = torus needs dimension = 3, not 2", "set type = torus"},
        {"boolean", "set fields every = 0.5 ns", "set fields = perhaps",
         "fields = perhaps is neither true nor false", "set fields = perhaps"},
        {"side_in_2d", "subsection Boundary: left",
         "subsection Boundary: front",
         "the side `front` exists for dimension = 3 only",
         "subsection Boundary: front"},
        {"unknown_group", "abs(x - 5 um) < 1 nm", "inclusion",
         "the mesh `rectangle` has no such group", "set where = inclusion"},
        {"side_of_interfaces", "abs(x - 5 um) < 1 nm", "left",
         "there are no faces between cells", "set where = left"},
        {"unknown_material", "abs(x - 5 um) < 1 nm",
         "between materials [bulk, gras]", "there is no material `gras`",
         "set where = between materials [bulk, gras]"},
        {"one_material", "abs(x - 5 um) < 1 nm", "between materials bulk",
         "does not name two materials", "set where = between materials bulk"},

        // --- parts that do not fit together
        {"velocity_and_displacement", "set velocity x = -2 m/s",
         "set velocity x = -2 m/s\n  set displacement x = 1 um",
         "`velocity x` and `displacement x` are both given",
         "set displacement x = 1 um"},
        {"velocity_and_traction", "set velocity x = -2 m/s",
         "set velocity x = -2 m/s\n  set traction x = 1 MPa",
         "`traction x` has no effect", "set traction x = 1 MPa"},
        {"third_component", "set velocity x = -2 m/s", "set velocity z = 1",
         "`velocity z` does not belong here: dimension = 2 has no z",
         "set velocity z = 1"},
        {"boundary_without_effect", "  set velocity x = -2 m/s\n", "",
         "section `Boundary: left` prescribes nothing",
         "subsection Boundary: left"},
        {"boundary_without_where", "subsection Boundary: left",
         "subsection Boundary: piston", "`where` is missing in section",
         "subsection Boundary: piston"},
        {"no_material", "subsection Material: bulk",
         "subsection Boundary: right", "the scene has no material", ""},
        {"friction_of_rigid", "set law = rigid",
         "set law = rigid\n  set friction = 1",
         "`friction` does not belong here: faces of the law `rigid` never open",
         "set friction = 1"},
        {"strength_of_rigid", "set law = rigid",
         "set law = rigid\n  set strength = 1 MPa",
         "`strength` is not an entry of section `Interface: elsewhere` in this "
         "scene",
         "set strength = 1 MPa"},
        {"young_of_rigid", "set Young modulus = 135 GPa", "set model = rigid",
         "`Poisson ratio` does not belong here: the material is rigid",
         "set Poisson ratio = 0.32"},
        {"extrinsic_everywhere", "set where = abs(x - 5 um) < 1 nm",
         "set where = all\n  set intact faces = rigid", "W singular",
         "set intact faces = rigid"},
        {"intact_bonded", "set law = rigid",
         "set law = elastic\n  set normal stiffness = 1e16\n"
         "  set intact faces = bonded",
         "contradicts the stiffness of the law elastic",
         "set intact faces = bonded"},
        {"overshoot_of_none", "set theta = 0.5", "set largest overshoot = 0.1",
         "there are no bonded faces that may break",
         "set largest overshoot = 0.1"},
        {"extrinsic_spring", "set friction = 0", "set intact faces = spring",
         "the extrinsic law camacho-ortiz has none",
         "set intact faces = spring"},
        {"intrinsic_rigid", "set law = rigid",
         "set law = elastic\n  set normal stiffness = 1e16\n"
         "  set intact faces = rigid",
         "contradicts the stiffness of the law elastic",
         "set intact faces = rigid"},
        {"courant_of_rigid_bodies",
         "set Young modulus = 135 GPa\n  set Poisson ratio = 0.32\n",
         "set model = rigid\n", "the step must be a time",
         "set step = 0.6 courant"},
        {"simplex_degree", mesh_and_degree,
         with_triangles + "  set degree = 3\n",
         "deal.II 9.4.1 has no higher element for triangles", "set degree = 3"},
        {"lumped_triangles", mesh_and_degree + "  set mass = consistent\n",
         with_triangles + "  set degree = 2\n  set mass = lumped\n",
         "would leave vertices without mass", "set mass = lumped"},
        {"plateau_of_an_intrinsic_law",
         "set law = camacho-ortiz\n  set strength = 300 MPa\n"
         "  set toughness = 0.5 J/m^2",
         "set law = tvergaard\n  set strength = 300 MPa\n"
         "  set toughness = 0.5 J/m^2\n  set unloading = plateau",
         "the law tvergaard is intrinsic", "set unloading = plateau"},
        {"dilatancy_above_friction", "set friction = 0",
         "set friction = 0.2\n  set dilatancy = 0.3",
         "sliding would give energy", "set dilatancy = 0.3"},
        {"saturation_without_dilatancy", "set friction = 0",
         "set friction = 0\n  set dilatancy saturation = 1 um",
         "there is no `dilatancy`", "set dilatancy saturation = 1 um"},
        {"limit_without_viscosity", "set friction = 0",
         "set friction = 0\n  set viscous limit = 1 MPa",
         "there is no `opening viscosity`", "set viscous limit = 1 MPa"},
        {"bodies_without_body", mesh_and_degree,
         "set type = bodies\nend\nsubsection Discretization\n",
         "type = bodies needs blocks `Body: name`", "set type = bodies"},
        {"notch_too_long", "set type = rectangle",
         "set type = notched plate\n  set notch length = 1 mm\n"
         "  set notch height = 5 um",
         "notch length = 0.001 goes through the plate", "set notch length"},
        {"notch_outside", "set type = rectangle",
         "set type = notched plate\n  set notch length = 1 um\n"
         "  set notch height = 15 um",
         "notch height = 1.5e-05", "set notch height"},
        {"notch_of_rectangle", "set type = rectangle",
         "set type = rectangle\n  set notch length = 1 um",
         "the mesh `rectangle` has no notch", "set notch length"},
        {"plane_in_3d", "set dimension = 2", "set dimension = 3",
         "plane strain, plane stress and axisymmetric bodies are for dimension "
         "= "
         "2",
         "set plane = strain"},
        {"checkpoint", "set fields every = 0.5 ns",
         "set checkpoint every = -5 min", "must not be negative",
         "set checkpoint every = -5 min"},
        {"quarter_points", "set mass = consistent",
         "set interface quadrature = quarter points\n"
         "  set interface points = 3",
         "the rule `quarter points` has 2 per direction",
         "set interface points = 3"},
        {"verification", "subsection Solver\n  set method = auto",
         "subsection Verification\n  set case = no such case",
         "case = no such case is not a verification case",
         "set case = no such case"},
        {"adaptivity", "subsection Solver\n  set method = auto",
         "subsection Adaptivity\n  set method = auto",
         "no indicator says where cells are to be small",
         "subsection Adaptivity"},
        {"body_without_bodies", "subsection Obstacle: floor",
         "subsection Body: floor", "the mesh is `rectangle`",
         "subsection Body: floor"},
    };

    class BadInputTest : public testing::TestWithParam<BadInput>
    {
    };
  } // namespace

  TEST(GoodInput, BaseFileHasNoErrors)
  {
    InputErrors errors;
    EXPECT_NE(read_scene_text(base_file, "base.prm", {}, errors), nullptr);
    EXPECT_EQ(errors.report(), "");
  }

  TEST_P(BadInputTest, IsRefusedAtItsLine)
  {
    const BadInput &bad = GetParam();
    InputErrors errors;
    const std::string text = with_change(bad);
    const auto scene = read_scene_text(text, "bad.prm", {}, errors);
    EXPECT_EQ(scene, nullptr);
    EXPECT_TRUE(errors.has_errors());

    bool found = false;
    for (const Diagnostic &d : errors.diagnostics()) {
      EXPECT_EQ(d.location.text, line_of(text, d.location.line));
      const bool is_place =
          bad.place.empty()
              ? d.location.line == 0
              : d.location.text.find(bad.place) != std::string::npos;
      found = found || (d.is_error() && is_place &&
                        (d.message + "\n" + d.advice).find(bad.message) !=
                            std::string::npos);
    }
    EXPECT_TRUE(found) << "expected at `" << bad.place << "`: " << bad.message
                       << "\n"
                       << errors.report();
  }

  INSTANTIATE_TEST_SUITE_P(Table, BadInputTest, testing::ValuesIn(cases),
                           [](const testing::TestParamInfo<BadInput> &info) {
                             return info.param.name;
                           });
} // namespace nsfd::changed_scene::test_bad_input
