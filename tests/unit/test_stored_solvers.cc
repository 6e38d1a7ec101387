// Stored contact problems: error measure, one contact, every solver.
#include "known_contacts.h"
#include "nonsmooth/solver.h"
#include "nonsmooth/solvers/contact_solvers.h"

#include "nonsmooth/frictional_contact/one_contact.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nsfd::test_stored_solvers
{
  namespace
  {
    using contact_copies::Dice;
    using known_contacts::Known;
    using known_contacts::manufacture;
    using known_contacts::Options;
    using stored::OneContact;
    using stored::project_on_cone;
    using stored::tangential_norm;

    ContactProblem one_contact(const unsigned int d, const double mu,
                               const std::vector<double> &q)
    {
      ContactProblem problem;
      problem.dimension = d;
      problem.q = q;
      problem.friction = {mu};
      problem.row_start = {0};
      for (unsigned int c = 0; c < d; ++c) {
        problem.column.push_back(int(c));
        problem.value.push_back(1.);
        problem.row_start.push_back(int(c) + 1);
      }
      return problem;
    }
  } // namespace

  // r - P_K(r - u^) by hand
  TEST(StoredProblems, ErrorMeasureOfOneContact)
  {
    // u = q = (-1, 0, 0), P_K(1, 0, 0) = (1, 0, 0)
    EXPECT_DOUBLE_EQ(
        natural_map_error(one_contact(3, 0.5, {-1., 0., 0.}), {0., 0., 0.}),
        1.);
    // closed and at rest: u = 0
    EXPECT_DOUBLE_EQ(
        natural_map_error(one_contact(3, 0.5, {-1., 0., 0.}), {1., 0., 0.}),
        0.);
    // sliding solution: r = (2, -1), u = (0, 3), u^ = (1.5, 3),
    // r - u^ = (0.5, -4) and P_K = (2.5, -4 * 2.5 * 0.5 / 4) / (1 + 0.25)
    EXPECT_NEAR(natural_map_error(one_contact(2, 0.5, {-2., 4.}), {2., -1.}),
                0., 1e-16);
    // the same with half the impulse: u = (-1, 3.5), u^ = (0.75, 3.5),
    // x = (0.25, -4), P_K = (1.8, -0.9), r - P_K = (-0.8, 0.4),
    // |q| = sqrt(20) is the largest norm
    EXPECT_NEAR(natural_map_error(one_contact(2, 0.5, {-2., 4.}), {1., -0.5}),
                std::sqrt(0.8 / 20.), 1e-15);
    // nothing at all: the numerator itself
    EXPECT_DOUBLE_EQ(natural_map_error(one_contact(2, 0.5, {0., 0.}), {0., 0.}),
                     0.);
    EXPECT_TRUE(std::isnan(
        natural_map_error(one_contact(2, 0.5, {0., 1.}), {std::nan(""), 0.})));
  }

  // Moreau: x = y + z, y in K, z in the polar cone, y z = 0
  TEST(StoredProblems, ProjectionSplitsIntoConeAndPolar)
  {
    Dice dice(3);
    for (int k = 0; k < 1000; ++k) {
      const double mu = dice(0., 1.5);
      const double x[3] = {dice(-1., 1.), dice(-1., 1.), dice(-1., 1.)};
      const auto y = project_on_cone<3>(x, mu);
      const double z[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      EXPECT_LE(tangential_norm<3>(y.data()), mu * y[0] + 1e-15);
      EXPECT_LE(mu * tangential_norm<3>(z), -z[0] + 1e-15);
      EXPECT_NEAR(y[0] * z[0] + y[1] * z[1] + y[2] * z[2], 0., 1e-15);
    }
  }

  // random blocks, symmetric or not; natural map of the solution relative to
  // |b| and the block's condition: 1e-12 leaves room for a condition of 1e3
  TEST(StoredProblems, OneContactIsSolvedExactly)
  {
    Dice dice(5);
    int counts[3] = {};
    for (int k = 0; k < 3000; ++k) {
      double h[9], A[9];
      for (double &x : h)
        x = dice(-1., 1.);
      const double asymmetry = k % 2 ? 0.2 : 0.;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          A[3 * i + j] = (i == j ? 0.05 : 0.) + asymmetry * dice(-0.1, 0.1);
          for (int l = 0; l < 3; ++l)
            A[3 * i + j] += h[3 * i + l] * h[3 * j + l];
        }
      const double mu = dice(0., 1.2);
      const double b[3] = {dice(-1., 0.2), dice(-1., 1.), dice(-1., 1.)};
      OneContact<3> contact(A, mu);
      double r[3] = {}, u[3];
      contact.solve(b, r);
      stored::multiply_vector<3>(A, r, u);
      for (int c = 0; c < 3; ++c)
        u[c] += b[c];
      const double size =
          std::max(1., std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
      EXPECT_LE(std::sqrt(stored::squared_natural_map<3>(r, u, mu)) / size,
                1e-12)
          << "block " << k;
      const double t = tangential_norm<3>(r);
      ++counts[r[0] == 0. ? 0 : t < mu * r[0] * (1. - 1e-12) ? 1 : 2];
    }
    for (const int count : counts) // all three cases have been met
      EXPECT_GT(count, 100);
  }

  // a block without tangential or without any compliance must not break it
  TEST(StoredProblems, OneContactOfASingularBlockStaysInTheCone)
  {
    const double normal_only[9] = {1., 0., 0., 0., 0., 0., 0., 0., 0.};
    const double nothing[9] = {};
    const double negative[9] = {-1e-9, 0., 0., 0., 1., 0., 0., 0., 1.};
    for (const double *A : {normal_only, nothing, negative}) {
      OneContact<3> contact(A, 0.5);
      const double b[3] = {-1., 0.3, -0.4};
      double r[3] = {};
      contact.solve(b, r);
      for (const double x : r)
        EXPECT_TRUE(std::isfinite(x));
      EXPECT_LE(tangential_norm<3>(r), 0.5 * r[0] * (1. + 1e-14));
    }
    // frictionless in normal direction, which is regular: r_N = 1
    OneContact<3> contact(normal_only, 0.);
    const double b[3] = {-1., 0., 0.};
    double r[3] = {};
    contact.solve(b, r);
    EXPECT_NEAR(r[0], 1., 1e-9); // 1e-10 of the block is added to it
  }

  std::vector<std::string> names()
  {
    std::vector<std::string> result;
    for (const auto &solver : contact_solvers())
      result.push_back(solver.first);
    return result;
  }

  // one registry: those that know laws are among them where W is assembled
  TEST(StoredSolvers, AreThoseOfRunsAndThoseThatNeedWAssembled)
  {
    const std::vector<std::string> expected{
        "admm",         "auto",           "dual newton",
        "gauss seidel", "interior point", "projected gradient",
        "proximal"};
    EXPECT_EQ(names(), expected);
    for (const std::string &name : expected) {
      EXPECT_TRUE(SolverRegistry<2>::instance().knows(name)) << name;
      EXPECT_TRUE(SolverRegistry<3>::instance().create(name)->contact_solver())
          << name;
    }
    EXPECT_FALSE(
        SolverRegistry<2>::instance().create("cascade")->contact_solver());
  }

  class StoredSolverTest : public testing::TestWithParam<std::string>
  {
  };

  // W well conditioned and mu small: one solution, and every solver finds it
  TEST_P(StoredSolverTest, FindsTheOnlySolution)
  {
    for (const unsigned int d : {2u, 3u}) {
      Options options;
      options.dimension = d;
      const Known known = manufacture(options);
      ASSERT_LT(natural_map_error(known.problem, known.r), 1e-14);
      std::vector<double> r;
      SolverControl control;
      control.tolerance = 1e-10;
      const SolverReport report =
          solve_contact_problem(known.problem, GetParam(), control, r);
      EXPECT_TRUE(report.converged) << report.residual;
      EXPECT_GT(report.iterations, 0u);
      EXPECT_EQ(report.residual, natural_map_error(known.problem, r));
      // error times condition: W has its eigenvalues in 1 .. 5
      for (std::size_t j = 0; j < r.size(); ++j)
        EXPECT_NEAR(r[j], known.r[j], 1e-8) << j;
    }
  }

  // far fewer degrees of freedom than contact rows, W unsymmetric as far as
  // the public problems are
  TEST_P(StoredSolverTest, SolvesHyperstaticProblems)
  {
    for (const unsigned int d : {2u, 3u})
      for (const double asymmetry : {0., 1e-4}) {
        Options options;
        options.dimension = d;
        options.contacts = 12;
        options.rank = 18;
        options.asymmetry = asymmetry;
        const Known known = manufacture(options);
        std::vector<double> r;
        const SolverReport report =
            solve_contact_problem(known.problem, GetParam(), {}, r);
        EXPECT_TRUE(report.converged) << d << "D: " << report.residual;
      }
  }

  // units: W from 1e-5 to 1e6, velocities from 1e-6 to 1e3. The measure itself
  // is not free of units, so the solution is compared, at a tolerance that
  // means 1e-8 of the smaller of r and u
  TEST_P(StoredSolverTest, DoesNotCareAboutUnits)
  {
    for (const double w : {1e-5, 1e6})
      for (const double q : {1e-6, 1e3}) {
        Options options;
        options.w_scale = w;
        options.q_scale = q;
        const Known known = manufacture(options);
        std::vector<double> r;
        SolverControl control;
        control.tolerance = 1e-9 * std::min(w, 1. / w);
        const SolverReport report =
            solve_contact_problem(known.problem, GetParam(), control, r);
        EXPECT_TRUE(report.converged)
            << w << " " << q << " " << report.residual;
        for (std::size_t j = 0; j < r.size(); ++j)
          EXPECT_NEAR(r[j] * w / q, known.r[j] * w / q, 1e-6) << j;
      }
  }

  TEST_P(StoredSolverTest, DoesNothingWhereNothingIsToDo)
  {
    std::vector<double> r;
    const SolverReport report = solve_contact_problem(
        one_contact(3, 0.5, {1., 2., 3.}), GetParam(), {}, r);
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.iterations, 0u);
    EXPECT_EQ(r, (std::vector<double>{0., 0., 0.}));

    Options options;
    Known known = manufacture(options);
    std::vector<double> start = known.r;
    const SolverReport again =
        solve_contact_problem(known.problem, GetParam(), {}, start);
    EXPECT_TRUE(again.converged);
    EXPECT_EQ(again.iterations, 0u);
  }

  // u_N = -1 whatever r is: there is no solution
  TEST_P(StoredSolverTest, SaysWhenThereIsNoSolution)
  {
    ContactProblem problem = one_contact(3, 0.5, {-1., 0., 0.});
    problem.value = {0., 1., 1.};
    std::vector<double> r;
    SolverControl control;
    control.maximum_iterations = 30;
    const SolverReport report =
        solve_contact_problem(problem, GetParam(), control, r);
    // the measure divides by |r|: huge impulses satisfy it, but nothing hides
    // that the contact closes
    EXPECT_GT(std::max(report.residual / control.tolerance, report.penetration),
              0.99);
    EXPECT_EQ(report.converged, report.residual <= control.tolerance);
    EXPECT_NEAR(report.penetration, 1., 1e-12);
    for (const double x : r)
      EXPECT_TRUE(std::isfinite(x));
  }

  INSTANTIATE_TEST_SUITE_P(All, StoredSolverTest, testing::ValuesIn(names()),
                           [](const auto &info) {
                             std::string name = info.param;
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                           });

  // dimension, rank, friction, asymmetry at random: the chain must not give up
  TEST(StoredProblems, TheChainSolvesRandomProblems)
  {
    Dice dice(11);
    for (unsigned int k = 0; k < 60; ++k) {
      Options options;
      options.seed = 100 + k;
      options.dimension = 2 + k % 2;
      options.contacts = 5 + int(dice(0., 30.));
      options.mu = dice(0., 1.);
      options.rank = int(dice(0.3, 0.9) * options.dimension * options.contacts);
      options.asymmetry = k % 3 ? 0. : 1e-5;
      const Known known = manufacture(options);
      std::vector<double> r;
      const SolverReport report =
          solve_contact_problem(known.problem, "auto", {}, r);
      EXPECT_TRUE(report.converged)
          << "problem " << k << ", " << report.residual;
    }
  }
} // namespace nsfd::test_stored_solvers
