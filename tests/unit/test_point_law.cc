#include "one_point.h"

#include "cohesive_laws/friction_weight.h"

#include <algorithm>
#include <random>

namespace point_law_test::test_point_law
{
  // --- friction and cohesion in shear

  struct ShearWork {
    double fine = 0.;   ///< Simpson rule over the ends of the steps
    double booked = 0.; ///< friction at the end of a step times its slip
    double before_softening = 0.;
  };

  /**
   * Slip from 0 to @p range under the constant contact traction N = 3, in
   * @p n steps. Checks the traction at the end of every step.
   */
  template <int dim>
  ShearWork slide(const std::shared_ptr<const CohesiveLaw> &law,
                  const double exponent, const double range,
                  const unsigned int n)
  {
    const double N = 3., mu = 0.4;
    OnePoint<dim> point(interaction_of(law, mu, exponent), PointKind::cohesive,
                        CohesionRule::end_point);
    std::vector<double> friction{mu * N * kappa(1., exponent)};
    ShearWork work;
    for (unsigned int i = 1; i <= n; ++i) {
      const double slip = range * i / n;
      std::array<double, dim> target{};
      target[1] = slip;
      const auto solution = point.drive(target, N);
      EXPECT_NEAR(point.jump[0], 0., 1e-15 * range);
      const double beta = law->beta(slip);
      const double expected = beta * law->normal_stiffness() * slip +
                              mu * kappa(beta, exponent) * N;
      // The impulse is a difference of velocities over R, so that 1e-16 of
      // the slip per step grows by 1 / (R w h^2 C) = 100, times slip / step.
      EXPECT_NEAR(point.pull(solution)[1], expected, 1e-10 * N);
      EXPECT_NEAR(solution.impulse[0], point.weight_step() * N, 1e-14 * N);
      friction.push_back(point.friction_traction(solution));
      work.booked += friction.back() * range / n;
      if (slip <= law->elastic_limit())
        work.before_softening += solution.frozen.threshold;
    }
    work.fine = simpson(friction, range / n) / (mu * N);
    work.booked /= mu * N;
    return work;
  }

  TEST(PointLaw, ShearMonotoneTvergaard)
  {
    // kappa = (2 x - x^2)^s: 2/3, 8/15, 16/35. The Simpson rule is exact up to
    // h^4 f'''' / 180 = 1e-10; the end of each step overestimates a kappa that
    // grows from 0 to 1 by at most one step.
    const double exact[] = {2. / 3., 8. / 15., 16. / 35.};
    const unsigned int n = 300;
    for (unsigned int s = 1; s <= 3; ++s) {
      const auto work = slide<2>(tvergaard(), s, 0.6, n);
      EXPECT_NEAR(work.fine / 0.6, exact[s - 1], 2e-9) << "s = " << s;
      EXPECT_GT(work.booked / 0.6, exact[s - 1]) << "s = " << s;
      EXPECT_LT(work.booked / 0.6, exact[s - 1] + 1. / n) << "s = " << s;
    }
    EXPECT_NEAR(slide<3>(tvergaard(), 2., 0.6, 100).fine / 0.6, 8. / 15., 1e-7)
        << "in three dimensions";
  }

  TEST(PointLaw, ShearMonotoneMichelSuquet)
  {
    const double ln2 = std::log(2.);
    const double exact[] = {4. - 4. * ln2, 12. - 16. * ln2, 34. - 48. * ln2};
    const double printed[] = {1.2274113, 0.9096451, 0.7289353};
    for (unsigned int s = 1; s <= 3; ++s) {
      // the kink at x = 1 lies between two panels of the Simpson rule
      const auto work = slide<2>(michel_suquet(), s, 1.2, 600);
      EXPECT_NEAR(work.fine / 0.4, exact[s - 1], 2e-9) << "s = " << s;
      EXPECT_NEAR(work.fine / 0.4, printed[s - 1], 6e-8) << "s = " << s;
      EXPECT_EQ(work.before_softening, 0.) << "no friction while intact";
    }
  }

  /** kappa^3 of the Michel-Suquet law, and its primitive, x = u / d_c. */
  double kappa_3(const double x)
  {
    return x <= 1. ? 0. : x >= 3. ? 1. : std::pow(2. - 4. / (1. + x), 3);
  }
  double kappa_3_primitive(const double x)
  {
    return 8. * x - 48. * std::log(1. + x) - 96. / (1. + x) +
           32. / ((1. + x) * (1. + x));
  }

  TEST(PointLaw, ShearCycle)
  {
    const double d_c = 0.4, R_max = 2., N = 3., mu = 0.4;
    OnePoint<2> point(interaction_of(michel_suquet(), mu, 3.),
                      PointKind::cohesive, CohesionRule::end_point);
    double damage = 0., work = 0., last_friction = 0., last = 0.;
    double total = 0.; // tangential traction at the end of the last step
    const auto go_to = [&](const double x, const unsigned int n) {
      const double start = last;
      for (unsigned int i = 1; i <= n; ++i) {
        const double slip = start + (x - start) * i / n;
        const auto solution = point.drive({{0., slip * d_c}}, N);
        EXPECT_NEAR(point.jump[1], slip * d_c, 1e-14);
        EXPECT_NEAR(point.jump[0], 0., 1e-15);
        total = point.pull(solution)[1];
        damage += point.energies.damage;
        const double friction = std::abs(point.friction_traction(solution));
        work += (friction + last_friction) / 2. * std::abs(slip - last) * d_c;
        last_friction = friction;
        last = slip;
      }
    };
    // 1e-10: see ShearMonotone
    const auto expect_total = [&](const double cohesive, const double weight) {
      EXPECT_NEAR(total, cohesive * R_max + weight * mu * N, 1e-10 * N);
    };
    go_to(1., 200);
    expect_total(1., 0.);
    go_to(1.5, 1000);
    expect_total(0.9, 0.064);
    // just after the reversal; 0.6 of the slip is what the spring gives back
    go_to(1.5 - 1e-6, 1);
    EXPECT_NEAR(total, (0.9 - 0.6e-6) * R_max - 0.064 * mu * N, 1e-8);
    go_to(0., 100);
    expect_total(0., -0.064);
    go_to(-1.5, 100);
    expect_total(-0.9, -0.064);
    go_to(-2., 1000);
    expect_total(-2. / 3., -8. / 27.);
    EXPECT_NEAR(-8. / 27., -0.2962963, 5e-8);
    go_to(0., 50);
    expect_total(0., 8. / 27.);
    go_to(2., 50);
    expect_total(2. / 3., 8. / 27.);
    go_to(3., 1000);
    expect_total(0., 1.);
    go_to(4., 50);
    expect_total(0., 1.);
    EXPECT_EQ(point.problem.kind[0], PointKind::free);

    EXPECT_NEAR(damage, point.law().toughness(), 1e-12 * damage);
    const double path =
        (kappa_3_primitive(1.5) - kappa_3_primitive(1.)) + 3. * kappa_3(1.5) +
        (kappa_3_primitive(2.) - kappa_3_primitive(1.5)) + 4. * kappa_3(2.) +
        (kappa_3_primitive(3.) - kappa_3_primitive(2.)) + 1.;
    // trapezoidal rule with steps up to 1e-3 in x, |kappa''| below 1:
    // h^2 / 12 times the change of kappa' over the path
    EXPECT_NEAR(work / (mu * N * d_c), path, 3e-7);
  }

  // --- opening and closing

  TEST(PointLaw, NormalCycle)
  {
    const double d_c = 0.4, R_max = 2., F = 1.4;
    OnePoint<2> point(interaction_of(michel_suquet(), 0.5), PointKind::cohesive,
                      CohesionRule::end_point);
    double last = 0., damage = 0.;
    // ends at x = u_N / d_c and returns the cohesive traction over R_max
    const auto go_to = [&](const double x) {
      const double start = last;
      double traction = 0.;
      for (unsigned int i = 1; i <= 20; ++i) {
        last = start + (x - start) * i / 20;
        const auto solution = point.drive({{last * d_c, 0.}});
        traction = point.pull(solution)[0] / R_max;
        EXPECT_NEAR(point.energies.cohesive_traction[0] / R_max, traction,
                    1e-12);
        EXPECT_EQ(solution.contact_impulse, 0.);
        damage += point.energies.damage;
      }
      return traction;
    };
    const auto press = [&] {
      const double opening_max = point.problem.opening_max[0];
      for (unsigned int i = 0; i < 3; ++i) {
        const auto solution = point.drive({{0., 0.}}, F);
        // R_N + R_N^coh = F, no spring-like penetration
        EXPECT_NEAR(solution.impulse[0] / point.weight_step() +
                        point.energies.cohesive_traction[0],
                    F, 1e-14 * F);
        EXPECT_NEAR(point.energies.cohesive_traction[0], 0., 1e-14 * R_max);
        EXPECT_NEAR(point.jump[0], 0., 1e-15);
        EXPECT_EQ(point.problem.opening_max[0], opening_max)
            << "damage changed in contact";
      }
    };
    EXPECT_NEAR(go_to(0.5), 0.5, 1e-12);
    EXPECT_NEAR(go_to(1.5), 0.9, 1e-12);
    EXPECT_NEAR(go_to(0.5), 0.3, 1e-12) << "unloading with slope 0.6";
    EXPECT_NEAR(go_to(0.), 0., 1e-12);
    press();
    EXPECT_NEAR(go_to(0.75), 0.45, 1e-12) << "loading again with slope 0.6";
    EXPECT_NEAR(go_to(1.5), 0.9, 1e-12);
    EXPECT_NEAR(go_to(2.), 2. / 3., 1e-12);
    EXPECT_NEAR(go_to(0.5), 1. / 6., 1e-12);
    EXPECT_NEAR(go_to(3.), 0., 1e-12);
    EXPECT_EQ(go_to(0.), 0.);
    press();
    EXPECT_EQ(go_to(1.), 0.);
    EXPECT_NEAR(damage, point.law().toughness(), 1e-12 * damage);
  }

  TEST(PointLaw, TvergaardIsClipped)
  {
    // (1 - lambda)^2 without its positive part would be 0.01 at 0.9 and 0.25
    // at 1.5: a running minimum of it never reaches 0
    for (const CohesionRule rule : rules) {
      OnePoint<2> point(interaction_of(tvergaard()), PointKind::cohesive, rule);
      point.drive({{0.9 * 0.6, 0.}});
      EXPECT_NEAR(point.beta(), 0.01, 1e-14);
      point.drive({{1.5 * 0.6, 0.}});
      EXPECT_EQ(point.beta(), 0.);
      EXPECT_EQ(point.problem.kind[0], PointKind::free);
      for (const double x : {1.5, 0.5, 0.1, 2.}) {
        const auto solution = point.drive({{x * 0.6, 0.2}});
        EXPECT_EQ(solution.impulse[0], 0.);
        EXPECT_EQ(solution.impulse[1], 0.);
      }
    }
    // with the law at the end of the step there is no traction in it either
    OnePoint<2> point(interaction_of(tvergaard()), PointKind::cohesive,
                      CohesionRule::end_point);
    point.drive({{0.9 * 0.6, 0.}});
    const auto solution = point.drive({{1.5 * 0.6, 0.}});
    EXPECT_EQ(solution.impulse[0], 0.);
  }

  TEST(PointLaw, MixedModeTvergaard)
  {
    OnePoint<2> point(interaction_of(tvergaard()), PointKind::cohesive,
                      CohesionRule::end_point);
    const auto solution = point.drive({{0.3 * 0.6, 0.4 * 0.6}});
    EXPECT_NEAR(point.pull(solution)[0], 0.50625 * 2., 1e-12);
    EXPECT_NEAR(point.pull(solution)[1], 0.675 * 2., 1e-12);
  }

  TEST(PointLaw, CamachoOrtizUnloadsToTheOrigin)
  {
    // opened to d_c / 2 and closed: R_max d_m / 2 = G / 2 is dissipated
    for (const CohesionRule rule : rules) {
      OnePoint<2> point(interaction_of(camacho_ortiz()), PointKind::rigid,
                        rule);
      const double G = point.law().toughness();
      double damage = 0., work = 0.;
      const auto go_to = [&](const double opening) {
        const double old = point.jump[0];
        point.drive({{opening, 0.}});
        damage += point.energies.damage;
        work += point.energies.cohesive_traction[0] * (point.jump[0] - old);
      };
      for (const double x : {0.1, 0.2, 0.4, 0.5})
        go_to(x * 0.6);
      EXPECT_NEAR(point.energies.stored, G / 4., 1e-12 * G);
      EXPECT_NEAR(damage, G / 2., 1e-12 * G);
      // secant to the origin: R = beta R_max u / d_m
      go_to(0.3 * 0.6);
      EXPECT_NEAR(point.energies.stored, 0.5 * 2. * 0.3 / 0.5 * 0.3 * 0.6 / 2.,
                  1e-12 * G);
      if (rule == CohesionRule::end_point) {
        EXPECT_NEAR(point.energies.cohesive_traction[0], 0.5 * 2. * 0.3 / 0.5,
                    1e-12);
      }
      go_to(0.);
      EXPECT_NEAR(damage, G / 2., 1e-12 * G);
      EXPECT_NEAR(point.energies.stored, 0., 1e-12 * G);
      if (rule == CohesionRule::exact) {
        EXPECT_NEAR(work, G / 2., 1e-12 * G);
      } else {
        EXPECT_GT(std::abs(work - G / 2.), 1e-2 * G)
            << "the other rules are not exact at such steps";
      }
      // and opened for good
      go_to(0.61);
      EXPECT_NEAR(damage, G, 1e-12 * G);
      EXPECT_EQ(point.energies.beta, 0.);
    }
  }

  // --- viscosity

  TEST(PointLaw, ViscosityAtConstantSpeed)
  {
    // opened to Delta with the speed v: G + eta v Delta, whatever the steps
    for (const auto &entry : potentials) {
      std::shared_ptr<const CohesiveLaw> law =
          make_law(entry.name, entry.entries);
      if (!std::isfinite(law->final_opening()))
        continue;
      SCOPED_TRACE(entry.name);
      const double G = law->toughness(), Delta = law->final_opening();
      for (const double theta : {0.5, 1.})
        for (const unsigned int n : {1u, 7u, 60u}) {
          OnePoint<2> point(interaction_of(law), initial_kind(*law),
                            CohesionRule::exact, theta);
          const double v = Delta / (n * point.problem.time_step),
                       eta = 0.3 * law->strength() / v;
          point.problem.viscosity = {eta};
          double work = 0., damage = 0., viscous = 0.;
          for (unsigned int k = 1; k <= n; ++k) {
            const double old = point.jump[0];
            // a little too far: the last step must not miss separation
            point.drive({{k * Delta / n * (1. + 1e-13), 0.}});
            work += point.energies.cohesive_traction[0] * (point.jump[0] - old);
            damage += point.energies.damage;
            viscous += point.energies.viscous;
          }
          const double dragged = eta * v * Delta;
          EXPECT_NEAR(work, G + dragged, 1e-11 * (G + dragged));
          EXPECT_NEAR(damage, G, 1e-11 * G);
          EXPECT_NEAR(viscous, dragged, 1e-11 * dragged);
          EXPECT_EQ(point.problem.kind[0], PointKind::free);
        }
    }
  }

  TEST(PointLaw, ViscosityShiftsThePeak)
  {
    // by eta v, only while the point opens
    OnePoint<2> point(interaction_of(tvergaard()), PointKind::cohesive,
                      CohesionRule::end_point);
    point.problem.viscosity = {0.05};
    const double peak = point.law().peak_opening(),
                 v = peak / 4. / point.problem.time_step;
    for (unsigned int k = 1; k <= 4; ++k) {
      const auto solution = point.drive({{k * peak / 4., 0.}});
      EXPECT_NEAR(point.pull(solution)[0],
                  point.law().traction(k * peak / 4.) + 0.05 * v, 1e-12);
      EXPECT_NEAR(point.energies.viscous_traction, 0.05 * v, 1e-12);
    }
    const auto closing = point.drive({{0.5 * peak, 0.}});
    EXPECT_NEAR(point.pull(closing)[0], 0.5 * point.law().strength(), 1e-12);
    EXPECT_EQ(point.energies.viscous, 0.);
    // nor against slip
    const auto slipping = point.drive({{0.5 * peak, 0.1 * peak}});
    EXPECT_NEAR(point.energies.viscous, 0., 1e-20);
    EXPECT_NEAR(point.pull(slipping)[0], 0.5 * point.law().strength(), 1e-12);
  }

  // --- friction

  TEST(PointLaw, NoFrictionNoTangentialImpulse)
  {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-1., 1.);
    OnePoint<3> broken(contact_only(0.), PointKind::free, CohesionRule::exact);
    OnePoint<3> cohesive(interaction_of(michel_suquet(), 0.),
                         PointKind::cohesive, CohesionRule::end_point);
    for (unsigned int k = 0; k < 200; ++k) {
      broken.prepare();
      broken.problem.contact[0] = 1;
      const std::array<double, 3> local{
          {-1e3 * std::abs(number(random)), number(random), number(random)}};
      const auto solution = broken.solve(local);
      EXPECT_GT(solution.impulse[0], 0.);
      EXPECT_EQ(solution.impulse[1], 0.);
      EXPECT_EQ(solution.impulse[2], 0.);
      EXPECT_EQ(solution.velocity[1], local[1]);

      // nothing beyond cohesion, whatever presses the faces together
      const auto pressed =
          cohesive.drive({{0., 0.5 * number(random), 0.5 * number(random)}},
                         1e3 * std::abs(number(random)) + 1e-3);
      for (unsigned int c = 1; c < 3; ++c)
        EXPECT_NEAR(cohesive.pull(pressed)[c],
                    cohesive.energies.cohesive_traction[c], 1e-14 * 2.);
    }
  }

  TEST(PointLaw, HugeFrictionSticks)
  {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> number(-1., 1.);
    OnePoint<3> broken(contact_only(1e3), PointKind::free, CohesionRule::exact);
    OnePoint<3> cohesive(interaction_of(michel_suquet(), 1e3, 0.),
                         PointKind::cohesive, CohesionRule::exact);
    for (auto *point : {&broken, &cohesive})
      for (unsigned int k = 0; k < 200; ++k) {
        point->prepare();
        point->problem.contact[0] = 1;
        const auto solution = point->solve({{-0.1 - std::abs(number(random)),
                                             number(random), number(random)}});
        EXPECT_GT(solution.contact_impulse, 0.);
        for (unsigned int c = 0; c < 3; ++c) {
          EXPECT_EQ(solution.velocity[c], 0.);
          EXPECT_TRUE(std::isfinite(solution.impulse[c]));
        }
      }
  }

  TEST(PointLaw, PrescribedComponents)
  {
    OnePoint<3> point(contact_only(0.), PointKind::prescribed,
                      CohesionRule::exact);
    point.problem.mask = {0b101};
    point.problem.given_velocity = {2., 7., -3.};
    point.prepare();
    const auto solution = point.solve({{1., 4., 5.}});
    const double R_N = point.majorant_normal, R_T = point.majorant_tangential;
    EXPECT_EQ(solution.velocity[0], 2.);
    EXPECT_EQ(solution.velocity[1], 4.) << "not prescribed: carries nothing";
    EXPECT_EQ(solution.velocity[2], -3.);
    EXPECT_DOUBLE_EQ(solution.impulse[0], 1. / R_N);
    EXPECT_EQ(solution.impulse[1], 0.);
    EXPECT_DOUBLE_EQ(solution.impulse[2], -8. / R_T);
    const auto slopes =
        frozen_slopes<3>(point.problem, 0, solution.frozen, solution, R_N, R_T);
    EXPECT_DOUBLE_EQ(slopes[0], 1. / R_N);
    EXPECT_EQ(slopes[1], 0.);
    EXPECT_DOUBLE_EQ(slopes[2], 1. / R_T);
  }
} // namespace point_law_test::test_point_law
