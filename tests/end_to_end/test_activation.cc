#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

// Extrinsic laws are rigid until their strength is reached, and begin there.

namespace end_to_end::test_activation
{
  namespace
  {
    struct Law {
      std::string name, entries;
    };

    void PrintTo(const Law &law, std::ostream *stream) { *stream << law.name; }

    const std::vector<Law> laws = {
        {"camacho", "  set law = camacho-ortiz\n"},
        {"ppr", "  set law = ppr-extrinsic\n  set alpha = 4\n"},
        {"dugdale", "  set law = dugdale\n"}};

    /** A pulse runs through a body with a plane that may break. */
    std::string pulse(const unsigned int dimension, const std::string &plane)
    {
      const bool flat = dimension == 2;
      return std::string("# pulse.prm - a pulse meets a plane.\n") +
             "set dimension = " + (flat ? "2" : "3") + R"(
subsection Mesh
  set type         = )" +
             (flat ? "rectangle" : "brick") + R"(
  set upper corner = )" +
             (flat ? "20 mm, 5 mm" : "10 mm, 2 mm, 3 mm") + R"(
  set cells        = )" +
             (flat ? "40, 10" : "10, 2, 3") + R"(
end
subsection Material: steel
  set Young modulus      = 200 GPa
  set Poisson ratio      = 0.3
  set density            = 8000 kg/m^3
  set initial velocity x = if(x < 4 mm, 1 m/s * sin(pi * x / 4 mm)^2, 0)
  set initial velocity y = if(x < 4 mm, 0.3 m/s * sin(pi * x / 4 mm), 0)
end
subsection Interface: plane
  set where = abs(x - 7 mm) < 1 um
)" + plane + R"(end
subsection Interface: joints
  set law = rigid
end
subsection Time
  set end  = )" +
             (flat ? "8 us" : "4 us") + R"(
  set step = 0.5 courant
end
subsection Solver
  set tolerance = 1e-10
end
subsection Output
  set fields every = 0.5 us
end
)";
    }

    Result run_pulse(const Workspace &workspace, const std::string &name,
                     const unsigned int dimension, const std::string &plane)
    {
      const auto file = workspace.path() / (name + ".prm");
      write_text(file, pulse(dimension, plane));
      return good_run(workspace, name, {file});
    }

    double largest(const Result &result, const std::string &base,
                   const std::string &array)
    {
      double value = 0.;
      for (const Snapshot &snapshot : snapshots(result.directory, base))
        for (const double x : snapshot.at(array))
          value = std::max(value, std::abs(x));
      return value;
    }

    class ActivationTest : public testing::TestWithParam<Law>
    {
    };
  } // namespace

  // Below its strength the plane is not there: the waves are those of a body
  // that is joined for good.
  TEST_P(ActivationTest, BeforeItThePlaneIsRigid)
  {
    for (const unsigned int dimension : {2u, 3u}) {
      SCOPED_TRACE(dimension);
      const Workspace workspace;
      const Result joined = run_pulse(workspace, "joined", dimension,
                                      "  set law = rigid\n"),
                   law = run_pulse(workspace, "law", dimension,
                                   GetParam().entries +
                                       "  set strength  = 1 GPa\n"
                                       "  set toughness = 100 J/m^2\n");
      ASSERT_TRUE(joined.completed() && law.completed());
      ASSERT_GT(law.counter("cohesive_points"), 0.);
      EXPECT_EQ(law.dissipated("damage"), 0.);
      for (const std::string array : {"displacement", "velocity", "stress"})
        expect_below(
            "difference in " + array,
            field_difference(joined, law, "fields", array, "fields", array),
            1e-10, "the same waves");
      expect_below("energies", energy_difference(joined.history, law.history),
                   1e-10);
      expect_below("jump over displacement",
                   largest(law, "interfaces", "jump") /
                       largest(law, "fields", "displacement"),
                   1e-8, "tolerance 1e-10 per step, 100 steps");
      EXPECT_GT(largest(law, "fields", "stress"), 1e6) << "a wave runs";
    }
  }

  // The same up to the step in which the strength is reached.
  TEST_P(ActivationTest, UntilItThePlaneIsRigid)
  {
    for (const unsigned int dimension : {2u, 3u}) {
      SCOPED_TRACE(dimension);
      const Workspace workspace;
      const Result joined = run_pulse(workspace, "joined", dimension,
                                      "  set law = rigid\n"),
                   law = run_pulse(workspace, "law", dimension,
                                   GetParam().entries +
                                       "  set strength  = 8 MPa\n"
                                       "  set toughness = 100 J/m^2\n");
      ASSERT_TRUE(joined.completed() && law.completed());
      EXPECT_GT(law.dissipated("damage"), 0.);
      const std::size_t n = rows_without_damage(law.history);
      EXPECT_GT(n, 10u) << "the pulse has to come first";
      EXPECT_LT(n, law.history.size());
      expect_below("energies before",
                   energy_difference(joined.history, law.history, n), 1e-10);
    }
  }

  namespace
  {
    enum class Mode { opening, shear };

    /**
     * A rigid block on rigid ground under a load that rises slowly through the
     * strength of the face between them, 1e-4 of it per step. The load of shear
     * has its resultant in the face: the tractions are uniform.
     */
    std::string ramp(const unsigned int dimension, const Mode mode,
                     const std::string &law)
    {
      const bool flat = dimension == 2;
      const std::string up = flat ? "y" : "z";
      return std::string("# ramp.prm - a slow load opens a face.\n") +
             "set dimension = " + (flat ? "2" : "3") + R"(
subsection Constants
  set R = 1 MPa
  set H = 10 mm
end
subsection Mesh
  set type         = )" +
             (flat ? "rectangle" : "brick") + R"(
  set upper corner = )" +
             (flat ? "10 mm, 2 * H" : "10 mm, 10 mm, 2 * H") + R"(
  set cells        = )" +
             (flat ? "1, 2" : "1, 1, 2") + R"(
end
subsection Material: block
  set where   = )" +
             up + R"( > H
  set model   = rigid
  set density = 20000 kg/m^3
  set body force )" +
             (mode == Mode::opening
                  ? up + " = R / H"
                  : "x = R * 0.7 / H * (4 - 6 * (" + up + " - H) / H)") +
             R"( * (0.9 + t * 10 kHz)
end
subsection Material: ground
  set model   = rigid
  set density = 20000 kg/m^3
end
subsection Interface: face
  set where       = )" +
             up + R"( > 0
)" + law + R"(  set strength    = R
  set toughness   = 50 J/m^2
  set mode mixity = 0.7
end
subsection Boundary: )" +
             (flat ? "bottom" : "back") + R"(
  set velocity x = 0
  set velocity y = 0
)" + (flat ? "" : "  set velocity z = 0\n") +
             R"(end
subsection Time
  set end  = 12 us
  set step = 0.01 us
end
subsection Solver
  set tolerance = 1e-11
end
)";
    }
  } // namespace

  TEST_P(ActivationTest, TractionGoesOnFromTheStrength)
  {
    for (const unsigned int dimension : {2u, 3u})
      for (const Mode mode : {Mode::opening, Mode::shear}) {
        SCOPED_TRACE(std::to_string(dimension) + " dimensions, " +
                     (mode == Mode::opening ? "opening" : "shear"));
        const Workspace workspace;
        const auto file = workspace.path() / "ramp.prm";
        write_text(file, ramp(dimension, mode, GetParam().entries));
        // in 2D per metre of depth
        const double area = dimension == 2 ? 0.01 : 1e-4;
        // no energy balance: all energies are round-off until the face is
        // activated
        const Result result = run(workspace, "ramp", {file});
        ASSERT_TRUE(result.completed()) << result.description();
        EXPECT_LE(result.number("residual_max"), 1e-11);
        const double strength = mode == Mode::opening ? 1e6 : 0.7e6;
        const std::string column =
            std::string(dimension == 2 ? "reaction_bottom_"
                                       : "reaction_back_") +
            (mode == Mode::shear ? "x"
             : dimension == 2    ? "y"
                                 : "z");
        const auto &reaction = result.history[column];
        const auto traction = [&](const std::size_t i) {
          return std::abs(reaction[i]) / area / strength;
        };
        // the load in the middle of step i is 0.9 + 1e-4 (i - 1/2)
        const std::size_t n = rows_without_damage(result.history);
        EXPECT_EQ(n, 1001u) << "with the start";
        ASSERT_GT(result.history.size(), n + 100);
        for (std::size_t i = 1; i < n; ++i)
          ASSERT_NEAR(traction(i), 0.9 + 1e-4 * (double(i) - 0.5), 1e-9);
        expect_below("strength less the traction just before",
                     1. - traction(n - 1), 1e-4, "one step of the load");
        // Openings of 1e-17 m and, later, 1e-11 m of at least 50 um soften
        // nothing. In shear the excess e of the load turns the block as well:
        // a share of e of the traction is then normal, which leaves cos(e).
        const double turn = mode == Mode::shear ? 1. : 0.;
        expect_below("traction just after, over the strength, less 1",
                     std::abs(traction(n) - 1.), 1e-9 + turn * 10. * 1e-8,
                     "e = 1e-4");
        expect_below("100 steps later", std::abs(traction(n + 100) - 1.),
                     1e-6 + turn * 1e-4, "e = 1e-2");
      }
  }

  INSTANTIATE_TEST_SUITE_P(Laws, ActivationTest, testing::ValuesIn(laws),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_activation
