#include "app/command_line.h"
#include "input/read_scene.h"
#include "nonsmooth/solver.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "parameters/parameter_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace nsfd::test_input
{
  namespace
  {
    /** One section with the given lines, and a reader of it. */
    struct OneSection {
      explicit OneSection(const std::string &lines)
          : reader((file.read_text("subsection Test\n" + lines + "\nend\n",
                                   "test.prm", errors),
                    file.open("Test")),
                   errors)
      {
      }

      InputErrors errors;
      ParameterFile file;
      SectionReader reader;
    };

    double read_number(const std::string &value, const Unit &unit)
    {
      OneSection section("set entry = " + value);
      const double result =
          section.reader.number("entry", "", unit, Range::any(), "");
      EXPECT_EQ(section.errors.report(), "");
      return result;
    }

    Expression read_expression(const std::string &value,
                               const Unit &unit = units::none)
    {
      OneSection section("set entry = " + value);
      const Expression result =
          section.reader.expression("entry", "", unit, "");
      EXPECT_EQ(section.errors.report(), "");
      return result;
    }

    double value_of(const std::string &text)
    {
      return read_expression(text)(0.5, 2., 3., 4.);
    }

    const std::string small_scene = R"(# small - the least that runs
set dimension = 2
subsection Mesh
  set upper corner = 10 um, 20 um
  set cells = 2, 4
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density = 7800 kg/m^3
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end = 10 ns
end
)";

    std::unique_ptr<SceneInput>
    read_good(const std::string &text,
              const std::vector<std::string> &overrides = {})
    {
      InputErrors errors;
      auto scene = read_scene_text(text, "prm/small.prm", overrides, errors);
      EXPECT_EQ(errors.report(), "");
      return scene;
    }

    std::string report_of(const std::string &text,
                          const std::vector<std::string> &overrides = {})
    {
      InputErrors errors;
      read_scene_text(text, "small.prm", overrides, errors);
      return errors.report();
    }

    std::string replaced(std::string text, const std::string &from,
                         const std::string &to)
    {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      return text.replace(at, from.size(), to);
    }

    struct PlanePoint {
      static constexpr unsigned int dimension = 2;
      double operator[](const unsigned int i) const { return i + 1.; }
    };

    /** Exit code (-1: go on) and what was printed. */
    struct Parsed {
      CommandLine command_line;
      int code;
      std::string out, err;
    };

    Parsed parse(std::vector<const char *> arguments)
    {
      arguments.insert(arguments.begin(), "nsfd");
      Parsed result;
      std::ostringstream out, err;
      result.code =
          parse_command_line(static_cast<int>(arguments.size()),
                             arguments.data(), result.command_line, out, err)
              .value_or(-1);
      result.out = out.str();
      result.err = err.str();
      return result;
    }
  } // namespace

  // --- quantities

  TEST(Quantity, SuffixesAreExactPowersOfTen)
  {
    EXPECT_EQ(read_number("5 um", units::length), 5e-6);
    EXPECT_EQ(read_number("5um", units::length), 5e-6);
    EXPECT_EQ(read_number("5 µm", units::length), 5e-6);
    EXPECT_EQ(read_number("0.3 nm", units::length), 0.3e-9);
    EXPECT_EQ(read_number("135 GPa", units::pressure), 135e9);
    EXPECT_EQ(read_number("1.5e2 kPa", units::pressure), 1.5e5);
    EXPECT_EQ(read_number("2 g", units::mass), 2e-3);
    EXPECT_EQ(read_number("2 kg", units::mass), 2.);
    EXPECT_EQ(read_number("3 mg", units::mass), 3e-6);
    EXPECT_EQ(read_number("2 min", units::time), 120.);
    EXPECT_EQ(read_number("0.5 h", units::time), 1800.);
    EXPECT_EQ(read_number("-10 ns", units::time), -1e-8);
  }

  TEST(Quantity, ProductsQuotientsAndPowers)
  {
    EXPECT_DOUBLE_EQ(read_number("0.5 J/m^2", units::energy_per_area), 0.5);
    EXPECT_DOUBLE_EQ(read_number("0.5 N/m", units::energy_per_area), 0.5);
    EXPECT_DOUBLE_EQ(read_number("7800 kg/m^3", units::density), 7800.);
    EXPECT_DOUBLE_EQ(read_number("7.8 g/cm^3", units::density), 7800.);
    EXPECT_DOUBLE_EQ(read_number("-9.81 m/s^2", units::acceleration), -9.81);
    EXPECT_DOUBLE_EQ(read_number("3.6 km/h", units::velocity), 1.);
    EXPECT_DOUBLE_EQ(read_number("2 MPa/mm", units::stiffness_per_area), 2e9);
    EXPECT_DOUBLE_EQ(read_number("2 GPa/um", units::stiffness_per_area), 2e15);
    EXPECT_DOUBLE_EQ(read_number("4 kg*m/s^2/mm^2", units::pressure), 4e6);
    EXPECT_DOUBLE_EQ(read_number("50 1/s", {0, 0, -1}), 50.);
    EXPECT_DOUBLE_EQ(read_number("2 MHz", {0, 0, -1}), 2e6);
    EXPECT_DOUBLE_EQ(read_number("3 m/m", units::none), 3.);
    EXPECT_DOUBLE_EQ(read_number("3 m*s^-1", units::velocity), 3.);
  }

  TEST(Quantity, ExamplesOfAdviceCanBeRead)
  {
    for (const Unit &unit :
         {units::none, units::length, units::time, units::mass, units::velocity,
          units::acceleration, units::density, units::pressure,
          units::energy_per_area, units::stiffness_per_area,
          units::viscosity_per_length, units::damage_viscosity,
          units::wear_coefficient, units::mass_per_area, units::mass_per_length,
          units::inertia, units::inertia_per_length}) {
      ASSERT_FALSE(example(unit).empty()) << describe(unit);
      EXPECT_NE(read_number(example(unit), unit), 0.) << describe(unit);
    }
  }

  TEST(Quantity, BareNumbersFitEverywhere)
  {
    EXPECT_EQ(read_number("135", units::pressure), 135.);
    EXPECT_EQ(read_number("1e-3", units::time), 1e-3);
    EXPECT_EQ(read_number("2 * (3 + 4)", units::length), 14.);
  }

  TEST(Quantity, ArithmeticKeepsDimensions)
  {
    EXPECT_DOUBLE_EQ(read_number("10 um / 2 ns", units::velocity), 5e3);
    EXPECT_DOUBLE_EQ(read_number("sqrt(4 GPa / 1000 kg/m^3)", units::velocity),
                     2e3);
    EXPECT_DOUBLE_EQ(read_number("(2 um)^2 / 1 um", units::length), 4e-6);
    EXPECT_DOUBLE_EQ(read_number("max(1 um, 3000 nm)", units::length), 3e-6);

    OneSection wrong("set entry = 10 um * 2 ns");
    wrong.reader.number("entry", "", units::length, Range::any(), "");
    EXPECT_NE(wrong.errors.report().find("in m s; `entry` must be a length"),
              std::string::npos)
        << wrong.errors.report();
  }

  // --- expressions

  TEST(Expressions, FollowTheUsualRules)
  {
    EXPECT_DOUBLE_EQ(value_of("1 + 2 * 3 ^ 2"), 19.);
    EXPECT_DOUBLE_EQ(value_of("-3^2"), -9.);
    EXPECT_DOUBLE_EQ(value_of("2^-1"), 0.5);
    EXPECT_DOUBLE_EQ(value_of("2^3^2"), 512.);
    EXPECT_DOUBLE_EQ(value_of("8 / 2 / 2"), 2.);
    EXPECT_DOUBLE_EQ(value_of("1 - 2 - 3"), -4.);
    EXPECT_DOUBLE_EQ(value_of("2 - -x"), 2.5);
    EXPECT_DOUBLE_EQ(value_of("x + 10 * y + 100 * z + 1000 * t"), 4320.5);
    EXPECT_DOUBLE_EQ(value_of("x < 1 && y > 1 || false"), 1.);
    EXPECT_DOUBLE_EQ(value_of("!(x < 1)"), 0.);
    EXPECT_DOUBLE_EQ(value_of("x != 0.5"), 0.);
    EXPECT_DOUBLE_EQ(value_of("x == 0.5"), 1.);
    EXPECT_DOUBLE_EQ(value_of("if(x < 1, y, z)"), 2.);
    EXPECT_DOUBLE_EQ(value_of("x > 1 ? y : z"), 3.);
    EXPECT_DOUBLE_EQ(value_of("min(z, x, y) + max(x, y)"), 2.5);
    EXPECT_DOUBLE_EQ(value_of("heaviside(x - 0.5) + heaviside(-x)"), 1.);
    EXPECT_DOUBLE_EQ(value_of("sin(pi * x)"), 1.);
    EXPECT_DOUBLE_EQ(value_of("log(exp(y))"), 2.);
    EXPECT_DOUBLE_EQ(value_of("atan2(y, y)"), std::atan(1.));
    EXPECT_DOUBLE_EQ(value_of("mod(z, y) + floor(x) + ceil(x)"), 2.);
    EXPECT_DOUBLE_EQ(value_of("pow(y, 3) + sqrt(t)"), 10.);
  }

  TEST(Expressions, CarryUnits)
  {
    const Expression band = read_expression("abs(x - 5 um) < 1 nm");
    EXPECT_EQ(band(5e-6, 0., 0.), 1.);
    EXPECT_EQ(band(5.002e-6, 0., 0.), 0.);
    EXPECT_EQ(band.text(), "abs(x - 5 um) < 1 nm");

    const Expression pulse =
        read_expression("2 m/s * sin(2 * pi * t / 10 ns) * heaviside(5 ns - t)",
                        units::velocity);
    EXPECT_DOUBLE_EQ(pulse(0., 0., 0., 2.5e-9), 2.);
    EXPECT_EQ(pulse(0., 0., 0., 6e-9), 0.);
    EXPECT_TRUE(pulse.depends_on_time());

    // a file without any unit stays free in its choice
    EXPECT_DOUBLE_EQ(read_expression("3 * x", units::velocity)(2., 0., 0.), 6.);
    EXPECT_DOUBLE_EQ(read_expression("x", units::velocity)(2., 0., 0.), 2.);
  }

  TEST(Expressions, KnowWhatTheyDependOn)
  {
    EXPECT_TRUE(read_expression("0").is_zero());
    EXPECT_TRUE(read_expression("false").is_zero());
    EXPECT_TRUE(read_expression("1 - 1").is_zero());
    EXPECT_FALSE(read_expression("0 * x").is_zero());
    EXPECT_TRUE(read_expression("2 * pi").is_constant());
    EXPECT_FALSE(read_expression("2 * y").is_constant());
    EXPECT_FALSE(read_expression("2 * y").depends_on_time());
    EXPECT_EQ(Expression(2.5)(1., 1., 1., 1.), 2.5);
    EXPECT_TRUE(Expression().is_zero());
  }

  TEST(Expressions, CopiesShareTheFormula)
  {
    Expression a = read_expression("x + t");
    const Expression b = a;
    a = Expression(1.);
    EXPECT_EQ(b(2., 0., 0., 3.), 5.);
    EXPECT_EQ(read_expression("x + 10 * y + z").at(PlanePoint()), 21.);
  }

  TEST(Expressions, CaretStandsAtTheFault)
  {
    OneSection section("set entry = sin(x) + cso(y)");
    section.reader.expression("entry", "", units::none, "");
    EXPECT_EQ(section.errors.report(),
              "test.prm:2: error: entry: `cso` is not known\n"
              "   2 | set entry = sin(x) + cso(y)\n"
              "     |                      ^~~\n"
              "  did you mean `cos`?\n"
              "1 error, nothing was run\n");
  }

  TEST(Expressions, NeverCrash)
  {
    const std::vector<std::string> texts = {"(",
                                            ")",
                                            "()",
                                            "+",
                                            "1 +",
                                            "sin",
                                            "sin(",
                                            "sin()",
                                            "sin(1,2)",
                                            ",",
                                            "..",
                                            "1..2",
                                            "x y",
                                            "2x",
                                            "2 x",
                                            "2 m m",
                                            "5 m^x",
                                            "5 m^1.5",
                                            "1 1/",
                                            "if(1,2)",
                                            "a?b:c",
                                            "1 ? 2",
                                            "x = 1",
                                            "x & y",
                                            "x | y",
                                            "\xff\xfe",
                                            "1e",
                                            "1e+",
                                            "0x10",
                                            "--",
                                            "!",
                                            "!!x",
                                            "$",
                                            "x;y",
                                            "'x'",
                                            "\"x\"",
                                            "[1]",
                                            "{1}",
                                            "%",
                                            "1 % 2",
                                            "sin(x",
                                            "min()",
                                            "pi(",
                                            "pi()",
                                            "x()",
                                            "5 GPa()",
                                            "5 min(1)",
                                            std::string(5000, '('),
                                            std::string(5000, '-') + "1",
                                            "1" + std::string(2000, '^') + "1"};
    for (const std::string &text : texts) {
      OneSection section("set entry = " + text);
      section.reader.expression("entry", "", units::none, "");
      const bool is_right = text.substr(0, 2) == "--" && text.size() > 2;
      EXPECT_EQ(section.errors.has_errors(), !is_right) << text;
    }
  }

  // --- parameter files

  TEST(ParameterFiles, SyntaxOfDealII)
  {
    InputErrors errors;
    ParameterFile file;
    file.read_text("# title - text\n\n"
                   "set   dimension =  3   # comment\r\n"
                   "subsection  Interface :  my   line\n"
                   "\tset  where   = x > 1 && \\\n"
                   "      # in between\n"
                   "      y < 2 # and here\n"
                   "  set law =\n"
                   "end",
                   "f.prm", errors);
    EXPECT_EQ(errors.report(), "");
    ASSERT_NE(file.top().find("dimension"), nullptr);
    EXPECT_EQ(file.top().find("dimension")->value.text(), "3");
    const ParameterSection *section = file.find("Interface: my line");
    ASSERT_NE(section, nullptr);
    EXPECT_EQ(section->kind(), "Interface");
    EXPECT_EQ(section->block_name(), "my line");
    const SourceText &where = section->find("where")->value;
    EXPECT_EQ(where.text(), "x > 1 && y < 2");
    EXPECT_EQ(where.locate(0, 5).line, 5u);
    EXPECT_EQ(where.locate(9, 1).line, 7u);
    EXPECT_EQ(where.locate(9, 1).column, 6u);
    EXPECT_EQ(section->find("law")->value.text(), "");
  }

  TEST(ParameterFiles, Include)
  {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("nsfd_input_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder / "parts");
    std::ofstream(folder / "parts" / "mesh.prm")
        << "subsection Mesh\n  set upper corner = 1, 1\n  set cells = 1, "
           "1\nend\n"
        << "include other.prm\n";
    std::ofstream(folder / "parts" / "other.prm") << "set dimension = 2\n";
    const std::string rest =
        small_scene.substr(small_scene.find("subsection Material"));
    std::ofstream(folder / "main.prm") << "include parts/mesh.prm\n" << rest;
    std::ofstream(folder / "loop.prm") << "\ninclude ./loop.prm\n";
    std::ofstream(folder / "twice.prm") << "set dimension = 2\n"
                                        << "include parts/other.prm\n";

    InputErrors errors;
    const auto scene = read_scene((folder / "main.prm").string(), {}, errors);
    EXPECT_EQ(errors.report(), "");
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->mesh.upper, (std::vector<double>{1., 1.}));

    InputErrors loop;
    ParameterFile().read_file((folder / "loop.prm").string(), loop);
    EXPECT_NE(loop.report().find("loop.prm:2: error:"), std::string::npos);
    EXPECT_NE(loop.report().find("includes itself"), std::string::npos);

    InputErrors twice;
    ParameterFile().read_file((folder / "twice.prm").string(), twice);
    EXPECT_NE(twice.report().find("other.prm:1: error: `dimension` is given "
                                  "twice"),
              std::string::npos)
        << twice.report();
    std::filesystem::remove_all(folder);
  }

  TEST(ParameterFiles, WhatIsNoFileIsRefused)
  {
    InputErrors missing, folder;
    EXPECT_EQ(read_scene("no/such.prm", {}, missing), nullptr);
    EXPECT_NE(missing.report().find("`no/such.prm` cannot be read"),
              std::string::npos);
    EXPECT_EQ(missing.n_errors(), 1u);
    EXPECT_EQ(read_scene("/tmp", {}, folder), nullptr);
    EXPECT_NE(folder.report().find("is a folder"), std::string::npos);
  }

  TEST(Messages, AreSortedByLineAndCounted)
  {
    const std::string report =
        report_of(replaced(replaced(small_scene, "0.32", "0.7"),
                           "set dimension = 2", "set dimension = 5"));
    EXPECT_EQ(report,
              "small.prm:2: error: dimension = 5 must be at most 3\n"
              "   2 | set dimension = 5\n"
              "     |                 ^\n"
              "  write for example: 2\n"
              "small.prm:9: error: Poisson ratio = 0.7 must be greater than -1 "
              "and less than 0.5\n"
              "   9 |   set Poisson ratio = 0.7\n"
              "     |                       ^~~\n"
              "  write for example: 0.32\n"
              "2 errors, nothing was run\n");
  }

  TEST(Messages, OneFaultGivesOneError)
  {
    // what depends on a wrong value is not blamed as well
    for (const auto &[from, to] : std::vector<std::array<std::string, 2>>{
             {"135 GPa", "135 Gpa"},
             {"set Poisson ratio", "set Poison ratio"},
             {"set end", "set ende"},
             {"set law = rigid", "set law = rigit\n  set friction = 0.3"},
             {"set upper corner = 10 um, 20 um", "set upper corner = 10 um"},
             {"set cells = 2, 4", "set cells = 2, a"},
             {"set cells = 2, 4", "set type = brik\n  set cells = 2, 4"},
             {"set end = 10 ns", "set end = 10 ns\n  set theta = o.5"},
             {"set dimension = 2",
              "subsection Constants\n set a = b\nend\n"
              "subsection Loads\n set gravity = 0, a\nend"}}) {
      InputErrors errors;
      read_scene_text(replaced(small_scene, from, to), "f", {}, errors);
      EXPECT_EQ(errors.n_errors(), 1u) << errors.report();
    }
  }

  TEST(Messages, NearestNames)
  {
    EXPECT_EQ(nearest_name("strenght", {"stiffness", "strength"}), "strength");
    EXPECT_EQ(nearest_name("DEGREE", {"mass", "degree"}), "degree");
    EXPECT_EQ(nearest_name("modulus", {"Poisson ratio", "Young modulus"}),
              "Young modulus");
    EXPECT_EQ(nearest_name("banana", {"mass", "degree"}), "");
    EXPECT_EQ(nearest_name("q", {"x", "y"}), "");
    EXPECT_EQ(did_you_mean("mas", {"mass"}), "did you mean `mass`?");
  }

  TEST(Messages, LongLinesAndStrangeBytesStayReadable)
  {
    const std::string report = report_of(
        "set dimension = " + std::string(3000, ' ') + "7 \x01\n" + small_scene);
    EXPECT_NE(report.find("^"), std::string::npos);
    EXPECT_EQ(report.find('\x01'), std::string::npos);
    std::istringstream lines(report);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LT(line.size(), 200u);
  }

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
    EXPECT_EQ(scene->time.step_kind, StepKind::crossings);
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
  set path = element-wise
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
    EXPECT_EQ(step("2 crossings").step, 2.);
    EXPECT_EQ(step("0.6crossings").step_kind, StepKind::crossings);
    EXPECT_EQ(step("1e-9").step_kind, StepKind::time);
    EXPECT_EQ(step("2e-3 ns").step, 2e-12);
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
         {"# small - the least that runs", "set dimension = 2",
          "set theta            = 0.5", "  set degree               = 3",
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

  // --- command line

  TEST(CommandLineTest, Options)
  {
    const Parsed parsed =
        parse({"a.prm", "--set", "Time/theta=0.6", "--force", "--set",
               "Interface: x/where=between materials [a, b]", "--output", "out",
               "--quiet", "--check", "--print-parameters"});
    EXPECT_EQ(parsed.code, -1) << parsed.err;
    const CommandLine &line = parsed.command_line;
    EXPECT_EQ(line.file, "a.prm");
    EXPECT_EQ(line.set, (std::vector<std::string>{
                            "Time/theta=0.6",
                            "Interface: x/where=between materials [a, b]"}));
    EXPECT_TRUE(line.force && line.quiet && line.check &&
                line.print_parameters);
    EXPECT_EQ(line.output, "out");
    EXPECT_EQ(line.overrides().back(), "Output/directory=out");
    EXPECT_EQ(parse({"--set", "a=b", "a.prm"}).command_line.file, "a.prm");
    EXPECT_EQ(parse({"--set=Mesh/cells=[1,2]", "a.prm"}).command_line.set,
              (std::vector<std::string>{"Mesh/cells=[1,2]"}));
    for (const std::vector<const char *> &arguments :
         {std::vector<const char *>{"a.prm", "--resume", "--output", "b"},
          {"a.prm", "--resume", "b"},
          {"--resume=b", "a.prm"},
          {"--resume", "a.prm", "--output", "b"}}) {
      const CommandLine line = parse(arguments).command_line;
      EXPECT_TRUE(line.resume);
      EXPECT_EQ(line.file, "a.prm");
      EXPECT_EQ(line.output, "b");
    }
  }

  TEST(CommandLineTest, InformationEndsWithZero)
  {
    const Parsed help = parse({"--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("--print-parameters"), std::string::npos);
    EXPECT_NE(help.out.find("--resume"), std::string::npos);
    EXPECT_EQ(parse({"--version"}).code, 0);
    EXPECT_NE(parse({"--version"}).out.find("nsfd "), std::string::npos);
    const Parsed list = parse({"--list"});
    EXPECT_EQ(list.code, 0);
    for (const char *name :
         {"camacho-ortiz", "rigid", "rectangle", "gauss seidel", "hyper_cube"})
      EXPECT_NE(list.out.find(name), std::string::npos) << name;
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      for (const std::string &example : entry.examples) {
        const bool is_first = &example == &entry.examples.front();
        EXPECT_EQ(list.out.find(": " + example + "\n") != std::string::npos,
                  is_first)
            << name << ": " << example;
      }
  }

  TEST(CommandLineTest, WrongUsageEndsWithTwo)
  {
    const auto fails = [](const std::vector<const char *> &arguments,
                          const std::string &message) {
      const Parsed parsed = parse(arguments);
      EXPECT_EQ(parsed.code, 2) << message;
      EXPECT_EQ(parsed.out, "");
      EXPECT_NE(parsed.err.find(message), std::string::npos) << parsed.err;
    };
    fails({}, "run a scene");
    fails({"a.prm", "--froce"}, "did you mean `--force`?");
    fails({"a.prm", "-x"}, "there is no option `-x`");
    fails({"a.prm", "b.prm"}, "`b.prm` is one file too many");
    fails({"--check"}, "no parameter file is named");
    fails({"a.prm", "--set"}, "--set");
    fails({"a.prm", "--set", "theta"}, "there is no `=`");
    fails({"law"}, "no law is named");
    fails({"law", "rcc", "--stpes=3"}, "did you mean `--steps`?");
    fails({"a.prm", "--resume", "b", "--output", "c"}, "are two folders");
    fails({"a.prm", "--resume", "--force"}, "exclude each other");
    fails({"--resume"}, "no parameter file is named");
    fails({"a.prm", "--force=maybe"}, "--force");
  }
} // namespace nsfd::test_input
