#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

// Meshes that follow the motion: orders on non-conforming faces, energy
// balance, ranks.

namespace end_to_end::test_adaptivity
{
  namespace
  {
    const std::string waves =
        R"(# waves.prm - a hit plate whose mesh follows its waves; a seam tears.
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 8, 4
end
subsection Discretization
  set degree = 2
end
subsection Material: plate
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 0.02 * exp(-30 * ((x - 0.5)^2 + (y - 0.4)^2))
end
subsection Interface: seam
  set where        = abs(x - 1) < 1e-6
  set law          = LAW
  set strength     = 0.002
  set toughness    = 2e-5
  MORE
end
subsection Interface: elsewhere
  set law = JOINT
end
subsection Time
  set end  = 1.5
  set step = 0.02
end
subsection Adaptivity
  set levels              = 2
  set coarsen every steps = 5
end
subsection Indicator: waves
  set type   = energy
  set factor = 3
end
subsection Indicator: stress
  set type  = stress jump
  set share = 0.5
end
subsection Output
  set fields = false
end
)";

    std::filesystem::path write_waves(const Workspace &workspace,
                                      const bool bonded)
    {
      const auto file = workspace.path() / "waves.prm";
      std::string text = replaced(waves, "JOINT", bonded ? "bonded" : "rigid");
      text = replaced(text, "LAW", bonded ? "camacho-ortiz" : "michel-suquet");
      text = replaced(text, "MORE", bonded ? "set intact faces = bonded" : "");
      write_text(file, text);
      return file;
    }

    double counter(const Result &result, const std::string &name)
    {
      return result.summary["counters"][name].get<double>();
    }
  } // namespace

  // refine and coarsen during waves, with damaged faces
  TEST(Adaptivity, WavesOverAMeshThatChanges)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "waves", {write_waves(workspace, true)});
    EXPECT_GT(counter(result, "mesh_changes"), 10.);
    EXPECT_GT(counter(result, "largest_cells"),
              1.2 * counter(result, "mean_cells"));
    EXPECT_GT(result.summary["dissipated"]["damage"].get<double>(), 0.);
    expect_below("energy of a change over the largest",
                 counter(result, "mesh_change_energy_worst"), 1e-3);
  }

  TEST(Adaptivity, RanksAgree)
  {
    const Workspace workspace;
    for (const bool bonded : {true, false}) {
      const auto file = write_waves(workspace, bonded);
      const std::vector<std::string> tight = {"Solver/tolerance=1e-12"};
      const std::string name = bonded ? "bonded" : "rigid";
      const Result one = good_run(workspace, name + "_1", {file, tight});
      EXPECT_GT(counter(one, "mesh_changes"), 10.);
      for (const unsigned int ranks : {2u, 3u}) {
        Launch launch{file, tight};
        launch.ranks = ranks;
        const Result more =
            good_run(workspace, name + "_" + std::to_string(ranks), launch);
        EXPECT_EQ(counter(more, "mesh_changes"), counter(one, "mesh_changes"));
        expect_below(name + " on " + std::to_string(ranks) + " ranks",
                     energy_difference(one.history, more.history), 1e-9);
      }
    }
  }

  // Half of the cells are half as large: the order of the coarse ones shows.
  TEST(Adaptivity, OrdersWithHangingFaces)
  {
    const Workspace workspace;
    const auto file = workspace.path() / "hanging.prm";
    write_text(file, "include " + scene("manufactured").string() + R"(
subsection Adaptivity
  set levels = 1
end
subsection Indicator: part
  set type      = region
  set region    = x + 0.7 * y < 0.8
  set cell size = 0.5 m / n
end
)");
    for (const unsigned int degree : {1u, 2u, 3u}) {
      std::vector<double> error;
      for (const unsigned int n : {4u, 8u, 16u}) {
        const Result result = good_run(
            workspace, "p" + std::to_string(degree) + "n" + std::to_string(n),
            {file,
             {"Discretization/degree=" + std::to_string(degree),
              "Constants/n=" + std::to_string(n), "Time/end=0.05 ms",
              "Time/step=" + std::to_string(degree < 3 ? 16 : 1) +
                  " us * 4 / n"}});
        EXPECT_GT(result.summary["cells"].get<double>(), 1.5 * n * n);
        error.push_back(result.error("displacement_L2"));
      }
      expect_below("degree " + std::to_string(degree) + ": order p + 1",
                   degree + 1. - std::log2(error[1] / error[2]), 0.2);
    }
  }
} // namespace end_to_end::test_adaptivity
