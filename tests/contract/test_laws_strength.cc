#include "every_law.h"

#include "nsfd/cohesive_laws/law_point.h"

namespace every_law::test_laws_strength
{
  /** Opening and shear. */
  using Traction = std::array<double, 2>;

  double ratio(const LawPoint &point, const Traction &t,
               const double friction = 0.)
  {
    return strength_ratio<2>(point, t[0], &t[1], {}, friction);
  }

  /** Largest traction in pure shear, as the law gives it. */
  double shear_strength(const CohesiveLaw &law)
  {
    if (const MixedLaw *mixed = law.mixed())
      return mixed->tangential_secant(0., mixed->peak_slip()) *
             mixed->peak_slip();
    // at the effective opening of the peak, next to 0 if it is there
    const double d =
        std::max(law.peak_opening(), 1e-13 * end_of_softening(law));
    return law.secant(d) * law.stiffness_ratio() * d /
           std::sqrt(law.shear_weight());
  }

  // 1e-10: the traction of a law next to its peak at 0 is not quite R_max
  void strengths_of_single_modes(const CohesiveLaw &law)
  {
    const double R_N = law.strength(), R_T = shear_strength(law);
    for (const double a : {1., 0.4, 2.}) {
      const LawPoint point(law, a, 3.);
      EXPECT_NEAR(ratio(point, {{a * R_N, 0.}}), 1., 1e-14);
      EXPECT_NEAR(ratio(point, {{0., a * R_T}}), 1., 1e-10);
      EXPECT_NEAR(ratio(point, {{0., -a * R_T}}), 1., 1e-10);
      EXPECT_NEAR(ratio(point, {{-a * R_N, a * R_T}}), 1., 1e-10);
      EXPECT_EQ(ratio(point, {{-R_N, 0.}}), 0.);
    }
  }

  void ratio_is_homogeneous(const CohesiveLaw &law)
  {
    const LawPoint point(law);
    const double R_N = law.strength(), R_T = shear_strength(law);
    for (const double N : {-1., 0., 0.2, 1.})
      for (const double T : {0., 0.01, 0.3, 1.}) {
        const Traction t{{N * R_N, T * R_T}};
        const double once = ratio(point, t, 0.3);
        for (const double k : {1e-9, 0.5, 7., 1e6})
          EXPECT_NEAR(ratio(point, {{k * t[0], k * t[1]}}, 0.3), k * once,
                      1e-13 * k); // tractions are of the size of R_max
        // the direction of the shear in the face does not matter
        const double shear[] = {0.6 * t[1], -0.8 * t[1]};
        EXPECT_NEAR(strength_ratio<3>(point, t[0], shear), ratio(point, t),
                    1e-13);
      }
  }

  // Compression counts for friction only: it never lowers the strength, and
  // carries the shear up to mu times the pressure.
  void compression_never_lowers_the_strength(const CohesiveLaw &law)
  {
    const LawPoint point(law);
    const double R_N = law.strength(), R_T = shear_strength(law);
    const double sheared = ratio(point, {{0., 0.8 * R_T}});
    EXPECT_NEAR(sheared, 0.8, 1e-10);
    double last = sheared;
    for (const double pressure : {0.1, 0.5, 2., 10.}) {
      const Traction t{{-pressure * R_N, 0.8 * R_T}};
      EXPECT_NEAR(ratio(point, t), sheared, 1e-14);
      const double held = ratio(point, t, 0.4);
      EXPECT_LE(held, last);
      EXPECT_NEAR(held, std::max(0., 0.8 - 0.4 * pressure * R_N / R_T),
                  1e-10 * (1. + R_N / R_T));
      last = held;
    }
    // in tension there is no pressure
    EXPECT_EQ(ratio(point, {{0.3 * R_N, 0.2 * R_T}}, 0.4),
              ratio(point, {{0.3 * R_N, 0.2 * R_T}}));
    for (const double T : {0.1, 0.5, 1.})
      for (double N = 0.1, before = T; N < 1.; N += 0.1) {
        const double now = ratio(point, {{N * R_N, T * R_T}});
        // of added openings the shear alone counts: what is not quite R_max
        EXPECT_GE(now, before * (1. - 1e-10)) << N << ' ' << T;
        before = now;
      }
  }

  /**
   * No jump has a traction beyond the strength, and on every straight way
   * from 0 in the space of jumps there is one that reaches it. Between two of
   * 400 jumps the largest ratio is missed by the square of their distance.
   */
  void no_traction_is_larger(const CohesiveLaw &law)
  {
    const LawPoint point(law, 1.3, 0.7);
    const double end =
        2. *
        (law.mixed() || !law.extrinsic() ? law.peak_opening()
                                         : 0.1 * end_of_softening(law)) /
        0.7;
    const double slip = law.mixed() ? 2. * law.mixed()->peak_slip() / 0.7
                                    : end / std::sqrt(law.shear_weight());
    for (unsigned int k = 0; k <= 8; ++k) {
      const double angle = M_PI / 16. * k;
      double largest = 0.;
      for (unsigned int i = 1; i <= 400; ++i) {
        const double u[] = {end * std::cos(angle) * i / 400.,
                            slip * std::sin(angle) * i / 400.};
        const Reach history = point.moved({}, JumpSize::of<2>(u)).history;
        const Secant b = point.secant(history);
        Traction t{{b.normal * u[0], b.tangential * u[1]}};
        if (law.adds_openings()) { // each direction by itself
          const double T = point.traction(history.opening);
          t = {{u[0] > 0. ? T : 0.,
                u[1] > 0. ? T * std::sqrt(law.shear_weight()) : 0.}};
        }
        const double now = ratio(point, t);
        ASSERT_LE(now, 1. + 1e-12) << "angle " << angle << ", jump " << i;
        largest = std::max(largest, now);
      }
      EXPECT_GT(largest, 1. - 1e-2) << "angle " << angle;
    }
  }

  TEST(LawsContract, StrengthsOfSingleModes)
  {
    expect_for_all_laws(strengths_of_single_modes);
  }

  TEST(LawsContract, StrengthRatioIsHomogeneous)
  {
    expect_for_all_laws(ratio_is_homogeneous);
  }

  TEST(LawsContract, CompressionNeverLowersTheStrength)
  {
    expect_for_all_laws(compression_never_lowers_the_strength);
  }

  TEST(LawsContract, NoTractionIsLargerThanTheStrength)
  {
    expect_for_all_laws(no_traction_is_larger);
  }

  // What is left of the strength where the traction stays while a point closes.
  TEST(LawsContract, PlateauKeepsWhatItsLargestOpeningHasLeft)
  {
    expect_for_all_laws([](const CohesiveLaw &law) {
      if (!law.extrinsic())
        return;
      const LawPoint point(law, 1.3, 0.7, true);
      const double d = 0.4 * end_of_softening(law), T = 1.3 * law.traction(d);
      const double shear = 0.;
      EXPECT_NEAR(strength_ratio<2>(point, T, &shear, {d / 0.7, 0.}), 1.,
                  1e-12);
      EXPECT_NEAR(strength_ratio<2>(point, 1.3 * law.strength(), &shear), 1.,
                  1e-14);
    });
  }

  /**
   * Xu and Needleman: along a direction of the traction, y (1 + x) is
   * proportional to x, and the traction is largest where
   * 1/x - 1 = 2 y y', hence y^2 = (1 - x^2) / 2. With x from 0 to 1 that is the
   * whole surface: (1 - x)(1 + x) / 2 = y^2, T_N = e R x e^(-x - y^2) and
   * T_T = (2 phi / delta_T) y (1 + x) e^(-x - y^2).
   */
  TEST(LawsContract, StrengthOfXuNeedlemanInClosedForm)
  {
    const double e = std::exp(1.), R = 3e6, delta_N = 0.5e-6, delta_T = 0.8e-6;
    const auto law =
        make_law("xu-needleman", {{"strength", "3 MPa"},
                                  {"characteristic opening", "0.5 um"},
                                  {"characteristic slip", "0.8 um"}});
    const LawPoint point(*law);
    for (double x = 1e-6; x < 1.; x += 0.01) {
      const double y = std::sqrt((1. - x) * (1. + x) / 2.);
      const double fade = std::exp(-x - y * y);
      EXPECT_NEAR(
          ratio(point, {{e * R * x * fade, 2. * e * R * delta_N / delta_T * y *
                                               (1. + x) * fade}}),
          1., 1e-12)
          << "x = " << x;
    }
  }
} // namespace every_law::test_laws_strength
