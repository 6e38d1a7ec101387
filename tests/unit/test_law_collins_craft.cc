#include "law_checks.h"
#include "one_point.h"

#include "nsfd/cohesive_laws/law_point.h"

#include <cmath>

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_collins_craft
{
  using namespace point_law_test;

  constexpr double s = 0.5e6, delta = 1e-3, mu = 0.5, r_N = 1e6;

  TEST(CollinsCraft, ClosedForms)
  {
    for (const LawEntries &entries :
         {LawEntries{{"strength", "0.5 MPa"}, {"critical opening", "1 mm"}},
          LawEntries{{"strength", "0.5 MPa"}, {"toughness", "250 J/m^2"}},
          LawEntries{{"toughness", "250 J/m^2"},
                     {"critical opening", "1 mm"}}}) {
      const auto law = make_law("collins-craft", entries);
      EXPECT_TRUE(law->extrinsic());
      EXPECT_TRUE(law->adds_openings());
      expect_relative(law->strength(), s);
      expect_relative(law->final_opening(), delta);
      expect_relative(law->toughness(), s * delta / 2.);
      for (const double x : {0., 0.1, 0.5, 0.999}) {
        expect_relative(law->beta(x * delta), 1. - x);
        expect_relative(law->traction(x * delta), s * (1. - x));
      }
      expect_toughness(*law, {0., law->final_opening(), 3. * delta});
      expect_broken_beyond(*law, delta);
    }
  }

  // Psi = beta s (u_N + gamma |u_T|) + w (1 - beta)^2, w = s delta / 2: the
  // first part is stored, the second one has been dissipated.
  TEST(CollinsCraft, FreeEnergy)
  {
    const double gamma = 0.7;
    const auto law = make_law("collins-craft", {{"strength", "0.5 MPa"},
                                                {"critical opening", "1 mm"},
                                                {"mode mixity", "0.7"}});
    const LawPoint point(*law);
    const auto jump = [](const double u_N, const double u_T) {
      const double u[] = {u_N, u_T};
      return JumpSize::of<2>(u);
    };
    LawState state;
    double dissipated = 0.;
    for (const auto &[u_N, u_T] : {std::pair(0.2e-3, 0.1e-3),
                                   {0.1e-3, -0.2e-3},
                                   {0., 0.},
                                   {0., 0.6e-3},
                                   {0.3e-3, 0.5e-3},
                                   {-0.1e-3, -0.1e-3}}) {
      const LawState next = point.moved(state, jump(u_N, u_T));
      dissipated += point.dissipated(state, next).total();
      state = next;
      const double beta = point.beta(state.history),
                   d = std::max(0., u_N) + gamma * std::abs(u_T);
      expect_relative(state.history.opening, (1. - beta) * delta);
      EXPECT_LE(d, state.history.opening * (1. + 1e-14));
      EXPECT_NEAR(point.stored(state), beta * s * d, 1e-12 * s * delta);
      EXPECT_NEAR(dissipated, s * delta / 2. * (1. - beta) * (1. - beta),
                  1e-12 * s * delta);
    }
  }

  // Each direction by itself; friction carries a part of the shear.
  TEST(CollinsCraft, Strength)
  {
    const auto law = make_law("collins-craft", {{"strength", "2"},
                                                {"critical opening", "0.6"},
                                                {"mode mixity", "0.5"}});
    const LawPoint point(*law);
    const auto ratio = [&](const double normal, const double shear,
                           const double friction = 0.) {
      return strength_ratio<2>(point, normal, &shear, {}, friction);
    };
    expect_relative(ratio(2., 0.), 1.);
    expect_relative(ratio(0., 1.), 1.);
    expect_relative(ratio(2., -1.), 1.); // a corner of the surface
    expect_relative(ratio(-4., 0.5), 0.5);
    expect_relative(ratio(-1., 1., 0.3), 0.7);
  }

  // The driven point of the authors' 2024 paper, with time over 4 ms: they give
  // beta, the driving force A_r, and friction mu (r_N + beta s).
  TEST(CollinsCraft, DrivenPoint)
  {
    const std::shared_ptr<const CohesiveLaw> law =
        make_law("collins-craft",
                 {{"strength", "0.5 MPa"}, {"critical opening", "1 mm"}});
    const auto slip_at = [](const double t) {
      return t <= 1. ? t / 2. : t <= 2. ? 1. - t / 2. : t / 2. - 1.;
    };
    const auto beta_at = [](const double t) {
      return t <= 1. ? 1. - t / 2. : t <= 3. ? 0.5 : 2. - t / 2.;
    };
    std::vector<PathPoint> points;
    for (unsigned int i = 0; i <= 400; ++i) {
      const double t = i / 100.; // ms
      points.push_back({t, {0., slip_at(t) * 1e-3, r_N + beta_at(t) * s}});
    }
    for (const CohesionRule rule :
         {CohesionRule::exact, CohesionRule::end_point}) {
      const bool exact = rule == CohesionRule::exact;
      const auto rows = drive_point(interaction_of(law, mu, 0.), points, rule);
      unsigned int seen = 0;
      double last = 0.;
      for (const CurveRow &row : rows) {
        const double t = row.path;
        const double u_T = slip_at(t), expected = beta_at(t);
        EXPECT_NEAR(row.slip, u_T * 1e-3, 1e-15);
        EXPECT_NEAR(row.beta, expected, 1e-12) << "t = " << t;
        const double driving = s * delta * (1. - row.beta) - s * row.slip;
        const double of_paper = t <= 1.   ? 0.
                                : t <= 2. ? 250. * (t - 1.)
                                : t <= 3. ? 250. * (3. - t)
                                          : 0.;
        EXPECT_NEAR(driving, of_paper, 1e-9) << "t = " << t; // N/m
        // inside of a step that moves: the end of a step, not its start
        const bool moves = row.slip != last && row.path > 0.;
        last = row.slip;
        if (!moves)
          continue;
        ++seen;
        const double forward = t > 1. && t <= 2. ? -1. : 1.;
        EXPECT_NEAR(row.friction, forward * mu * (r_N + expected * s), 1e-3)
            << "t = " << t;
        // the exact rule has the mean over the step of 1/400
        if (u_T > 1e-9) {
          EXPECT_NEAR(row.cohesive_tangential, expected * s,
                      exact ? s / 400. * (1. + 1e-9) : 1e-6)
              << "t = " << t;
        }
      }
      EXPECT_EQ(seen, 400u);
      EXPECT_EQ(rows.back().beta, 0.);
      // w (1 - beta)^2 of the whole way, and nothing by the rule but where it
      // passes u_T = 0
      EXPECT_NEAR(rows.back().damage, s * delta / 2., 1e-9);
      if (exact) {
        EXPECT_NEAR(rows.back().numerical(), 0., 1e-9);
      }
    }
  }

  /**
   * Random steps in both dimensions: impulses make the velocity, cohesion takes
   * what is stored and dissipated, and what is left is friction below its
   * threshold, against the sliding.
   */
  template <int dim>
  void check_random_steps(const double friction)
  {
    for (const LawEntries &entries :
         {LawEntries{{"strength", "2"}, {"critical opening", "0.6"}},
          LawEntries{{"strength", "2"},
                     {"critical opening", "0.6"},
                     {"mode mixity", "1.7"}}})
      for (const double theta : {0.5, 0.8, 1.})
        random_paths<dim>(
            {"collins-craft", entries}, CohesionRule::exact, theta, friction,
            [&](const OnePoint<dim> &point,
                const std::array<double, dim> &local,
                const LocalSolution<dim> &solution) {
              const auto &problem = point.problem;
              const auto energies = point_energies<dim>(
                  problem, 0, solution.velocity, solution.frozen);
              const double wh = point.weight_step();
              double size = 0., work = 0., rubbing = 0., square = 0.,
                     large = energies.stored + energies.stored_old +
                             energies.damage;
              std::array<double, dim> contact{};
              for (unsigned int c = 0; c < dim; ++c) {
                const double R =
                    c == 0 ? point.majorant_normal : point.majorant_tangential;
                size = std::max({size, std::abs(local[c]),
                                 std::abs(R * solution.impulse[c])});
              }
              for (unsigned int c = 0; c < dim; ++c) {
                const double R =
                    c == 0 ? point.majorant_normal : point.majorant_tangential;
                ASSERT_NEAR(solution.velocity[c],
                            local[c] + R * solution.impulse[c], 1e-12 * size);
                const double pull = energies.cohesive_traction[c],
                             way = problem.jump_free[c] +
                                   problem.time_step * problem.theta *
                                       solution.velocity[c] -
                                   problem.jump_old[c];
                work += pull * way;
                large +=
                    std::abs(pull) *
                    (std::abs(way) + 1e-3 * std::abs(problem.jump_free[c]));
                contact[c] = solution.impulse[c] + wh * pull;
                if (c > 0) {
                  rubbing += contact[c] * solution.velocity[c];
                  square += contact[c] * contact[c];
                }
              }
              if (problem.kind[0] == PointKind::rigid && !solution.damages)
                return;
              ASSERT_NEAR(
                  work, energies.stored - energies.stored_old + energies.damage,
                  1e-11 * large);
              ASSERT_GE(energies.damage, 0.);
              // a slip that stays 0 is held by cohesion, friction or both; one
              // next to 0 is a difference of jumps, and so is its direction
              const double R = point.majorant_tangential;
              double slip = 0., jumps = 0., pull = 0.;
              for (unsigned int c = 1; c < dim; ++c) {
                slip += std::abs(problem.jump_old[c]) +
                        std::abs(problem.jump_free[c] +
                                 problem.time_step * problem.theta *
                                     solution.velocity[c]);
                jumps += std::abs(problem.jump_free[c]);
                pull += std::abs(energies.cohesive_traction[c]);
              }
              if (slip <= 2e-15 * problem.interactions[0].law->final_opening() /
                              problem.opening_factor[0])
                return; // last bits of openings
              const double slack =
                  1e-9 * size + R * wh * pull * 4e-15 * jumps / slip;
              ASSERT_LE(R * std::sqrt(square),
                        R * solution.frozen.threshold * (1. + 1e-9) + slack);
              ASSERT_LE(R * rubbing, slack * size);
            });
  }

  TEST(CollinsCraft, RandomStepsIn2D)
  {
    check_random_steps<2>(0.);
    check_random_steps<2>(0.6);
  }

  TEST(CollinsCraft, RandomStepsIn3D)
  {
    check_random_steps<3>(0.);
    check_random_steps<3>(0.6);
  }

  // Held until t_N = s or |t_T| = gamma s + mu (s - t_N): then it slides.
  TEST(CollinsCraft, HeldByCohesionAndFriction)
  {
    const std::shared_ptr<const CohesiveLaw> law = make_law(
        "collins-craft", {{"strength", "2"}, {"critical opening", "0.6"}});
    for (const double pressure : {0., 1., 5.})
      for (const double share : {0.5, 0.99, 1.01, 2.}) {
        OnePoint<3> point(interaction_of(law, 0.5, 0.), PointKind::rigid,
                          CohesionRule::exact, 0.5);
        point.prepare();
        point.problem.contact[0] = 1;
        const double shear = share * (2. + 0.5 * (pressure + 2.));
        const double wh = point.weight_step();
        const auto solution =
            point.solve({{-point.majorant_normal * wh * pressure,
                          0.6 * point.majorant_tangential * wh * shear,
                          -0.8 * point.majorant_tangential * wh * shear}});
        const double slip =
            std::hypot(solution.velocity[1], solution.velocity[2]);
        EXPECT_EQ(slip > 0., share > 1.) << pressure << ' ' << share;
        EXPECT_EQ(solution.damages, share > 1.);
        if (share > 1.) {
          expect_relative(solution.velocity[1] / slip, 0.6, 1e-9);
        }
      }
  }
} // namespace test_law_collins_craft
