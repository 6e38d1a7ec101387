#include "input/read_scene.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

// Entries of materials that flow, and everything that does not fit to them.

namespace nsfd::test_plastic_input
{
  namespace
  {
    const std::string steel = R"(# steel - a plate that flows
set dimension = 2
subsection Mesh
  set type = rectangle
  set upper corner = 3 mm, 1 mm
  set cells = 3, 1
end
subsection Material: steel
  set model = viscoplastic
  set Young modulus = 200 GPa
  set Poisson ratio = 0.3
  set density = 7.8 g/cm^3
  set yield stress = 300 MPa
  set isotropic hardening modulus = 1 GPa
  set kinematic hardening modulus = 2 GPa
  set saturation stress = 100 MPa
  set saturation exponent = 20
  set viscosity = 3 kPa*s
  set rate exponent = 4
  set reference rate = 100 1/s
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end = 1 ms
  set step = 1 us
end
)";

    std::unique_ptr<SceneInput> read(const std::string &text,
                                     const std::vector<std::string> &overrides,
                                     InputErrors &errors)
    {
      return read_scene_text(text, "steel.prm", overrides, errors);
    }

    TEST(PlasticInput, EveryEntry)
    {
      InputErrors errors;
      const auto scene = read(steel, {}, errors);
      ASSERT_TRUE(scene) << errors.report();
      ASSERT_TRUE(scene->has_history());
      const PlasticInput &plastic = *scene->materials[0].plastic;
      EXPECT_DOUBLE_EQ(plastic.yield_stress, 300e6);
      EXPECT_DOUBLE_EQ(plastic.isotropic, 1e9);
      EXPECT_DOUBLE_EQ(plastic.kinematic, 2e9);
      EXPECT_DOUBLE_EQ(plastic.saturation_stress, 100e6);
      EXPECT_DOUBLE_EQ(plastic.saturation_exponent, 20.);
      EXPECT_DOUBLE_EQ(plastic.viscosity, 3e3);
      EXPECT_DOUBLE_EQ(plastic.rate_exponent, 4.);
      EXPECT_DOUBLE_EQ(plastic.reference_rate, 100.);
    }

    TEST(PlasticInput, EchoReadsBackTheSame)
    {
      InputErrors errors;
      const auto first = read(steel, {}, errors);
      ASSERT_TRUE(first) << errors.report();
      const auto second = read(first->echo, {}, errors);
      ASSERT_TRUE(second) << errors.report();
      EXPECT_EQ(second->materials[0].plastic->viscosity,
                first->materials[0].plastic->viscosity);
      EXPECT_EQ(second->echo, first->echo);
    }

    struct Refused {
      std::vector<std::string> overrides;
      std::string message;
    };

    TEST(PlasticInput, WhatDoesNotFitIsRefused)
    {
      const std::string at = "Material: steel/";
      const std::vector<Refused> table = {
          {{at + "yield stress=0"}, "yield stress"},
          {{at + "yield stress=3 m"}, "yield stress"},
          {{at + "isotropic hardening modulus=-1 GPa"},
           "isotropic hardening modulus"},
          {{at + "saturation stress=0"}, "there is no `saturation stress`"},
          {{at + "viscosity=0"}, "viscosity"},
          {{at + "viscosity=1 MPa"}, "viscosity"},
          {{at + "rate exponent=0.5"}, "rate exponent"},
          {{at + "rate exponent=1"}, "reference rate"},
          {{"plane=stress", "motion=large"},
           "model = viscoplastic is not available for plane = stress"},
          {{"Interface: all/law=bonded"},
           "joins bodies without history, and the scene has model = "
           "viscoplastic"},
          {{"Solver/path=assembled"}, "path = assembled has one matrix"},
          {{"Time/scheme=symplectic"},
           "scheme = symplectic is not available for model = viscoplastic"},
          {{"Time/start=equilibrium"}, "equilibria of scenes with model"},
      };
      for (const Refused &row : table) {
        InputErrors errors;
        EXPECT_EQ(read(steel, row.overrides, errors), nullptr)
            << row.overrides[0];
        EXPECT_EQ(errors.n_errors(), 1u) << errors.report();
        EXPECT_NE(errors.report().find(row.message), std::string::npos)
            << errors.report();
      }
      InputErrors errors; // four entries too many
      EXPECT_EQ(read(steel, {at + "model=j2 plastic"}, errors), nullptr);
      EXPECT_EQ(errors.n_errors(), 3u) << errors.report();
      InputErrors power; // in place of the linear and the saturating part
      EXPECT_EQ(read(steel, {at + "hardening exponent=0.1"}, power), nullptr);
      EXPECT_EQ(power.n_errors(), 3u) << power.report();
      EXPECT_NE(power.report().find("grows by the power law"),
                std::string::npos)
          << power.report();
      InputErrors linear; // N = 1 would be an elastic bar
      EXPECT_EQ(read(steel, {at + "hardening exponent=1"}, linear), nullptr);
      EXPECT_EQ(linear.n_errors(), 4u) << linear.report();
      InputErrors elastic;
      EXPECT_EQ(read(steel, {at + "model=linear elastic"}, elastic), nullptr);
      EXPECT_EQ(elastic.n_errors(), 8u) << elastic.report();
    }
  } // namespace
} // namespace nsfd::test_plastic_input
