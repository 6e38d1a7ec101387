#include "material_point/bar.h"
#include "material_point/drive_point.h"
#include "material_point/read_law.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// A bar that pulls one point: section 3.1 of [AM06]. Exact values are
// closed forms in units of the law.

using namespace nsfd;

namespace test_bar
{
  /** A law by its name, with the bar of the given entries. */
  std::unique_ptr<LawInput> read(const std::string &law,
                                 std::vector<std::string> entries,
                                 const std::string &expected = "")
  {
    InputErrors errors;
    auto input = read_law(law, entries, errors);
    EXPECT_EQ(errors.report(), expected);
    return input;
  }

  Interaction point(const std::string &law, std::vector<std::string> entries)
  {
    const auto input = read(law, entries);
    return input ? input->curves.at(0).interaction : Interaction();
  }

  /** Strength 1 and d_c = 1 up to Delta = 3. */
  Interaction michel_suquet()
  {
    return point("michel-suquet", {"stiffness=1", "strength=1"});
  }
  /** Strength 2, broken at 3. */
  Interaction linear()
  {
    return point("camacho-ortiz", {"strength=2", "critical opening=3"});
  }
  Interaction gate()
  {
    return point("dugdale", {"strength=2", "critical opening=3"});
  }
  Interaction bilinear()
  {
    return point("geubelle-baylor", {"strength=2", "critical opening=3",
                                     "initial strength parameter=0.75"});
  }
  Interaction tvergaard()
  {
    return point("tvergaard", {"strength=2", "critical opening=3"});
  }

  Bar bar_of(const BarMode mode, const double stiffness)
  {
    Bar bar;
    bar.mode = mode;
    bar.stiffness = stiffness;
    bar.rule = CohesionRule::exact;
    return bar;
  }

  /** I(u) of michel_suquet() beyond the peak. */
  double michel_area(const double u)
  {
    const auto F = [](const double x) {
      return 4. * x - 0.5 * x * x - 4. * std::log(1. + x);
    };
    return 0.5 + F(u) - F(1.);
  }

  // U falls where |T'| = 4/(1+u)^2 - 1 exceeds k.
  TEST(BarJump, MichelSuquet)
  {
    const auto law = michel_suquet().law;
    struct Row {
      double k, opening, traction, grip, excess;
    };
    for (const Row &row :
         {Row{0.1, 1.1081851, 0.9944483, 11.0526681, 3.8252081},
          Row{0.25, 1.3094011, 0.9585481, 5.1435935, 0.9151923},
          Row{0.5, 1.8284271, 0.7573593, 3.3431458, 0.1020231}}) {
      const auto jumps = bar_jumps(*law, row.k);
      ASSERT_EQ(jumps.size(), 1u) << row.k;
      const BarJump &jump = jumps[0];
      // seven decimals were computed independently
      EXPECT_NEAR(jump.opening_from, row.opening, 0.6e-7);
      EXPECT_NEAR(jump.traction_from, row.traction, 0.6e-7);
      EXPECT_NEAR(jump.grip, row.grip, 0.6e-7);
      EXPECT_NEAR(jump.excess, row.excess, 0.6e-7);
      const double u = 2. / std::sqrt(1. - row.k) - 1.;
      const double T = u * (3. - u) / (1. + u);
      // differences of fourth order for the slope that vanishes at u_a
      EXPECT_NEAR(jump.opening_from, u, 1e-9);
      EXPECT_NEAR(jump.grip, u + T / row.k, 4e-15 * jump.grip);
      EXPECT_NEAR(jump.opening_to, u + T / row.k, 4e-15 * jump.grip);
      EXPECT_EQ(jump.traction_to, 0.);
      EXPECT_NEAR(jump.excess,
                  0.5 * T * T / row.k - (michel_area(3.) - michel_area(u)),
                  1e-13);
      EXPECT_NEAR(slope_ratio(*law, row.k), 0.75 / row.k, 1e-15 / row.k);
    }
    for (const double k : {0.75, 0.8, 1., 10.})
      EXPECT_TRUE(bar_jumps(*law, k).empty()) << k;
    // just below, the law is left at its end: 2/sqrt(1-k) - 1 near 3
    const auto late = bar_jumps(*law, 0.74);
    ASSERT_EQ(late.size(), 1u);
    EXPECT_NEAR(late[0].opening_from, 2. / std::sqrt(0.26) - 1., 1e-7);
  }

  // T(0) = 2 and T' = -2/3 up to 3.
  TEST(BarJump, LinearExtrinsic)
  {
    const auto law = linear().law;
    for (const double k : {0.1, 0.3, 0.6}) {
      const auto jumps = bar_jumps(*law, k);
      ASSERT_EQ(jumps.size(), 1u) << k;
      EXPECT_EQ(jumps[0].opening_from, 0.);
      EXPECT_EQ(jumps[0].grip, 2. / k);
      EXPECT_NEAR(jumps[0].opening_to, 2. / k, 4e-15 / k);
      EXPECT_NEAR(jumps[0].excess, 2. / k - 3., 1e-14 / k);
    }
    for (const double k : {2. / 3., 0.7, 5.})
      EXPECT_TRUE(bar_jumps(*law, k).empty()) << k;
  }

  // The traction drops: every bar jumps.
  TEST(BarJump, GateAndBrittle)
  {
    const auto brittle = point("brittle", {"stiffness=4", "strength=2"});
    for (const double k : {0.1, 1., 100.}) {
      const auto gates = bar_jumps(*gate().law, k);
      ASSERT_EQ(gates.size(), 1u) << k;
      EXPECT_NEAR(gates[0].opening_from, 3., 1e-14);
      EXPECT_NEAR(gates[0].grip, 3. + 2. / k, 1e-14 * gates[0].grip);
      EXPECT_NEAR(gates[0].opening_to, 3. + 2. / k, 1e-14 * gates[0].grip);
      EXPECT_NEAR(gates[0].excess, 2. / k, 1e-13 / k + 1e-14);
      const auto snaps = bar_jumps(*brittle.law, k);
      ASSERT_EQ(snaps.size(), 1u) << k;
      EXPECT_NEAR(snaps[0].opening_from, 0.5, 1e-14);
      EXPECT_NEAR(snaps[0].grip, 0.5 + 2. / k, 1e-14 * snaps[0].grip);
      EXPECT_NEAR(snaps[0].excess, 2. / k, 1e-13 / k + 1e-14);
    }
  }

  // Two falls steeper than the bar, a gentle one in between.
  TEST(BarJump, SeveralOfOneLaw)
  {
    const auto law =
        point("tabulated", {"points=0:0, 1:4, 2:1, 6:0.8, 6.2:0"}).law;
    const auto jumps = bar_jumps(*law, 2.);
    ASSERT_EQ(jumps.size(), 2u);
    EXPECT_NEAR(jumps[0].opening_from, 1., 1e-14);
    EXPECT_NEAR(jumps[0].grip, 3., 1e-14);
    // u + (1.1 - 0.05 u) / 2 = 3
    const double u = 2.45 / 0.975, T = 1.1 - 0.05 * u;
    EXPECT_NEAR(jumps[0].opening_to, u, 1e-13);
    EXPECT_NEAR(jumps[0].excess,
                0.5 * (4. + T) * (u - 1.) - 2.5 - 0.5 * (1. + T) * (u - 2.),
                1e-13);
    EXPECT_NEAR(jumps[1].opening_from, 6., 1e-13);
    EXPECT_NEAR(jumps[1].grip, 6.4, 1e-13);
    EXPECT_NEAR(jumps[1].opening_to, 6.4, 1e-13);
    EXPECT_NEAR(jumps[1].excess, 0.5 * 0.8 * 0.4 - 0.5 * 0.8 * 0.2, 1e-13);
  }

  // Jumps exactly where (42) says so; rows are in equilibrium, and the integral
  // of the pull over the way of the grip is where the rows say it went.
  TEST(Bar, StaticRunsOfEveryLaw)
  {
    for (const std::string &name : CohesiveLawRegistry::instance().names()) {
      const Interaction interaction = point(name, {});
      const CohesiveLaw &law = *interaction.law;
      const double softening = std::isinf(law.steepest_softening())
                                   ? law.strength() / opening_scale(law)
                                   : law.steepest_softening();
      for (const double ratio : {0.2, 0.8, 1.2, 5.}) {
        SCOPED_TRACE(name + " " + std::to_string(ratio));
        const double k = softening * ratio;
        EXPECT_EQ(bar_jumps(law, k).empty(), slope_ratio(law, k) <= 1.);
        Bar bar = bar_of(BarMode::quasi_static, k);
        bar.n_steps = 4000;
        const BarRun run = pull_bar(interaction, bar);
        double work = 0.;
        for (std::size_t i = 1; i < run.rows.size(); ++i) {
          const BarRow &a = run.rows[i - 1], &b = run.rows[i];
          EXPECT_GE(b.grip, a.grip * (1. - 1e-12));
          EXPECT_GE(b.opening, a.opening);
          EXPECT_GE(b.excess, a.excess);
          EXPECT_NEAR(b.pull, k * (b.grip - b.opening), 1e-9 * law.strength());
          work += 0.5 * (a.pull + b.pull) * (b.grip - a.grip);
        }
        const BarRow &end = run.rows.back();
        EXPECT_NEAR(end.grip, default_end(law, k), 1e-9 * end.grip);
        // trapezoids: second order in the 4000 steps of each kind of branch
        EXPECT_NEAR(work, end.work, 1e-5 * end.work);
        if (std::isfinite(law.final_opening())) {
          EXPECT_NEAR(end.damage, law.toughness(), 1e-12 * law.toughness());
        }
      }
    }
  }

  // eta u' = k (U_a - u) - T(u): the integral of eta u'^2 is the area between
  // the line of the bar and the law, whatever eta is.
  TEST(Bar, ViscosityTakesWhatTheJumpLeaves)
  {
    struct Row {
      Interaction interaction;
      double stiffness, excess;
    };
    const double u_a = 2. / std::sqrt(0.75) - 1.,
                 T_a = u_a * (3. - u_a) / (1. + u_a);
    const double michel = 2. * T_a * T_a - (michel_area(3.) - michel_area(u_a));
    for (const Row &row : {Row{michel_suquet(), 0.25, michel},
                           Row{linear(), 0.3, 11. / 3.}, Row{gate(), 0.5, 4.}})
      for (const double eta : {0.01, 0.1, 1., 100.}) {
        Bar bar = bar_of(BarMode::viscous, row.stiffness);
        bar.viscosity = eta;
        const BarRun run = pull_bar(row.interaction, bar);
        const BarRow &end = run.rows.back();
        const double G = row.interaction.law->toughness();
        // 1e-9 for the nudge at the start, 1e-14 for what is left at the end
        EXPECT_NEAR(end.viscous, row.excess, 2e-9 * row.excess) << eta;
        EXPECT_NEAR(end.damage, G, 1e-12 * G);
        EXPECT_NEAR(end.numerical(), 0., 1e-11 * G);
        EXPECT_EQ(end.beta, 0.);
        // the work was done before
        EXPECT_EQ(end.work, run.rows.front().work);
      }
  }

  // A stiff bar imposes the speed of the opening: eta v Delta, less eta^2 v^2 /
  // 2k where it starts from rest; the remainder is of the order (C/k)^2 = 1e-6.
  TEST(Bar, ViscosityAtAnImposedSpeed)
  {
    const double k = 1e3, eta = 0.2;
    for (const double speed : {0.25, 0.5, 1.}) {
      Bar bar = bar_of(BarMode::viscous, k);
      bar.viscosity = eta;
      bar.speed = speed;
      const BarRun run = pull_bar(michel_suquet(), bar);
      const double v = eta * speed;
      EXPECT_NEAR(run.viscous_at(3.), 3. * v - 0.5 * v * v / k, 3e-6 * v);
      EXPECT_NEAR(run.rows.back().numerical(), 0., 1e-9);
    }
  }

  // Pulled ever more slowly, a soft bar does not take the viscous part with it.
  TEST(Bar, ViscosityHasAFloor)
  {
    const Interaction interaction = michel_suquet();
    const BarJump jump = bar_jumps(*interaction.law, 0.25).at(0);
    double last = 1e9;
    for (const double speed : {1e-1, 1e-2, 1e-3}) {
      Bar bar = bar_of(BarMode::viscous, 0.25);
      bar.viscosity = 1.;
      bar.speed = speed;
      const BarRun run = pull_bar(interaction, bar);
      const double above = run.viscous_at(jump.opening_to) - jump.excess;
      EXPECT_GT(above, 0.) << speed;
      // the grip passes U_a by v^(2/3) before the point gives way
      EXPECT_LT(above, last / 3.5) << speed;
      last = above;
      EXPECT_NEAR(run.rows.back().numerical(), 0., 1e-10);
    }
  }

  // In the elastic branch M u'' + (k + C) u = k v t.
  TEST(Bar, MassSwingsAsItShould)
  {
    const double k = 0.25, M = 2., v = 0.3;
    const double omega = std::sqrt((k + 1.) / M);
    const auto error = [&](const double h) {
      Bar bar = bar_of(BarMode::dynamic, k);
      bar.mass = M, bar.speed = v, bar.step = h;
      bar.end = 1.8; // the point stays below d_c = 1
      double largest = 0.;
      for (const BarRow &row : pull_bar(michel_suquet(), bar).rows) {
        const double exact =
            k * v / (k + 1.) * (row.time - std::sin(omega * row.time) / omega);
        EXPECT_LT(row.opening, 1.);
        EXPECT_NEAR(row.numerical(), 0., 1e-13);
        largest = std::max(largest, std::abs(row.opening - exact));
      }
      return largest;
    };
    const double coarse = error(0.1), fine = error(0.05);
    EXPECT_LT(coarse, 1e-3);
    EXPECT_NEAR(coarse / fine, 4., 0.1);
  }

  // Pulled slowly, the mass gets what the jump leaves over. M u'' = k v t + c
  // x^2 next to u_a has the length v^(2/5): the grip passes U_a by v^(4/5), and
  // so much more energy is there.
  TEST(Bar, MassTakesWhatTheJumpLeaves)
  {
    const Interaction interaction = michel_suquet();
    const BarJump jump = bar_jumps(*interaction.law, 0.25).at(0);
    std::vector<double> errors;
    for (const double v : {1e-2, 1e-3, 1e-4}) {
      Bar bar = bar_of(BarMode::dynamic, 0.25);
      bar.mass = 1., bar.speed = v, bar.step = 0.25;
      const BarRun run = pull_bar(interaction, bar);
      const auto row = std::find_if(
          run.rows.begin(), run.rows.end(), [&](const BarRow &candidate) {
            return candidate.opening >= jump.opening_to;
          });
      ASSERT_NE(row, run.rows.end());
      errors.push_back((row->kinetic + row->elastic) / jump.excess - 1.);
      EXPECT_NEAR(row->damage, interaction.law->toughness(), 1e-11);
      EXPECT_NEAR(run.rows.back().numerical(), 0., 1e-9);
    }
    EXPECT_GT(errors[2], 0.);
    for (const unsigned int i : {0u, 1u})
      EXPECT_NEAR(std::log10(errors[i] / errors[i + 1]), 0.8, 0.05);
  }

  /** States and ends at which the law falls most steeply. */
  struct Scan {
    Interaction interaction;
    double steepest; ///< opening
  };

  std::vector<Scan> scans()
  {
    // where T' is smallest: anywhere on a line, 2 delta / 3, the end
    return {{michel_suquet(), 3.},
            {tvergaard(), 2.},
            {bilinear(), 2.},
            {linear(), 1.}};
  }

  /**
   * The mass at @p u, so fast that @p end solves a step of length @p h: with
   * the mean traction R of the rule, end = u + h v - h^2 theta R / M^, M^ =
   * M + h^2 theta^2 k, the grip at u + h theta v.
   */
  double speed_to(const CohesiveLaw &law, const Bar &bar, const double u,
                  const double end)
  {
    const double h = bar.step, mass = bar.mass + h * h * bar.theta * bar.theta *
                                                     bar.stiffness;
    const double R = bar.rule == CohesionRule::exact
                         ? law.energy_increment(u, end) / (end - u)
                         : law.traction(end);
    return (end - u) / h + h * bar.theta * R / mass;
  }

  struct Ends {
    unsigned int most = 0; ///< openings that solve one step
    double spread = 0.;    ///< of the ends from different starts
    double far_from_target = 0.;
  };

  Ends look_for_second_root(const Scan &scan, const Bar &bar)
  {
    const CohesiveLaw &law = *scan.interaction.law;
    Ends ends;
    const double scale = law.final_opening();
    for (const double back : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001})
      for (const double forth : {-0.01, 0.001, 0.01, 0.1, 0.3}) {
        const double u = scan.steepest - back * scale,
                     target = scan.steepest + forth * scale;
        if (target <= u || u < law.peak_opening())
          continue;
        BarStep step(scan.interaction, bar);
        const double v = speed_to(law, bar, u, target);
        step.set_state(u, v);
        const double grip = u + bar.step * v;
        const auto solve = [&](const double start) {
          // the grip where the bar pulls nothing on the free way
          return step.end_opening(step.solve(bar.step, u, grip, start));
        };
        const double first = solve(u);
        ends.most = std::max(ends.most, step.count_solutions());
        for (const double start :
             {0.5, 0.9, 0.99, 0.999, 1., 1.001, 1.01, 1.1, 1.5, 3.})
          ends.spread = std::max(
              ends.spread, std::abs(solve(start * target) - first) / scale);
        ends.far_from_target =
            std::max(ends.far_from_target, std::abs(first - target) / scale);
      }
    return ends;
  }

  // M / (S theta h^2) + theta k > chi max |T'|: below that step one opening
  // solves it, found from every start; 1 % above it there are several.
  TEST(Bar, StepsWithOneSolution)
  {
    for (const Scan &scan : scans())
      for (const CohesionRule rule :
           {CohesionRule::end_point, CohesionRule::exact})
        for (const double theta : {0.5, 0.7, 1.})
          for (const double share : {0., 0.3}) {
            const CohesiveLaw &law = *scan.interaction.law;
            Bar bar =
                bar_of(BarMode::dynamic, share * law.steepest_softening());
            bar.mass = 1.7, bar.theta = theta, bar.rule = rule;
            SCOPED_TRACE(std::to_string(law.steepest_softening()) + " " +
                         std::to_string(theta) + " " + std::to_string(share));
            const double bound = unique_step(law, bar);
            bar.step = 0.99 * bound;
            const Ends below = look_for_second_root(scan, bar);
            EXPECT_EQ(below.most, 1u);
            EXPECT_LT(below.spread, 1e-9);
            EXPECT_LT(below.far_from_target, 1e-9);
            bar.step = 1.01 * bound;
            EXPECT_GT(look_for_second_root(scan, bar).most, 1u);
          }
  }

  // From the peak on, steps beyond the bound may end before or after the fall:
  // the start of the solve chooses, and both ends solve the step. (On a law
  // that falls on a line the first of the two is the undamaged end, which comes
  // first.)
  TEST(Bar, StartChoosesAmongSeveral)
  {
    for (const Scan &scan : {scans()[0], scans()[1]}) {
      const CohesiveLaw &law = *scan.interaction.law;
      Bar bar = bar_of(BarMode::dynamic, 0.);
      bar.mass = 1., bar.theta = 1., bar.rule = CohesionRule::end_point;
      bar.step = 1.2 * unique_step(law, bar);
      const double u = law.peak_opening(), middle = 0.98 * scan.steepest;
      const double v = speed_to(law, bar, u, middle);
      BarStep step(scan.interaction, bar);
      step.set_state(u, v);
      const auto solve = [&](const double start) {
        const double end =
            step.end_opening(step.solve(bar.step, 0., 0., start));
        EXPECT_NEAR(speed_to(law, bar, u, end), v, 1e-12 * v);
        return end;
      };
      EXPECT_LT(solve(0.999 * middle), 0.99 * middle);
      EXPECT_GT(solve(1.001 * middle), 1.01 * middle);
      EXPECT_EQ(step.count_solutions(), 3u);
    }
  }

  // Element of 1 mm, half of it lumped behind the interface: 1.25 kg/m^2.
  TEST(Bar, UniqueStepOfACell)
  {
    const auto law =
        point("michel-suquet", {"strength=1 MPa", "toughness=10 J/m^2"}).law;
    Bar bar = bar_of(BarMode::dynamic, 0.);
    bar.mass = 2500. * 1e-3 / 2.;
    bar.theta = 1.;
    bar.rule = CohesionRule::end_point;
    EXPECT_NEAR(unique_step(*law, bar), 3.1062e-6, 0.5e-10);
    EXPECT_NEAR(dynamic_slope(bar, unique_step(*law, bar)), 1.29556e11, 0.5e6);
    bar.rule = CohesionRule::exact;
    EXPECT_NEAR(unique_step(*law, bar), std::sqrt(2.) * 3.1062e-6, 1e-10);
    bar.stiffness = 0.5 * law->steepest_softening();
    EXPECT_TRUE(std::isinf(unique_step(*law, bar)));
    EXPECT_EQ(unique_step(*gate().law, bar), 0.);
  }
} // namespace test_bar
