#include "cohesive_laws/stiffened_law.h"
#include "make_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

// Intrinsic laws with stiffer springs: the same strength, toughness and damage.

namespace nsfd::test_stiffened_law
{
  namespace
  {
    struct Named {
      std::string name;
      std::shared_ptr<const CohesiveLaw> law;
    };

    /** All examples of laws whose springs may become stiffer. */
    std::vector<Named> laws()
    {
      std::vector<Named> result;
      for (const auto &[name, entry] :
           CohesiveLawRegistry::instance().entries())
        for (const std::string &example : entry.examples) {
          std::shared_ptr<const CohesiveLaw> law =
              test::make_law(name, test::entries_of(example));
          if (!law->extrinsic() && not_stiffened(*law).empty())
            result.push_back({name + ": " + example, law});
        }
      return result;
    }

    /** Openings of the law on its whole way, next to its kinks too. */
    std::vector<double> openings(const CohesiveLaw &law)
    {
      const double end = std::isfinite(law.final_opening())
                             ? law.final_opening()
                             : 20. * law.peak_opening();
      std::vector<double> result;
      for (unsigned int i = 1; i <= 500; ++i)
        result.push_back(1.2 * end * i / 500.);
      for (const double kink : law.kinks())
        if (std::isfinite(kink))
          for (const double offset : {-1e-6, 1e-6})
            result.push_back(std::max(0., kink + offset * end));
      std::sort(result.begin(), result.end());
      return result;
    }

    constexpr double compliances[] = {0.75, 0.5, 1. / 16.};
  } // namespace

  // T' = T and D' = D at d' = d - (1 - c) T / C; tolerance: round-off of the
  // root behind every value, 1e-12
  TEST(StiffenedLaw, ChangesTheElasticPartOfTheOpeningOnly)
  {
    ASSERT_GE(laws().size(), 8u);
    for (const auto &[name, law] : laws())
      for (const double c : compliances) {
        const StiffenedLaw stiff(law, c);
        const double C = law->normal_stiffness(), R = law->strength();
        EXPECT_DOUBLE_EQ(stiff.normal_stiffness(), C / c) << name;
        EXPECT_EQ(stiff.strength(), R);
        EXPECT_EQ(stiff.toughness(), law->toughness());
        EXPECT_EQ(stiff.has_potential(), law->has_potential());
        for (const double d : openings(*law)) {
          const double T = law->traction(d), x = d - (1. - c) * T / C;
          SCOPED_TRACE(name + " at " + std::to_string(d / law->peak_opening()));
          ASSERT_NEAR(stiff.opening(d), x, 1e-15 * d);
          ASSERT_NEAR(stiff.law_opening(x), d, 1e-12 * d);
          ASSERT_NEAR(stiff.traction(x), T, 1e-11 * R);
          const double beta = law->beta(d);
          ASSERT_NEAR(stiff.beta(x), c * beta / (1. - (1. - c) * beta), 1e-11);
          ASSERT_NEAR(stiff.energy(x) - T * x / 2., law->energy(d) - T * d / 2.,
                      1e-11 * law->toughness());
        }
        EXPECT_NEAR(stiff.traction(stiff.peak_opening()), R, 1e-12 * R) << name;
        EXPECT_EQ(stiff.traction(1.0001 * std::min(1e9, law->final_opening())) *
                      (std::isfinite(law->final_opening()) ? 1. : 0.),
                  0.);
      }
  }

  TEST(StiffenedLaw, EnergyIsTheAreaUnderTheCurveAndDamageGrows)
  {
    for (const auto &[name, law] : laws())
      for (const double c : compliances) {
        const StiffenedLaw stiff(law, c);
        double beta = 1., sum = 0., last = 0.;
        for (const double d : openings(*law)) {
          const double x = stiff.opening(d);
          if (x <= last) // to both sides of a jump of the law
            continue;
          SCOPED_TRACE(name + " at " + std::to_string(d / law->peak_opening()));
          ASSERT_LE(stiff.beta(x), beta * (1. + 1e-14));
          beta = stiff.beta(x);
          // close ones by a rule, distant ones by the difference
          const double middle = 0.5 * (last + x);
          sum += stiff.energy_increment(last, middle) +
                 stiff.energy_increment(middle, x);
          ASSERT_NEAR(sum, stiff.energy(x), 1e-10 * law->toughness());
          last = x;
        }
      }
  }

  // A spring that breaks at once becomes, behind a stiffer one, a line from
  // (c d_0, R_max) to (d_0, 0): the bilinear law, by hand.
  TEST(StiffenedLaw, BrittleBecomesBilinear)
  {
    const double C = 2e12, R = 4e6, d_0 = R / C, c = 0.25;
    const StiffenedLaw stiff(test::make_law("brittle", {{"stiffness", "2e12"},
                                                        {"strength", "4 MPa"}}),
                             c);
    const auto bilinear = test::make_law(
        "geubelle-baylor", {{"strength", "4 MPa"},
                            {"critical opening", "2 um"},
                            {"initial strength parameter", "0.75"}});
    EXPECT_DOUBLE_EQ(d_0, 2e-6);
    EXPECT_NEAR(stiff.steepest_softening(), R / (d_0 * (1. - c)), 1e-9 * C);
    for (unsigned int i = 0; i <= 60; ++i) {
      const double d = d_0 * i / 50.;
      EXPECT_NEAR(stiff.traction(d), bilinear->traction(d), 1e-9 * R) << i;
      EXPECT_NEAR(stiff.energy(d), bilinear->energy(d), 1e-9 * R * d_0) << i;
    }
  }

  TEST(StiffenedLaw, FromOneComplianceToAnother)
  {
    for (const auto &[name, law] : laws())
      for (const double d : openings(*law)) {
        const double there = opening_at_compliance(law, d, 1., 0.5),
                     on = opening_at_compliance(law, there, 0.5, 0.375);
        EXPECT_NEAR(on, StiffenedLaw(law, 0.375).opening(d), 1e-12 * d) << name;
        EXPECT_NEAR(opening_at_compliance(law, on, 0.375, 1.), d, 1e-12 * d)
            << name;
      }
  }

  // What cannot be told apart into a spring and the rest, in words
  TEST(StiffenedLaw, LawsThatCannot)
  {
    const auto why = [](const std::string &name,
                        const test::LawEntries &entries) {
      return not_stiffened(*test::make_law(name, entries));
    };
    EXPECT_EQ(why("ppr", {{"strength", "40 MPa"}, {"toughness", "100 J/m^2"}}),
              "has two damage scalars");
    EXPECT_EQ(why("rcc", {{"stiffness", "2e12"},
                          {"adhesion energy", "8 J/m^2"},
                          {"damage viscosity", "0.01"}}),
              "has a damage that takes time");
  }
} // namespace nsfd::test_stiffened_law
