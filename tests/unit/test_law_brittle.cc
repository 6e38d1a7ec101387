#include "law_checks.h"

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_brittle
{
  TEST(Brittle, ClosedForms)
  {
    // C = 5e12 Pa/m, R_max = 10 MPa, hence d_0 = 2 um and G = 10 J/m^2
    const double C = 5e12, R = 10e6, d_0 = 2e-6, G = 10.;
    for (const LawEntries &entries :
         {LawEntries{{"stiffness", "5e12"}, {"strength", "10 MPa"}},
          LawEntries{{"stiffness", "5e12"}, {"toughness", "10 J/m^2"}},
          LawEntries{{"strength", "10 MPa"}, {"toughness", "10 J/m^2"}}}) {
      const auto law = make_law("brittle", entries);
      EXPECT_FALSE(law->extrinsic());
      EXPECT_TRUE(law->has_potential());
      expect_relative(law->normal_stiffness(), C);
      expect_relative(law->strength(), R);
      expect_relative(law->toughness(), G);
      expect_relative(law->elastic_limit(), d_0);
      expect_relative(law->peak_opening(), d_0);
      expect_relative(law->final_opening(), d_0);
      expect_relative(law->toughness() / (R * law->final_opening()), 0.5);
      EXPECT_TRUE(std::isinf(law->steepest_softening()));
      for (const double x : {0.1, 0.5, 0.999}) {
        EXPECT_EQ(law->beta(x * d_0), 1.);
        expect_relative(law->traction(x * d_0), C * x * d_0);
        expect_relative(law->energy(x * d_0), G * x * x);
        // nothing is lost before
        expect_relative(stored(*law, x * d_0), G * x * x);
        expect_slope(*law, x * d_0, C, 1e-4 * d_0);
      }
      expect_toughness(*law, {0., law->elastic_limit(), 3. * d_0});
      expect_broken_beyond(*law, d_0);
    }
  }

  TEST(Brittle, TheJump)
  {
    const auto law =
        make_law("brittle", {{"stiffness", "5e12"}, {"strength", "10 MPa"}});
    const double last = law->elastic_limit(), first = law->final_opening();
    EXPECT_GT(first, last);
    EXPECT_EQ(law->beta(last), 1.);
    EXPECT_EQ(law->beta(first), 0.);
    expect_relative(law->traction(last), law->strength());
    EXPECT_EQ(law->traction(first), 0.);
    // the area does not jump, what is stored does
    expect_relative(law->energy(last), law->toughness());
    expect_relative(law->energy(first), law->toughness());
    expect_relative(stored(*law, last), law->toughness());
    EXPECT_EQ(stored(*law, first), 0.);
    // increments that end at or cross it
    const double unit = law->strength() * last;
    for (const double step : {1e-3, 1e-6, 1e-9}) {
      const double before = last * (1. - step), after = last * (1. + step);
      const double exact = unit * step * (1. - step / 2.);
      EXPECT_NEAR(law->energy_increment(before, last), exact, 1e-15 * unit);
      EXPECT_NEAR(law->energy_increment(before, after), exact, 1e-15 * unit);
      EXPECT_NEAR(law->energy_increment(last, after), 0., 1e-15 * unit);
    }
  }

  TEST(Brittle, TangentialStiffness)
  {
    const auto law = make_law("brittle", {{"stiffness", "5e12"},
                                          {"strength", "10 MPa"},
                                          {"tangential stiffness", "2e12"}});
    expect_relative(law->stiffness_ratio(), 0.4);
    expect_relative(law->shear_weight(), 0.4);
    EXPECT_TRUE(law->has_potential());
  }

  TEST(Brittle, WrongEntries)
  {
    expect_error("brittle",
                 {{"stiffness", "5e12"},
                  {"strength", "10 MPa"},
                  {"toughness", "10 J/m^2"}},
                 "G = R_max^2 / (2 C)");
    expect_error("brittle", {{"stiffness", "5e12"}}, "needs two of");
    expect_error("brittle", {{"stiffness", "0"}, {"strength", "10 MPa"}},
                 "stiffness = 0");
  }
} // namespace test_law_brittle
