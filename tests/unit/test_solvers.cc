#include "solver_checks.h"

namespace solver_checks::test_solvers
{
  TEST(Solvers, Registered)
  {
    EXPECT_EQ(solvers(), SolverRegistry<3>::instance().names());
    EXPECT_GE(solvers().size(), 2u);
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
  set step = 0.4 courant
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
  set step = 0.4 courant
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
  set step = 0.05 courant
end
subsection Solver
  set tolerance = 1e-10
end
)";

  TEST(GaussSeidel, ColoursShareNoBody)
  {
    const auto check = [](const auto &scene) {
      const auto &points = scene.delassus->points();
      const auto colours = colour_faces(*scene.delassus);
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
    /// method may cycle, and must say so; the cascade goes on
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
      scene.advance_bisecting();
      const auto &problem = scene.stepper->problem();
      const double scale = 4. * scene.state.energy.kinetic;
      const double size = largest(scene.state.relative_velocity);
      for (const auto &name : solvers()) {
        const auto solver = SolverRegistry<dim>::instance().create(name);
        LawEvaluation<dim> evaluation(problem, *scene.delassus, scale, 1e-10);
        SolverControl control;
        control.tolerance = 1e-10;
        control.maximum_iterations = 2000;
        Vector P(problem.n_points * dim, 0.);
        const auto report = solver->solve(problem, *scene.delassus, scale,
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
        LawEvaluation<dim> judge(problem, *scene.delassus, scale, 1e-10);
        Vector U(P.size());
        scene.delassus->apply_delassus(P.data(), U.data());
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
        const auto again = solver->solve(problem, *scene.delassus, scale,
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
                      "Time/step=" + step + " courant"},
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
      LawEvaluation<2> evaluation(problem, *scene.delassus, 1., 1e-10);
      SolverControl control;
      control.tolerance = 1e-10;
      Vector P(problem.n_points * 2, 0.);
      const auto report =
          solver->solve(problem, *scene.delassus, 1., control, P, evaluation);
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
      LawEvaluation<2> evaluation(problem, *scene.delassus, 1., 1e-8);
      SolverControl control;
      control.tolerance = 1e-19;
      control.maximum_iterations = 5;
      Vector P(problem.n_points * 2, 0.);
      const auto report =
          solver->solve(problem, *scene.delassus, 1., control, P, evaluation);
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
  const std::string row = R"(
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
  set path = assembled
end
)";

  // The springs are linear, so the matrix of the bodies joined by them gives
  // the impulses of a step at once, also where they are far stiffer than the
  // inertia of a block: h^2 C w W is some 1e8 here.
  TEST(Solvers, StiffSpringsBetweenRigidBodies)
  {
    Scene<2> scene(row, {"Solver/tolerance=1e-11"});
    for (unsigned int step = 0; step < 20; ++step) {
      const StepReport report = scene.advance();
      EXPECT_LE(report.solver.newton, 3u + 1u)
          << step << ", the last one for the rows of the support";
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
    scene.delassus->apply_delassus(P.data(), U.data());
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
      scene.advance_bisecting();
    const auto &problem = scene.stepper->problem();
    const double scale = 4. * scene.state.energy.kinetic;
    std::mt19937 random(3);
    std::normal_distribution<double> number;
    for (const auto &name : solvers()) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      LawEvaluation<2> evaluation(problem, *scene.delassus, scale, 1e-12);
      SolverControl control;
      control.tolerance = 1e-12;
      control.maximum_iterations = 1000;
      Vector P(problem.n_points * 2, 0.);
      ASSERT_TRUE(
          solver->solve(problem, *scene.delassus, scale, control, P, evaluation)
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
} // namespace solver_checks::test_solvers
