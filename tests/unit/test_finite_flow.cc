#include "plastic_flow.h"

namespace plastic_flow::test_finite_flow
{
  // --------------------------------------------------------------- logarithm

  const Voigt<3> one = {1., 1., 1., 0., 0., 0.};

  /** Eigenvalues are known to round-off of the largest one. */
  double condition(const Spectrum &C)
  {
    const Vec3 &c = C.values();
    return *std::max_element(c.begin(), c.end()) /
           *std::min_element(c.begin(), c.end());
  }

  TEST(MatrixLog, OfItsExponential)
  {
    Random random;
    for (const double scale : {1e-12, 1e-6, 1e-3, 0.3, 2.})
      for (unsigned int k = 0; k < 50; ++k) {
        const Voigt<3> E = symmetric(random, scale);
        const Spectrum C(Spectrum(E).function(
            [](const double e) { return std::exp(2. * e); }));
        ASSERT_TRUE(C.positive());
        EXPECT_LT(size(plus(C.half_log(), -1., E)), 1e-14 * condition(C));
      }
    EXPECT_EQ(size(Spectrum(one).half_log()), 0.);
  }

  TEST(MatrixLog, SecantIsExact)
  {
    Random random;
    for (const double start : {0., 1e-3, 0.5})
      for (const double way : {1e-14, 1e-8, 1e-3, 0.3}) {
        const auto positive = [](const Voigt<3> &E) {
          return Spectrum(E).function(
              [](const double e) { return std::exp(2. * e); });
        };
        for (unsigned int k = 0; k < 20; ++k) {
          const Voigt<3> E0 = symmetric(random, start), C0 = positive(E0),
                         C1 = positive(plus(E0, 1., symmetric(random, way)));
          const Voigt<3> T = symmetric(random, 1.);
          const Spectrum a(C0), b(C1);
          const double work =
              contract<3>(T, plus(b.half_log(), -1., a.half_log()));
          EXPECT_NEAR(
              contract<3>(LogSecant(a, b).pulled_back(T), plus(C1, -1., C0)) /
                  2.,
              work, 1e-14 * (condition(a) + condition(b)));
        }
      }
  }

  TEST(MatrixLog, ChangesAreThoseOfTheSecant)
  {
    Random random;
    for (const double scale : {0., 1e-9, 0.01, 0.1, 0.8})
      for (unsigned int k = 0; k < 20; ++k) {
        const auto exponential = [&](const double s) {
          return Spectrum(symmetric(random, s)).function([](const double e) {
            return std::exp(e);
          });
        };
        const Voigt<3> C0 = exponential(scale), C1 = exponential(scale),
                       T = symmetric(random, 1.), H = symmetric(random, 1.);
        const double d = 1e-6;
        const auto at = [&](const double s) {
          return LogSecant(Spectrum(C0), Spectrum(plus(C1, s * d, H)))
              .pulled_back(T);
        };
        const Voigt<3> difference = plus(at(1.), -1., at(-1.));
        const Voigt<3> change =
            LogSecant(Spectrum(C0), Spectrum(C1)).derivative_at_end(T)(H);
        EXPECT_LT(size(plus(plus({}, 0.5 / d, difference), -1., change)),
                  1e-6 * (1. + size(change)));
        const auto log_at = [&](const double s) {
          return Spectrum(plus(C1, s * d, H)).half_log();
        };
        EXPECT_LT(
            size(plus(plus({}, 0.5 / d, plus(log_at(1.), -1., log_at(-1.))),
                      -1., half_log_change(Spectrum(C1), H))),
            1e-6);
      }
  }

  // ------------------------------------------------------------ finite strain

  /** A point of finite strain and its energy balance. */
  struct Point {
    explicit Point(const PlasticInput &plastic)
        : law(make_history_material<3>(young, poisson, plastic, true, false)),
          history(law->n_history())
    {
      law->begin(history.data());
    }

    void go(const Voigt<3> &to, const double h = 1., const double theta = 0.5)
    {
      HistoryMaterial<3>::Way way;
      way.C0 = C;
      way.C1 = to;
      way.history = history.data();
      way.time_step = h;
      way.theta = theta;
      std::vector<double> next(history.size());
      const double before = law->energy(C, history.data());
      ASSERT_TRUE(law->step(way, false, step, next.data()));
      const double work = contract<3>(step.S, plus(to, -1., C)) / 2.;
      const double after = law->energy(to, next.data());
      plastic += step.plastic;
      largest = std::max({largest, after, std::abs(work)});
      defect =
          std::max(defect, std::abs(work - (after - before) - step.plastic -
                                    step.viscous - step.numerical) /
                               largest);
      C = to;
      history = next;
    }

    std::unique_ptr<const HistoryMaterial<3>> law;
    std::vector<double> history;
    Voigt<3> C = one;
    HistoryMaterial<3>::Step step;
    double plastic = 0., defect = 0., largest = 0.;
  };

  double determinant_of_flow(const Point &point)
  {
    const double *G = point.history.data();
    return G[0] * (G[4] * G[8] - G[5] * G[7]) -
           G[1] * (G[3] * G[8] - G[5] * G[6]) +
           G[2] * (G[3] * G[7] - G[4] * G[6]);
  }

  // ln of the stretches: elastic ones of Hencky's law and the flow. The stress
  // of Hencky is Kirchhoff's, sigma det F.
  TEST(FiniteFlow, BarInLogarithmicStrain)
  {
    const double H = 2e9, K = 3e9;
    for (const unsigned int n : {1u, 4u, 60u}) {
      Point bar(flow(H, K));
      double p = 0.;
      for (unsigned int k = 1; k <= n; ++k) {
        p = 0.8 * k / n;
        const double tau = yield + (H + K) * p;
        const double axial = tau / young + p,
                     lateral = -poisson * tau / young - p / 2.;
        bar.go({std::exp(2. * axial), std::exp(2. * lateral),
                std::exp(2. * lateral), 0., 0., 0.});
        const double gradient[9] = {std::exp(axial) - 1.,   0., 0., 0.,
                                    std::exp(lateral) - 1., 0., 0., 0.,
                                    std::exp(lateral) - 1.};
        const auto sigma = bar.law->stress(gradient, bar.history.data());
        const double J = std::exp(axial + 2. * lateral);
        EXPECT_NEAR(sigma[0], tau / J, 1e-10 * yield);
        EXPECT_NEAR(sigma[1], 0., 1e-10 * yield);
        EXPECT_NEAR(bar.law->equivalent_strain(bar.history.data()), p, 1e-12);
      }
      EXPECT_NEAR(bar.plastic, yield * p, 1e-10 * yield);
      EXPECT_LT(bar.defect, 1e-12);
      EXPECT_NEAR(determinant_of_flow(bar), 1., 1e-14);
    }
  }

  // Flow without hardening: the shear stress of simple shear stays, up to the
  // elastic strain, which also lets volume and normal stresses change.
  TEST(FiniteFlow, SimpleShearStaysOnTheSurface)
  {
    Point point(flow(0., 0.));
    for (unsigned int k = 1; k <= 400; ++k) {
      const double g = 4. * k / 400.;
      point.go({1., 1. + g * g, 1., g, 0., 0.});
    }
    const double gradient[9] = {0., 4., 0., 0., 0., 0., 0., 0., 0.};
    const auto sigma = point.law->stress(gradient, point.history.data());
    EXPECT_NEAR(sigma[3], yield / std::sqrt(3.), 0.02 * yield);
    const double J2 =
        (std::pow(sigma[0] - sigma[1], 2) + std::pow(sigma[1] - sigma[2], 2) +
         std::pow(sigma[2] - sigma[0], 2)) /
            6. +
        sigma[3] * sigma[3];
    EXPECT_NEAR(std::sqrt(3. * J2), yield, 1e-10 * yield);
    EXPECT_LT(point.defect, 1e-12);
  }

  TEST(FiniteFlow, PressureDoesNotFlow)
  {
    Point point(flow());
    for (const double stretch : {0.5, 1.7}) {
      const double c = stretch * stretch;
      point.go({c, c, c, 0., 0., 0.});
      EXPECT_EQ(point.law->equivalent_strain(point.history.data()), 0.);
    }
  }

  TEST(FiniteFlow, RandomStrainPathsCloseTheBalanceAndGainNothing)
  {
    for (const double viscosity : {0., 1e8})
      for (const double theta : {0.5, 0.7}) {
        Random random;
        Point point(flow(2e9, 3e9, viscosity));
        std::vector<double> F = {1., 0., 0., 0., 1., 0., 0., 0., 1.};
        for (unsigned int k = 0; k < 2000; ++k) {
          const double scale =
              std::pow(10., -1.5 - std::abs(random.number(2.)));
          std::vector<double> next = F;
          for (unsigned int i = 0; i < 9; ++i)
            next[i] += random.number(scale) +
                       (k % 100 ? 0. : 1. * (i % 4 == 0) - F[i]);
          Voigt<3> C;
          const unsigned int at[6][2] = {{0, 0}, {1, 1}, {2, 2},
                                         {0, 1}, {0, 2}, {1, 2}};
          for (unsigned int i = 0; i < 6; ++i) {
            C[i] = 0.;
            for (unsigned int c = 0; c < 3; ++c)
              C[i] += next[c * 3 + at[i][0]] * next[c * 3 + at[i][1]];
          }
          if (!(determinant(C) > 0.05) || !(C[0] + C[1] + C[2] < 9.))
            continue;
          F = next;
          point.go(C, std::pow(10., random.number(2.)), theta);
          ASSERT_GE(point.step.plastic, 0.);
          ASSERT_GE(point.step.viscous, 0.);
          ASSERT_NEAR(determinant_of_flow(point), 1., 1e-13);
        }
        EXPECT_GT(point.plastic, 0.);
        EXPECT_LT(point.defect, 1e-11);
      }
  }

  TEST(FiniteFlow, TangentIsThatOfTheStress)
  {
    Random random;
    unsigned int flowing = 0;
    Point point(flow(2e9, 3e9));
    for (unsigned int k = 0; k < 200; ++k) {
      const Voigt<3> to =
          Spectrum(symmetric(random, 0.1)).function([](const double e) {
            return std::exp(2. * e);
          });
      HistoryMaterial<3>::Way way;
      way.C0 = point.C;
      way.C1 = to;
      const std::vector<double> history = point.history;
      way.history = history.data();
      way.theta = 0.6;
      point.go(to, 1., 0.6);
      HistoryMaterial<3>::Step here, up, down;
      ASSERT_TRUE(point.law->step(way, true, here, nullptr));
      const Voigt<3> along = symmetric(random, 1.);
      const double d = 1e-7;
      way.C1 = plus(to, d, along);
      point.law->step(way, false, up, nullptr);
      way.C1 = plus(to, -d, along);
      point.law->step(way, false, down, nullptr);
      if ((up.plastic > 0.) != (down.plastic > 0.))
        continue;
      flowing += here.plastic > 0.;
      Voigt<3> error = plus({}, 0.5 / d, plus(up.S, -1., down.S));
      double scale = size(error);
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j < 6; ++j)
          error[i] -= here.tangent[i * 6 + j] * voigt_weight<3>(j) * along[j];
      EXPECT_LT(size(error), 1e-5 * (scale + young)) << k;
    }
    EXPECT_GT(flowing, 100u);
  }
} // namespace plastic_flow::test_finite_flow
