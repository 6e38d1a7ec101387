// The cascade for stored contact problems: what must not depend on order,
// units or luck, and what restarts return.
#include "known_contacts.h"
#include "nonsmooth/frictional_contact/fclib.h"
#include "nonsmooth/frictional_contact/session.h"
#include "nonsmooth/solvers/contact_solvers.h"

#include <gtest/gtest.h>

namespace nsfd::test_contact_restarts
{
  namespace
  {
    using contact_copies::Dice;
    using known_contacts::Known;
    using known_contacts::manufacture;
    using known_contacts::Options;

    struct Solved {
      SolverReport report;
      std::vector<double> r;
    };

    Solved solve(const ContactProblem &problem, const double tolerance,
                 const unsigned int attempts = 1000)
    {
      SolverControl control;
      control.tolerance = tolerance;
      control.attempts = attempts;
      Solved result;
      result.report = solve_contact_problem(problem, "auto", control, result.r);
      return result;
    }

    ContactProblem own_problem(const std::string &name)
    {
      return read_fclib(std::string(NSFD_SOURCE_DIR) + "/tests/problems/" +
                        name + ".hdf5");
    }
    const std::vector<std::string> own_problems{
        "brick_3d", "fragments_2d", "fragments_tight_2d",
        "plate_2d", "pile_3d",      "pile_short_step_3d"};

    /** Well conditioned, so that it has one solution; of either dimension. */
    Known with_one_solution(const unsigned int k)
    {
      Options options;
      options.seed = 40 + k;
      options.dimension = 2 + k % 2;
      return manufacture(options);
    }
  } // namespace

  // error times condition: W has its eigenvalues in 1 .. 5
  TEST(ContactRestarts, ARelabelledProblemHasTheSameAnswer)
  {
    for (unsigned int k = 0; k < 6; ++k) {
      const Known known = with_one_solution(k);
      Dice dice(k);
      const std::vector<int> order = dice.order(known.problem.n_contacts());
      const Solved solved = solve(known.problem, 1e-10),
                   other = solve(
                       contact_copies::relabelled(known.problem, order), 1e-10);
      ASSERT_TRUE(solved.report.converged && other.report.converged);
      const auto same = contact_copies::relabelled(solved.r, order);
      for (std::size_t j = 0; j < same.size(); ++j)
        EXPECT_NEAR(other.r[j], same[j], 1e-8) << k << " " << j;
    }
  }

  // powers of two change no digit of W / w, q / s and r w / s; of other units
  // only the measure depends, which compares r with u
  TEST(ContactRestarts, AScaledProblemHasTheSameAnswer)
  {
    for (unsigned int k = 0; k < 6; ++k) {
      const Known known = with_one_solution(k);
      const Solved solved = solve(known.problem, 1e-10);
      ASSERT_TRUE(solved.report.converged);
      const Solved doubled =
          solve(contact_copies::scaled(known.problem, 1., 0x1p20), 1e-10);
      EXPECT_EQ(doubled.report.iterations, solved.report.iterations);
      EXPECT_EQ(doubled.report.residual, solved.report.residual);
      for (std::size_t j = 0; j < solved.r.size(); ++j)
        EXPECT_EQ(doubled.r[j], 0x1p20 * solved.r[j]);
      const double w = 10., s = 3e-4;
      const Solved other =
          solve(contact_copies::scaled(known.problem, w, s), 1e-11);
      ASSERT_TRUE(other.report.converged);
      for (std::size_t j = 0; j < solved.r.size(); ++j)
        EXPECT_NEAR(other.r[j] * w / s, solved.r[j], 1e-8) << k << " " << j;
    }
  }

  // two of these are steps that the solver of their run had rejected
  TEST(ContactRestarts, OwnProblemsAreSolvedWhateverTheirOrder)
  {
    for (const std::string &name : own_problems) {
      const ContactProblem problem = own_problem(name);
      for (unsigned int seed = 1; seed <= 4; ++seed) {
        Dice dice(seed);
        const Solved solved =
            solve(contact_copies::relabelled(problem,
                                             dice.order(problem.n_contacts())),
                  1e-8);
        EXPECT_TRUE(solved.report.converged)
            << name << ", order " << seed << ": " << solved.report.residual;
      }
    }
  }

  // below what round-off allows: every attempt fails, and more of them may only
  // do better. Sums of the problem as it is stored and in blocks differ by some
  // epsilons.
  TEST(ContactRestarts, MoreAttemptsNeverGiveAWorseAnswer)
  {
    for (const std::string &name : own_problems) {
      const ContactProblem problem = own_problem(name);
      double before = std::numeric_limits<double>::infinity();
      const double round_off = 8. * std::numeric_limits<double>::epsilon();
      for (const unsigned int attempts : {1u, 2u, 5u, 20u}) {
        const Solved solved = solve(problem, 1e-30, attempts);
        EXPECT_LE(solved.report.residual, std::max(before, round_off))
            << name << " " << attempts;
        EXPECT_LE(solved.report.attempts, attempts);
        EXPECT_LE(solved.report.best_attempt, solved.report.attempts);
        EXPECT_EQ(solved.report.residual, natural_map_error(problem, solved.r));
        EXPECT_FALSE(solved.report.solver.empty());
        before = solved.report.residual;
      }
    }
  }

  TEST(ContactRestarts, EveryRunGivesTheSameBits)
  {
    for (const std::string &name : own_problems) {
      const ContactProblem problem = own_problem(name);
      const Solved first = solve(problem, 1e-30, 30),
                   second = solve(problem, 1e-30, 30);
      EXPECT_EQ(first.r, second.r) << name;
      EXPECT_EQ(first.report.iterations, second.report.iterations);
      EXPECT_EQ(first.report.best_attempt, second.report.best_attempt);
      EXPECT_EQ(first.report.solver, second.report.solver);
    }
  }

  // a solver that comes near and leaves again, as ADMM and sweeps may
  TEST(ContactRestarts, TheBestOnTheWayIsKeptWithItsSolver)
  {
    const Known known = with_one_solution(1);
    stored::Session<3> s(known.problem, 1e-12);
    const auto go_to = [&](const double share) {
      for (std::size_t j = 0; j < s.r.size(); ++j)
        s.r[j] = share * known.r[j] / s.problem.impulse_unit;
      s.judge();
    };
    const double at_start = s.error;
    s.attempt("admm", [&] {
      go_to(0.9);
      go_to(1. + 1e-9);
      go_to(0.8);
    });
    EXPECT_LT(s.error, at_start); // the next one begins where it ended
    EXPECT_GT(s.error, 1e-3);
    s.attempt("gauss seidel", [&] {
      go_to(0.85);
      go_to(0.5);
    });
    s.restart("proximal", [&] { go_to(0.7); });
    EXPECT_LT(s.error, 1e-8);
    EXPECT_EQ(s.finisher, "admm");
    EXPECT_EQ(s.attempts, 2u);
    EXPECT_EQ(s.best_attempt, 1u);
    s.restart("proximal", [&] { go_to(1. + 1e-11); });
    EXPECT_EQ(s.finisher, "proximal");
    EXPECT_EQ(s.best_attempt, 3u);
    EXPECT_FALSE(s.solved());
    s.restart("interior point", [&] { go_to(1.); });
    EXPECT_TRUE(s.solved());
    EXPECT_EQ(s.finisher, "interior point");
    EXPECT_EQ(s.best_attempt, 4u);
    EXPECT_EQ(s.switches, (std::vector<std::string>{"admm -> gauss seidel"}));
  }

  TEST(ContactRestarts, AnUnusableGuessDoesNoHarm)
  {
    const Known known = with_one_solution(1);
    std::vector<double> r(known.problem.n_rows(), std::nan(""));
    const SolverReport report =
        solve_contact_problem(known.problem, "auto", {}, r);
    EXPECT_TRUE(report.converged) << report.residual;
  }
} // namespace nsfd::test_contact_restarts
