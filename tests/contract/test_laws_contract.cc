#include "every_law.h"

namespace every_law::test_laws_contract
{
  void keeps_all_promises(const CohesiveLaw &law)
  {
    for (const auto &promise : law_contract::promises(law))
      EXPECT_EQ(promise.failure, "") << promise.text;
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

  TEST(LawsContract, AllPromisesAreKept)
  {
    expect_for_all_laws(keeps_all_promises);
  }

  TEST(LawsContract, FactorsScaleStrengthAndToughness)
  {
    expect_for_all_laws(factors_scale_strength_and_toughness);
  }
} // namespace every_law::test_laws_contract
