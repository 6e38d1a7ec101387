#include "law_checks.h"
#include "make_scene.h"

#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"

using namespace nsfd;
using namespace nsfd::test;

// The thermodynamic form (7)-(11), and adhesion with viscosity.

namespace test_law_fremond
{
  using Entries = LawEntries;

  std::unique_ptr<CohesiveLaw> fremond(Entries entries = {})
  {
    entries.push_back({"stiffness", "2"});
    entries.push_back({"adhesion energy", "3"});
    return make_law("fremond", entries);
  }

  void expect_same(const CohesiveLaw &a, const CohesiveLaw &b,
                   const double range)
  {
    for (const auto value :
         {&CohesiveLaw::elastic_limit, &CohesiveLaw::peak_opening,
          &CohesiveLaw::strength, &CohesiveLaw::toughness,
          &CohesiveLaw::normal_stiffness, &CohesiveLaw::stiffness_ratio,
          &CohesiveLaw::shear_weight})
      expect_relative((a.*value)(), (b.*value)(), 1e-10);
    for (unsigned int i = 0; i <= 3000; ++i) {
      const double d = range * i / 3000.;
      ASSERT_NEAR(a.beta(d), b.beta(d), 1e-10) << d;
      ASSERT_NEAR(a.traction(d), b.traction(d), 1e-10 * b.strength()) << d;
      ASSERT_NEAR(a.energy(d), b.energy(d), 1e-10 * b.toughness()) << d;
    }
  }

  TEST(Fremond, QuadraticInBetaIsAdhesion)
  {
    const auto law = fremond({{"tangential stiffness", "5"}});
    const auto rcc = make_law("rcc", {{"stiffness", "2"},
                                      {"adhesion energy", "3"},
                                      {"tangential stiffness", "5"}});
    expect_same(*law, *rcc, 20.);
    expect_relative(law->steepest_softening(), 6., 1e-8);
    EXPECT_TRUE(std::isinf(law->final_opening()));
  }

  TEST(Fremond, LinearInBetaIsBrittle)
  {
    const auto law = fremond({{"stiffness function", "beta"}});
    // w = G = R_max^2 / (2 C)
    const auto brittle =
        make_law("brittle", {{"stiffness", "2"}, {"toughness", "3"}});
    const double d_0 = std::sqrt(3.);
    expect_relative(law->final_opening(), d_0);
    expect_relative(law->strength(), 2. * d_0);
    EXPECT_TRUE(std::isinf(law->steepest_softening()));
    for (const double d :
         {0., 0.3 * d_0, d_0 * (1. - 1e-9), d_0 * (1. + 1e-9), 2. * d_0}) {
      EXPECT_EQ(law->beta(d), brittle->beta(d));
      EXPECT_NEAR(law->energy(d), brittle->energy(d), 1e-10);
    }
  }

  // f = b^2, g = (1 - b)^2: chi = b C d^2 - 2 w (1 - b), damage at once
  TEST(Fremond, AnotherPotential)
  {
    const auto law = fremond({{"surface energy function", "(1 - beta)^2"}});
    EXPECT_EQ(law->elastic_limit(), 0.);
    for (const double d : {0.1, 0.5, 1., 3., 10.}) {
      const double b = 6. / (6. + 2. * d * d);
      expect_relative(law->beta(d), b * b, 1e-10);
      expect_relative(law->energy(d), b * b * d * d + 3. * (1. - b) * (1. - b),
                      1e-10);
    }
  }

  /** b after @p time of an opening @p d, through the law. */
  double intensity_after(const CohesiveLaw &law, const double from,
                         const double d, const double time)
  {
    return std::sqrt(law.beta(law.delayed_opening(from, d, time)));
  }

  TEST(ViscousAdhesion, RelaxesAtAConstantOpening)
  {
    // C = 2, w = 3, b = 0.7, U = 2 u_0: b_end = 1/4, b(0.1) = 0.3850692
    const Entries entries = {{"stiffness", "2"},
                             {"adhesion energy", "3"},
                             {"damage viscosity", "0.7"}};
    for (const std::string name : {"rcc", "fremond"}) {
      SCOPED_TRACE(name);
      const auto law = make_law(name, entries);
      const double u_0 = std::sqrt(1.5), U = 2. * u_0;
      for (const double t : {1e-4, 0.01, 0.1, 0.3, 1.}) {
        const double exact = 0.25 + 0.75 * std::exp(-2. * U * U * t / 0.7);
        expect_relative(intensity_after(*law, u_0, U, t), exact, 1e-10);
      }
      EXPECT_NEAR(intensity_after(*law, u_0, U, 0.1), 0.3850692, 5e-8);
      // the same in ten parts
      double d_m = u_0;
      for (unsigned int k = 0; k < 10; ++k)
        d_m = law->delayed_opening(d_m, U, 0.01);
      expect_relative(std::sqrt(law->beta(d_m)),
                      intensity_after(*law, u_0, U, 0.1), 1e-10);
      EXPECT_EQ(law->delayed_opening(U, 0.5 * U, 1.), U) << "never heals";
    }
  }

  /** Drives a point of the law at the speed 1 from u_0 on for a time of 1. */
  struct Ramp {
    double intensity, work, spent, viscous;
  };
  Ramp ramp(const CohesiveLaw &law, const unsigned int n,
            const CohesionRule rule)
  {
    OneStepProblem<2> problem;
    resize(problem, 1);
    problem.n_owned = 1;
    problem.time_step = 1. / n;
    problem.theta = 1.;
    problem.rule = rule;
    Interaction interaction;
    interaction.law = {std::shared_ptr<void>(), &law}; // not owned
    problem.interactions = {interaction};
    problem.kind = {PointKind::cohesive};
    problem.weight = {1.};
    const double u_0 = law.elastic_limit();
    problem.opening_max = {u_0};
    problem.jump_old = {u_0, 0.};
    Ramp result{1., 0., 0., 0.};
    const double stored = law.energy(u_0);
    for (unsigned int k = 0; k < n; ++k) {
      problem.jump_free = problem.jump_old;
      const double R = 1e-12;
      const auto solution = solve_point<2>(problem, 0, {{1., 0.}}, R, R,
                                           {problem.opening_max[0], 0.});
      const auto energies =
          point_energies<2>(problem, 0, solution.velocity, solution.frozen);
      const double way = solution.velocity[0] / n;
      problem.jump_old[0] += way;
      problem.opening_max[0] = energies.history.opening;
      EXPECT_GE(energies.damage, 0.);
      EXPECT_GE(energies.viscous, 0.);
      result.work += energies.cohesive_traction[0] * way;
      result.spent += energies.damage + energies.viscous;
      result.viscous += energies.viscous;
      result.intensity = std::sqrt(energies.beta);
      if (k + 1 == n)
        result.spent += energies.stored - stored;
    }
    return result;
  }

  TEST(ViscousAdhesion, ClosesTheBalanceOfARun)
  {
    const std::string blocks = R"(# blocks - two blocks fly apart.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Material: left
  set where              = x < 1
  set model              = rigid
  set density            = 1
  set initial velocity x = -1
end
subsection Material: right
  set model              = rigid
  set density            = 1
  set initial velocity x = 1
  set initial velocity y = 0.3
end
subsection Interface: face
  set law              = rcc
  set stiffness        = 20
  set adhesion energy  = 0.3
  set damage viscosity = 0.05
end
subsection Time
  set end  = 1
  set step = 0.01 s
end
)";
    for (const std::string rule : {"exact", "end point"}) {
      Scene<2> scene(blocks, {"Time/cohesion rule=" + rule});
      for (unsigned int k = 0; k < 200; ++k)
        EXPECT_LT(scene.advance().balance_residual, 1e-12);
      const EnergyLines &e = scene.state.energy;
      EXPECT_GT(e.viscous, 0.01);
      EXPECT_GT(e.damage, 0.28) << "most of w = 0.3";
      EXPECT_LE(e.damage, 0.3);
      if (rule == "exact") {
        EXPECT_NEAR(e.numerical, 0., 1e-9);
      }
      EXPECT_FALSE(scene.state.viscous_traction);
    }
  }

  TEST(ViscousAdhesion, FollowsARamp)
  {
    const auto law = make_law("rcc", {{"stiffness", "2"},
                                      {"adhesion energy", "3"},
                                      {"damage viscosity", "0.7"}});
    const double exact = 0.3266883;
    for (const CohesionRule rule :
         {CohesionRule::end_point, CohesionRule::exact}) {
      std::vector<double> error;
      for (const unsigned int n : {100u, 200u, 400u, 800u})
        error.push_back(std::abs(ramp(*law, n, rule).intensity - exact));
      for (unsigned int k = 0; k + 1 < error.size(); ++k)
        EXPECT_NEAR(error[k] / error[k + 1], 2., 0.05) << "first order";
      EXPECT_LT(error.back(), 1e-3);
    }
    const Ramp closed = ramp(*law, 50, CohesionRule::exact);
    EXPECT_NEAR(closed.work, closed.spent, 1e-11 * closed.work);
    EXPECT_GT(closed.viscous, 0.1);
    // viscosity that hardly matters: the law at rest
    const auto quick = make_law("rcc", {{"stiffness", "2"},
                                        {"adhesion energy", "3"},
                                        {"damage viscosity", "1e-6"}});
    const auto rest =
        make_law("rcc", {{"stiffness", "2"}, {"adhesion energy", "3"}});
    const Ramp fast = ramp(*quick, 100, CohesionRule::exact);
    EXPECT_NEAR(fast.intensity,
                std::sqrt(rest->beta(rest->elastic_limit() + 1.)), 1e-6);
    EXPECT_NEAR(fast.viscous, 0., 1e-4);
  }
} // namespace test_law_fremond
