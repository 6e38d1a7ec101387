#include "parameters/parameter_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace nsfd::test_expressions
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

    struct PlanePoint {
      static constexpr unsigned int dimension = 2;
      double operator[](const unsigned int i) const { return i + 1.; }
    };

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

    // reports print the step in picoseconds
    EXPECT_DOUBLE_EQ(read_expression("30.5 ps", units::time)(0., 0., 0.),
                     30.5e-12);
    EXPECT_DOUBLE_EQ(read_expression("1.05 TPa", units::pressure)(0., 0., 0.),
                     1.05e12);

    // products of units below the line, as they are printed
    for (const char *text : {"800 J/(kg K)", "800 J/(kg*K)", "800 J / ( kg K )",
                             "0.8 kJ/(K kg)", "800 J/kg/K"})
      EXPECT_DOUBLE_EQ(read_expression(text, units::heat_capacity)(0., 0., 0.),
                       800.)
          << text;
    EXPECT_DOUBLE_EQ(read_expression("6 m/(2*y)", units::length)(0., 3., 0.),
                     1.);

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
} // namespace nsfd::test_expressions
