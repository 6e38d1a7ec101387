#include "law_formulas.h"

namespace law_formulas::test_laws
{
  TEST(Tvergaard, ConstantsFromCriticalOpening)
  {
    const double R = 3e6, delta = 2e-6;
    const auto law = tvergaard();
    EXPECT_FALSE(law->extrinsic());
    EXPECT_TRUE(law->has_potential());
    expect_relative(law->normal_stiffness(), 27. * R / (4. * delta));
    expect_relative(law->stiffness_ratio(), 1.);
    expect_relative(law->shear_weight(), 1.);
    expect_relative(law->strength(), R);
    expect_relative(law->peak_opening(), delta / 3.);
    expect_relative(law->final_opening(), delta);
    EXPECT_EQ(law->elastic_limit(), 0.);
    expect_relative(law->toughness(), 9. / 16. * R * delta);
    expect_relative(law->toughness() / (R * delta), 0.5625);
    expect_relative(law->steepest_softening(), 2.25 * R / delta);
  }

  TEST(Tvergaard, FromToughness)
  {
    const auto law = make_law(
        "tvergaard", {{"strength", "3 MPa"}, {"toughness", "3.375 J/m^2"}});
    expect_relative(law->toughness(), 3.375);
    expect_relative(law->final_opening(), 2e-6);
  }

  TEST(Tvergaard, PointsOnTheEnvelope)
  {
    const double R = 3e6, delta = 2e-6;
    const auto law = tvergaard();
    struct {
      double x, traction, beta;
    } const points[] = {{0.1, 0.54675, 0.81},    {0.2, 0.864, 0.64},
                        {1. / 3., 1., 4. / 9.},  {0.5, 0.84375, 0.25},
                        {2. / 3., 0.5, 1. / 9.}, {0.9, 0.06075, 0.01}};
    for (const auto &[x, t, beta] : points) {
      expect_relative(law->traction(x * delta), t * R);
      expect_relative(law->beta(x * delta), beta);
      expect_relative(
          law->energy(x * delta),
          R * delta * 6.75 *
              (x * x / 2. - 2. * x * x * x / 3. + x * x * x * x / 4.));
    }
    EXPECT_EQ(law->traction(delta), 0.);
    EXPECT_EQ(law->beta(delta), 0.);
    EXPECT_EQ(law->beta(0.), 1.);
    expect_relative(area(*law, 0., delta), law->toughness(), 1e-10);
    EXPECT_EQ(law->energy(1e6 * delta), law->toughness());
  }

  TEST(Tvergaard, Unloading)
  {
    const double R = 3e6, delta = 2e-6;
    const auto law = tvergaard();
    expect_relative(law->secant(0.5 * delta) * 0.25 * delta, 0.421875 * R);
    const double psi = stored(*law, 0.5 * delta);
    expect_relative(psi, 0.2109375 * R * delta);
    expect_relative(law->energy(0.5 * delta) - psi, 0.17578125 * R * delta);
  }

  TEST(Tvergaard, MixedMode)
  {
    const auto law = tvergaard();
    const auto t = traction(*law, 0.3 * 2e-6, 0.4 * 2e-6);
    expect_relative(t.normal, 0.50625 * 3e6);
    expect_relative(t.tangential, 0.675 * 3e6);
  }

  // Energy in mode II is i 9/16 R_max delta_T.
  TEST(Tvergaard, ShearEnergy)
  {
    const auto law =
        make_law("tvergaard", {{"strength", "3 MPa"},
                               {"critical opening", "2 um"},
                               {"tangential critical opening", "5 um"},
                               {"mixity", "0.7"}});
    expect_relative(law->normal_stiffness() * law->stiffness_ratio(),
                    27. * 0.7 * 3e6 / (4. * 5e-6));
    expect_relative(law->shear_weight(), 0.16);
    const double work = integral(
        [&](double x) { return traction(*law, 0., x).tangential; }, 0., 5e-6);
    expect_relative(work, 0.7 * 9. / 16. * 3e6 * 5e-6, 1e-10);
  }

  TEST(Tvergaard, PotentialNeedsTheMatchingMixity)
  {
    const test::LawEntries entries{{"strength", "3 MPa"},
                                   {"critical opening", "2 um"},
                                   {"tangential critical opening", "5 um"}};
    const auto matching = make_law("tvergaard", entries);
    EXPECT_TRUE(matching->has_potential());
    const double u_N = 0.4 * 2e-6, u_T = 0.6 * 5e-6;
    expect_relative(work_normal_first(*matching, u_N, u_T),
                    work_shear_first(*matching, u_N, u_T), 1e-9);
    expect_relative(work_normal_first(*matching, u_N, u_T),
                    matching->energy(std::sqrt(0.52) * 2e-6), 1e-9);

    auto with_mixity = entries;
    with_mixity.push_back({"mixity", "1"});
    const auto other = make_law("tvergaard", with_mixity);
    EXPECT_FALSE(other->has_potential());
    EXPECT_GT(std::abs(work_normal_first(*other, u_N, u_T) /
                           work_shear_first(*other, u_N, u_T) -
                       1.),
              0.05);
  }

  // (1 - lambda)^2 of the print grows again past lambda = 1: 0.01 at 0.9.
  TEST(Tvergaard, OvershootInOneStep)
  {
    const double delta = 2e-6;
    const auto law = tvergaard();
    double beta = 1.;
    for (const double lambda : {0.9, 1.5})
      beta = std::min(beta, law->beta(lambda * delta));
    EXPECT_EQ(beta, 0.);
    EXPECT_EQ(law->traction(1.5 * delta), 0.);
    EXPECT_EQ(law->secant(1.5 * delta), 0.);
  }

  TEST(MichelSuquet, Constants)
  {
    const auto law = michel_suquet();
    const double C = 5e12, d_c = 2e-6;
    EXPECT_FALSE(law->extrinsic());
    EXPECT_TRUE(law->has_potential());
    expect_relative(law->normal_stiffness(), C);
    expect_relative(law->elastic_limit(), d_c);
    expect_relative(law->peak_opening(), d_c);
    expect_relative(law->final_opening(), 3. * d_c);
    expect_relative(law->strength(), 10e6);
    expect_relative(law->steepest_softening(), 0.75 * C);
    const double G = law->toughness();
    expect_relative(G, (4.5 - 4. * std::log(2.)) * C * d_c * d_c);
    EXPECT_NEAR(G / (C * d_c * d_c), 1.7274112778, 0.5e-10);
    EXPECT_NEAR(G / (10e6 * 3. * d_c), 0.5758037593, 0.5e-10);
  }

  TEST(MichelSuquet, AnyTwoOfThree)
  {
    const double C = 5e12, R = 1e7, d_c = 2e-6;
    const double G = (4.5 - 4. * std::log(2.)) * C * d_c * d_c;
    char toughness[32];
    std::snprintf(toughness, sizeof toughness, "%.17g", G);

    for (const test::LawEntries &entries :
         {test::LawEntries{{"stiffness", "5e12"}, {"strength", "10 MPa"}},
          test::LawEntries{{"stiffness", "5e12"}, {"toughness", toughness}},
          test::LawEntries{{"strength", "10 MPa"}, {"toughness", toughness}}}) {
      const auto law = make_law("michel-suquet", entries);
      expect_relative(law->normal_stiffness(), C);
      expect_relative(law->strength(), R);
      expect_relative(law->toughness(), G);
      expect_relative(law->elastic_limit(), d_c);
    }
  }

  TEST(MichelSuquet, PointsOnTheEnvelope)
  {
    const double C = 5e12, R = 1e7, d_c = 2e-6;
    const auto law = michel_suquet();
    struct {
      double x, traction, beta;
    } const points[] = {{0.5, 0.5, 1.},
                        {1., 1., 1.},
                        {1.5, 0.9, 0.6},
                        {2., 0.6666667, 1. / 3.},
                        {2.5, 0.3571429, 0.1428571},
                        {2.9, 0.0743590, 0.0256410}};
    for (const auto &[x, t, beta] : points) {
      EXPECT_NEAR(law->traction(x * d_c) / R, t, 0.5e-7);
      EXPECT_NEAR(law->beta(x * d_c), beta, 0.5e-7);
      const double beta_x = x <= 1. ? 1. : (3. - x) / (1. + x);
      expect_relative(law->beta(x * d_c), beta_x);
      expect_relative(law->traction(x * d_c), R * x * beta_x);
      const double W = x <= 1. ? x * x / 2.
                               : 0.5 - (x * x - 1.) / 2. + 4. * (x - 1.) -
                                     4. * std::log((1. + x) / 2.);
      expect_relative(law->energy(x * d_c), W * C * d_c * d_c);
    }
    EXPECT_EQ(law->traction(law->final_opening()), 0.);
    EXPECT_EQ(law->beta(law->final_opening()), 0.);
    EXPECT_EQ(law->energy(1e6 * d_c), law->toughness());
    expect_relative(area(*law, 0., d_c) + area(*law, d_c, 3. * d_c),
                    law->toughness(), 1e-10);
  }

  TEST(MichelSuquet, EnergiesPastThePeak)
  {
    const double C = 5e12, d_c = 2e-6, unit = C * d_c * d_c;
    const auto law = michel_suquet();
    const double W = law->energy(2. * d_c), psi = stored(*law, 2. * d_c);
    EXPECT_NEAR(W / unit, 1.3781395676, 0.5e-10);
    expect_relative(psi, 2. / 3. * unit);
    EXPECT_NEAR((W - psi) / unit, 0.7114729009, 0.5e-10);
    expect_relative(W - psi, (1.5 + 1.5 - 4. * std::log(1.5) - 2. / 3.) * unit);
  }

  TEST(MichelSuquet, MixedMode)
  {
    const auto law = michel_suquet();
    const auto t = traction(*law, 1.2 * 2e-6, 1.6 * 2e-6);
    expect_relative(t.normal, 0.4 * 1e7);
    expect_relative(t.tangential, 1.6 / 3. * 1e7);
  }

  TEST(MichelSuquet, TangentialStiffnessKeepsThePotential)
  {
    const auto law =
        make_law("michel-suquet", {{"stiffness", "5e12"},
                                   {"strength", "10 MPa"},
                                   {"tangential stiffness", "2e12"}});
    expect_relative(law->stiffness_ratio(), 0.4);
    EXPECT_TRUE(law->has_potential());
    const double u_N = 2.5e-6, u_T = 3e-6;
    expect_relative(work_normal_first(*law, u_N, u_T),
                    work_shear_first(*law, u_N, u_T), 1e-6);
  }

  TEST(CamachoOrtiz, Constants)
  {
    const double R = 300e6, G = 0.5, d_c = 2. * G / R;
    const auto law = camacho_ortiz();
    EXPECT_TRUE(law->extrinsic());
    EXPECT_TRUE(law->has_potential());
    EXPECT_EQ(law->normal_stiffness(), infinity);
    EXPECT_EQ(law->elastic_limit(), 0.);
    EXPECT_EQ(law->peak_opening(), 0.);
    expect_relative(law->strength(), R);
    expect_relative(law->toughness(), G);
    expect_relative(law->final_opening(), d_c);
    expect_relative(law->steepest_softening(), R * R / (2. * G));

    const auto same = make_law("camacho-ortiz", {{"strength", "300 MPa"},
                                                 {"critical opening", "4 nm"}});
    expect_relative(same->toughness(), 0.6);
  }

  TEST(CamachoOrtiz, LinearEnvelope)
  {
    const double R = 300e6, d_c = 1. / R;
    const auto law = camacho_ortiz();
    EXPECT_EQ(law->traction(0.), R);
    EXPECT_EQ(law->secant(0.), infinity);
    for (const double x : {0.1, 0.25, 0.5, 0.75, 0.9}) {
      expect_relative(law->beta(x * d_c), 1. - x);
      expect_relative(law->traction(x * d_c), R * (1. - x));
      expect_relative(law->energy(x * d_c), R * d_c * (x - x * x / 2.));
      expect_relative(law->secant(x * d_c), R * (1. - x) / (x * d_c));
      // opened to d_m and closed on the secant: R_max d_m / 2
      expect_relative(law->energy(x * d_c) - stored(*law, x * d_c),
                      0.5 * R * x * d_c);
    }
    expect_relative(law->energy(0.5 * d_c) - stored(*law, 0.5 * d_c),
                    0.5 * law->toughness());
    EXPECT_EQ(law->traction(law->final_opening()), 0.);
    EXPECT_EQ(law->energy(1e6 * d_c), law->toughness());
    expect_relative(area(*law, 0., d_c), law->toughness(), 1e-10);
  }

  TEST(CamachoOrtiz, ModeMixity)
  {
    const auto law = make_law("camacho-ortiz", {{"strength", "300 MPa"},
                                                {"toughness", "0.5 J/m^2"},
                                                {"mode mixity", "2"}});
    expect_relative(law->shear_weight(), 4.);
    expect_relative(law->stiffness_ratio(), 4.);
    EXPECT_TRUE(law->has_potential());
    // R = T(d) / d (u_N, a^2 u_T) with d = 5 nm / 10
    const double u_N = 0.3e-9, u_T = 0.2e-9, d = 0.5e-9;
    const auto t = traction(*law, u_N, u_T);
    const double T = 300e6 * (1. - d * 300e6);
    expect_relative(t.normal, 0.6 * T);
    expect_relative(t.tangential, 1.6 * T);
  }

  TEST(Rcc, ClosedForms)
  {
    const double C = 2e12, w = 8., u_0 = 2e-6;
    const auto law = rcc();
    EXPECT_FALSE(law->extrinsic());
    EXPECT_TRUE(law->has_potential());
    expect_relative(law->normal_stiffness(), C);
    expect_relative(law->elastic_limit(), u_0);
    expect_relative(law->peak_opening(), u_0);
    EXPECT_EQ(law->final_opening(), infinity);
    expect_relative(law->strength(), std::sqrt(w * C));
    expect_relative(law->toughness(), w);
    expect_relative(law->steepest_softening(), 3. * C);

    for (const double x : {0.1, 0.5, 0.99, 1.}) {
      const double u = x * u_0;
      EXPECT_EQ(law->beta(u), 1.);
      expect_relative(law->traction(u), C * u);
      expect_relative(law->energy(u), C * u * u / 2.);
    }
    for (const double x : {1.01, 1.5, 2., 10., 1e3, 1e6}) {
      const double u = x * u_0, beta_rcc = w / (C * u * u);
      expect_relative(law->beta(u), beta_rcc * beta_rcc);
      expect_relative(law->traction(u), w * w / (C * u * u * u));
      expect_relative(law->energy(u), w - w * w / (2. * C * u * u));
    }
    // half of the energy before the peak, half after
    expect_relative(law->energy(u_0), w / 2.);
    expect_relative(law->energy(1e9 * u_0), w);
    expect_relative(area(*law, 0., u_0), w / 2., 1e-10);
    expect_relative(integral(
                        [&](const double s) {
                          return s == 0.
                                     ? 0.
                                     : law->traction(u_0 / s) * u_0 / (s * s);
                        },
                        0., 1.),
                    w / 2., 1e-10);
    // slope just after the peak
    const double h = 1e-5 * u_0;
    const double slope =
        (-3. * law->traction(u_0) + 4. * law->traction(u_0 + h) -
         law->traction(u_0 + 2. * h)) /
        (2. * h);
    expect_relative(slope, -3. * C, 1e-8);
    EXPECT_EQ(law->beta(infinity), 0.);
    EXPECT_EQ(law->traction(infinity), 0.);
  }

  TEST(Rcc, TangentialStiffness)
  {
    const auto law = make_law("rcc", {{"stiffness", "2e12"},
                                      {"adhesion energy", "8 J/m^2"},
                                      {"tangential stiffness", "1e12"}});
    expect_relative(law->stiffness_ratio(), 0.5);
    EXPECT_TRUE(law->has_potential());
    // beta_rcc = w / (C_N u_N^2 + C_T u_T^2) = 8 / (2e12 9e-12 + 1e12 6e-12)
    const double u_N = 3e-6, u_T = std::sqrt(6.) * 1e-6;
    const auto t = traction(*law, u_N, u_T);
    expect_relative(t.normal, 2e12 * u_N / 9.);
    expect_relative(t.tangential, 1e12 * u_T / 9.);
  }

  TEST(FrictionWeight, Values)
  {
    const auto law = tvergaard();
    const double half = law->beta(0.5 * 2e-6), late = law->beta(0.9 * 2e-6);
    expect_relative(kappa(half, 1.), 0.75);
    expect_relative(kappa(half, 2.), 0.5625);
    expect_relative(kappa(half, 3.), 0.421875);
    expect_relative(kappa(late, 1.), 0.99);
    expect_relative(kappa(late, 2.), 0.9801);
    expect_relative(kappa(late, 3.), 0.970299);
    for (const double s : {0.5, 1., 2., 3.}) {
      EXPECT_EQ(kappa(1., s), 0.);
      EXPECT_EQ(kappa(0., s), 1.);
    }
    for (const double beta : {0., 0.3, 1.})
      EXPECT_EQ(kappa(beta, 0.), 1.);
  }

  // max |T'| in units R_max^2 / G
  TEST(Laws, SteepestSoftening)
  {
    const auto dimensionless = [](const CohesiveLaw &law) {
      return law.steepest_softening() * law.toughness() /
             (law.strength() * law.strength());
    };
    expect_relative(dimensionless(*tvergaard()), 1.265625);
    EXPECT_NEAR(dimensionless(*michel_suquet()), 1.2955585, 0.5e-7);
    expect_relative(dimensionless(*michel_suquet()),
                    0.75 * (4.5 - 4. * std::log(2.)));
    expect_relative(dimensionless(*camacho_ortiz()), 0.5);
    expect_relative(dimensionless(*rcc()), 3.);
  }

  TEST(Laws, CloseOpeningsWithoutCancellation)
  {
    for (const auto &law : all_laws())
      for (const double x : {0.2, 0.9, 1.1, 1.5, 1.6})
        for (const double step : {1e-3, 1e-6, 1e-9, 1e-12}) {
          const double d0 = x * scale(*law), d1 = d0 * (1. + step);
          // Simpson is exact up to step^5; no kink is in between
          const double reference =
              (d1 - d0) / 6. *
              (law->traction(d0) + 4. * law->traction(0.5 * (d0 + d1)) +
               law->traction(d1));
          expect_relative(law->energy_increment(d0, d1), reference, 1e-11);
          EXPECT_EQ(law->energy_increment(d1, d0),
                    -law->energy_increment(d0, d1));
        }
  }

  TEST(Laws, EnergyIncrementIsADifference)
  {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> uniform(0., 4.);
    for (const auto &law : all_laws())
      for (unsigned int i = 0; i < 2000; ++i) {
        const double d0 = uniform(generator) * scale(*law);
        const double d1 = i % 2 ? uniform(generator) * scale(*law)
                                : d0 * (1. + 0.05 * (uniform(generator) - 2.));
        EXPECT_NEAR(law->energy_increment(d0, d1),
                    law->energy(d1) - law->energy(d0),
                    1e-14 * law->toughness());
      }
  }

  TEST(Laws, EnergyIncrementAcrossKinks)
  {
    for (const auto &law : all_laws())
      for (const double kink : {law->elastic_limit(), law->final_opening()})
        if (kink > 0. && kink < infinity) {
          const double d0 = kink * (1. - 0.03), d1 = kink * (1. + 0.02);
          EXPECT_NEAR(law->energy_increment(d0, d1),
                      law->energy(d1) - law->energy(d0),
                      1e-14 * law->toughness());
          EXPECT_DOUBLE_EQ(law->energy_increment(d0, d1),
                           law->energy_increment(d0, kink) +
                               law->energy_increment(kink, d1));
        }
    for (const auto &law : all_laws()) {
      EXPECT_EQ(law->energy_increment(0., 0.), 0.);
      EXPECT_EQ(law->energy_increment(0., 0.5 * scale(*law)),
                law->energy(0.5 * scale(*law)));
    }
  }

  TEST(Laws, FiniteFarBeyondSeparation)
  {
    for (const auto &law : all_laws())
      for (const double x : {1., 1e3, 1e6, 1e12}) {
        const double d = x * 3. * scale(*law);
        EXPECT_TRUE(std::isfinite(law->beta(d)));
        EXPECT_TRUE(std::isfinite(law->traction(d)));
        EXPECT_TRUE(std::isfinite(law->secant(d)));
        EXPECT_TRUE(std::isfinite(law->energy(d)));
        EXPECT_TRUE(std::isfinite(law->energy_increment(0., d)));
        EXPECT_TRUE(std::isfinite(law->energy_increment(d, 1.05 * d)));
        EXPECT_LE(law->beta(d), 0.2);
        EXPECT_LE(law->energy(d), law->toughness());
      }
  }

  TEST(Laws, BetaNeverGrows)
  {
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> exponent(-3., 3.);
    for (const auto &law : all_laws()) {
      std::vector<double> openings{0.};
      for (unsigned int i = 0; i < 5000; ++i)
        openings.push_back(std::pow(10., exponent(generator)) * scale(*law));
      std::sort(openings.begin(), openings.end());
      double beta = 1.;
      for (const double d : openings) {
        EXPECT_LE(law->beta(d), beta);
        EXPECT_GE(law->beta(d), 0.);
        beta = law->beta(d);
      }
    }
  }
} // namespace law_formulas::test_laws
