#include "law_checks.h"

#include "nonsmooth/point_law.h"
#include "nsfd/scene/time_input.h"

#include <optional>

using namespace nsfd;
using namespace nsfd::test;

// Laws with a damage scalar for each direction: xu-needleman and ppr.

namespace test_laws_two_scalars
{
  const double e = std::exp(1.);

  double normal(const MixedLaw &law, const double x, const double y)
  {
    return law.normal_secant(x, y) * x;
  }
  double tangential(const MixedLaw &law, const double x, const double y)
  {
    return law.tangential_secant(x, y) * y;
  }

  TEST(XuNeedleman, ClosedForms)
  {
    const double R = 3e6, delta_n = 0.5e-6, phi = e * R * delta_n;
    const auto law =
        make_law("xu-needleman", {{"strength", "3 MPa"},
                                  {"characteristic opening", "0.5 um"},
                                  {"characteristic slip", "0.8 um"}});
    const double delta_t = 0.8e-6;
    ASSERT_NE(law->mixed(), nullptr);
    const MixedLaw &mixed = *law->mixed();
    expect_relative(law->toughness(), phi);
    expect_relative(law->strength(), R);
    expect_relative(law->normal_stiffness(), e * R / delta_n);
    expect_relative(law->steepest_softening(), R * R / phi);
    for (const double x : {0., 0.3, 1., 2., 7.})
      for (const double y : {0., 0.4, 1., 2.}) {
        const double fade = std::exp(-x - y * y);
        EXPECT_NEAR(normal(mixed, x * delta_n, y * delta_t),
                    phi / delta_n * x * fade, 1e-12 * R);
        EXPECT_NEAR(tangential(mixed, x * delta_n, y * delta_t),
                    2. * phi / delta_t * y * (1. + x) * fade, 1e-12 * R);
      }
    // shear alone
    const double y = 1. / std::sqrt(2.);
    expect_relative(tangential(mixed, 0., y * delta_t),
                    0.857764 * phi / delta_t, 1e-6);
    expect_relative(mixed.peak_slip(), y * delta_t);
    expect_relative(mixed.tangential_energy(0., 1e3 * delta_t, 0.), phi);
    expect_relative(mixed.steepest_shear_softening(),
                    0.892521 * phi / delta_t / delta_t, 1e-6);
    const double h = 1e-5 * delta_t, at = std::sqrt(1.5) * delta_t;
    expect_relative(
        (tangential(mixed, 0., at - h) - tangential(mixed, 0., at + h)) /
            (2. * h),
        mixed.steepest_shear_softening(), 1e-6);
    // dissipated so far in mode I
    for (const auto &[x, share] :
         {std::make_pair(5., 0.959572), {10., 0.999501}})
      EXPECT_NEAR(law->energy(x * delta_n) / phi, share + 0., 5e-7);
  }

  TEST(XuNeedleman, ShearStrengthGivesTheSlip)
  {
    const auto law = make_law("xu-needleman", {{"strength", "3 MPa"},
                                               {"toughness", "4 J/m^2"},
                                               {"shear strength", "5 MPa"}});
    const MixedLaw &mixed = *law->mixed();
    expect_relative(tangential(mixed, 0., mixed.peak_slip()), 5e6);
    expect_relative(law->traction(law->peak_opening()), 3e6);
  }

  TEST(Ppr, NumbersOfTheReference)
  {
    const auto law = make_law("ppr", {{"strength", "40 MPa"},
                                      {"toughness", "100 J/m^2"},
                                      {"shear strength", "30 MPa"},
                                      {"shear toughness", "200 J/m^2"},
                                      {"alpha", "5"},
                                      {"shear alpha", "1.3"},
                                      {"peak ratio", "0.1"},
                                      {"shear peak ratio", "0.2"}});
    const MixedLaw &mixed = *law->mixed();
    const double delta_n = 7.769570e-6, delta_t = 8.086361e-6;
    expect_relative(law->final_opening(), delta_n, 1e-6);
    expect_relative(law->peak_opening(), 0.1 * law->final_opening());
    expect_relative(mixed.peak_slip() / 0.2, delta_t, 1e-6);
    const double d_n = law->final_opening(), d_t = mixed.peak_slip() / 0.2;
    expect_relative(normal(mixed, 0.1 * d_n, 0.), 40e6);
    expect_relative(tangential(mixed, 0., 0.2 * d_t), 30e6);
    expect_relative(mixed.normal_energy(0., d_n, 0.), 100.);
    expect_relative(mixed.tangential_energy(0., d_t, 0.), 200.);
    expect_relative(normal(mixed, 0.3 * d_n, 0.25 * d_t), 9.796788e6, 1e-6);
    expect_relative(tangential(mixed, 0.3 * d_n, 0.25 * d_t), 7.806474e6, 1e-6);
    // opening is broken by slip before the slip is: 100 of 200 J/m^2 are gone
    EXPECT_EQ(mixed.normal_secant(0., 0.99 * d_t), 0.);
    EXPECT_GT(mixed.tangential_secant(0., 0.99 * d_t), 0.);
    EXPECT_EQ(mixed.tangential_secant(d_n, 0.), 0.);
    EXPECT_GT(mixed.beta(0., 0.99 * d_t), 0.);
    EXPECT_EQ(mixed.beta(d_n, d_t), 0.);

    const auto equal = make_law("ppr", {{"strength", "40 MPa"},
                                        {"toughness", "100 J/m^2"},
                                        {"shear strength", "30 MPa"},
                                        {"alpha", "3"},
                                        {"peak ratio", "0.05"}});
    expect_relative(equal->final_opening(), 6.407579e-6, 1e-6);
    expect_relative(equal->mixed()->peak_slip() / 0.05, 8.543438e-6, 1e-6);
  }

  const std::vector<std::unique_ptr<CohesiveLaw>> &examples()
  {
    static const auto laws = [] {
      std::vector<std::unique_ptr<CohesiveLaw>> result;
      for (const auto &[name, entry] :
           CohesiveLawRegistry::instance().entries())
        for (const std::string &example : entry.examples)
          if (auto law = make_law(name, entries_of(example)); law->mixed())
            result.push_back(std::move(law));
      return result;
    }();
    return laws;
  }

  TEST(TwoScalars, SecantsFallAndEnergiesAreTheirIntegrals)
  {
    ASSERT_GE(examples().size(), 5u);
    for (const auto &law : examples()) {
      const MixedLaw &mixed = *law->mixed();
      const double a = law->toughness() / law->strength(),
                   b = a / std::sqrt(law->shear_weight());
      for (double x = 0.; x < 3.; x += 0.05)
        for (double y = 0.; y < 3.; y += 0.05) {
          const auto K_N = [&](const double u, const double v) {
            return mixed.normal_secant(u * a, v * b);
          };
          const auto K_T = [&](const double u, const double v) {
            return mixed.tangential_secant(u * a, v * b);
          };
          for (const double d : {1e-3, 0.05, 1., 1e6}) {
            ASSERT_LE(K_N(x + d, y), K_N(x, y));
            ASSERT_LE(K_N(x, y + d), K_N(x, y));
            ASSERT_LE(K_T(x + d, y), K_T(x, y));
            ASSERT_LE(K_T(x, y + d), K_T(x, y));
          }
          ASSERT_TRUE(std::isfinite(mixed.beta(x * a, y * b)));
          ASSERT_NEAR(
              mixed.normal_energy(x * a, (x + 0.05) * a, y * b),
              integral([&](const double u) { return normal(mixed, u, y * b); },
                       x * a, (x + 0.05) * a, 400),
              1e-8 * law->toughness());
          ASSERT_NEAR(
              mixed.tangential_energy(y * b, (y + 0.05) * b, x * a),
              integral(
                  [&](const double v) { return tangential(mixed, x * a, v); },
                  y * b, (y + 0.05) * b, 400),
              1e-8 * mixed.tangential_energy(0., 1e6 * b, 0.));
        }
      // small parts of an integral add up to all of it
      double sum = 0.;
      for (unsigned int k = 0; k < 1000; ++k)
        sum += mixed.normal_energy(0.003 * k * a, 0.003 * (k + 1) * a, 0.3 * b);
      expect_relative(sum, mixed.normal_energy(0., 3. * a, 0.3 * b), 1e-11);
    }
  }

  // opening first or slip first
  TEST(TwoScalars, BothLawsHaveAPotential)
  {
    for (const auto &law : examples()) {
      const MixedLaw &mixed = *law->mixed();
      const double a = law->toughness() / law->strength(),
                   b = a / std::sqrt(law->shear_weight());
      for (const double x : {0.1, 0.5, 1.})
        for (const double y : {0.05, 0.2, 0.3}) {
          const double first = mixed.normal_energy(0., x * a, 0.) +
                               mixed.tangential_energy(0., y * b, x * a),
                       second = mixed.tangential_energy(0., y * b, 0.) +
                                mixed.normal_energy(0., x * a, y * b);
          // unless a direction is broken by the other one on its way
          if (mixed.normal_secant(x * a, y * b) > 0. &&
              mixed.tangential_secant(x * a, y * b) > 0.)
            expect_relative(first, second, 1e-11);
        }
    }
  }

  /** Through the point law, with a majorant too soft to matter. */
  struct Driven {
    OneStepProblem<3> problem;
    PointEnergies<3> energies;
    double work = 0., damage = 0.;

    Driven(const CohesiveLaw &law, const CohesionRule rule)
    {
      resize(problem, 1);
      problem.n_owned = 1;
      problem.time_step = 1.;
      problem.theta = 1.;
      problem.rule = rule;
      Interaction interaction;
      interaction.law = {std::shared_ptr<void>(), &law}; // not owned
      interaction.stiffness_ratio = law.stiffness_ratio();
      interaction.shear_weight = law.shear_weight();
      problem.interactions = {interaction};
      problem.kind = {PointKind::cohesive};
      problem.weight = {1.};
      problem.slip_max = {0.};
    }

    void to(const std::array<double, 3> &u)
    {
      problem.jump_free = problem.jump_old;
      std::array<double, 3> U;
      for (unsigned int c = 0; c < 3; ++c)
        U[c] = u[c] - problem.jump_old[c];
      const double size = std::abs(U[0]) + std::abs(U[1]) + std::abs(U[2]);
      const auto &law = *problem.interactions[0].law;
      const double R = 1e-9 * size /
                       (law.normal_stiffness() * (1. + law.stiffness_ratio()) *
                            (std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2])) +
                        law.strength());
      const auto solution = solve_point<3>(
          problem, 0, U, R, R, {problem.opening_max[0], problem.slip_max[0]});
      energies =
          point_energies<3>(problem, 0, solution.velocity, solution.frozen);
      for (unsigned int c = 0; c < 3; ++c) {
        EXPECT_NEAR(solution.velocity[c], U[c], 1e-7 * size);
        work += energies.cohesive_traction[c] * solution.velocity[c];
        problem.jump_old[c] += solution.velocity[c];
      }
      damage += energies.damage;
      problem.opening_max[0] = energies.history.opening;
      problem.slip_max[0] = energies.history.slip;
    }
  };

  TEST(TwoScalars, PointUnloadsToTheOrigin)
  {
    for (const auto &law : examples()) {
      const MixedLaw &mixed = *law->mixed();
      const double a = law->peak_opening(), b = mixed.peak_slip();
      Driven point(*law, CohesionRule::end_point);
      point.to({1.2 * a, 0.3 * b, -0.4 * b});
      const double K_N = mixed.normal_secant(1.2 * a, 0.5 * b),
                   K_T = mixed.tangential_secant(1.2 * a, 0.5 * b);
      expect_relative(point.energies.cohesive_traction[0], K_N * 1.2 * a, 1e-7);
      expect_relative(point.energies.cohesive_traction[2], -K_T * 0.4 * b,
                      1e-7);
      point.to({0.6 * a, 0., 0.25 * b});
      expect_relative(point.energies.cohesive_traction[0], K_N * 0.6 * a, 1e-6);
      EXPECT_NEAR(point.energies.cohesive_traction[1], 0., 1e-6 * K_T * b);
      expect_relative(point.energies.cohesive_traction[2], K_T * 0.25 * b,
                      1e-6);
      EXPECT_EQ(point.energies.damage, 0.);
    }
  }

  // Iterated with its secant where that is a contraction, bracketed where it is
  // not: the end of a step is the one that its secant leads to, from any start.
  TEST(TwoScalars, EndIsThatOfItsSecantFromAnyStart)
  {
    for (const auto &law : examples())
      for (const double share : {1e-3, 0.1, 1.}) {
        const MixedLaw &mixed = *law->mixed();
        const double a = law->peak_opening(), b = mixed.peak_slip();
        Driven point(*law, CohesionRule::exact);
        point.to({0.2 * a, 0.1 * b, 0.});
        auto &problem = point.problem;
        problem.jump_free = problem.jump_old;
        const double R =
            share / (problem.weight[0] * problem.time_step *
                     law->normal_stiffness() * (1. + law->stiffness_ratio()));
        const std::array<double, 3> U = {{0.5 * a, 0.2 * b, 0.3 * b}};
        std::optional<std::array<double, 3>> first;
        for (const double start : {0., 0.3, 0.6, 2.}) {
          const auto solution =
              solve_point<3>(problem, 0, U, R, R, {start * a, start * b});
          if (!first) {
            first = solution.velocity;
            EXPECT_TRUE(solution.damages) << share;
          }
          for (unsigned int c = 0; c < 3; ++c) {
            EXPECT_NEAR(solution.velocity[c], (*first)[c], 1e-13 * a)
                << share << ' ' << start;
            // U_local - R P(secant of that end)
            const double K = c == 0 ? solution.frozen.secant.normal
                                    : solution.frozen.secant.tangential,
                         mean = problem.jump_old[c] +
                                solution.velocity[c] * problem.time_step / 2.,
                         P = -problem.weight[0] * problem.time_step * K * mean;
            EXPECT_NEAR(solution.velocity[c], U[c] + R * P, 1e-12 * a)
                << share << ' ' << start;
          }
        }
      }
  }

  // The exact rule: its work is what is stored and dissipated, in any steps;
  // in the limit of small ones along a straight way it is the potential.
  TEST(TwoScalars, ExactRuleClosesAndConverges)
  {
    for (const auto &law : examples()) {
      const MixedLaw &mixed = *law->mixed();
      const double a = 2. * law->peak_opening(), b = mixed.peak_slip();
      const double potential =
          mixed.normal_energy(0., a, 0.) + mixed.tangential_energy(0., b, a);
      std::vector<double> error;
      for (const unsigned int n : {1u, 8u, 16u, 32u}) {
        Driven point(*law, CohesionRule::exact);
        for (unsigned int k = 1; k <= n; ++k)
          point.to({a * k / n, b * k / n, 0.});
        expect_relative(point.work, point.energies.stored + point.damage,
                        1e-11);
        error.push_back(std::abs(point.work - potential) / potential);
      }
      // the mean of both ways is the potential in one step and in many
      for (const double value : error)
        EXPECT_LT(value, 1e-6);
      Driven opened(*law, CohesionRule::exact);
      opened.to({1e3 * a, 0., 0.});
      expect_relative(opened.damage + opened.energies.stored, law->toughness(),
                      1e-9);
    }
  }

  // The first of a wave that arrives moves a point by less than any square
  // holds: it has the secant of a point that was never open.
  TEST(TwoScalars, SmallestWaysHaveTheFirstSecant)
  {
    for (const auto &law : examples()) {
      const LawPoint point(*law, 1., 1., false);
      const Secant first = point.secant({});
      const double a = law->peak_opening(), b = law->mixed()->peak_slip();
      for (const double share : {1e-90, 1e-150, 1e-170, 1e-300}) {
        const Reach small{share * a, share * b},
            more{2. * share * a, 3. * share * b};
        for (const auto &[from, to] :
             {std::pair(Reach{}, small), {small, more}}) {
          const Secant mean = point.mean_secant({from, from}, {to, to});
          expect_relative(mean.normal, first.normal, 1e-9);
          expect_relative(mean.tangential, first.tangential, 1e-9);
        }
      }
    }
  }
} // namespace test_laws_two_scalars
