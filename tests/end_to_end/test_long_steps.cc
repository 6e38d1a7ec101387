#include "compare.h"

#include <gtest/gtest.h>

// Long steps through intact faces: one factor for a whole run, work that
// depends neither on stiffness nor on step, the same result from both solvers
// and on any number of ranks.

namespace end_to_end::test_long_steps
{
  namespace
  {
    /// a bar in space, one end held, the other one driven: its middle opens all
    /// at once, and what comes off is held in one direction alone
    constexpr const char *pulled_bar = R"(
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 40 mm, 20 mm, 20 mm
  set cells        = 10, 6, 6
end
subsection Material: PMMA
  set Young modulus = 3 GPa
  set Poisson ratio = 0.35
  set density       = 1190 kg/m^3
end
subsection Interface: middle
  set where     = abs(x - 20 mm) < 1 um
  set law       = camacho-ortiz
  set strength  = 5 MPa
  set toughness = 300 J/m^2
end
subsection Interface: elsewhere
  set law = joined
end
subsection Boundary: left
  set displacement x = 0
  set displacement y = 0
  set displacement z = 0
end
subsection Boundary: right
  set displacement x = t / 1 s * 0.4 mm
end
subsection Time
  set scheme = quasi-static
  set end    = 0.4 s
  set step   = 0.04 s
end
subsection Output
  set fields = false
end
)";

    std::filesystem::path pulse()
    {
      return prm_folder() / "benchmarks/pulse.prm";
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
      // what round-off of the sums of BLAS, which differ from processor to
      // processor, may stop once
      EXPECT_LE(result.counter("rejected_steps"), 1.);
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

  // Multigrid goes the way of factors through a plane whose points soften, all
  // of them at once, and to the equilibria of what has come apart. A bar of 400
  // mm^2 and 300 J/m^2.
  TEST(LongSteps, PlanesOpenWithMultigridAsWithFactors)
  {
    const Workspace workspace;
    const auto file = workspace.path() / "bar.prm";
    write_text(file, pulled_bar);
    const auto run_with = [&](const std::string &solver) {
      return good_run(workspace, solver,
                      {file, {"Solver/linear solver=" + solver}});
    };
    const Result factors = run_with("direct"), cycles = run_with("cg");
    ASSERT_TRUE(factors.completed() && cycles.completed());
    for (const Result *result : {&factors, &cycles})
      expect_below("work of separation",
                   std::abs(result->dissipated("damage") / 0.12 - 1.), 1e-8);
    expect_below("rounds of multigrid over those of factors",
                 cycles.counter("equilibrium_rounds") /
                     factors.counter("equilibrium_rounds"),
                 1.5, "what solutions to round-off leave as it was");
  }
} // namespace end_to_end::test_long_steps
