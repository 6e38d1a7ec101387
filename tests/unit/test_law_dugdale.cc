#include "law_checks.h"

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_dugdale
{
  TEST(Dugdale, ClosedForms)
  {
    const double R = 30e6, d_c = 2e-6, G = 60.;
    for (const LawEntries &entries :
         {LawEntries{{"strength", "30 MPa"}, {"toughness", "60 J/m^2"}},
          LawEntries{{"strength", "30 MPa"}, {"critical opening", "2 um"}},
          LawEntries{{"toughness", "60 J/m^2"},
                     {"critical opening", "2 um"}}}) {
      const auto law = make_law("dugdale", entries);
      EXPECT_TRUE(law->extrinsic());
      EXPECT_TRUE(law->has_potential());
      expect_relative(law->strength(), R);
      expect_relative(law->toughness(), G);
      expect_relative(law->final_opening(), d_c);
      expect_relative(law->toughness() / (R * law->final_opening()), 1.);
      EXPECT_TRUE(std::isinf(law->steepest_softening()));
      for (const double x : {0., 0.1, 0.5, 0.999}) {
        EXPECT_EQ(law->beta(x * d_c), 1.);
        EXPECT_EQ(law->traction(x * d_c), law->strength());
        expect_relative(law->energy(x * d_c), R * x * d_c);
      }
      // closed again from d_m on the secant: R_max d_m / 2
      for (const double x : {0.1, 0.5, 0.999})
        expect_relative(law->energy(x * d_c) - stored(*law, x * d_c),
                        0.5 * R * x * d_c);
      expect_toughness(*law, {0., law->final_opening(), 3. * d_c});
      expect_broken_beyond(*law, d_c);
    }
  }

  TEST(Dugdale, TheJump)
  {
    const auto law = make_law(
        "dugdale", {{"strength", "30 MPa"}, {"critical opening", "2 um"}});
    const double d_c = law->final_opening();
    EXPECT_EQ(law->beta(std::nextafter(d_c, 0.)), 1.);
    EXPECT_EQ(law->beta(d_c), 0.);
    EXPECT_EQ(law->traction(d_c), 0.);
    EXPECT_EQ(law->energy(d_c), law->toughness());
    for (const double step : {1e-3, 1e-6, 1e-9}) {
      const double before = d_c * (1. - step), after = d_c * (1. + step);
      EXPECT_EQ(law->energy_increment(before, after),
                law->strength() * (d_c - before));
      EXPECT_EQ(law->energy_increment(d_c, after), 0.);
    }
  }

  TEST(Dugdale, ModeMixity)
  {
    const auto law = make_law("dugdale", {{"strength", "30 MPa"},
                                          {"critical opening", "2 um"},
                                          {"mode mixity", "2"}});
    expect_relative(law->shear_weight(), 4.);
    expect_relative(law->stiffness_ratio(), 4.);
    EXPECT_TRUE(law->has_potential());
  }

  TEST(Dugdale, WrongEntries)
  {
    expect_error("dugdale",
                 {{"strength", "30 MPa"},
                  {"toughness", "60 J/m^2"},
                  {"critical opening", "2 um"}},
                 "G = R_max d_c");
    expect_error("dugdale", {{"strength", "30 MPa"}}, "needs two of");
    expect_error("dugdale", {{"strength", "-1"}, {"toughness", "1"}},
                 "strength = -1");
  }
} // namespace test_law_dugdale
