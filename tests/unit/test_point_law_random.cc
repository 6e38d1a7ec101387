#include "one_point.h"

#include "cohesive_laws/friction_weight.h"

#include <algorithm>
#include <functional>
#include <random>

namespace point_law_test::test_point_law_random
{
  // --- the equations themselves, on random problems

  TEST(PointLaw, SolutionsSatisfyTheLaw)
  {
    const auto check = [](auto &point, const auto &local,
                          const auto &solution) {
      constexpr unsigned int dim =
          std::tuple_size<std::decay_t<decltype(local)>>::value;
      const auto &problem = point.problem;
      const double wh = point.weight_step();
      const auto energies =
          point_energies<dim>(problem, 0, solution.velocity, solution.frozen);
      std::array<double, dim> R{}, contact{};
      double size = 0., jump = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        R[c] = c == 0 ? point.majorant_normal : point.majorant_tangential;
        size = std::max(
            {size, std::abs(local[c]), R[c] * std::abs(solution.impulse[c])});
        jump = std::max(jump, std::abs(problem.jump_free[c]));
        contact[c] = solution.impulse[c] + wh * energies.cohesive_traction[c];
      }
      // Velocities come from jumps, whose round-off is divided by h theta, and
      // so do impulses, multiplied by the stiffness against R.
      const double h_theta = problem.time_step * problem.theta;
      const double stiffness =
          std::isfinite(solution.frozen.secant.normal)
              ? (R[0] + R[1]) * wh * solution.frozen.secant.normal * h_theta
              : 0.;
      const double tolerance =
          1e-12 * size + 1e-14 * jump / h_theta * (1. + stiffness);
      for (unsigned int c = 0; c < dim; ++c)
        EXPECT_NEAR(solution.velocity[c], local[c] + R[c] * solution.impulse[c],
                    tolerance);
      if (problem.kind[0] == PointKind::rigid && !solution.damages) {
        for (unsigned int c = 0; c < dim; ++c)
          EXPECT_EQ(solution.velocity[c], 0.);
        return;
      }
      // normal part
      EXPECT_NEAR(R[0] * contact[0], R[0] * solution.contact_impulse,
                  tolerance);
      if (solution.contact_impulse > 0.) {
        EXPECT_TRUE(problem.contact[0]);
        EXPECT_EQ(solution.velocity[0], problem.target[0]);
      } else {
        EXPECT_EQ(solution.contact_impulse, 0.);
        if (problem.contact[0]) {
          EXPECT_GE(solution.velocity[0], problem.target[0]);
        }
      }
      // Coulomb with the friction coefficient of the damage that is reached;
      // where beta jumps, with one between those of both sides
      const auto &interaction = point.interaction();
      const auto threshold = [&](const double opening) {
        const double beta =
            problem.kind[0] == PointKind::free
                ? 0.
                : point.law().beta(problem.opening_factor[0] * opening);
        return interaction.friction *
               kappa(beta, interaction.friction_exponent) *
               solution.contact_impulse;
      };
      const double lower = threshold(energies.history.opening * (1. - 1e-14)),
                   upper = threshold(energies.history.opening * (1. + 1e-14));
      double friction = 0., slip = 0., power = 0.;
      for (unsigned int c = 1; c < dim; ++c) {
        friction += contact[c] * contact[c];
        slip += solution.velocity[c] * solution.velocity[c];
        power += contact[c] * solution.velocity[c];
      }
      friction = std::sqrt(friction);
      slip = std::sqrt(slip);
      // 1e-10: kappa is taken at the opening of the local solve, known to
      // 1e-16 divided by the slope of its equation
      const double for_kappa = tolerance + 1e-10 * R[1] * upper;
      EXPECT_LE(R[1] * friction, R[1] * upper + for_kappa);
      EXPECT_LE(R[1] * power, -R[1] * lower * slip + for_kappa * size);
      EXPECT_GE(R[1] * power, -R[1] * upper * slip - for_kappa * size);
      // and it opposes the slip
      EXPECT_NEAR(R[1] * power, -R[1] * friction * slip, for_kappa * size);
    };
    for (const auto &entry : potentials)
      for (const CohesionRule rule : rules)
        for (const double theta : {0.5, 0.8, 1.}) {
          random_paths<2>(entry, rule, theta, 0.7, check);
          random_paths<3>(entry, rule, theta, 0.7, check);
        }
  }

  TEST(PointLaw, ExactRuleClosesTheEnergy)
  {
    unsigned int damaging = 0, released = 0, dragged = 0;
    const auto check = [&](auto &point, const auto &local,
                           const auto &solution) {
      constexpr unsigned int dim =
          std::tuple_size<std::decay_t<decltype(local)>>::value;
      const auto &problem = point.problem;
      const auto e =
          point_energies<dim>(problem, 0, solution.velocity, solution.frozen);
      double work = 0., size = e.stored + e.stored_old + e.overlap_released;
      for (unsigned int c = 0; c < dim; ++c) {
        const double change =
            problem.jump_free[c] +
            problem.time_step * problem.theta * solution.velocity[c] -
            problem.jump_old[c];
        work += e.cohesive_traction[c] * change;
        size += std::abs(e.cohesive_traction[c] * change);
      }
      // the change of an energy is a difference: relative to the larger one
      EXPECT_NEAR(work,
                  e.stored + e.overlap_released - e.stored_old + e.damage +
                      e.viscous,
                  1e-12 * size);
      EXPECT_GE(e.viscous, 0.);
      dragged += e.viscous > 0.;
      EXPECT_GE(e.damage, 0.);
      EXPECT_LE(e.beta, point.beta()) << "damage healed";
      if (problem.kind[0] == PointKind::rigid && !solution.damages)
        return;
      released += e.overlap_released > 0.;
      if (problem.kind[0] == PointKind::free || !solution.damages)
        return;
      ++damaging;
      // b between beta_{k+1} C and beta_k C
      const double l = problem.opening_factor[0],
                   al = problem.strength_factor[0] * l,
                   b = solution.frozen.secant.normal;
      const auto &law = point.law();
      // 1e-15 G: round-off of a difference of energies far apart
      const double d = effective_opening<dim>(point.interaction(),
                                              problem.jump_old.data()),
                   round_off = 1e-12 * b + 1e-15 * law.toughness() /
                                               ((e.history.opening - d) *
                                                (e.history.opening + d));
      EXPECT_GE(b, al * law.secant(l * e.history.opening) - round_off);
      if (problem.kind[0] != PointKind::rigid) {
        EXPECT_LE(b, al * law.secant(l * problem.opening_max[0]) + round_off);
      }
    };
    for (const auto &entry : potentials)
      for (const double theta : {0.5, 0.8, 1.}) {
        random_paths<2>(entry, CohesionRule::exact, theta, 0.5, check);
        random_paths<3>(entry, CohesionRule::exact, theta, 0.5, check);
      }
    // the paths have met what they are for
    EXPECT_GT(damaging, 1000u);
    EXPECT_GT(released, 10u);
    EXPECT_GT(dragged, 100u);
  }

  TEST(PointLaw, ClosesTheEnergyInTinySteps)
  {
    // b is a quotient of two small numbers; it stays accurate to 1e-12 down to
    // steps of 1e-13 of the opening, unlike a difference of energies
    for (const auto &entry : potentials) {
      std::shared_ptr<const CohesiveLaw> law =
          make_law(entry.name, entry.entries);
      if (law->elastic_limit() > 0.6 * range_of(*law))
        continue; // brittle: there are no damaging steps
      for (const double f : {1., 0.7, 1.3})
        for (const double step : {1e-3, 1e-6, 1e-9, 1e-12}) {
          const double start = 0.6 * range_of(*law) / f,
                       end = start * (1. + step);
          OnePoint<2> point(interaction_of(law), PointKind::cohesive,
                            CohesionRule::exact, 1., f);
          point.drive({{start, 0.}});
          const auto solution = point.drive({{end, 0.}});
          ASSERT_TRUE(solution.damages) << entry.name << ", step " << step;
          EXPECT_LE(solution.frozen.secant.normal,
                    f * f * law->secant(f * start) * (1. + 1e-12))
              << entry.name << ", step " << step << ", factor " << f;
          EXPECT_GE(solution.frozen.secant.normal,
                    f * f * law->secant(f * end) * (1. - 1e-12))
              << entry.name << ", step " << step << ", factor " << f;
          // mean traction over the step, by the trapezoidal rule
          EXPECT_NEAR(point.pull(solution)[0],
                      f * (law->traction(f * start) + law->traction(f * end)) /
                          2.,
                      law->strength() * (1e-11 + step * step))
              << entry.name << ", step " << step << ", factor " << f;
        }
    }
  }

  TEST(PointLaw, OneStepRemovesTheToughness)
  {
    // from closed to fully open at once, in a mixed direction
    for (const auto &entry : potentials) {
      std::shared_ptr<const CohesiveLaw> law =
          make_law(entry.name, entry.entries);
      const double end = 2. * range_of(*law);
      for (const double angle : {0., 0.5, 1.2}) {
        OnePoint<2> point(interaction_of(law), initial_kind(*law),
                          CohesionRule::exact);
        point.drive({{end * std::cos(angle), end * std::sin(angle)}});
        const auto &e = point.energies;
        const double work = e.cohesive_traction[0] * point.jump[0] +
                            e.cohesive_traction[1] * point.jump[1];
        EXPECT_NEAR(work, law->energy(e.history.opening), 1e-12 * work);
        EXPECT_NEAR(e.damage + e.stored, work, 1e-12 * work);
        if (std::isfinite(law->final_opening())) {
          EXPECT_NEAR(e.damage, law->toughness(), 1e-12 * work);
        }
      }
    }
  }

  TEST(PointLaw, LargeStepsStayFinite)
  {
    for (const auto &entry : potentials) {
      std::shared_ptr<const CohesiveLaw> law =
          make_law(entry.name, entry.entries);
      for (const CohesionRule rule : rules)
        for (const double factor : {1e3, 1e6, 1e12})
          for (const double sign : {1., -1.}) {
            OnePoint<3> point(interaction_of(law, 0.5), initial_kind(*law),
                              rule, 0.5);
            point.two_sided = !law->extrinsic();
            point.prepare();
            point.problem.contact[0] = !point.two_sided;
            const double U = factor * range_of(*law) / point.problem.time_step;
            const auto solution = point.solve({{sign * U, 0.3 * U, -0.2 * U}});
            point.accept(solution);
            for (unsigned int c = 0; c < 3; ++c) {
              EXPECT_TRUE(std::isfinite(solution.velocity[c])) << entry.name;
              EXPECT_TRUE(std::isfinite(solution.impulse[c])) << entry.name;
              EXPECT_TRUE(std::isfinite(point.energies.cohesive_traction[c]));
            }
            EXPECT_TRUE(std::isfinite(point.energies.stored));
            EXPECT_TRUE(std::isfinite(point.energies.damage));
            EXPECT_GE(point.energies.damage, 0.);
            // in compression, friction may hold an extrinsic point
            if (sign > 0. && std::isfinite(law->final_opening())) {
              EXPECT_EQ(point.beta(), 0.) << entry.name;
            }
          }
    }
  }

  // --- extrinsic points

  TEST(PointLaw, RigidInsideTheBall)
  {
    const auto law = make_law("camacho-ortiz", {{"strength", "2"},
                                                {"critical opening", "0.6"},
                                                {"mode mixity", "1.7"}});
    const double a = 1.7, f = 0.8;
    OnePoint<3> point(
        interaction_of(std::shared_ptr<const CohesiveLaw>(
            make_law("camacho-ortiz", {{"strength", "2"},
                                       {"critical opening", "0.6"},
                                       {"mode mixity", "1.7"}}))),
        PointKind::rigid, CohesionRule::exact, 0.5, f);
    point.prepare();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1., 1.);
    unsigned int compressed = 0;
    for (unsigned int k = 0; k < 500; ++k) {
      // a traction on the surface of the ball |<t_N>+ n + t_T / a| = f R_max
      std::array<double, 3> t{{number(random), number(random), number(random)}};
      const double size =
          std::hypot(std::max(0., t[0]), t[1] / a, t[2] / a) / (f * 2.);
      if (t[0] < 0.)
        ++compressed;
      const auto at = [&](const double factor) {
        std::array<double, 3> local;
        for (unsigned int c = 0; c < 3; ++c)
          local[c] =
              factor * t[c] / size * point.weight_step() *
              (c == 0 ? point.majorant_normal : point.majorant_tangential);
        point.problem.contact[0] = 1; // closed, as the forecast sees it
        return point.solve(local);
      };
      const auto inside = at(1. - 1e-12);
      EXPECT_FALSE(inside.damages);
      for (unsigned int c = 0; c < 3; ++c) {
        EXPECT_EQ(inside.velocity[c], 0.);
        EXPECT_NEAR(point.pull(inside)[c], t[c] / size * (1. - 1e-12), 1e-12);
      }
      // continuous at the limit: an excess of 1e-7 moves by O(1e-7)
      const auto outside = at(1. + 1e-7);
      EXPECT_TRUE(outside.damages);
      EXPECT_GT(outside.reach.opening, 0.);
      EXPECT_LT(outside.reach.opening, 1e-6 * 0.6);
      // In compression the normal part is a contact with its own impulse.
      for (unsigned int c = 0; c < 3; ++c)
        EXPECT_NEAR(point.pull(outside)[c], t[c] / size,
                    1e-5 * (2. + std::abs(t[c] / size)));
      EXPECT_TRUE(at(1.5).damages);
    }
    EXPECT_GT(compressed, 100u);
    // compression alone never activates
    const auto pressed = point.solve({{-1e6, 0., 0.}});
    EXPECT_FALSE(pressed.damages);
    EXPECT_EQ(pressed.velocity[0], 0.);
    EXPECT_EQ(law->traction(0.), 2.);
  }

  TEST(PointLaw, FrictionHoldsARigidPoint)
  {
    // kappa = 1: friction carries mu p_N of the shear from the start, so that
    // the point is activated at a R_max + mu p_N; with kappa = (1 - beta)^s it
    // does so at a R_max. Compression does not count against the strength.
    const double p = 7., mu = 0.5, R_max = 2.;
    for (const double exponent : {0., 1., 2.}) {
      const double limit = R_max + (exponent == 0. ? mu * p : 0.);
      for (const double factor : {0.1, 0.5, 0.9, 0.999, 1.001, 1.5, 4.}) {
        OnePoint<2> point(interaction_of(camacho_ortiz(), mu, exponent),
                          PointKind::rigid, CohesionRule::exact, 0.5);
        point.prepare();
        point.problem.contact[0] = 1;
        const auto solution =
            point.solve({{-p * point.weight_step() * point.majorant_normal,
                          factor * limit * point.weight_step() *
                              point.majorant_tangential}});
        SCOPED_TRACE("exponent " + std::to_string(exponent) + ", factor " +
                     std::to_string(factor));
        EXPECT_EQ(solution.damages, factor > 1.);
        EXPECT_EQ(solution.velocity[0], 0.);
        EXPECT_EQ(solution.velocity[1] > 0., factor > 1.);
        point.accept(solution);
        EXPECT_TRUE(std::isfinite(point.energies.cohesive_traction[1]));
        EXPECT_TRUE(std::isfinite(point.energies.stored));
        // one equation for both: shear = cohesion of the step + friction
        if (factor > 1.) {
          const double friction = mu * kappa(point.energies.beta, exponent) * p;
          EXPECT_NEAR(point.pull(solution)[1],
                      point.energies.cohesive_traction[1] + friction, 1e-11);
        }
      }
    }
  }

  TEST(PointLaw, ActivatedPointCarriesTheStrength)
  {
    // the opening of 1e-8 d_c that the strength leaves, whatever the rule
    for (const CohesionRule rule : rules) {
      OnePoint<2> point(interaction_of(camacho_ortiz()), PointKind::rigid,
                        rule);
      point.prepare();
      const double opening = 1e-8 * 0.6;
      const auto solution =
          point.solve({{opening / point.problem.time_step +
                            point.majorant_normal * point.weight_step() * 2.,
                        0.}});
      // beta falls by 1e-8. The softening slope C = R_max / d_c (half of it
      // under the exact rule) against R: w h^2 R C = 0.01 more opening. It is
      // a difference of velocities, 1e-16 over 1e-8 of them.
      const double chi = rule == CohesionRule::exact ? 0.5 : 1.;
      EXPECT_NEAR(point.pull(solution)[0], 2., 2. * 2e-8);
      EXPECT_NEAR(solution.reach.opening, opening / (1. - 0.01 * chi),
                  1e-7 * opening);
      point.accept(solution);
      EXPECT_EQ(point.problem.kind[0], PointKind::cohesive);
    }
  }
} // namespace point_law_test::test_point_law_random
