#include "make_law.h"
#include "nonsmooth/linear_spring.h"

#include "cohesive_laws/friction_weight.h"
#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

// One interface point, driven through the functions that the solvers call.
// Exact values are closed forms; a tolerance of 1e-12 is a few hundred
// round-offs of the local solve.

using namespace nsfd;
using nsfd::test::LawEntries;
using nsfd::test::make_law;

namespace test_point_law
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr CohesionRule rules[] = {
      CohesionRule::exact, CohesionRule::end_point, CohesionRule::end_velocity};

  Interaction interaction_of(std::shared_ptr<const CohesiveLaw> law,
                             const double friction = 0.,
                             const double friction_exponent = 1.)
  {
    Interaction interaction;
    interaction.stiffness_ratio = law->stiffness_ratio();
    interaction.shear_weight = law->shear_weight();
    interaction.law = std::move(law);
    interaction.friction = friction;
    interaction.friction_exponent = friction_exponent;
    return interaction;
  }

  Interaction contact_only(const double friction)
  {
    Interaction interaction;
    interaction.friction = friction;
    return interaction;
  }

  Interaction spring(const double normal_stiffness, const double ratio)
  {
    Interaction interaction;
    interaction.normal_stiffness = normal_stiffness;
    interaction.stiffness_ratio = ratio;
    interaction.shear_weight = ratio;
    return interaction;
  }

  /** Weight, step and majorant are not 1, so that none can be forgotten. */
  template <int dim>
  class OnePoint
  {
  public:
    OneStepProblem<dim> problem;
    std::array<double, dim> jump{}, old_velocity{};
    PointEnergies<dim> energies; ///< of the last step
    double majorant_normal = 0., majorant_tangential = 0.;
    bool two_sided = false;

    OnePoint(const Interaction &interaction, const PointKind kind,
             const CohesionRule rule, const double theta = 1.,
             const double strength_factor = 1.,
             const double toughness_factor = 1.)
    {
      problem.resize(1);
      problem.n_owned = 1;
      problem.time_step = 0.02;
      problem.theta = theta;
      problem.rule = rule;
      problem.interactions = {interaction};
      problem.kind = {kind};
      problem.weight = {0.3};
      problem.strength_factor = {strength_factor};
      problem.opening_factor = {strength_factor / toughness_factor};
      if (interaction.law && !interaction.law->extrinsic())
        problem.opening_max = {interaction.law->elastic_limit() /
                               problem.opening_factor[0]};
      set_majorants(0.01, 0.02);
    }

    const Interaction &interaction() const { return problem.interactions[0]; }
    const CohesiveLaw &law() const { return *interaction().law; }
    double weight_step() const { return problem.weight[0] * problem.time_step; }
    double beta() const
    {
      return beta_of(interaction(), problem.kind[0], problem.opening_factor[0],
                     {problem.opening_max[0], 0.});
    }

    /** R in units of 1 / (w h^2 C), C a stiffness of the law. */
    void set_majorants(const double normal, const double tangential)
    {
      const auto &it = interaction();
      const double C = !it.law ? std::max(it.normal_stiffness, 1.)
                       : it.law->extrinsic()
                           ? it.law->strength() / it.law->final_opening()
                           : it.law->normal_stiffness();
      const double unit = 1. / (weight_step() * problem.time_step * C);
      majorant_normal = normal * unit;
      majorant_tangential = tangential * unit;
    }

    /** What the stepper writes before a solve. */
    void prepare()
    {
      for (unsigned int c = 0; c < dim; ++c) {
        problem.jump_old[c] = jump[c];
        problem.jump_free[c] = jump[c] + problem.time_step *
                                             (1. - problem.theta) *
                                             old_velocity[c];
      }
      problem.compression_stiffness[0] = !two_sided ? 0.
                                         : interaction().law
                                             ? problem.strength_factor[0] *
                                                   problem.opening_factor[0] *
                                                   law().normal_stiffness()
                                             : interaction().normal_stiffness;
    }

    LocalSolution<dim> solve(const std::array<double, dim> &local) const
    {
      return solve_point<dim>(problem, 0, local, majorant_normal,
                              majorant_tangential,
                              {problem.opening_max[0], 0.});
    }

    /** What the stepper does after a solve. */
    void accept(const LocalSolution<dim> &solution)
    {
      energies =
          point_energies<dim>(problem, 0, solution.velocity, solution.frozen);
      for (unsigned int c = 0; c < dim; ++c)
        jump[c] = problem.jump_free[c] +
                  problem.time_step * problem.theta * solution.velocity[c];
      old_velocity = solution.velocity;
      problem.opening_max[0] = energies.history.opening;
      if (problem.kind[0] == PointKind::rigid && solution.damages)
        problem.kind[0] = PointKind::cohesive;
      if (problem.kind[0] == PointKind::cohesive) {
        two_sided = two_sided && energies.beta == 1.;
        if (energies.beta <= 0.) {
          problem.kind[0] = PointKind::free;
          problem.viscosity.clear();
        }
      }
    }

    /** -P over w h: the traction that pulls body 2 back. */
    std::array<double, dim> pull(const LocalSolution<dim> &solution) const
    {
      std::array<double, dim> result;
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = -solution.impulse[c] / weight_step();
      return result;
    }

    /**
     * One step to the jump @p target. The local velocity is corrected until
     * the point arrives, with the velocity that the target asks for. With a
     * contact traction @p reaction > 0, the normal jump is left to the contact.
     */
    LocalSolution<dim> drive(const std::array<double, dim> &target,
                             const double reaction = 0.)
    {
      prepare();
      const bool pressed = reaction > 0.;
      problem.contact[0] = pressed;
      problem.target[0] = 0.;
      std::array<double, dim> wanted, local;
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        wanted[c] = (target[c] - problem.jump_free[c]) /
                    (problem.time_step * problem.theta);
        local[c] = wanted[c];
        size = std::max(size, std::abs(wanted[c]));
      }
      if (pressed)
        local[0] = -majorant_normal * weight_step() * reaction;
      LocalSolution<dim> solution;
      // one of these for every unit of the slip that friction still holds
      for (unsigned int k = 0; k < 10000; ++k) {
        solution = solve(local);
        double error = 0.;
        for (unsigned int c = pressed ? 1 : 0; c < dim; ++c) {
          const double d = wanted[c] - solution.velocity[c];
          local[c] += d;
          error = std::max(error, std::abs(d));
        }
        if (error <= 1e-13 * size)
          break;
      }
      accept(solution);
      return solution;
    }

    /** Friction traction of a solution: what cohesion leaves over. */
    double friction_traction(const LocalSolution<dim> &solution) const
    {
      return pull(solution)[1] - energies.cohesive_traction[1];
    }
  };

  /** C = 5, d_c = 0.4, so R_max = 2 and Delta = 1.2. */
  std::shared_ptr<const CohesiveLaw> michel_suquet()
  {
    return make_law("michel-suquet", {{"stiffness", "5"}, {"strength", "2"}});
  }

  /** R_max = 2, Delta = 0.6 in both directions. */
  std::shared_ptr<const CohesiveLaw> tvergaard()
  {
    return make_law("tvergaard",
                    {{"strength", "2"}, {"critical opening", "0.6"}});
  }

  /** R_max = 2, d_c = 0.6. */
  std::shared_ptr<const CohesiveLaw> camacho_ortiz()
  {
    return make_law("camacho-ortiz",
                    {{"strength", "2"}, {"critical opening", "0.6"}});
  }

  struct NamedLaw {
    std::string name;
    LawEntries entries;
  };

  /** Laws with a potential, with unequal stiffness in shear as well. */
  const std::vector<NamedLaw> potentials = {
      {"michel-suquet", {{"stiffness", "5"}, {"strength", "2"}}},
      {"michel-suquet",
       {{"stiffness", "5"}, {"strength", "2"}, {"tangential stiffness", "3"}}},
      {"tvergaard", {{"strength", "2"}, {"critical opening", "0.6"}}},
      {"tvergaard",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"tangential critical opening", "0.9"}}},
      {"camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}}},
      {"camacho-ortiz",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"mode mixity", "1.7"}}},
      {"rcc", {{"stiffness", "5"}, {"adhesion energy", "0.8"}}},
      {"rcc",
       {{"stiffness", "5"},
        {"adhesion energy", "0.8"},
        {"tangential stiffness", "9"}}},
      {"geubelle-baylor",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"initial strength parameter", "0.9"}}},
      {"trapezoid",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"tangential critical opening", "0.9"}}},
      {"ppr-extrinsic",
       {{"strength", "2"}, {"critical opening", "0.6"}, {"alpha", "3.5"}}},
      {"brittle",
       {{"stiffness", "5"}, {"strength", "2"}, {"tangential stiffness", "3"}}},
      {"dugdale",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"mode mixity", "1.7"}}},
  };

  PointKind initial_kind(const CohesiveLaw &law)
  {
    return law.extrinsic() ? PointKind::rigid : PointKind::cohesive;
  }

  /** An opening at which the law is nearly or fully spent. */
  double range_of(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening()) ? law.final_opening()
                                              : 5. * law.peak_opening();
  }

  /** Composite Simpson rule over equally spaced samples, an odd number. */
  double simpson(const std::vector<double> &samples, const double spacing)
  {
    double sum = 0.;
    for (std::size_t i = 0; i + 2 < samples.size(); i += 2)
      sum += samples[i] + 4. * samples[i + 1] + samples[i + 2];
    return sum * spacing / 3.;
  }

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

  // --- the equations themselves, on random problems

  /** Random steps of one point; @p check sees each of them. */
  template <int dim, typename Check>
  void random_paths(const NamedLaw &entry, const CohesionRule rule,
                    const double theta, const double friction,
                    const Check &check)
  {
    std::shared_ptr<const CohesiveLaw> law =
        make_law(entry.name, entry.entries);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0., 1.);
    const double range = range_of(*law);
    for (unsigned int path = 0; path < 60; ++path) {
      if (testing::Test::HasFailure())
        return;
      OnePoint<dim> point(interaction_of(law, friction, path % 3),
                          initial_kind(*law), rule, theta,
                          0.6 + 0.8 * unit(random), 0.5 + unit(random));
      point.two_sided = !law->extrinsic() && path % 2 == 0;
      if (path % 5 == 4) // against the spring in a step of 0.02
        point.problem.viscosity = {0.2 * unit(random) * law->strength() /
                                   range};
      point.set_majorants(std::pow(10., -3. * unit(random)),
                          std::pow(10., -3. * unit(random)));
      for (unsigned int step = 0; step < 25; ++step) {
        point.prepare();
        const double U_N = point.old_velocity[0];
        point.problem.contact[0] =
            !point.two_sided && point.jump[0] <= 0. && path % 4 != 3;
        point.problem.target[0] = U_N <= 0. ? 0. : -(1. - theta) / theta * U_N;
        // steps from a millionth of the range to its double
        const double size = range * 2. * std::pow(10., -6. * unit(random)) /
                            point.problem.time_step;
        std::array<double, dim> local;
        for (unsigned int c = 0; c < dim; ++c)
          local[c] = size * (2. * unit(random) - (c == 0 ? 0.7 : 1.));
        // extrinsic: hold it by impulses around the strength at first
        if (point.problem.kind[0] == PointKind::rigid)
          for (unsigned int c = 0; c < dim; ++c)
            local[c] =
                1.5 * (2. * unit(random) - (c == 0 ? 0.7 : 1.)) *
                law->strength() * point.weight_step() *
                (c == 0 ? point.majorant_normal : point.majorant_tangential);
        const auto solution = point.solve(local);
        check(point, local, solution);
        if (testing::Test::HasFailure())
          FAIL() << entry.name << ", path " << path << ", step " << step;
        point.accept(solution);
      }
    }
  }

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
    // the point lets go at a R_max + mu p_N; with kappa = (1 - beta)^s it does
    // so at a R_max. Compression does not count against the strength.
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
} // namespace test_point_law
