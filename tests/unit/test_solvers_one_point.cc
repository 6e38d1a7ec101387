#include "solver_checks.h"

namespace solver_checks::test_solvers_one_point
{
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
      points.frames = {1., 0., 0., 1.};
      points.weight = {0.4};
      InterfacePoints<2>::Face face;
      face.first = 0;
      face.count = 1;
      face.boundary = true;
      face.bodies = {{-1, 0}};
      points.faces = {face};
      points.face_of = {0};

      delassus = make_local_delassus<2>(communicator, bodies, points);
      delassus->reinit(h, 1.);

      resize(problem, 1);
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
      LawEvaluation<2> evaluation(problem, *delassus, 1., 1e-12);
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
          LawEvaluation<2> evaluation(problem, *delassus, 1., 1e-12);
          SolverControl control;
          control.tolerance = 1e-12;
          Vector P(start);
          const auto report =
              solver->solve(problem, *delassus, 1., control, P, evaluation);
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
    std::unique_ptr<DelassusOperator<2>> delassus;
    OneStepProblem<2> problem;
  };

  TEST(OnePoint, DelassusIsTheInverseOfTheMass)
  {
    OnePoint point;
    const Vector P{0.7, -0.3};
    Vector U(2);
    point.delassus->apply_delassus(P.data(), U.data());
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
    LawEvaluation<2> evaluation(point.problem, *point.delassus, 1., 1e-12);
    for (const auto &name : solvers()) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      Vector P{1., 1.};
      const auto report = solver->solve(point.problem, *point.delassus, 1.,
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
    LawEvaluation<2> evaluation(problem, *point.delassus, 1., 1e-12);
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
    LawEvaluation<2> evaluation(problem, *point.delassus, 1., 1e-12);
    evaluation.update(intact);
    EXPECT_TRUE(evaluation.solutions[0].damages);
    evaluation.update(none);
    EXPECT_TRUE(evaluation.solutions[0].damages);
    EXPECT_EQ(evaluation.error, 0.);
    for (const std::string name : {"dual newton", "gauss seidel"}) {
      const auto solver = SolverRegistry<2>::instance().create(name);
      Vector P(intact);
      LawEvaluation<2> own(problem, *point.delassus, 1., 1e-12);
      const auto report =
          solver->solve(problem, *point.delassus, 1., SolverControl(), P, own);
      EXPECT_TRUE(report.converged) << name;
      EXPECT_NEAR(P[0], 0., 1e-10) << name;
    }
  }
} // namespace solver_checks::test_solvers_one_point
