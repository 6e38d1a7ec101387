#include "law_checks.h"

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_trapezoid
{
  // l1 = 0.15, l2 = 0.5 by default
  std::unique_ptr<CohesiveLaw> trapezoid()
  {
    return make_law("trapezoid",
                    {{"strength", "3 MPa"}, {"critical opening", "2 um"}});
  }

  TEST(Trapezoid, ClosedForms)
  {
    const double R = 3e6, d_c = 2e-6, l1 = 0.15, l2 = 0.5;
    const auto law = trapezoid();
    EXPECT_FALSE(law->extrinsic());
    EXPECT_TRUE(law->has_potential());
    expect_relative(law->normal_stiffness(), R / (l1 * d_c));
    expect_relative(law->elastic_limit(), l1 * d_c);
    expect_relative(law->peak_opening(), l2 * d_c);
    expect_relative(law->final_opening(), d_c);
    expect_relative(law->strength(), R);
    expect_relative(law->toughness(), R * d_c * (1. + l2 - l1) / 2.);
    expect_relative(law->toughness() / (R * d_c), 0.675);
    expect_relative(law->steepest_softening(), R / (d_c * (1. - l2)));
    expect_relative(law->steepest_softening() * law->toughness() / (R * R),
                    1.35);
    for (const double x : {0.01, 0.1, 0.149}) {
      EXPECT_EQ(law->beta(x * d_c), 1.);
      expect_relative(law->traction(x * d_c), R * x / l1);
      expect_relative(law->energy(x * d_c), R * d_c * x * x / (2. * l1));
      expect_slope(*law, x * d_c, R / (l1 * d_c), 1e-4 * d_c);
    }
    for (const double x : {0.16, 0.3, 0.5}) {
      expect_relative(law->beta(x * d_c), l1 / x);
      EXPECT_EQ(law->traction(x * d_c), R);
      expect_relative(law->energy(x * d_c), R * d_c * (x - l1 / 2.));
    }
    for (const double x : {0.51, 0.7, 0.99}) {
      const double T = R * (1. - x) / (1. - l2);
      expect_relative(law->beta(x * d_c), l1 * (1. - x) / (x * (1. - l2)),
                      1e-12 / (1. - x));
      expect_relative(law->traction(x * d_c), T, 1e-12 / (1. - x));
      expect_relative(law->energy(x * d_c),
                      law->toughness() - T * (1. - x) * d_c / 2.);
      expect_slope(*law, x * d_c, -R / (d_c * (1. - l2)), 1e-4 * d_c);
    }
    expect_toughness(*law, {0., l1 * d_c, l2 * d_c, d_c});
    expect_broken_beyond(*law, d_c);
  }

  TEST(Trapezoid, PlateauDissipates)
  {
    // unloaded from the middle of the plateau: R_max (d - d_1) / 2 is lost
    const double R = 3e6, d_c = 2e-6, d = 0.3 * d_c;
    const auto law = trapezoid();
    expect_relative(stored(*law, d), R * d / 2.);
    expect_relative(law->energy(d) - stored(*law, d),
                    R * (d - 0.15 * d_c) / 2.);
  }

  TEST(Trapezoid, AnyTwo)
  {
    // G = (1 + 0.6 - 0.2) / 2 * 3 MPa * 2 um = 4.2 J/m^2
    const LawEntries shapes[] = {
        {{"strength", "3 MPa"}, {"critical opening", "2 um"}},
        {{"strength", "3 MPa"}, {"toughness", "4.2 J/m^2"}},
        {{"toughness", "4.2 J/m^2"}, {"critical opening", "2 um"}}};
    for (LawEntries entries : shapes) {
      entries.push_back({"l1", "0.2"});
      entries.push_back({"l2", "0.6"});
      entries.push_back({"tangential critical opening", "1 um"});
      const auto law = make_law("trapezoid", entries);
      expect_relative(law->strength(), 3e6);
      expect_relative(law->toughness(), 4.2);
      expect_relative(law->final_opening(), 2e-6);
      expect_relative(law->elastic_limit(), 0.4e-6);
      expect_relative(law->peak_opening(), 1.2e-6);
      expect_relative(law->shear_weight(), 4.);
      EXPECT_TRUE(law->has_potential());
    }
  }

  TEST(Trapezoid, BilinearWithoutPlateau)
  {
    const auto law = make_law("trapezoid", {{"strength", "3 MPa"},
                                            {"critical opening", "2 um"},
                                            {"l1", "0.02"},
                                            {"l2", "0.02"}});
    const auto bilinear =
        make_law("geubelle-baylor", {{"strength", "3 MPa"},
                                     {"critical opening", "2 um"},
                                     {"initial strength parameter", "0.98"}});
    for (const double x : {0.01, 0.02, 0.03, 0.5, 0.9}) {
      expect_relative(law->traction(x * 2e-6), bilinear->traction(x * 2e-6));
      expect_relative(law->beta(x * 2e-6), bilinear->beta(x * 2e-6));
      expect_relative(law->energy(x * 2e-6), bilinear->energy(x * 2e-6));
    }
    expect_relative(law->steepest_softening(), bilinear->steepest_softening());
  }

  TEST(Trapezoid, WrongEntries)
  {
    expect_error("trapezoid",
                 {{"strength", "3 MPa"},
                  {"toughness", "3 J/m^2"},
                  {"critical opening", "2 um"}},
                 "G = (1 + l2 - l1) / 2 R_max d_c");
    expect_error("trapezoid", {{"strength", "3 MPa"}}, "needs two of");
    expect_error(
        "trapezoid",
        {{"strength", "3 MPa"}, {"critical opening", "2 um"}, {"l1", "0.6"}},
        "l2 is below l1");
    expect_error(
        "trapezoid",
        {{"strength", "3 MPa"}, {"critical opening", "2 um"}, {"l2", "1"}},
        "l2 = 1");
    expect_error(
        "trapezoid",
        {{"strength", "3 MPa"}, {"critical opening", "2 um"}, {"l1", "0"}},
        "l1 = 0");
  }
} // namespace test_law_trapezoid
