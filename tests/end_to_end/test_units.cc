#include "compare.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <ostream>

// Copies of a scene in bare numbers of other units give the same dimensionless
// results: there is no absolute tolerance in the program.

namespace end_to_end::test_units
{
  namespace
  {
    /**
     * One unit of length, stress and time in SI. The unit of mass follows: a
     * density rho is counted in stress time^2 / length^2, which is 1e9 kg/m^3
     * in nm, GPa, ns; a velocity keeps its number there.
     */
    struct Units {
      std::string name;
      double length, stress, time;
    };
    const Units si = {"m, Pa, s", 1., 1., 1.};
    const Units small = {"nm, GPa, ns", 1e-9, 1e9, 1e-9};
    const Units large = {"km, MPa, h", 1e3, 1e6, 3600.};

    /** Exponents of length, stress and time. */
    const std::map<std::string, std::array<int, 3>> dimensions = {
        {"length", {1, 0, 0}},    {"stress", {0, 1, 0}},
        {"time", {0, 0, 1}},      {"velocity", {1, 0, -1}},
        {"density", {-2, 1, 2}},  {"stiffness", {-1, 1, 0}},
        {"toughness", {1, 1, 0}}, {"energy per depth", {2, 1, 0}},
    };

    /** "abs(x - {5e-6 length})" with the numbers counted in @p units. */
    std::string in_units(const std::string &text, const Units &units)
    {
      std::string result;
      std::size_t at = 0;
      while (true) {
        const std::size_t open = text.find('{', at);
        result += text.substr(at, open - at);
        if (open == std::string::npos)
          return result;
        const std::size_t close = text.find('}', open);
        const std::string inner = text.substr(open + 1, close - open - 1);
        const std::size_t blank = inner.find(' ');
        const auto &exponents = dimensions.at(inner.substr(blank + 1));
        const double unit = std::pow(units.length, exponents[0]) *
                            std::pow(units.stress, exponents[1]) *
                            std::pow(units.time, exponents[2]);
        char number[40];
        std::snprintf(number, sizeof(number), "%.17g",
                      std::stod(inner.substr(0, blank)) / unit);
        result += number;
        at = close + 1;
      }
    }

    struct UnitRow {
      std::string name;
      std::vector<std::string> set;
      double tolerance;
    };

    const std::vector<UnitRow> rows = {
        {"bar_wall",
         {"Mesh/cells=30, 1", "Mesh/upper corner={10 length}, {0.1 length}",
          "Material: bar/Young modulus={900 stress}",
          "Material: bar/density={1 density}",
          "Material: bar/initial velocity x={-10 velocity}",
          "Obstacle: wall/point={-5 length}, 0", "Time/end={1.4 time}"},
         1e-9},
        {"midplane",
         {"Mesh/cells=10, 10",
          "Mesh/upper corner={10e-6 length}, {10e-6 length}",
          "Material: bulk/Young modulus={135e9 stress}",
          "Material: bulk/density={7800 density}",
          "Interface: midline/where=abs(x - {5e-6 length}) < {1e-9 length}",
          "Interface: midline/strength={300e6 stress}",
          "Interface: midline/toughness={0.5 toughness}",
          "Boundary: left/velocity x={-2 velocity}",
          "Boundary: right/velocity x={2 velocity}", "Time/end={10e-9 time}",
          "Verification/exact dissipation={5e-6 energy per depth}",
          "Verification/force times={1e-9 time}"},
         1e-9},
        {"patch_blocks",
         {"Mesh/upper corner={4 length}, {4 length}",
          "Material: block/Young modulus={1 stress}",
          "Material: block/density={1 density}",
          "Interface: springs/normal stiffness={5 stiffness}",
          "Interface: springs/tangential stiffness={2 stiffness}",
          "Boundary: left/traction x={-1e-3 stress}",
          "Boundary: right/traction x={1e-3 stress}", "Time/end={1000 time}",
          "Time/step={20 time}"},
         1e-9},
        {"rigid_motion",
         {"Mesh/upper corner={3 length}, {2 length}",
          "Material: body/Young modulus={200e9 stress}",
          "Material: body/density={8000 density}",
          "Material: body/initial velocity x={3 velocity} - (y - {1 length}) * "
          "0.5 * {1 velocity} / {1 length}",
          "Material: body/initial velocity y={-2 velocity} + (x - {1 length}) "
          "* 0.5 * {1 velocity} / {1 length}",
          "Interface: springs/normal stiffness={8e12 stiffness}",
          "Interface: springs/tangential stiffness={4e12 stiffness}",
          "Time/end={2e-3 time}"},
         1e-9},
        // damage, contact, friction, scattered strengths, crack pressure
        {"torn_plate",
         {"Mesh/cells=12, 9", "Constants/pull={4 velocity}",
          "Constants/push={4 velocity}", "Constants/rub={2 velocity}",
          "Constants/turn={70e-6 time}",
          "Mesh/upper corner={60e-3 length}, {42.5e-3 length}",
          "Mesh/notch length={20e-3 length}",
          "Mesh/notch height={21.25e-3 length}",
          "Mesh/notch width={2.5e-3 length}",
          "Material: PMMA/Young modulus={3.24e9 stress}",
          "Material: PMMA/density={1190 density}",
          "Interface: all/stiffness={2.72e13 stiffness}",
          "Interface: all/toughness={350 toughness}",
          "Interface: all/crack pressure={1e5 stress} * (1 + y / {1 length})",
          "Boundary: top/velocity x=if(t < turn, 0, rub)",
          "Boundary: bottom/velocity x=if(t < turn, 0, -rub)",
          "Time/step={0.4e-6 time}", "Time/end={100e-6 time}"},
         1e-9},
    };

    Result in(const Units &units, const Workspace &workspace,
              const UnitRow &row)
    {
      std::vector<std::string> set = {"Output/fields every=0",
                                      "Solver/tolerance=1e-12"};
      for (const std::string &assignment : row.set)
        set.push_back(in_units(assignment, units));
      return good_run(
          workspace, units.name,
          {row.name == "torn_plate" ? torn_plate() : scene(row.name), set});
    }

    void PrintTo(const UnitRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    class UnitsTest : public testing::TestWithParam<UnitRow>
    {
    };
  } // namespace

  TEST(Units, ConversionOfTheTest)
  {
    // kg/m^3 to GPa ns^2/nm^2
    EXPECT_NEAR(std::stod(in_units("{7800 density}", small)), 7.8e-6, 1e-20);
    EXPECT_NEAR(std::stod(in_units("{2 velocity}", small)), 2., 1e-14);
    EXPECT_NEAR(std::stod(in_units("{2 velocity}", large)), 7.2, 1e-14);
    EXPECT_EQ(in_units("abs(x - {3000 length}) < 1", large), "abs(x - 3) < 1");
  }

  TEST_P(UnitsTest, DoNotMatter)
  {
    const UnitRow &row = GetParam();
    const Workspace workspace;
    const Result reference = in(si, workspace, row);
    ASSERT_TRUE(reference.completed());
    for (const Units &units : {small, large}) {
      const Result other = in(units, workspace, row);
      ASSERT_TRUE(other.completed());
      expect_below(units.name + ": energies",
                   energy_difference(reference.history, other.history),
                   row.tolerance);
      for (const std::string &name : reference.history.names())
        if (name.rfind("reaction_", 0) == 0 || name == "broken_area" ||
            name == "time" || name == "time_step")
          expect_below(
              units.name + ": " + name,
              column_difference(reference.history, name, other.history, name),
              // a reaction is an impulse over a step
              10. * row.tolerance);
      for (const auto &[key, value] : reference.summary["errors"].items())
        if (key != "compliance" && key != "peak_force" &&
            key != "separation_time" && key.rfind("force_", 0) != 0)
          expect_below(units.name + ": " + key,
                       std::abs(other.error(key) - value.get<double>()),
                       row.tolerance);
    }
  }

  INSTANTIATE_TEST_SUITE_P(Table, UnitsTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_units
