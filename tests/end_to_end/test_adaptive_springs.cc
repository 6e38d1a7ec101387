#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

// The modulus of a bar whose faces are springs, on meshes that are refined.

namespace end_to_end::test_adaptive_springs
{
  namespace
  {
    // E = 1, unit cross section, 8 cells, pulled by 0.01
    const std::string bar =
        R"(# bar.prm - a bar of springs and cells in equilibrium: long damped steps.
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 8, 1
  set cells        = 8, 1
end
subsection Material: bar
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law       = michel-suquet
  set stiffness = 10
  set strength  = 1
end
subsection Boundary: left
  set velocity x = 0
  set velocity y = 0
end
subsection Boundary: right
  set traction x = 0.01
end
subsection Time
  set end           = 600
  set step          = 20
  set theta         = 1
  set cohesion rule = end point
end
subsection Adaptivity
  set levels  = 2
  set springs = SPRINGS
end
subsection Indicator: part
  set type      = region
  set region    = x < END
  set cell size = SIZE
end
subsection Output
  set fields = false
end
)";

    struct Bar {
      std::string end, size;
      std::vector<double> sizes; ///< of the cells along the bar
    };
  } // namespace

  // elongation = work / force = F (8 / E + sum over faces of c / C), c the
  // share of a face: the mean size of its cells, or 1
  TEST(Adaptivity, ModulusOfARefinedBarOfSprings)
  {
    const std::vector<Bar> bars = {
        {"-1", "0.5", std::vector<double>(8, 1.)},
        {"9", "0.5", std::vector<double>(16, 0.5)},
        {"9", "0.25", std::vector<double>(32, 0.25)},
        // next to cells of a quarter there are halves, then whole ones
        {"4", "0.25", {0.25, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25,
                       0.25, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25,
                       0.25, 0.25, 0.5,  0.5,  1.,   1.,   1.}}};
    const Workspace workspace;
    for (const std::string springs : {"constant modulus", "constant stiffness"})
      for (const Bar &one : bars) {
        const std::string name = springs.substr(9) + "_" + one.end + one.size;
        const auto file = workspace.path() / (name + ".prm");
        write_text(file, replaced(replaced(replaced(bar, "SPRINGS", springs),
                                           "END", one.end),
                                  "SIZE", one.size));
        const Result result =
            good_run(workspace, name, {file, {"Solver/tolerance=1e-12"}});
        double compliance = 0.;
        for (std::size_t i = 0; i + 1 < one.sizes.size(); ++i)
          compliance += springs == "constant modulus"
                            ? 0.5 * (one.sizes[i] + one.sizes[i + 1])
                            : 1.;
        const double elongation = result.summary["work"].get<double>() / 0.01;
        // what thirty damped steps and the tolerance of the solver leave
        expect_below(
            name + ": elongation",
            std::abs(elongation / (0.01 * (8. + compliance / 10.)) - 1.), 1e-8);
        // the modulus is that of the first mesh, but for half a spring at the
        // ends of the bar
        if (springs == "constant modulus")
          expect_below(name + ": modulus against the first mesh",
                       std::abs(elongation / 0.087 - 1.), 0.5 * 2. / 10. / 8.7);
      }
  }

  // A ramp of 8 s reaches half of its force on the wall, 2 Z v, after 4 s and
  // the way at c / sqrt(1 + E / (C L)), L the size of the cells for springs
  // that stay as they are; 0.5 % for the dispersion of the cells and the ends
  // of the bar.
  TEST(Adaptivity, WaveThroughARefinedBarOfSprings)
  {
    const auto file = prm_folder() / "benchmarks" / "spring_bar.prm";
    const double speed = 1. / std::sqrt(1.1);
    const Workspace workspace;
    for (const auto &[springs, seconds] :
         {std::pair<std::string, double>{"constant modulus", 100. / speed},
          {"constant stiffness", 50. / speed + 50. * std::sqrt(1.4)}}) {
      const Result result = good_run(
          workspace, springs.substr(9),
          {file, {"Adaptivity/springs=" + springs, "Output/fields=false"}});
      const auto &time = result.history["time"],
                 &force = result.history["reaction_right_x"];
      double arrival = 0.;
      for (std::size_t k = 1; k < time.size() && arrival == 0.; ++k) {
        const double a = std::abs(force[k - 1]) - 0.01 * speed,
                     b = std::abs(force[k]) - 0.01 * speed;
        if (b > 0.)
          arrival = time[k - 1] + (time[k] - time[k - 1]) * a / (a - b);
      }
      expect_below(springs + ": arrival",
                   std::abs((arrival - 4.) / seconds - 1.), 5e-3);
    }
  }

  // damage, contact and friction while springs come, go and change
  TEST(Adaptivity, RanksAgreeOnSprings)
  {
    const std::vector<std::string> set = {"Mesh/cells=12, 9",
                                          "Time/step=0.4 us",
                                          "Constants/pull=4 m/s",
                                          "Time/end=60 us",
                                          "Adaptivity/levels=1",
                                          "Adaptivity/coarsen every steps=5",
                                          "Indicator: front/type=process zone",
                                          "Solver/tolerance=1e-12"};
    const Workspace workspace;
    const Result one = good_run(workspace, "1", {torn_plate(), set});
    const auto changes = [](const Result &result) {
      return result.summary["counters"]["mesh_changes"].get<double>();
    };
    EXPECT_GT(changes(one), 3.);
    for (const unsigned int ranks : {2u, 3u}) {
      const Result more = good_run(workspace, std::to_string(ranks),
                                   {torn_plate(), set, ranks});
      EXPECT_EQ(changes(more), changes(one));
      expect_below(std::to_string(ranks) + " ranks: energies",
                   energy_difference(one.history, more.history), 1e-9);
    }
  }
} // namespace end_to_end::test_adaptive_springs
