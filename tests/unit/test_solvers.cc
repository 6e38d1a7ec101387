#include "make_law.h"
#include "make_scene.h"
#include "rigid_in_rubber.h"

#include "cohesive_laws/friction_weight.h"
#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

// Every registered solver on problems with known solutions, and against each
// other on problems without. Impulses need not be unique (W may be singular):
// velocities and objectives are compared.

using namespace nsfd;
using nsfd::test::make_law;
using nsfd::test::Scene;

namespace test_solvers
{
  using Vector = std::vector<double>;

  std::vector<std::string> solvers()
  {
    return SolverRegistry<2>::instance().names();
  }

  TEST(Solvers, Registered)
  {
    EXPECT_EQ(solvers(), SolverRegistry<3>::instance().names());
    EXPECT_GE(solvers().size(), 2u);
  }

  double largest(const Vector &x)
  {
    double result = 0.;
    for (const double value : x)
      result = std::max(result, std::abs(value));
    return result;
  }

  double dot(const Vector &a, const Vector &b)
  {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
  }

  // --- one point, by hand

  /** One body that meets the ground at one point, W = M^{-1} given. */
  class OnePoint
  {
  public:
    const double W_NN = 2., W_NT = 0.5, W_TT = 1.;

    OnePoint() : communicator(MPI_COMM_SELF)
    {
      BodyClass body;
      body.n_dofs = 2;
      body.n_slots = 1;
      body.rigid = true;
      body.mass = Block(2, 2);
      const double det = W_NN * W_TT - W_NT * W_NT;
      body.mass(0, 0) = W_TT / det;
      body.mass(1, 1) = W_NN / det;
      body.mass(0, 1) = body.mass(1, 0) = -W_NT / det;
      body.trace = Block(2, 2);
      body.trace(0, 0) = body.trace(1, 1) = 1.;
      body.bodies = {0};
      bodies.classes = {body};
      bodies.class_of = {0};
      bodies.first_dof = {0, 2};
      bodies.first_slot = {0, 1};
      bodies.slot_point = {0};
      bodies.slot_sign = {1};

      points.n_points = points.n_owned = 1;
      points.position = {0., 0.};
      points.frame = {1., 0., 0., 1.};
      points.weight = {0.4};
      InterfacePoints<2>::Face face;
      face.first = 0;
      face.count = 1;
      face.boundary = true;
      face.bodies = {{-1, 0}};
      points.faces = {face};
      points.face_of = {0};

      dynamics = make_elementwise_dynamics<2>(communicator, bodies, points);
      dynamics->reinit(h, 1.);

      problem.resize(1);
      problem.n_owned = 1;
      problem.time_step = h;
      problem.theta = 1.;
      problem.rule = CohesionRule::end_point;
      problem.interactions.resize(1);
      problem.weight = points.weight;
      problem.strength_factor = {1.};
      problem.majorant_normal = {W_NN + W_NT};
      problem.majorant_tangential = {W_TT + W_NT};
    }

    /** The natural map at P, without and with a share of 1e-3 too much. */
    double error_at(const Vector &P)
    {
      LawEvaluation<2> evaluation(problem, *dynamics, 1., 1e-12);
      evaluation.update(P);
      return evaluation.error;
    }

    void set_free_velocity(const double normal, const double tangential)
    {
      problem.free_velocity = {normal, tangential};
    }

    /** Every solver, from nothing and from somewhere else. */
    void expect_solution(const Vector &exact)
    {
      EXPECT_LE(error_at(exact), 1e-13) << "round-off of the local solve";
      Vector wrong(exact);
      wrong[0] = wrong[0] * 1.001 + 1e-3;
      EXPECT_GE(error_at(wrong), 1e-4) << "the natural map is blind";
      for (const auto &name : solvers())
        for (const Vector &start : {Vector{0., 0.}, Vector{3., -2.}}) {
          const auto solver = SolverRegistry<2>::instance().create(name);
          LawEvaluation<2> evaluation(problem, *dynamics, 1., 1e-12);
          SolverControl control;
          control.tolerance = 1e-12;
          Vector P(start);
          const auto report =
              solver->solve(problem, *dynamics, 1., control, P, evaluation);
          EXPECT_TRUE(report.converged) << name;
          EXPECT_LE(report.residual, 1e-12) << name;
          // the tolerance times the condition of the problem, below 100
          EXPECT_NEAR(P[0], exact[0], 1e-10 * (1. + std::abs(exact[0])))
              << name;
          EXPECT_NEAR(P[1], exact[1], 1e-10 * (1. + std::abs(exact[1])))
              << name;
        }
    }

    static constexpr double h = 0.02;
    Communicator communicator;
    Bodies bodies;
    InterfacePoints<2> points;
    std::unique_ptr<Dynamics<2>> dynamics;
    OneStepProblem<2> problem;
  };

  TEST(OnePoint, DelassusIsTheInverseOfTheMass)
  {
    OnePoint point;
    const Vector P{0.7, -0.3};
    Vector U(2);
    point.dynamics->apply_delassus(P.data(), U.data());
    EXPECT_NEAR(U[0], 2. * 0.7 - 0.5 * 0.3, 1e-15);
    EXPECT_NEAR(U[1], 0.5 * 0.7 - 0.3, 1e-15);
  }

  TEST(OnePoint, SlidingImpact)
  {
    OnePoint point;
    point.problem.contact = {1};
    point.problem.interactions[0].friction = 0.3;
    point.set_free_velocity(-1., 0.8);
    // U_N = 0 with P_T = -mu P_N, and U_T > 0
    const double P_N = 1. / (point.W_NN - 0.3 * point.W_NT);
    ASSERT_GT(0.8 + point.W_NT * P_N - 0.3 * point.W_TT * P_N, 0.);
    point.expect_solution({P_N, -0.3 * P_N});
  }

  TEST(OnePoint, StickingImpact)
  {
    OnePoint point;
    point.problem.contact = {1};
    point.problem.interactions[0].friction = 5.;
    point.set_free_velocity(-1., 0.8);
    // W P = -U_free: (0.8, -1.2)
    point.expect_solution({0.8, -1.2});
  }

  TEST(OnePoint, BouncingImpact)
  {
    OnePoint point;
    point.problem.contact = {1};
    point.problem.target = {0.5}; // e U_k
    point.set_free_velocity(-1., 0.8);
    point.expect_solution({1.5 / point.W_NN, 0.});
  }

  TEST(OnePoint, Open)
  {
    OnePoint point;
    point.problem.contact = {1};
    point.problem.interactions[0].friction = 0.3;
    point.set_free_velocity(0.5, 0.8);
    LawEvaluation<2> evaluation(point.problem, *point.dynamics, 1., 1e-12);
    for (const auto &name : solvers()) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      Vector P{1., 1.};
      const auto report = solver->solve(point.problem, *point.dynamics, 1.,
                                        SolverControl(), P, evaluation);
      EXPECT_TRUE(report.converged) << name;
      // the floor of the natural map: 1e-6 of a velocity of 1, times 1e-8
      EXPECT_NEAR(P[0], 0., 1e-13) << name;
      EXPECT_NEAR(P[1], 0., 1e-13) << name;
    }
  }

  TEST(OnePoint, Prescribed)
  {
    OnePoint point;
    point.problem.kind = {PointKind::prescribed};
    point.problem.mask = {3};
    point.problem.given_velocity = {0.2, -0.4};
    point.set_free_velocity(-1., 0.8);
    // W P = (1.2, -1.2)
    point.expect_solution({1.8 / 1.75, -3. / 1.75});
  }

  TEST(OnePoint, SofteningMixedMode)
  {
    OnePoint point;
    const std::shared_ptr<const CohesiveLaw> law =
        make_law("michel-suquet", {{"stiffness", "5"}, {"strength", "2"}});
    const double d_c = 0.4, w = 0.4, h = OnePoint::h;
    auto &problem = point.problem;
    problem.interactions[0].law = law;
    problem.kind = {PointKind::cohesive};
    problem.opening_max = {d_c};
    // jump at the end (1.2, 1.6) d_c: T = (0.4, 0.5333..) R_max
    const Vector U{1.2 * d_c / h, 1.6 * d_c / h},
        P{-w * h * 0.8, -w * h * 2. * 1.6 / 3.};
    point.set_free_velocity(U[0] - point.W_NN * P[0] - point.W_NT * P[1],
                            U[1] - point.W_NT * P[0] - point.W_TT * P[1]);
    point.expect_solution(P);
  }

  TEST(OnePoint, SofteningUnderPressureWithFriction)
  {
    OnePoint point;
    const std::shared_ptr<const CohesiveLaw> law =
        make_law("michel-suquet", {{"stiffness", "5"}, {"strength", "2"}});
    const double d_c = 0.4, w = 0.4, h = OnePoint::h, mu = 0.3;
    auto &problem = point.problem;
    problem.interactions[0].law = law;
    problem.interactions[0].friction = mu;
    problem.interactions[0].friction_exponent = 2.;
    problem.kind = {PointKind::cohesive};
    problem.opening_max = {d_c};
    problem.contact = {1};
    // slip to 2 d_c, beta = 1/3, kappa = 4/9, under the impulse 0.01
    const double slip = 2. * d_c / h, P_N = 0.01,
                 P_T = -w * h * 2. * 2. / 3. - mu * 4. / 9. * P_N;
    point.set_free_velocity(-point.W_NN * P_N - point.W_NT * P_T,
                            slip - point.W_NT * P_N - point.W_TT * P_T);
    point.expect_solution({P_N, P_T});
  }

  TEST(OnePoint, RigidUpToTheStrength)
  {
    OnePoint point;
    auto &problem = point.problem;
    problem.interactions[0].law = make_law(
        "camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}});
    problem.kind = {PointKind::rigid};
    const double limit = 0.4 * OnePoint::h * 2.; // w h R_max
    // held by the impulse (-0.6, 0.7) of the limit, inside the circle
    const Vector P{-0.6 * limit, 0.7 * limit};
    point.set_free_velocity(-point.W_NN * P[0] - point.W_NT * P[1],
                            -point.W_NT * P[0] - point.W_TT * P[1]);
    LawEvaluation<2> evaluation(problem, *point.dynamics, 1., 1e-12);
    evaluation.update(P);
    EXPECT_LE(evaluation.error, 1e-13);
    EXPECT_FALSE(evaluation.solutions[0].damages);
    point.expect_solution(P);
  }

  TEST(OnePoint, BrokenStaysBroken)
  {
    // The only end of the step is beyond d_0. From the impulse of the intact
    // spring on, the local problem, whose R is ten times W, has nothing else;
    // without impulse it has 0.6 d_0 as well.
    OnePoint point;
    auto &problem = point.problem;
    const double C = 312.5, d_0 = 0.01, w = 0.4, h = OnePoint::h;
    problem.interactions[0].law =
        make_law("brittle", {{"stiffness", "312.5"}, {"strength", "3.125"}});
    problem.kind = {PointKind::cohesive};
    problem.compression_stiffness = {C};
    problem.opening_max = {0.9 * d_0};
    problem.jump_old = problem.jump_free = {0.9 * d_0, 0.};
    problem.majorant_normal = {10. * point.W_NN};
    point.set_free_velocity(0.3 * d_0 / h, 0.);
    const Vector intact{-w * h * C * d_0, 0.}, none{0., 0.};
    LawEvaluation<2> evaluation(problem, *point.dynamics, 1., 1e-12);
    evaluation.update(intact);
    EXPECT_TRUE(evaluation.solutions[0].damages);
    evaluation.update(none);
    EXPECT_TRUE(evaluation.solutions[0].damages);
    EXPECT_EQ(evaluation.error, 0.);
    for (const std::string name : {"dual newton", "gauss seidel"}) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      Vector P(intact);
      LawEvaluation<2> own(problem, *point.dynamics, 1., 1e-12);
      const auto report =
          solver->solve(problem, *point.dynamics, 1., SolverControl(), P, own);
      EXPECT_TRUE(report.converged) << name;
      EXPECT_NEAR(P[0], 0., 1e-10) << name;
    }
  }

  // --- many points

  /** Blocks on the ground, pushed and sheared: contact and Coulomb friction. */
  const std::string pile = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 8, 6
  set cells        = 8, 6
  set distortion   = 0.1
end
subsection Discretization
  set interface points = 2
end
subsection Material: block
  set model              = linear elastic
  set Young modulus      = 100
  set Poisson ratio      = 0.2
  set density            = 1
  set initial velocity x = 0.4 * y + 0.2 * sin(3 * x)
  set initial velocity y = -0.2 - 0.3 * cos(2 * x + y)
end
subsection Interface: joints
  set law      = contact
  set friction = 0.4
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.5
end
subsection Loads
  set gravity = 0, -1
end
subsection Time
  set end  = 100
  set step = 0.4 crossings
end
subsection Solver
  set tolerance = 1e-10
end
)";

  const std::string cube_pile = R"(
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 2, 2, 2
  set cells        = 2, 2, 2
  set distortion   = 0.1
end
subsection Discretization
  set interface points = 2
end
subsection Material: block
  set model              = linear elastic
  set Young modulus      = 100
  set Poisson ratio      = 0.2
  set density            = 1
  set initial velocity x = 0.4 * z + 0.2 * sin(3 * x)
  set initial velocity y = 0.3 * z - 0.1 * x
  set initial velocity z = -0.5 - 0.3 * cos(2 * x + y)
end
subsection Interface: joints
  set law      = contact
  set friction = 0.4
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0, 0
  set normal   = 0, 0, 1
  set friction = 0.5
end
subsection Loads
  set gravity = 0, 0, -1
end
subsection Time
  set end  = 100
  set step = 0.4 crossings
end
subsection Solver
  set tolerance = 1e-10
end
)";

  /** A plate that tears along many faces, with friction. */
  const std::string tearing = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 4, 3
  set cells        = 4, 3
end
subsection Material: plate
  set model              = linear elastic
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 0.8 * sin(4 * x) + 0.5 * sin(3 * y)
  set initial velocity y = 0.6 * sin(3 * x) - 0.3 * (y - 1.5)
end
subsection Interface: all
  set law              = michel-suquet
  set stiffness        = 2000
  set strength         = 4
  set strength scatter = 0.3
  set friction         = 0.4
end
subsection Time
  set end  = 100
  set step = 0.05 crossings
end
subsection Solver
  set tolerance = 1e-10
end
)";

  TEST(GaussSeidel, ColoursShareNoBody)
  {
    const auto check = [](const auto &scene) {
      const auto &points = scene.dynamics->points();
      const auto colours = colour_faces(*scene.dynamics);
      std::vector<unsigned int> seen(points.faces.size(), 0);
      for (const auto &faces : colours) {
        std::set<int> bodies;
        EXPECT_FALSE(faces.empty());
        for (const unsigned int f : faces) {
          ++seen[f];
          for (const int b : points.faces[f].bodies)
            if (b >= 0) {
              EXPECT_TRUE(bodies.insert(b).second)
                  << "body " << b << " twice in a colour";
            }
        }
      }
      EXPECT_EQ(std::count(seen.begin(), seen.end(), 1u),
                long(points.faces.size()));
      // greedy: a face meets at most the other faces of its two bodies
      std::map<int, unsigned int> per_body;
      for (const auto &face : points.faces)
        for (const int b : face.bodies)
          if (b >= 0)
            ++per_body[b];
      unsigned int most = 0;
      for (const auto &[body, count] : per_body)
        most = std::max(most, count);
      EXPECT_GE(colours.size(), most);
      EXPECT_LE(colours.size(), 2 * most - 1);
    };
    check(Scene<2>(pile));
    check(Scene<3>(cube_pile));
    check(Scene<2>(pile, {"Mesh/type=crossed triangles"}));
    check(Scene<3>(cube_pile, {"Mesh/type=tetrahedra"}));
    // a bar with more faces than a word has bits
    check(Scene<2>(test::rigid_in_rubber,
                   {"Mesh/upper corner=50, 3", "Mesh/cells=50, 3",
                    "Material: block/where=y > 1 && y < 2"}));
  }

  struct Expected {
    bool same_velocities = true;
    double least_friction = 0., least_damage = 0.; ///< share of the energy
    /// friction that is not unique: fixed points on its threshold and Newton's
    /// method may cycle, and must say so; the chain goes on
    bool may_cycle = false;
  };

  /**
   * Advances a scene; each problem on the way is solved by every solver from
   * nothing.
   */
  template <int dim>
  void solve_along(const std::string &text,
                   const std::vector<std::string> &overrides,
                   const unsigned int n_steps, const Expected &expected)
  {
    Scene<dim> scene(text, overrides);
    for (unsigned int step = 0; step < n_steps; ++step) {
      scene.advance_halving();
      const auto &problem = scene.stepper->problem();
      const double scale = 4. * scene.state.energy.kinetic;
      const double size = largest(scene.state.relative_velocity);
      for (const auto &name : solvers()) {
        const auto solver = SolverRegistry<dim>::instance().create(name);
        LawEvaluation<dim> evaluation(problem, *scene.dynamics, scale, 1e-10);
        SolverControl control;
        control.tolerance = 1e-10;
        control.maximum_iterations = 2000;
        Vector P(problem.n_points * dim, 0.);
        const auto report = solver->solve(problem, *scene.dynamics, scale,
                                          control, P, evaluation);
        if (expected.may_cycle && !report.converged &&
            (name == "fixed point" || name == "anderson" ||
             name == "dual newton")) {
          EXPECT_GT(report.residual, control.tolerance);
          continue;
        }
        ASSERT_TRUE(report.converged)
            << name << ", step " << step << ", residual " << report.residual;

        // its own statement, checked from scratch
        LawEvaluation<dim> judge(problem, *scene.dynamics, scale, 1e-10);
        Vector U(P.size());
        scene.dynamics->apply_delassus(P.data(), U.data());
        judge.update(P);
        EXPECT_LE(judge.error, 1.01e-10) << name;
        for (std::size_t k = 0; k < U.size(); ++k) {
          ASSERT_NEAR(evaluation.velocity[k], U[k] + problem.free_velocity[k],
                      1e-12 * size);
          // 1e-7: the tolerance of 1e-10 times the condition of the problem
          if (expected.same_velocities) {
            ASSERT_NEAR(evaluation.velocity[k],
                        scene.state.relative_velocity[k], 1e-7 * size)
                << name << ", step " << step;
          }
        }
        // a solution needs no work
        const auto again = solver->solve(problem, *scene.dynamics, scale,
                                         control, P, evaluation);
        EXPECT_EQ(again.newton + again.sweeps, 0u) << name;
      }
    }
    const double energy = scene.state.initial_energy;
    EXPECT_GE(scene.state.energy.friction, expected.least_friction * energy)
        << "the scene is meant to rub";
    EXPECT_GE(scene.state.energy.damage, expected.least_damage * energy)
        << "the scene is meant to break";
  }

  // Coulomb friction has one solution where W is regular and mu small enough:
  // with one point per face, a cell has as many rows as velocities at most.

  TEST(Solvers, AgreeOnAPile)
  {
    for (const std::string step : {"0.4", "2"})
      solve_along<2>(pile,
                     {"Discretization/interface points=1",
                      "Time/step=" + step + " crossings"},
                     30, {true, 0.05, 0.});
  }

  TEST(Solvers, AgreeOnAPileOfCubes)
  {
    solve_along<3>(cube_pile, {"Discretization/interface points=1"}, 20,
                   {true, 0.01, 0.});
  }

  TEST(Solvers, AgreeWhereThePlateTears)
  {
    solve_along<2>(tearing, {"Discretization/interface points=1"}, 160,
                   {true, 0.01, 0.1});
  }

  TEST(Solvers, AgreeWithoutFriction)
  {
    // convex: the velocities are unique although W is singular
    solve_along<2>(
        pile, {"Interface: joints/friction=0", "Obstacle: floor/friction=0"},
        20, {});
  }

  TEST(Solvers, SolveRedundantFriction)
  {
    // Two points per face: the share of each is free, so is the friction it
    // allows, and solutions differ in velocity by up to a few percent.
    solve_along<2>(pile, {}, 30, {false, 0.05, 0., true});
    solve_along<3>(cube_pile, {}, 8, {false, 0.01, 0., true});
  }

  TEST(Solvers, RunsAgree)
  {
    // short runs, each with its own warm starts
    std::map<std::string, State> states;
    for (const auto &name : solvers()) {
      Scene<2> scene(tearing, {"Solver/method=" + name,
                               "Discretization/interface points=1"});
      for (unsigned int step = 0; step < 100; ++step)
        scene.advance();
      states[name] = scene.state;
    }
    const State &reference = states.begin()->second;
    for (const auto &[name, state] : states) {
      // 1e-10 per step, accumulated over 100 steps of a softening system
      EXPECT_NEAR(state.energy.damage, reference.energy.damage,
                  1e-6 * reference.energy.damage)
          << name;
      const double size = largest(reference.velocity);
      for (std::size_t i = 0; i < state.velocity.size(); ++i)
        ASSERT_NEAR(state.velocity[i], reference.velocity[i], 1e-5 * size)
            << name;
    }
  }

  TEST(Solvers, CountsTheirWork)
  {
    Scene<2> scene(pile);
    scene.advance();
    const auto &problem = scene.stepper->problem();
    for (const auto &name : solvers()) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      LawEvaluation<2> evaluation(problem, *scene.dynamics, 1., 1e-10);
      SolverControl control;
      control.tolerance = 1e-10;
      Vector P(problem.n_points * 2, 0.);
      const auto report =
          solver->solve(problem, *scene.dynamics, 1., control, P, evaluation);
      EXPECT_TRUE(report.converged);
      EXPECT_GT(report.newton + report.sweeps, 0u) << name;
      EXPECT_GT(evaluation.law_calls, 0u) << name;
      EXPECT_EQ(report.residual, evaluation.error) << name;
    }
  }

  TEST(Solvers, AdmitFailure)
  {
    // a tolerance below round-off cannot be met: no throw, no false claim
    Scene<2> scene(pile);
    scene.advance();
    const auto &problem = scene.stepper->problem();
    for (const auto &name : solvers()) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      LawEvaluation<2> evaluation(problem, *scene.dynamics, 1., 1e-8);
      SolverControl control;
      control.tolerance = 1e-19;
      control.maximum_iterations = 5;
      Vector P(problem.n_points * 2, 0.);
      const auto report =
          solver->solve(problem, *scene.dynamics, 1., control, P, evaluation);
      EXPECT_FALSE(report.converged) << name;
      EXPECT_GT(report.residual, 1e-19) << name;
      EXPECT_TRUE(std::isfinite(report.residual)) << name;
    }
    // and the step is rejected, with the place in its text
    Scene<2> stuck(pile, {"Solver/method=dual newton", "Solver/tolerance=1e-18",
                          "Solver/maximum iterations=3"});
    const State before = stuck.state;
    try {
      stuck.advance();
      FAIL() << "the step was kept";
    } catch (const StepRejected &rejected) {
      const std::string text = rejected.what();
      EXPECT_NE(text.find("residual"), std::string::npos) << text;
      EXPECT_NE(text.find("worst face at ("), std::string::npos) << text;
    }
    EXPECT_EQ(stuck.state.velocity, before.velocity);
  }

  /** A beam of rigid blocks on springs E/l, one end is lifted. */
  const std::string chain = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 80 mm, 10 mm
  set cells        = 80, 1
end
subsection Material: blocks
  set model   = rigid
  set density = 2700
end
subsection Interface: joints
  set law                  = elastic
  set normal stiffness     = 7e13
  set tangential stiffness = 7e16
end
subsection Boundary: left
  set velocity y = 1
end
subsection Time
  set end   = 1 ms
  set step  = 50 us
  set theta = 1
end
subsection Solver
  set path = global
end
)";

  // The springs are linear, so the matrix of the bodies joined by them gives
  // the impulses of a step at once, also where they are far stiffer than the
  // inertia of a block: h^2 C w W is some 1e8 here.
  TEST(Solvers, StiffSpringsBetweenRigidBodies)
  {
    Scene<2> scene(chain, {"Solver/tolerance=1e-11"});
    for (unsigned int step = 0; step < 20; ++step) {
      const StepReport report = scene.advance();
      EXPECT_LE(report.solver.newton, 3u) << step;
      EXPECT_EQ(report.solver.sweeps, 0u) << step;
    }
  }

  // --- the dual objective

  /** P.WP/2 + P.(U_free - target), P_N >= 0: contact without friction. */
  template <int dim>
  double objective(const Scene<dim> &scene, const Vector &P)
  {
    const auto &problem = scene.stepper->problem();
    Vector U(P.size());
    scene.dynamics->apply_delassus(P.data(), U.data());
    double result = 0.5 * dot(P, U) + dot(P, problem.free_velocity);
    for (std::size_t i = 0; i < problem.n_points; ++i)
      result -= P[i * dim] * problem.target[i];
    return result;
  }

  TEST(Solvers, MinimiseTheDualObjective)
  {
    Scene<2> scene(
        pile, {"Interface: joints/friction=0", "Obstacle: floor/friction=0"});
    for (unsigned int step = 0; step < 5; ++step)
      scene.advance_halving();
    const auto &problem = scene.stepper->problem();
    const double scale = 4. * scene.state.energy.kinetic;
    std::mt19937 random(3);
    std::normal_distribution<double> number;
    for (const auto &name : solvers()) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      LawEvaluation<2> evaluation(problem, *scene.dynamics, scale, 1e-12);
      SolverControl control;
      control.tolerance = 1e-12;
      control.maximum_iterations = 1000;
      Vector P(problem.n_points * 2, 0.);
      ASSERT_TRUE(
          solver->solve(problem, *scene.dynamics, scale, control, P, evaluation)
              .converged)
          << name;
      const double least = objective(scene, P);
      EXPECT_LT(least, 0.) << "better than no impulse";
      unsigned int active = 0;
      for (std::size_t i = 0; i < problem.n_points; ++i) {
        EXPECT_EQ(P[i * 2 + 1], 0.);
        EXPECT_GE(P[i * 2], -1e-12 * largest(P));
        active += P[i * 2] > 0.;
      }
      EXPECT_GT(active, 5u);
      EXPECT_LT(active, problem.n_points);
      // no other point of the domain is lower: convex, so near ones suffice
      for (unsigned int k = 0; k < 200; ++k) {
        Vector other(P);
        const double size = std::pow(10., -double(k % 6)) * largest(P);
        for (std::size_t i = 0; i < problem.n_points; ++i)
          if (problem.contact[i] && (k % 2 == 0 || i % 7 == k % 7))
            other[i * 2] = std::max(0., P[i * 2] + size * number(random));
        EXPECT_GE(objective(scene, other), least - 1e-12 * std::abs(least))
            << name;
      }
    }
  }
} // namespace test_solvers
