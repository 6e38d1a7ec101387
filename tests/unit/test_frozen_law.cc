#include "one_point.h"

#include "nonsmooth/linear_spring.h"

#include <algorithm>
#include <random>

namespace point_law_test::test_frozen_law
{
  // --- the frozen law

  template <int dim>
  struct FrozenCase {
    std::string name;
    OnePoint<dim> point;
    FrozenPoint frozen;
    std::array<double, dim> local; ///< normal, along, across the sliding
    bool closed, slides;
  };

  /**
   * All branches of the frozen law, away from its kinks; the tangential part
   * of the local velocity lies along t1.
   */
  template <int dim>
  std::vector<FrozenCase<dim>> frozen_cases()
  {
    std::vector<FrozenCase<dim>> result;
    for (const double viscosity : {0., 0.05})
      for (const CohesionRule rule : rules)
        for (const double theta : {0.5, 1.}) {
          const auto add = [&](const std::string &name, const double old_N,
                               const double local_N, const bool contact,
                               const double secant, const double threshold,
                               const bool two_sided, const double slip,
                               const bool closed, const bool slides) {
            FrozenCase<dim> item{name + ", rule " + std::to_string(int(rule)) +
                                     ", theta " + std::to_string(theta) +
                                     ", viscosity " + std::to_string(viscosity),
                                 OnePoint<dim>(spring(5., 0.7),
                                               PointKind::cohesive, rule,
                                               theta),
                                 {{secant, 0.7 * secant}},
                                 {},
                                 closed,
                                 slides};
            auto &point = item.point;
            point.problem.interactions[0].law = michel_suquet();
            point.problem.interactions[0].stiffness_ratio = 0.7;
            point.problem.interactions[0].shear_weight = 0.7;
            point.set_majorants(0.4, 0.9);
            point.two_sided = two_sided;
            point.jump[0] = old_N;
            point.old_velocity[0] = viscosity > 0. ? 1.7 : 2.; // off its kink
            if (viscosity > 0.)
              point.problem.viscosity = {viscosity};
            point.prepare();
            point.problem.contact[0] = contact;
            point.problem.target[0] = -1.5;
            item.frozen.threshold = threshold * point.weight_step();
            item.local[0] = local_N;
            item.local[1] = slip;
            result.push_back(item);
          };
          add("open and opening", 0.3, 8., false, 3., 0., false, 4., false,
              true);
          add("intact in compression", -0.3, -8., false, 5., 0., true, 4.,
              false, true);
          add("opens in the step", -0.05, 40., false, 5., 0., true, 4., false,
              true);
          add("closes in the step", 0.05, -40., false, 5., 0., true, 4., false,
              true);
          add("sticks in contact", 0.02, -40., true, 3., 50., false, 4., true,
              false);
          add("slides in contact", 0.02, -40., true, 3., 1., false, 40., true,
              true);
          add("slides without cohesion", 0.02, -40., true, 0., 1., false, 40.,
              true, true);
        }
    return result;
  }

  template <int dim>
  void slopes_match()
  {
    for (const auto &item : frozen_cases<dim>()) {
      SCOPED_TRACE(item.name);
      const auto &point = item.point;
      const auto solve = [&](const std::array<double, dim> &local) {
        return solve_frozen_point<dim>(point.problem, 0, item.frozen, local,
                                       point.majorant_normal,
                                       point.majorant_tangential);
      };
      const auto solution = solve(item.local);
      EXPECT_EQ(solution.contact_impulse > 0., item.closed);
      EXPECT_EQ(solution.velocity[1] != 0., item.slides);
      const auto slopes =
          frozen_slopes<dim>(point.problem, 0, item.frozen, solution,
                             point.majorant_normal, point.majorant_tangential);
      for (unsigned int c = 0; c < dim; ++c) {
        // centred difference: error (1e-5)^2 of the curvature and 1e-11 of
        // round-off, relative
        const double step = 1e-5 * 40.;
        auto forward = item.local, backward = item.local;
        forward[c] += step;
        backward[c] -= step;
        const auto up = solve(forward), down = solve(backward);
        const double slope = -(up.impulse[c] - down.impulse[c]) / (2. * step);
        const double R =
            c == 0 ? point.majorant_normal : point.majorant_tangential;
        EXPECT_NEAR(R * slopes[c], R * slope, 1e-7) << "direction " << c;
        // the other components do not answer in this frame
        for (unsigned int d = 0; d < dim; ++d)
          if (d != c) {
            EXPECT_NEAR(R * (up.impulse[d] - down.impulse[d]) / (2. * step), 0.,
                        1e-7);
          }
        // a monotone law against R: the slope is below 1 / R
        EXPECT_GE(R * slopes[c], 0.);
        EXPECT_LE(R * slopes[c], 1. + 1e-14);
      }
    }
  }

  TEST(FrozenLaw, SlopesAreDifferenceQuotients2D) { slopes_match<2>(); }
  TEST(FrozenLaw, SlopesAreDifferenceQuotients3D) { slopes_match<3>(); }

  TEST(FrozenLaw, SlopesInAnyFrame3D)
  {
    // sliding in a direction between t1 and t2: along and across it
    const double angle = 0.6, c = std::cos(angle), s = std::sin(angle);
    for (const auto &item : frozen_cases<3>()) {
      SCOPED_TRACE(item.name);
      const auto &point = item.point;
      const auto impulse = [&](const double along, const double across) {
        const auto solution = solve_frozen_point<3>(
            point.problem, 0, item.frozen,
            {{item.local[0], c * along - s * across, s * along + c * across}},
            point.majorant_normal, point.majorant_tangential);
        return std::make_pair(
            solution,
            std::array<double, 2>{
                {c * solution.impulse[1] + s * solution.impulse[2],
                 -s * solution.impulse[1] + c * solution.impulse[2]}});
      };
      const double slip = item.local[1], step = 1e-5 * 40.;
      const auto slopes = frozen_slopes<3>(
          point.problem, 0, item.frozen, impulse(slip, 0.).first,
          point.majorant_normal, point.majorant_tangential);
      const double along = (impulse(slip - step, 0.).second[0] -
                            impulse(slip + step, 0.).second[0]) /
                           (2. * step),
                   across = (impulse(slip, -step).second[1] -
                             impulse(slip, step).second[1]) /
                            (2. * step);
      const double R = point.majorant_tangential;
      EXPECT_NEAR(R * slopes[1], R * along, 1e-7);
      EXPECT_NEAR(R * slopes[2], R * across, 1e-7);
    }
  }

  template <int dim>
  void velocity_inverts()
  {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1., 1.);
    for (const auto &item : frozen_cases<dim>()) {
      SCOPED_TRACE(item.name);
      const auto &point = item.point;
      for (unsigned int k = 0; k < 100; ++k) {
        std::array<double, dim> local;
        for (unsigned int c = 0; c < dim; ++c)
          local[c] = 50. * number(random);
        const auto solution = solve_frozen_point<dim>(
            point.problem, 0, item.frozen, local, point.majorant_normal,
            point.majorant_tangential);
        const auto velocity = frozen_velocity<dim>(
            point.problem, 0, item.frozen, solution.impulse);
        const bool closed = solution.contact_impulse > 0.;
        // Where the law is flat (an open point without stiffness, sliding
        // without cohesion) an impulse has many velocities.
        const bool springs = item.frozen.secant.normal > 0.;
        const double x = point.problem.jump_free[0] + point.problem.time_step *
                                                          point.problem.theta *
                                                          solution.velocity[0];
        const bool compressed =
            !point.two_sided &&
            (x <= 0. || point.problem.rule == CohesionRule::end_velocity);
        if (closed || (springs && !compressed)) {
          EXPECT_NEAR(velocity[0], solution.velocity[0], 1e-11 * 50.);
        }
        double slip = 0.;
        for (unsigned int c = 1; c < dim; ++c)
          slip = std::max(slip, std::abs(solution.velocity[c]));
        for (unsigned int c = 1; c < dim; ++c)
          if (springs || slip == 0.) {
            EXPECT_NEAR(velocity[c], solution.velocity[c], 1e-11 * 50.);
          }
      }
    }
  }

  TEST(FrozenLaw, VelocityInvertsTheSolve2D) { velocity_inverts<2>(); }
  TEST(FrozenLaw, VelocityInvertsTheSolve3D) { velocity_inverts<3>(); }

  // The law of a two-sided spring without R: the same line as the local solve
  // against R, and its velocity also where R P takes all digits of U.
  TEST(PointLaw, LinearSpringIsTheLawWithoutTheMajorant)
  {
    for (const CohesionRule rule : rules) {
      OnePoint<2> point(spring(3e7, 0.4), PointKind::elastic, rule, 0.7);
      point.two_sided = true;
      point.jump = {{2e-6, -5e-6}};
      point.old_velocity = {{3e-4, 1e-3}};
      point.prepare();
      for (const double majorant : {0.01, 1., 1e18}) {
        point.set_majorants(majorant, 2. * majorant);
        const double R[2] = {point.majorant_normal, point.majorant_tangential};
        const auto law = linear_point<2>(point.problem, 0, R[0], R[1]);
        ASSERT_TRUE(law.exists());
        const auto solution = point.solve({{-0.02, 0.05}});
        const auto U = frozen_velocity<2>(point.problem, 0, {law.secant},
                                          solution.impulse);
        for (unsigned int c = 0; c < 2; ++c) {
          const LinearSpring line(point.problem, law, c);
          const double P = solution.impulse[c];
          EXPECT_NEAR(line.velocity(P), U[c], 1e-12 * std::abs(U[c]));
          EXPECT_NEAR(line.velocity(P),
                      line.free_velocity() - line.compliance() * P,
                      1e-14 * std::abs(U[c]));
          if (majorant < 10.) { // beyond, U is the difference of U_loc and R P
            EXPECT_NEAR(line.velocity(P), solution.velocity[c], 1e-12 * 0.05);
          }
        }
      }
    }
  }

  TEST(FrozenLaw, Monotone)
  {
    // -P is the subgradient of a convex function of U
    std::mt19937 random(6);
    std::uniform_real_distribution<double> number(-1., 1.);
    for (const auto &item : frozen_cases<3>()) {
      SCOPED_TRACE(item.name);
      const auto &point = item.point;
      const auto solve = [&] {
        std::array<double, 3> local;
        for (double &value : local)
          value = 50. * number(random);
        return solve_frozen_point<3>(point.problem, 0, item.frozen, local,
                                     point.majorant_normal,
                                     point.majorant_tangential);
      };
      for (unsigned int k = 0; k < 300; ++k) {
        const auto a = solve(), b = solve();
        double product = 0., size = 0.;
        for (unsigned int c = 0; c < 3; ++c) {
          const double term =
              (b.velocity[c] - a.velocity[c]) * (b.impulse[c] - a.impulse[c]);
          product += term;
          size += std::abs(term);
        }
        EXPECT_LE(product, 1e-13 * size);
      }
    }
  }

  TEST(FrozenLaw, AgreesWithTheFullLaw)
  {
    // at the secant and the threshold that the full law ends with
    const auto check = [](auto &point, const auto &local,
                          const auto &solution) {
      constexpr unsigned int dim =
          std::tuple_size<std::decay_t<decltype(local)>>::value;
      const auto frozen = solve_frozen_point<dim>(
          point.problem, 0, solution.frozen, local, point.majorant_normal,
          point.majorant_tangential);
      for (unsigned int c = 0; c < dim; ++c) {
        EXPECT_EQ(frozen.velocity[c], solution.velocity[c]);
        EXPECT_EQ(frozen.impulse[c], solution.impulse[c]);
      }
    };
    for (const auto &entry : potentials)
      for (const CohesionRule rule : rules)
        random_paths<3>(entry, rule, 0.5, 0.7, check);
  }
} // namespace point_law_test::test_frozen_law
