#include "compare.h"

#include <gtest/gtest.h>

#include <ostream>

// Explicit steps on joined cells, `scheme = explicit`: one rank and several
// give the same files, bit for bit, while nodes at their borders fall apart.

namespace end_to_end::test_joined_ranks
{
  namespace
  {
    // everything breaks, and is pushed together again
    const std::string square = R"(
subsection Mesh
  set type         = rectangle
  set upper corner = 10 um, 10 um
  set cells        = 8, 8
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
end
subsection Interface: all
  set law              = camacho-ortiz
  set strength         = 300 MPa
  set toughness        = 0.5 J/m^2
  set strength scatter = 0.1
  set friction         = 0.3
end
subsection Boundary: left
  set velocity x = if(t < 10 ns, -3 m/s, 3 m/s)
  set velocity y = 0
end
subsection Boundary: right
  set velocity x = if(t < 10 ns, 3 m/s, -3 m/s)
end
subsection Time
  set end = 16 ns
end
subsection Output
  set fields every = 4 ns
end
)";

    struct JoinedRow {
      std::string name;
      std::vector<std::string> set;
      /// of prm/verification or prm/benchmarks, or the square
      bool is_scene = false;
      std::vector<unsigned int> ranks = {2, 3};
    };

    void PrintTo(const JoinedRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    /** The square with a soft material, in strains of a tenth. */
    std::vector<std::string> large(const std::string &model,
                                   const std::vector<std::string> &more)
    {
      std::vector<std::string> set = {
          "motion=large",
          "Material: bulk/model=" + model,
          "Material: bulk/Young modulus=3 GPa",
          "Boundary: left/velocity x=if(t < 25 ns, -60 m/s, 60 m/s)",
          "Boundary: right/velocity x=if(t < 25 ns, 60 m/s, -60 m/s)",
          "Time/end=40 ns",
          "Output/fields every=10 ns"};
      set.insert(set.end(), more.begin(), more.end());
      return set;
    }

    const std::string origin = "Mesh/lower corner=0, 0, 0",
                      corner = "Mesh/upper corner=10 um, 6 um, 6 um",
                      distorted = "Mesh/distortion=0.2";

    // forces of simplices, of quads and hexes, affine and not, and by blocks;
    // releases, contact and friction at the borders; supports, loads and an
    // obstacle; fronts that meet the ends of bars
    const std::vector<JoinedRow> rows = {
        {"triangles",
         {"dimension=2", "Mesh/type=crossed triangles", "Mesh/cells=6, 6",
          distorted}},
        {"isotropic", {"dimension=2", "Mesh/type=isotropic", "Mesh/cells=400"}},
        {"isotropic_tetrahedra",
         {"dimension=3", "Mesh/type=isotropic", origin, corner,
          "Mesh/cells=1500", "Time/end=6 ns"}},
        // cells are halved where it breaks, and joined again
        {"bisected",
         {"dimension=2", "Mesh/type=crossed triangles", "Mesh/cells=8, 8",
          "Interface: all/toughness=0.2 J/m^2", "Adaptivity/levels=2",
          "Adaptivity/ahead=0.02", "Indicator: front/type=process zone",
          "Indicator: front/cells=4", "Indicator: front/reach=0",
          "Indicator: front/traction=0.9", "Time/end=6 ns"}},
        {"bisected_isotropic",
         {"dimension=2", "Mesh/type=isotropic", "Mesh/cells=200",
          "Adaptivity/levels=1", "Adaptivity/ahead=0.3",
          "Indicator: front/type=process zone", "Indicator: front/cells=2",
          "Indicator: front/reach=0.5"}},
        {"quads", {"dimension=2", "Interface: all/restitution=0.2"}},
        {"rings",
         {"dimension=2", "plane=axisymmetric", "Mesh/lower corner=4 um, 0",
          "Mesh/upper corner=14 um, 10 um"}},
        // a full cylinder under a rough wall, also at its axis
        {"cylinder",
         {"dimension=2", "plane=axisymmetric", "Mesh/type=isotropic",
          "Mesh/cells=400", "Boundary: left/where=y < 1 nm",
          "Boundary: left/velocity x=0",
          "Boundary: left/velocity y=if(t < 10 ns, -3 m/s, 3 m/s)",
          "Obstacle: wall/where=y > 9.999 um", "Obstacle: wall/point=0, 10 um",
          "Obstacle: wall/normal=0, -1", "Obstacle: wall/friction=0.3"}},
        {"distorted_quads",
         {"dimension=2", distorted, "Mesh/cells=6, 6",
          "Discretization/degree=2", "Time/end=6 ns"}},
        {"graded",
         {"dimension=2", "Time/end=8 ns",
          "Material: bulk/Young modulus=135 GPa + "
          "if(x < 7 um, 0, 9 GPa * (x / 7 um - 1))"}},
        {"tetrahedra",
         {"dimension=3", "Mesh/type=tetrahedra", origin, corner,
          "Mesh/cells=4, 3, 2", distorted, "Time/end=12 ns"}},
        {"hexes",
         {"dimension=3", "Mesh/type=brick", origin, corner,
          "Mesh/cells=3, 2, 2", "Discretization/degree=3", "Time/end=5 ns"}},
        // grains that are turned, cells that flow
        {"textured_polycrystal",
         {"Mesh/cells=1500", "Mesh/grains=8", "Time/end=0.25 us"},
         true},
        {"flowing_quads",
         {"dimension=2", "Material: bulk/model=j2 plastic",
          "Material: bulk/yield stress=250 MPa", "Time/end=12 ns"}},
        {"flowing_tetrahedra",
         {"dimension=3", "Mesh/type=tetrahedra", origin, corner,
          "Mesh/cells=4, 3, 2", "Material: bulk/model=viscoplastic",
          "Material: bulk/yield stress=300 MPa",
          "Material: bulk/viscosity=0.1 Pa*s", "Time/end=9 ns"}},
        // cells of two and three sizes
        {"refined_quads",
         {"dimension=2", "Mesh/cells=5, 5", "Adaptivity/levels=2",
          "Indicator: near/type=region",
          "Indicator: near/region=abs(x - 4 um) < 1.5 um && y < 7 um",
          "Indicator: near/cell size=0.5 um", "Time/end=7 ns"}},
        {"refined_viscous",
         {"dimension=2", "Mesh/cells=5, 5", "Adaptivity/levels=1",
          "Indicator: near/type=region",
          "Indicator: near/region=abs(x - 4 um) < 1.5 um && y < 7 um",
          "Indicator: near/cell size=1 um", "Time/end=9 ns",
          "Material: bulk/shear viscosity=20 mPa*s",
          "Material: bulk/bulk viscosity=50 mPa*s"}},
        {"refined_hexes",
         {"dimension=3", "Mesh/type=brick", origin, corner,
          "Mesh/cells=4, 2, 2", "Discretization/degree=2",
          "Adaptivity/levels=2", "Indicator: near/type=region",
          "Indicator: near/region=(x - 5 um)^2 + (y - 2 um)^2 + (z - 6 um)^2 < "
          "(2.5 um)^2",
          "Indicator: near/cell size=1 um", "Time/end=5 ns"}},
        // motions of any size: frames turn, cells flow, steps change
        {"large_quads",
         large("neo-hookean",
               {"dimension=2", "Interface: all/restitution=0.2"}),
         false,
         {2, 4}},
        {"large_triangles",
         large("saint-venant kirchhoff",
               {"dimension=2", "Mesh/type=crossed triangles", "Mesh/cells=6, 6",
                distorted, "Loads/gravity=0, -1e9",
                "Boundary: top/traction x=20 MPa"}),
         false,
         {2, 4}},
        {"large_flowing_hexes",
         large("j2 plastic",
               {"dimension=3", "Mesh/type=brick", origin, corner,
                "Mesh/cells=4, 2, 2", "Material: bulk/yield stress=100 MPa",
                "Material: bulk/isotropic hardening modulus=1 GPa",
                "Interface: all/strength=120 MPa"}),
         false,
         {2, 4}},
        {"large_flowing_tetrahedra",
         large("viscoplastic",
               {"dimension=3", "Mesh/type=tetrahedra", origin, corner,
                "Mesh/cells=3, 2, 2", "Material: bulk/yield stress=100 MPa",
                "Material: bulk/viscosity=0.1 Pa*s",
                "Interface: all/strength=120 MPa"}),
         false,
         {2, 4}},
        // contacts, rigid bodies, obstacles: only the forces are divided
        {"large_contact",
         large("neo-hookean", {"dimension=2", "Contact: all/friction=0.3"}),
         false,
         {2, 4}},
        {"projectile",
         {"Body: plate/cells=4, 20", "Time/end=20 us"},
         true,
         {2, 4}},
        {"rigid_projectile",
         {"Body: plate/cells=4, 20", "Time/end=20 us"},
         true},
        {"taylor_bar",
         {with_mesh("taylor_bar_coarse.geo"), "Time/end=1 us"},
         true},
        {"taylor_axisymmetric", {"Time/end=2 us"}, true},
        {"spall_square", {"Mesh/cells=60, 1"}, true},
        {"plate_impact", {"Mesh/cells=80, 1"}, true},
        {"bar_wall", {"Mesh/cells=40, 1"}, true},
        {"viscous",
         {"dimension=2", "Time/end=9 ns",
          "Material: bulk/shear viscosity=20 mPa*s",
          "Material: bulk/bulk viscosity=50 mPa*s"}},
        {"pressure",
         {"dimension=2", "Time/end=9 ns",
          "Interface: all/crack pressure=20 MPa * (1 + x / 10 um)"}},
        {"dcb_dynamic", {"Constants/fine=2", "Time/end=1"}, true},
        {"rigid_punch", {"Time/end=15 us"}, true},
        // materials, faces and ends are groups of a file
        {"notched_plate", {"Time/end=3 us"}, true},
        {"notched_plate_3d", {"Time/end=0.5 us"}, true},
    };

    class JoinedRanksTest : public testing::TestWithParam<JoinedRow>
    {
    };
  } // namespace

  TEST_P(JoinedRanksTest, AreTheSameBitForBit)
  {
    const JoinedRow &row = GetParam();
    const Workspace workspace;
    const auto file = !row.is_scene ? workspace.path() / "square.prm"
                      : std::filesystem::exists(scene(row.name))
                          ? scene(row.name)
                          : benchmark(row.name);
    if (!row.is_scene)
      write_text(file, square);
    std::vector<std::string> set = {"Time/scheme=explicit", "Time/step=auto"};
    set.insert(set.end(), row.set.begin(), row.set.end());
    const Result one = good_run(workspace, "1 rank", {file, set});
    ASSERT_TRUE(one.completed());
    EXPECT_TRUE(row.is_scene || one.counter("released_points") > 0.);
    const auto fields = records(one, "fields");
    for (const unsigned int n : row.ranks) {
      SCOPED_TRACE(std::to_string(n) + " ranks");
      const Result several =
          good_run(workspace, std::to_string(n) + " ranks", {file, set, n});
      ASSERT_TRUE(several.completed());
      EXPECT_TRUE(one.history_text == several.history_text)
          << "history.csv differs by "
          << energy_difference(one.history, several.history);
      for (const char *key :
           {"errors", "penetration_max", "fragments", "steps"})
        EXPECT_EQ(one.summary[key], several.summary[key]) << key;
      for (const char *key :
           {"node_problems", "newton", "gauss_seidel_sweeps", "released_points",
            "active_points", "groups", "worst_excess_over_strength"})
        EXPECT_EQ(one.counter(key), several.counter(key)) << key;
      if (row.name.rfind("bisected", 0) == 0) {
        EXPECT_GT(one.counter("mesh_changes"), 1.);
        if (row.name == "bisected") {
          EXPECT_GT(one.counter("joined_halves"), 0.);
        }
        for (const char *key :
             {"mesh_changes", "joined_halves", "mesh_change_energy"})
          EXPECT_EQ(one.counter(key), several.counter(key)) << key;
      }
      EXPECT_TRUE(fields == records(several, "fields"));
    }
  }

  INSTANTIATE_TEST_SUITE_P(Table, JoinedRanksTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_joined_ranks
