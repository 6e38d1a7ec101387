#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

// The scenes on geometries of prm/meshes and on grains: every group is found
// and used as the scene means it, and the first steps in space keep momentum
// and energy.

namespace end_to_end::test_mesh_scenes
{
  namespace
  {
    namespace fs = std::filesystem;

    struct Body {
      std::array<double, 3> momentum{};
      double volume = 0.;
    };

    /** Of linear tetrahedra with four points each: V rho times mean velocity.
     */
    Body of_tetrahedra(const Snapshot &fields,
                       const std::vector<double> &density_of_material)
    {
      const auto &x = fields.at("Points"), &v = fields.at("velocity");
      const auto &material = fields.at("material");
      Body sum;
      for (std::size_t cell = 0; cell < material.size(); ++cell) {
        const double *p = &x[12 * cell];
        double edge[3][3];
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int c = 0; c < 3; ++c)
            edge[i][c] = p[3 * (i + 1) + c] - p[c];
        double determinant = 0.;
        for (unsigned int c = 0; c < 3; ++c)
          determinant +=
              edge[0][c] * (edge[1][(c + 1) % 3] * edge[2][(c + 2) % 3] -
                            edge[1][(c + 2) % 3] * edge[2][(c + 1) % 3]);
        const double volume = std::abs(determinant) / 6.;
        sum.volume += volume;
        for (unsigned int c = 0; c < 3; ++c)
          for (unsigned int i = 0; i < 4; ++i)
            sum.momentum[c] +=
                density_of_material.at(std::size_t(material[cell])) * volume *
                v[12 * cell + 3 * i + c] / 4.;
      }
      return sum;
    }
  } // namespace

  TEST(Meshes, ScenesFindTheirGroups)
  {
    const std::vector<std::pair<std::string, std::vector<std::string>>> scenes =
        {{"plate_with_hole",
          {"matrix (surface 1)", "used by Interface: rim",
           "used by Interface: crack", "used by Boundary: right"}},
         {"notched_plate",
          {"matrix (surface 1)", "notch (curve 3): 12 faces on the boundary",
           "used by Interface: rim", "used by Interface: crack",
           "used by Boundary: left"}},
         {"notched_plate_3d",
          {"matrix (volume 1)", "inclusion (volume 2)",
           "faces between cells, used by Interface: rim",
           "faces between cells, used by Interface: crack",
           "faces on the boundary, used by Boundary: right"}},
         {"grains",
          {"grain 8 (surface 8)", "used by Interface: weak boundary",
           "used by Boundary: left"}},
         {"grains_3d",
          {"grain 8 (volume 8)", "used by Interface: weak boundary",
           "used by Boundary: left"}},
         {"polycrystal", {"grain 1 (surface 1)", "grain boundaries"}},
         {"inclined_tension", {"900 cells"}},
         {"inclined_grains", {"cells      952 quads"}}};
    const Workspace workspace;
    for (const auto &[name, lines] : scenes) {
      SCOPED_TRACE(name);
      const Outcome outcome =
          nsfd(workspace, {benchmark(name).string(), "--check"});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.out.find("mesh note"), std::string::npos)
          << outcome.out;
      for (const std::string &line : lines)
        EXPECT_NE(outcome.out.find(line), std::string::npos) << line << "\n"
                                                             << outcome.out;
    }
  }

  // One end is held, the other is pulled: what the ends give is what the body
  // has, at every picture; on a curved inclusion and an open crack.
  TEST(Meshes, MomentumOfANotchedPlateInSpace)
  {
    const Workspace workspace;
    Launch launch;
    launch.file = benchmark("notched_plate_3d");
    launch.set = {"Boundary: left/velocity x=0", "Time/scheme=moreau-jean",
                  "Time/step=1 courant", "Time/end=1.2 us",
                  "Output/fields every=0.4 us"};
    const Result result = good_run(workspace, "plate", launch);
    ASSERT_TRUE(result.completed()) << result.description();
    ASSERT_GE(result.history.size(), 8u);

    const auto fields = snapshots(result.directory, "fields");
    const Body end = of_tetrahedra(fields.back(), {1190., 2400.});
    // 20 x 10 x 4 without a wedge of 2 x 2.5 / 2 x 4, in mm^3
    EXPECT_NEAR(end.volume / 790e-9, 1., 1e-6);
    const auto &h = result.history["time_step"];
    const char *const axes[] = {"x", "y", "z"};
    std::array<double, 3> given{};
    for (unsigned int c = 0; c < 3; ++c)
      for (const char *side : {"left", "right"}) {
        const auto &force =
            result.history[std::string("reaction_") + side + "_" + axes[c]];
        for (std::size_t k = 0; k < h.size(); ++k)
          given[c] += h[k] * force[k];
      }
    EXPECT_GT(given[0], 0.); // towards the pulled end
    for (unsigned int c = 0; c < 3; ++c)
      expect_below(std::string("momentum along ") + axes[c],
                   std::abs(end.momentum[c] - given[c]) / given[0], 1e-12,
                   "exact up to round-off");
  }

  // Only faces between grains may break, so pieces are grains or more.
  TEST(Meshes, GrainsInSpaceKeepTogether)
  {
    const Workspace workspace;
    Launch launch;
    launch.file = benchmark("grains_3d");
    launch.set = {"Time/end=1 ns"};
    const Result result = good_run(workspace, "grains", launch);
    ASSERT_TRUE(result.completed()) << result.description();
    EXPECT_EQ(result.number("fragments"), 1.);
    EXPECT_EQ(result.dissipated("damage"), 0.);
    EXPECT_GT(result.number("work"), 0.);
  }
} // namespace end_to_end::test_mesh_scenes
