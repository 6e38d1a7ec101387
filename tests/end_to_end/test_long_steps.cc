#include "compare.h"

#include <gtest/gtest.h>

// Long steps through intact faces: one factor for a whole run, work that
// depends neither on stiffness nor on step, the same result from both solvers
// and on any number of ranks.

namespace end_to_end::test_long_steps
{
  namespace
  {
    std::filesystem::path pulse()
    {
      return quickstart().parent_path() / "benchmarks/pulse.prm";
    }

    std::vector<std::string> settings(const std::string &solver,
                                      const std::string &ratio,
                                      const std::string &courant,
                                      const double steps)
    {
      const double end = (steps - 0.5) * std::stod(courant) / 12. / 1.16;
      return {"Solver/path=assembled",
              "Solver/linear solver=" + solver,
              "Mesh/cells=12, 12",
              "Interface: faces/stiffness=12 * " + ratio,
              "Time/step=" + courant + " courant",
              "Time/theta=1",
              "Time/end=" + std::to_string(end),
              "Output/fields=false"};
    }
  } // namespace

  TEST(LongSteps, LinearScenesFactoriseOnce)
  {
    for (const std::string solver : {"direct", "cg"})
      for (const std::string ratio : {"21", "1e5", "1e8"})
        for (const std::string step : {"1", "100"}) {
          SCOPED_TRACE(solver + ", C L/E = " + ratio + ", step " + step);
          const Workspace workspace;
          const Result result = good_run(
              workspace, "run", {pulse(), settings(solver, ratio, step, 6.)});
          ASSERT_TRUE(result.completed());
          EXPECT_EQ(result.counter("global_factorisations"), 1.);
          EXPECT_EQ(result.counter("coarse_spaces"), solver == "cg" ? 1. : 0.);
          EXPECT_EQ(result.counter("rejected_steps"), 0.);
          expect_below("applications per step",
                       result.counter("operator_applications") /
                           result.number("steps"),
                       150.);
        }
  }

  // (C L/E) step^2 up to the inverse of machine precision. The energy balance
  // of these steps shows the round-off of the bodies, doc/stability.md: no
  // good_run()
  TEST(LongSteps, StiffCorner)
  {
    const std::vector<std::pair<std::string, std::string>> corner = {
        {"1e6", "1e4"}, {"1e8", "1e3"}, {"1e7", "1e4"}, {"1e8", "1e4"}};
    for (const auto &[ratio, step] : corner) {
      SCOPED_TRACE("C L/E = " + ratio + ", step " + step);
      const Workspace workspace;
      const Result result =
          run(workspace, "run", {pulse(), settings("cg", ratio, step, 5.)});
      ASSERT_TRUE(result.completed()) << result.description();
      EXPECT_EQ(result.counter("rejected_steps"), 0.);
      expect_below("applications per step",
                   result.counter("operator_applications") /
                       result.number("steps"),
                   150.);
      expect_below("ledger", result.number("ledger_defect_max"), 1e-6,
                   "4e-7 with theta = 1 at a Courant number of 1e4");
    }
  }

  // every face in contact or open, nothing rubs: no step is cut, and W is
  // applied less often than the bound of the solvers of A
  TEST(LongSteps, ContactOnEveryFace)
  {
    for (const std::string step : {"10", "100"}) {
      SCOPED_TRACE("step " + step);
      const Workspace workspace;
      auto set = settings("direct", "21", step, 5.);
      set.push_back("Interface: faces/intact faces=unilateral");
      const Result result = good_run(workspace, "run", {pulse(), set});
      ASSERT_TRUE(result.completed());
      EXPECT_EQ(result.counter("rejected_steps"), 0.);
      expect_below("applications per step",
                   result.counter("operator_applications") /
                       result.number("steps"),
                   150.);
    }
  }

  TEST(LongSteps, BothSolversOnAnyNumberOfRanks)
  {
    const Workspace workspace;
    auto set = settings("direct", "1e3", "10", 6.);
    set.push_back("Solver/tolerance=1e-11");
    const Result one = good_run(workspace, "one", {pulse(), set});
    ASSERT_TRUE(one.completed());
    for (const std::string solver : {"direct", "cg"})
      for (const unsigned int n : {1u, 3u}) {
        set[1] = "Solver/linear solver=" + solver;
        const Result several =
            good_run(workspace, solver + std::to_string(n), {pulse(), set, n});
        ASSERT_TRUE(several.completed());
        expect_below(solver + " on " + std::to_string(n) + " ranks",
                     energy_difference(one.history, several.history), 1e-9,
                     "100 times the tolerance");
      }
  }
} // namespace end_to_end::test_long_steps
