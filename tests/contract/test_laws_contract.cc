#include "every_law.h"

namespace every_law::test_laws_contract
{
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
      // differences of fourth order, also next to a root of T
      if (d <= 2. * h || d > 2. * end ||
          kink_between(law, d - 20. * h, d + 20. * h))
        continue;
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
      // no bound: the quotient grows by half a power of the distance or more,
      // with a jump like 1 / h
      EXPECT_GT(largest_fall(law, 1e-8 * end) / 1e-8,
                5. * largest_fall(law, 1e-6 * end) / 1e-6);
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
    if (law.mixed())
      return; // its own functions are those of pure opening
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

  /**
   * A point with a times the strength and g times the toughness, opened from
   * closed by @p opening in one step. The majorant is so small that nothing
   * changes the opening.
   */
  struct GradedPoint {
    double traction; ///< pulls back
    double work;     ///< of the traction
    double spent;    ///< stored and dissipated
  };
  GradedPoint open_graded_point(const CohesiveLaw &law, const CohesionRule rule,
                                const double a, const double g,
                                const double opening)
  {
    OneStepProblem<2> problem;
    resize(problem, 1);
    problem.n_owned = 1;
    problem.time_step = 0.02;
    problem.theta = 1.;
    problem.rule = rule;
    problem.weight = {0.3};
    Interaction interaction;
    interaction.law = {std::shared_ptr<void>(), &law}; // not owned
    interaction.stiffness_ratio = law.stiffness_ratio();
    interaction.shear_weight = law.shear_weight();
    problem.interactions = {interaction};
    problem.kind = {law.extrinsic() ? PointKind::rigid : PointKind::cohesive};
    problem.strength_factor = {a};
    problem.opening_factor = {a / g};
    if (law.mixed())
      problem.slip_max = {0.};
    const double R = 1e-14 * opening / (law.strength() * 0.3 * 0.02 * 0.02);
    const auto solution = solve_point<2>(
        problem, 0, {{opening / problem.time_step, 0.}}, R, R, {});
    const auto energies =
        point_energies<2>(problem, 0, solution.velocity, solution.frozen);
    return {-solution.impulse[0] / (0.3 * 0.02),
            energies.cohesive_traction[0] * opening,
            energies.damage + energies.stored};
  }

  // Strength a R_max at the opening scaled by g / a, toughness g G: exact for
  // one point, to the 1e-14 that the majorant moves it.
  void factors_scale_strength_and_toughness(const CohesiveLaw &law)
  {
    if (law.rate_dependent())
      return; // its traction is that of the envelope at rest only
    const double end = end_of_softening(law), R_max = law.strength(),
                 G = law.toughness();
    for (const double a : {1., 0.3, 2.5})
      for (const double g : {1., 0.2, 3.}) {
        SCOPED_TRACE("a = " + std::to_string(a) + ", g = " + std::to_string(g));
        const double scale = g / a;
        const auto traction = [&](const double d) {
          return open_graded_point(law, CohesionRule::end_point, a, g,
                                   d * scale)
              .traction;
        };
        double largest = 0.;
        for (unsigned int i = 1; i <= 300; ++i) {
          const double d = 1.2 * end * i / 300.;
          const double T = traction(d);
          // next to a jump or an infinite slope round-off of d is amplified
          if (!kink_between(law, d * (1. - 1e-9), d * (1. + 1e-9))) {
            ASSERT_NEAR(T, a * law.traction(d), 1e-10 * a * R_max)
                << "d = " << d;
          }
          largest = std::max(largest, T);
        }
        EXPECT_LE(largest, a * R_max * (1. + 1e-12));
        // extrinsic laws have their peak at once
        const double peak =
            law.extrinsic() ? 1e-12 * end : law.peak_opening() * (1. - 1e-12);
        EXPECT_NEAR(traction(peak), a * R_max, 1e-10 * a * R_max);
        // the exact rule in one step: its work is the area under the curve
        const auto open = open_graded_point(law, CohesionRule::exact, a, g,
                                            1e9 * end * scale);
        EXPECT_NEAR(open.work, g * G, 1e-11 * g * G);
        if (law.has_potential()) {
          EXPECT_NEAR(open.spent, g * G, 1e-11 * g * G);
        }
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

  TEST(LawsContract, FactorsScaleStrengthAndToughness)
  {
    expect_for_all_laws(factors_scale_strength_and_toughness);
  }
} // namespace every_law::test_laws_contract
