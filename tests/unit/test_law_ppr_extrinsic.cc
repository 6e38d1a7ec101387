#include "law_checks.h"

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_ppr_extrinsic
{
  // sigma = 40 MPa, phi = 100 J/m^2
  std::unique_ptr<CohesiveLaw> ppr(const std::string &alpha)
  {
    return make_law(
        "ppr-extrinsic",
        {{"strength", "40 MPa"}, {"toughness", "100 J/m^2"}, {"alpha", alpha}});
  }

  TEST(PprExtrinsic, ClosedForms)
  {
    const double R = 40e6, G = 100.;
    for (const auto &[text, alpha] : {std::make_pair("1.5", 1.5),
                                      {"2", 2.},
                                      {"2.5", 2.5},
                                      {"5", 5.},
                                      {"7.3", 7.3}}) {
      SCOPED_TRACE(text);
      const auto law = ppr(text);
      const double d_c = alpha * G / R;
      EXPECT_TRUE(law->extrinsic());
      EXPECT_TRUE(law->has_potential());
      EXPECT_EQ(law->elastic_limit(), 0.);
      EXPECT_EQ(law->peak_opening(), 0.);
      EXPECT_EQ(law->beta(0.), 1.);
      EXPECT_EQ(law->traction(0.), R);
      expect_relative(law->strength(), R);
      expect_relative(law->toughness(), G);
      expect_relative(law->final_opening(), d_c);
      expect_relative(law->toughness() / (R * law->final_opening()),
                      1. / alpha);
      for (const double x : {0.01, 0.1, 0.3, 0.5, 0.9}) {
        expect_relative(law->beta(x * d_c), std::pow(1. - x, alpha - 1.));
        expect_relative(law->traction(x * d_c),
                        R * std::pow(1. - x, alpha - 1.));
        expect_relative(law->energy(x * d_c),
                        G * (1. - std::pow(1. - x, alpha)));
        const double slope =
            -(alpha - 1.) * R / d_c * std::pow(1. - x, alpha - 2.);
        expect_slope(*law, x * d_c, slope, 1e-5 * d_c);
        if (alpha >= 2.) {
          EXPECT_GE(law->steepest_softening(), -slope * (1. - 1e-12));
        }
      }
      if (alpha > 2.)
        expect_toughness(*law, {0., d_c});
      expect_broken_beyond(*law, d_c);
    }
    // at the start, where the difference is one-sided
    const auto law = ppr("5");
    const double h = 1e-5 * law->final_opening();
    expect_relative(law->steepest_softening(),
                    (3. * law->traction(0.) - 4. * law->traction(h) +
                     law->traction(2. * h)) /
                        (2. * h),
                    1e-6);
    EXPECT_TRUE(std::isinf(ppr("1.5")->steepest_softening()));
  }

  TEST(PprExtrinsic, LinearForTwo)
  {
    const auto law = ppr("2");
    const auto linear = make_law(
        "camacho-ortiz", {{"strength", "40 MPa"}, {"toughness", "100 J/m^2"}});
    for (const double x : {0., 0.1, 0.5, 0.99}) {
      const double d = x * linear->final_opening();
      expect_relative(law->traction(d), linear->traction(d), 1e-11);
      expect_relative(law->energy(d), linear->energy(d));
    }
    expect_relative(law->steepest_softening(), linear->steepest_softening());
  }

  TEST(PprExtrinsic, IncrementsWithoutCancellation)
  {
    // the exact integral of the tangent line differs by step^2
    const auto law = ppr("3.3");
    const double d_c = law->final_opening();
    for (const double x : {0.1, 0.5, 0.9, 0.999})
      for (const double step : {1e-6, 1e-9, 1e-12}) {
        const double d0 = x * d_c, d1 = d0 + step * (d_c - d0);
        const double T = (law->traction(d0) + law->traction(d1)) / 2.;
        expect_relative(law->energy_increment(d0, d1), T * (d1 - d0), 1e-11);
        EXPECT_EQ(law->energy_increment(d1, d0),
                  -law->energy_increment(d0, d1));
      }
  }

  TEST(PprExtrinsic, AnyThree)
  {
    // alpha = 5, d_c = 12.5 um
    const LawEntries all{{"strength", "40 MPa"},
                         {"toughness", "100 J/m^2"},
                         {"critical opening", "12.5 um"},
                         {"alpha", "5"}};
    for (std::size_t left_out = 0; left_out < all.size(); ++left_out) {
      LawEntries entries = all;
      entries.erase(entries.begin() + left_out);
      entries.push_back({"mode mixity", "0.5"});
      const auto law = make_law("ppr-extrinsic", entries);
      expect_relative(law->strength(), 40e6);
      expect_relative(law->toughness(), 100.);
      expect_relative(law->final_opening(), 12.5e-6);
      expect_relative(law->beta(2.5e-6), 0.4096);
      expect_relative(law->shear_weight(), 0.25);
      EXPECT_TRUE(law->has_potential());
    }
    expect_error("ppr-extrinsic", all, "G = R_max d_c / alpha");
  }

  TEST(PprExtrinsic, WrongEntries)
  {
    expect_error("ppr-extrinsic",
                 {{"strength", "40 MPa"}, {"toughness", "100 J/m^2"}},
                 "needs three of");
    expect_error("ppr-extrinsic", {{"strength", "40 MPa"}, {"alpha", "3"}},
                 "needs three of");
    expect_error(
        "ppr-extrinsic",
        {{"strength", "40 MPa"}, {"toughness", "100 J/m^2"}, {"alpha", "1"}},
        "alpha = 1");
    // R_max d_c = 80 J/m^2
    expect_error("ppr-extrinsic",
                 {{"strength", "40 MPa"},
                  {"toughness", "100 J/m^2"},
                  {"critical opening", "2 um"}},
                 "alpha at most 1");
  }
} // namespace test_law_ppr_extrinsic
