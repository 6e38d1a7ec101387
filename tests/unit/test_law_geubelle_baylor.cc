#include "law_checks.h"

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_geubelle_baylor
{
  // d_c = 2 um, S_i = 0.98, hence d_0 = 0.04 um
  std::unique_ptr<CohesiveLaw> geubelle_baylor(const std::string &strength)
  {
    return make_law("geubelle-baylor",
                    {{"strength", strength},
                     {"critical opening", "2 um"},
                     {"initial strength parameter", "0.98"}});
  }

  TEST(GeubelleBaylor, StrengthIsThePeak)
  {
    const double R = 3e6, d_c = 2e-6, d_0 = 0.02 * d_c;
    const auto law = geubelle_baylor("3 MPa");
    EXPECT_FALSE(law->extrinsic());
    EXPECT_TRUE(law->has_potential());
    expect_relative(law->normal_stiffness(), R / d_0);
    expect_relative(law->elastic_limit(), d_0);
    expect_relative(law->peak_opening(), d_0);
    expect_relative(law->final_opening(), d_c);
    expect_relative(law->strength(), R);
    expect_relative(law->toughness(), R * d_c / 2.);
    expect_relative(law->toughness() / (R * d_c), 0.5);
    expect_relative(law->steepest_softening(), R / (d_c - d_0));
    // in units R_max^2 / G
    expect_relative(law->steepest_softening() * law->toughness() / (R * R),
                    0.5 / 0.98);
    for (const double x : {0.005, 0.01, 0.02}) {
      EXPECT_EQ(law->beta(x * d_c), 1.);
      expect_relative(law->traction(x * d_c), R * x / 0.02);
      expect_relative(law->energy(x * d_c), R * x * x * d_c / 0.04);
      expect_slope(*law, 0.9 * x * d_c, R / d_0, 1e-4 * d_c);
    }
    for (const double x : {0.03, 0.1, 0.5, 0.9, 0.999}) {
      const double T = R * (1. - x) / 0.98;
      expect_relative(law->traction(x * d_c), T, 1e-12 / (1. - x));
      expect_relative(law->beta(x * d_c), 0.02 * (1. - x) / (x * 0.98),
                      1e-12 / (1. - x));
      expect_relative(law->energy(x * d_c),
                      R * d_c / 2. - T * (1. - x) * d_c / 2.);
      expect_slope(*law, x * d_c, -R / (d_c - d_0), 1e-4 * d_c);
    }
    expect_toughness(*law, {0., d_0, d_c});
    expect_broken_beyond(*law, d_c);
  }

  // The authors' own form: T = sigma_max S / (1 - S) d with S = min(S_i, 1 -
  // d).
  TEST(GeubelleBaylor, InitialStrength)
  {
    const double sigma = 3e6, D = 2e-6, S_i = 0.98;
    const auto law = geubelle_baylor("0.98 * 3 MPa");
    for (const double d : {0.01, 0.02, 0.1, 0.5, 0.9}) {
      const double S = std::min(S_i, 1. - d);
      expect_relative(law->traction(d * D), S / (1. - S) * d * sigma);
      expect_relative(law->beta(d * D),
                      d <= 0.02 ? 1. : (1. - d) * (1. - S_i) / (d * S_i));
    }
    expect_relative(law->normal_stiffness(), sigma * S_i / ((1. - S_i) * D));
    expect_relative(law->strength(), S_i * sigma);
    expect_relative(law->toughness(), 0.49 * sigma * D);
    expect_relative(law->steepest_softening(), sigma / D);
  }

  TEST(GeubelleBaylor, AnyTwoAndAStiffness)
  {
    // R_max = 3 MPa, d_c = 2 um, G = 3 J/m^2; C = R_max / d_0 = 7.5e13 Pa/m
    const LawEntries shapes[] = {
        {{"strength", "3 MPa"}, {"critical opening", "2 um"}},
        {{"strength", "3 MPa"}, {"toughness", "3 J/m^2"}},
        {{"toughness", "3 J/m^2"}, {"critical opening", "2 um"}}};
    for (const LawEntries &shape : shapes)
      for (const auto &start :
           {std::make_pair("stiffness", "7.5e13"),
            std::make_pair("initial strength parameter", "0.98")}) {
        LawEntries entries = shape;
        entries.push_back(start);
        const auto law = make_law("geubelle-baylor", entries);
        expect_relative(law->strength(), 3e6);
        expect_relative(law->toughness(), 3.);
        expect_relative(law->final_opening(), 2e-6);
        expect_relative(law->elastic_limit(), 0.04e-6);
        expect_relative(law->normal_stiffness(), 7.5e13);
      }
  }

  TEST(GeubelleBaylor, Shear)
  {
    const LawEntries entries{{"strength", "3 MPa"},
                             {"critical opening", "2 um"},
                             {"initial strength parameter", "0.9"},
                             {"tangential critical opening", "5 um"}};
    const auto law = make_law("geubelle-baylor", entries);
    EXPECT_TRUE(law->has_potential());
    expect_relative(law->shear_weight(), 0.16);
    auto with_mixity = entries;
    with_mixity.push_back({"mixity", "0.7"});
    const auto other = make_law("geubelle-baylor", with_mixity);
    EXPECT_FALSE(other->has_potential());
    expect_relative(other->shear_weight(), 0.16);
    expect_relative(other->stiffness_ratio(), 0.28);
    // energy in mode II: i R_max delta_T / 2
    const auto shear = [&other](const double slip) {
      return other->secant(0.4 * slip) * other->stiffness_ratio() * slip;
    };
    expect_relative(integral(shear, 0., 0.5e-6) + integral(shear, 0.5e-6, 5e-6),
                    0.7 * 3e6 * 5e-6 / 2., 1e-10);
  }

  TEST(GeubelleBaylor, WrongEntries)
  {
    expect_error("geubelle-baylor",
                 {{"strength", "3 MPa"},
                  {"toughness", "3 J/m^2"},
                  {"critical opening", "2 um"},
                  {"stiffness", "7.5e13"}},
                 "G = 1/2 R_max d_c");
    expect_error("geubelle-baylor",
                 {{"strength", "3 MPa"},
                  {"toughness", "3 J/m^2"},
                  {"initial strength parameter", "0.98"},
                  {"stiffness", "7.5e13"}},
                 "C = R_max / ((1 - S_i) d_c)");
    expect_error("geubelle-baylor",
                 {{"strength", "3 MPa"}, {"toughness", "3 J/m^2"}},
                 "needs `stiffness` or `initial strength parameter`");
    expect_error("geubelle-baylor",
                 {{"strength", "3 MPa"}, {"stiffness", "7.5e13"}},
                 "needs two of");
    // R_max / C is the critical opening
    expect_error("geubelle-baylor",
                 {{"strength", "3 MPa"},
                  {"critical opening", "2 um"},
                  {"stiffness", "1.5e12"}},
                 "raise `stiffness`");
    expect_error("geubelle-baylor",
                 {{"strength", "3 MPa"},
                  {"critical opening", "2 um"},
                  {"initial strength parameter", "1"}},
                 "initial strength parameter = 1");
  }
} // namespace test_law_geubelle_baylor
