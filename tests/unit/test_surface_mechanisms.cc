#include "law_checks.h"
#include "make_scene.h"

#include "material_point/drive_point.h"
#include "nonsmooth/point_law.h"

#include <random>

using namespace nsfd;
using namespace nsfd::test;

// Plateau unloading, limited viscosity, dilatancy and wear at one point.

namespace test_surface_mechanisms
{
  std::vector<CurveRow> open_and_close(const CohesiveLaw &law,
                                       const bool plateau, const double d,
                                       const CohesionRule rule)
  {
    Interaction interaction =
        interaction_of({std::shared_ptr<void>(), &law}, 0., 1.);
    interaction.plateau = plateau;
    const double end = law.final_opening();
    return drive_point(interaction,
                       points_between({{0., 0., 0.}, {d, 0., 0.}, {0., 0., 0.}},
                                      {end, end, 1.}, 400),
                       rule);
  }

  // opened to d_c / 2 and closed: G / 4 on the plateau, G / 2 on the secant
  TEST(Plateau, KeepsItsTractionWhileItCloses)
  {
    const auto law = make_law(
        "camacho-ortiz", {{"strength", "300 MPa"}, {"toughness", "0.5 J/m^2"}});
    const double R = 300e6, G = 0.5, d = 0.5 * law->final_opening();
    for (const CohesionRule rule :
         {CohesionRule::exact, CohesionRule::end_point}) {
      const auto plateau = open_and_close(*law, true, d, rule),
                 secant = open_and_close(*law, false, d, rule);
      expect_relative(plateau.back().damage, G / 4.);
      expect_relative(secant.back().damage, G / 2.);
      for (const CurveRow &row : plateau)
        if (row.path > 1. && row.opening > 1e-6 * d) {
          EXPECT_NEAR(row.cohesive_normal, R / 2., 1e-6 * R) << row.opening;
          expect_relative(row.stored, R / 2. * row.opening, 1e-9);
        }
      if (rule == CohesionRule::exact)
        expect_relative(plateau.back().work, G / 4., 1e-9);
    }
  }

  /** Two blocks of mass 1 that the plateau pulls together again. */
  TEST(Plateau, ClosesTheBalanceOfARun)
  {
    const std::string blocks = R"(# blocks - flung apart and pulled back.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Discretization
  set interface points = 1
end
subsection Material: left
  set where              = x < 1
  set model              = rigid
  set density            = 1
  set initial velocity x = -0.3
  set initial velocity y = -0.1
end
subsection Material: right
  set model              = rigid
  set density            = 1
  set initial velocity x = 0.3
  set initial velocity y = 0.1
end
subsection Interface: face
  set where     = abs(x - 1) < 1e-9
  set law       = camacho-ortiz
  set strength  = 2
  set toughness = 0.3
  set unloading = plateau
  set friction  = 0.2
end
subsection Time
  set end  = 1
  set step = 0.005 s
end
)";
    for (const std::string solver : {"dual newton", "gauss seidel"}) {
      Scene<2> scene(blocks, {"Solver/method=" + solver});
      double largest = 0.;
      for (unsigned int k = 0; k < 200; ++k) {
        EXPECT_LT(scene.advance().balance_residual, 1e-9);
        largest = std::max(largest, scene.state.jump[0]);
      }
      EXPECT_GT(largest, 0.01);
      EXPECT_LT(scene.state.opening_max[0], 0.3);
      EXPECT_LT(scene.state.jump[0], 1e-3) << "closed again";
      EXPECT_NEAR(scene.state.energy.numerical, 0., 1e-9);
    }
  }

  TEST(LimitedViscosity, DoesNotExceedItsLimit)
  {
    const auto law =
        make_law("michel-suquet", {{"strength", "2"}, {"toughness", "3"}});
    for (const double limit : {0.5, 5., 500.})
      for (const double theta : {0.5, 1.})
        for (const double speed : {1e-3, 0.1, 1., 1e3, 1e6}) {
          OneStepProblem<2> problem;
          resize(problem, 1);
          problem.n_owned = 1;
          problem.time_step = 1e-8;
          problem.theta = theta;
          problem.rule = CohesionRule::exact;
          Interaction interaction;
          interaction.law = {std::shared_ptr<void>(), law.get()};
          interaction.viscous_limit = limit;
          problem.interactions = {interaction};
          problem.kind = {PointKind::cohesive};
          problem.weight = {1.};
          problem.opening_max = {law->elastic_limit()};
          problem.viscosity = {0.7};
          // steady: the same speed before and after
          problem.jump_free = {(1. - theta) * speed * 1e-8, 0.};
          const double R = 1e-3 * speed / (1. + limit) * 1e8;
          const double drag = 0.7 * speed / (1. + 0.7 * speed / limit);
          const auto energies_at = [&](const double U) {
            return point_energies<2>(problem, 0, {{U, 0.}},
                                     {law->normal_stiffness()});
          };
          const double traction = energies_at(speed).cohesive_traction[0];
          const auto solution =
              solve_point<2>(problem, 0, {{speed + R * 1e-8 * traction, 0.}}, R,
                             R, {problem.opening_max[0], 0.});
          expect_relative(solution.velocity[0], speed, 1e-9);
          expect_relative(energies_at(speed).viscous_traction, drag, 1e-12);
          EXPECT_LT(drag, limit);
          expect_relative(energies_at(speed).viscous, drag * speed * 1e-8,
                          1e-9);
        }
  }

  /** What the contact law asks of a point that sliding lifts. */
  template <int dim>
  void check_lifted(const OneStepProblem<dim> &problem,
                    const std::array<double, dim> &local, const double R_N,
                    const double R_T)
  {
    const auto solution =
        solve_point<dim>(problem, 0, local, R_N, R_T, Reach());
    const auto &interaction = problem.interactions[0];
    double speed = 0., friction = 0., along = 0., size = 1e-300;
    for (unsigned int c = 0; c < dim; ++c)
      size = std::max(size, std::abs(local[c]));
    for (unsigned int c = 1; c < dim; ++c) {
      speed += std::pow(solution.velocity[c], 2);
      friction += std::pow(solution.impulse[c], 2);
      along += solution.velocity[c] * solution.impulse[c];
    }
    speed = std::sqrt(speed);
    friction = std::sqrt(friction);
    const double P = solution.contact_impulse;
    const double p = P / (problem.weight[0] * problem.time_step);
    const double lift =
        std::min(problem.dilatancy[0] * speed,
                 problem.lift_left[0] / (problem.time_step * problem.theta)) -
        interaction.wear * p * speed;
    const double tolerance = 1e-10 * size;
    for (unsigned int c = 0; c < dim; ++c)
      ASSERT_NEAR(solution.velocity[c],
                  local[c] + (c ? R_T : R_N) * solution.impulse[c], tolerance);
    ASSERT_GE(P, 0.);
    const double gap = solution.velocity[0] - problem.target[0] - lift;
    ASSERT_GE(gap, -tolerance);
    ASSERT_LE(std::min(gap, R_N * P), tolerance) << "complementary";
    ASSERT_LE(R_T * friction, R_T * interaction.friction * P + tolerance);
    if (speed > 1e-6 * size) {
      ASSERT_NEAR(R_T * friction, R_T * interaction.friction * P, tolerance);
      ASSERT_NEAR(along, -friction * speed, 1e-9 * size * friction + 1e-300);
    }
  }

  template <int dim>
  void random_lifted_points()
  {
    std::mt19937 random(3);
    const auto number = [&](const double a, const double b) {
      return std::uniform_real_distribution<double>(a, b)(random);
    };
    for (unsigned int k = 0; k < 4000; ++k) {
      OneStepProblem<dim> problem;
      resize(problem, 1);
      problem.n_owned = 1;
      problem.time_step = 0.02;
      problem.theta = number(0.5, 1.);
      problem.weight = {0.3};
      Interaction interaction;
      interaction.friction = number(0., 1.);
      interaction.wear = k % 3 == 0 ? 0. : std::pow(10., number(-6., 1.));
      problem.interactions = {interaction};
      problem.kind = {PointKind::free};
      problem.contact = {1};
      problem.target = {k % 4 ? 0. : number(-1., 1.)};
      problem.dilatancy = {k % 3 == 1 ? 0. : number(0., interaction.friction)};
      problem.lift_left = {k % 5 ? std::numeric_limits<double>::infinity()
                                 : number(0., 0.01)};
      std::array<double, dim> local;
      for (double &U : local)
        U = number(-1., 1.);
      check_lifted<dim>(problem, local, std::pow(10., number(-2., 2.)),
                        std::pow(10., number(-2., 2.)));
      if (testing::Test::HasFailure())
        FAIL() << "point " << k;
    }
  }

  TEST(SlidingLift, KeepsTheContactLaw)
  {
    random_lifted_points<2>();
    random_lifted_points<3>();
  }

  const std::string slider =
      R"(# slider - driven along a plane under its weight.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 1, 0.2
  set cells        = 1, 1
end
subsection Material: block
  set model              = rigid
  set density            = 1000
  set initial velocity x = 1
end
subsection Interface: none
  set law = rigid
end
subsection Obstacle: plane
  set where     = bottom
  set point     = 0, 1e-12
  set normal    = 0, 1
  set friction  = 0.3
end
subsection Loads
  set gravity = 0, -9.81
end
subsection Time
  set end  = 1
  set step = 1 ms
end
subsection Solver
  set tolerance = 1e-12
end
)";

  // The asperities end: lifted by the saturation, no more, and the energy
  // balance closes all the way.
  TEST(SlidingLift, Saturates)
  {
    Scene<2> scene(slider, {"Obstacle: plane/dilatancy=0.2",
                            "Obstacle: plane/dilatancy saturation=5e-3"});
    for (unsigned int k = 0; k < 300; ++k) {
      EXPECT_LT(scene.advance().balance_residual, 1e-12);
      EXPECT_GE(scene.state.energy.friction, 0.);
    }
    const double height = scene.state.jump[0];
    EXPECT_NEAR(scene.state.dilated[0], 5e-3, 1e-4) << "v tan(psi) h / 2";
    EXPECT_NEAR(height, 5e-3, 2e-4) << "thrown off by at most v tan(psi) h";
    // what is left of the kinetic energy went to friction, throw and height
    const EnergyLines &e = scene.state.energy;
    EXPECT_NEAR(e.kinetic + e.friction + e.impact + e.numerical - e.work, 100.,
                1e-10);
  }

  TEST(SlidingLift, WearFollowsTheSlip)
  {
    Scene<2> scene(slider, {"Obstacle: plane/wear coefficient=1e-6"});
    for (unsigned int k = 0; k < 200; ++k)
      EXPECT_LT(scene.advance().balance_residual, 1e-12);
    double worn = 0., slip = 0.;
    for (std::size_t i = 0; i < 2; ++i) {
      worn += scene.state.worn[i] / 2.;
      slip += scene.state.slip[i] / 2.;
      EXPECT_NEAR(scene.state.jump[2 * i], -scene.state.worn[i], 1e-11);
    }
    // p = m (g + u'') / A changes by a share k p of itself
    EXPECT_NEAR(worn, 1e-6 * 1962. * slip, 4. * 1e-6 * 1962. * worn);
    EXPECT_GT(slip, 0.1);
    EXPECT_TRUE(Scene<2>(slider).state.worn.empty());
  }
} // namespace test_surface_mechanisms
