#include "../unit/make_law.h"

#include "nsfd/interface/cohesive_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

// What every registered cohesive law must satisfy, whatever its shape.

using namespace nsfd;
using nsfd::test::entries_of;
using nsfd::test::make_law;

namespace
{
  /** Kinks of the envelope, in order. */
  std::vector<double> kinks(const CohesiveLaw &law)
  {
    std::vector<double> result{0., law.elastic_limit(), law.peak_opening()};
    if (std::isfinite(law.final_opening()))
      result.push_back(law.final_opening());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /** An opening by which most of the energy is spent. */
  double end_of_softening(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening())
               ? law.final_opening()
               : law.peak_opening() + 30. * law.toughness() / law.strength();
  }

  /** Openings in order: a fine grid, points next to the kinks, far away. */
  std::vector<double> samples(const CohesiveLaw &law)
  {
    const double end = end_of_softening(law);
    std::vector<double> result;
    for (unsigned int i = 0; i <= 4000; ++i)
      result.push_back(1.5 * end * i / 4000.);
    for (const double kink : kinks(law))
      for (const double offset : {-1e-4, -1e-9, 0., 1e-9, 1e-4})
        result.push_back(std::max(0., kink + offset * end));
    for (const double factor : {1e1, 1e2, 1e4, 1e6, 1e9})
      result.push_back(factor * end);
    std::sort(result.begin(), result.end());
    return result;
  }

  bool kink_between(const CohesiveLaw &law, double lower, double upper)
  {
    for (const double kink : kinks(law))
      if (lower < kink && kink < upper)
        return true;
    return false;
  }

  /** Work of the traction on the straight way from (u_N, u_T) to (v_N, v_T). */
  double work(const CohesiveLaw &law, double u_N, double u_T, double v_N,
              double v_T)
  {
    const unsigned int n = 20000;
    double sum = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      const double s = (i + 0.5) / n;
      const double N = u_N + s * (v_N - u_N), T = u_T + s * (v_T - u_T);
      const double d = std::sqrt(N * N + law.shear_weight() * T * T);
      sum += law.secant(d) *
             (N * (v_N - u_N) + law.stiffness_ratio() * T * (v_T - u_T));
    }
    return sum / n;
  }

  void beta_never_grows(const CohesiveLaw &law)
  {
    EXPECT_EQ(law.beta(0.), 1.);
    double last = 1.;
    for (const double d : samples(law)) {
      const double beta = law.beta(d);
      ASSERT_LE(beta, last) << "d = " << d;
      ASSERT_GE(beta, 0.) << "d = " << d;
      if (d <= law.elastic_limit()) {
        ASSERT_EQ(beta, 1.) << "d = " << d;
      }
      last = beta;
    }
  }

  void traction_and_beta_agree(const CohesiveLaw &law)
  {
    for (const double d : samples(law)) {
      const double T = law.traction(d);
      ASSERT_TRUE(std::isfinite(T)) << "d = " << d;
      ASSERT_GE(T, 0.) << "d = " << d;
      ASSERT_LE(T, law.strength() * (1. + 1e-12)) << "d = " << d;
      if (!law.extrinsic()) {
        ASSERT_NEAR(T, law.beta(d) * law.normal_stiffness() * d,
                    1e-13 * law.strength())
            << "d = " << d;
      }
      if (d > 0.) {
        ASSERT_NEAR(law.secant(d) * d, T, 1e-13 * law.strength())
            << "d = " << d;
      }
      if (d >= law.final_opening()) {
        ASSERT_EQ(T, 0.) << "d = " << d;
        ASSERT_EQ(law.beta(d), 0.) << "d = " << d;
      }
    }
    EXPECT_NEAR(law.traction(law.peak_opening()), law.strength(),
                1e-12 * law.strength());
    if (law.extrinsic()) {
      EXPECT_EQ(law.traction(0.), law.strength());
    } else {
      EXPECT_EQ(law.secant(0.), law.normal_stiffness());
    }
  }

  // Dissipated so far: I - beta C d^2 / 2, or I - T d / 2 with secant
  // unloading.
  void dissipation_never_falls(const CohesiveLaw &law)
  {
    double last = 0.;
    for (const double d : samples(law)) {
      const double psi =
          law.extrinsic() ? 0.5 * law.traction(d) * d
                          : 0.5 * law.beta(d) * law.normal_stiffness() * d * d;
      const double dissipated = law.energy(d) - psi;
      ASSERT_GE(dissipated, last - 1e-14 * law.toughness()) << "d = " << d;
      last = std::max(last, dissipated);
    }
    EXPECT_NEAR(last, law.toughness(), 1e-9 * law.toughness());
  }

  void energy_is_the_integral_of_the_traction(const CohesiveLaw &law)
  {
    EXPECT_EQ(law.energy(0.), 0.);
    const double end = end_of_softening(law), h = 1e-4 * end;
    for (const double d : samples(law)) {
      if (d <= 2. * h || d > 2. * end ||
          kink_between(law, d - 2. * h, d + 2. * h))
        continue;
      // differences of fourth order
      const double slope = (8. * (law.energy(d + h) - law.energy(d - h)) -
                            (law.energy(d + 2. * h) - law.energy(d - 2. * h))) /
                           (12. * h);
      ASSERT_NEAR(slope, law.traction(d), 1e-8 * law.strength()) << "d = " << d;
    }

    const auto openings = samples(law);
    for (std::size_t i = 0; i + 1 < openings.size(); ++i)
      for (const std::size_t j : {i + 1, (17 * i) % openings.size()})
        ASSERT_NEAR(law.energy_increment(openings[i], openings[j]),
                    law.energy(openings[j]) - law.energy(openings[i]),
                    1e-13 * law.toughness())
            << "from " << openings[i] << " to " << openings[j];

    EXPECT_NEAR(law.energy(1e9 * end), law.toughness(),
                1e-12 * law.toughness());
    if (std::isfinite(law.final_opening())) {
      EXPECT_NEAR(law.energy(law.final_opening()), law.toughness(),
                  1e-12 * law.toughness());
    }
  }

  /** Largest fall of T over a distance h, beyond the peak. */
  double largest_fall(const CohesiveLaw &law, const double h)
  {
    double result = 0.;
    for (const double d : samples(law))
      for (const double start : {d, d - h})
        if (start >= law.peak_opening() &&
            start + h <= 2. * end_of_softening(law))
          result =
              std::max(result, law.traction(start) - law.traction(start + h));
    return result;
  }

  // By the mean value theorem, no difference quotient exceeds max |T'|.
  void steepest_softening_is_attained(const CohesiveLaw &law)
  {
    const double end = end_of_softening(law);
    if (std::isinf(law.steepest_softening())) {
      // a jump: the fall does not shrink with the distance
      EXPECT_GT(largest_fall(law, 1e-8 * end),
                0.9 * largest_fall(law, 1e-6 * end));
      return;
    }
    const double h = 1e-6 * end;
    EXPECT_LE(largest_fall(law, h) / h, law.steepest_softening() * (1. + 1e-6));
    EXPECT_GE(largest_fall(law, h) / h, law.steepest_softening() * (1. - 1e-3));
  }

  // With a potential, opening first and slipping first take the same work;
  // without, they do not.
  void potential_means_independence_of_the_path(const CohesiveLaw &law)
  {
    const double end =
        std::min(end_of_softening(law), 3. * law.toughness() / law.strength());
    const double N = 0.4 * end, T = 0.4 * end / std::sqrt(law.shear_weight());
    const double opening_first =
        work(law, 0., 0., N, 0.) + work(law, N, 0., N, T);
    const double slip_first = work(law, 0., 0., 0., T) + work(law, 0., T, N, T);
    const double difference = std::abs(opening_first - slip_first);
    if (law.has_potential()) {
      EXPECT_LE(difference, 1e-6 * law.toughness());
      EXPECT_NEAR(opening_first, law.energy(std::sqrt(2.) * N),
                  1e-6 * law.toughness());
    } else
      EXPECT_GE(difference, 1e-4 * law.toughness());
  }

  /** Every registered law, with each of the examples it registers. */
  void
  expect_for_all_laws(const std::function<void(const CohesiveLaw &)> &check)
  {
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        check(*make_law(name, entries_of(example)));
      }
  }

  TEST(LawsContract, EveryLawHasExamples)
  {
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      EXPECT_FALSE(entry.examples.empty())
          << "the cohesive law '" << name
          << "' is not tested: add examples of its entries to NSFD_REGISTER";
  }

  TEST(LawsContract, BetaNeverGrows) { expect_for_all_laws(beta_never_grows); }

  TEST(LawsContract, TractionAndBetaAgree)
  {
    expect_for_all_laws(traction_and_beta_agree);
  }

  TEST(LawsContract, DissipationNeverFalls)
  {
    expect_for_all_laws(dissipation_never_falls);
  }

  TEST(LawsContract, EnergyIsTheIntegralOfTheTraction)
  {
    expect_for_all_laws(energy_is_the_integral_of_the_traction);
  }

  TEST(LawsContract, SteepestSofteningIsAttained)
  {
    expect_for_all_laws(steepest_softening_is_attained);
  }

  TEST(LawsContract, PotentialMeansIndependenceOfThePath)
  {
    expect_for_all_laws(potential_means_independence_of_the_path);
  }
} // namespace
