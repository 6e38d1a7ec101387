#include "material_point/read_law.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

// Section `Bar` of `nsfd law`: what it refuses, and of what it warns.

using namespace nsfd;

TEST(BarInput, WarnsOfStepsWithSeveralSolutions)
{
  const std::vector<std::string> entries = {
      "strength=1 MPa",       "toughness=10 J/m^2",
      "Bar/mode=dynamic",     "Bar/mass=1.25 kg/m^2",
      "Bar/theta=1",          "Bar/cohesion rule=end point",
      "Bar/stiffness=1 Pa/m", "Bar/speed=1 mm/s",
      "Bar/end=1 nm"};
  for (const auto &[step, warned] :
       {std::make_pair("3.10 us", false), std::make_pair("3.11 us", true)}) {
    InputErrors errors;
    auto all = entries;
    all.push_back(std::string("Bar/step=") + step);
    EXPECT_NE(read_law("michel-suquet", all, errors), nullptr);
    const std::string report = errors.report();
    EXPECT_EQ(report.find("several solutions") != std::string::npos, warned)
        << report;
    EXPECT_EQ(report.find("set step = 2.95e-06 s") != std::string::npos, warned)
        << report;
  }
}

TEST(BarInput, Refusals)
{
  const auto report = [](std::vector<std::string> entries) {
    InputErrors errors;
    EXPECT_EQ(read_law("michel-suquet", entries, errors), nullptr);
    return errors.report();
  };
  const auto has = [](const std::string &text, const std::string &part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(report({"Bar/mode=static"}), "stiffness");
  has(report({"Bar/stiffness=1 GPa/m", "Path/type=shear"}),
      "a point has a path or a bar, not both");
  has(report({"Bar/stiffness=1 GPa/m", "Bar/mass=1"}), "only mode = dynamic");
  has(report({"Bar/stiffness=1 GPa/m", "Bar/speed=1"}), "knows no time");
  has(report({"Bar/stiffness=1e30", "Bar/mode=viscous", "Bar/viscosity=1"}),
      "stays in equilibrium");
  has(report({"Bar/stiffness=1 GPa/m", "Bar/mode=viscous", "Bar/viscosity=1",
              "Bar/speed=1e-20"}),
      "steps");
}
