#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

// Faces that break at once, hardly cost anything, or never break.

namespace end_to_end::test_fracture_extremes
{
  namespace
  {
    /** A bar, stretched to 1.01 times the strength of its middle, is freed. */
    std::string stretched(const std::string &law)
    {
      return R"(# stretched.prm - a stretched bar between two grips.
set dimension = 2
subsection Constants
  set R = 10 MPa
  set E = 200 GPa
  set L = 1 m
end
subsection Mesh
  set type         = rectangle
  set upper corner = L, 5 mm
  set cells        = 100, 1
end
subsection Material: bar
  set Young modulus          = E
  set Poisson ratio          = 0
  set density                = 8000 kg/m^3
  set initial displacement x = 1.01 * R / E * x
end
subsection Interface: middle
  set where = abs(x - 0.5 * L) < 1 mm
)" + law + R"(end
subsection Interface: joints
  set law = rigid
end
subsection Boundary: left
  set velocity x = 0
end
subsection Boundary: right
  set velocity x = 0
end
subsection Time
  set end  = 150 us
  set step = 0.5 courant
end
subsection Solver
  set tolerance = 1e-10
end
)";
    }

    // E eps^2/2 times volume, J per metre of depth
    const double elastic_energy = 0.5 * 10.1e6 * 10.1e6 / 200e9 * 5e-3;

    Result run_text(const Workspace &workspace, const std::string &name,
                    const std::string &text,
                    const std::vector<std::string> &set = {})
    {
      const auto file = workspace.path() / (name + ".prm");
      write_text(file, text);
      return good_run(workspace, name, {file, set});
    }
  } // namespace

  // G is 1e-12 of the elastic energy: it breaks within a step, which takes G
  // and not more; the rest is kinetic when the release has reached both grips.
  TEST(Extremes, HardlyAnyToughness)
  {
    const double toughness = 1e-12 * elastic_energy / 5e-3;
    char number[32];
    std::snprintf(number, sizeof number, "%.17g", toughness);
    const Workspace workspace;
    for (const std::string law :
         {"camacho-ortiz", "dugdale", "ppr-extrinsic\n  set alpha = 3"}) {
      SCOPED_TRACE(law);
      const Result result = run_text(
          workspace, law.substr(0, law.find('\n')),
          stretched("  set law = " + law +
                    "\n  set strength = R\n  set toughness = " + number +
                    " J/m^2\n"));
      ASSERT_TRUE(result.completed());
      const History &history = result.history;
      EXPECT_EQ(rows_without_damage(history), 1u) << "the start";
      EXPECT_NEAR(history["broken_area"][1], 5e-3, 1e-12);
      for (std::size_t i = 1; i < history.size(); ++i)
        EXPECT_NEAR(history["damage"][i] / (toughness * 5e-3), 1., 1e-9);
      EXPECT_EQ(result.number("fragments"), 2);
      EXPECT_EQ(result.counter("rejected_steps"), 0.);
      // at 100 us each half is at rest in length and moves as a whole
      const auto &kinetic = history["kinetic"];
      const double most = *std::max_element(kinetic.begin(), kinetic.end());
      expect_below("elastic energy less the largest kinetic energy",
                   1. - most / elastic_energy, 2e-2,
                   "a front of some cells, of 100");
      expect_below("kinetic energy beyond it", most / elastic_energy - 1.,
                   1e-9);
    }
  }

  // G is 1e12 times the elastic energy: a law that is elastic up to its peak
  // is the elastic joint.
  TEST(Extremes, ToughnessOutOfReach)
  {
    const Workspace workspace;
    const Result elastic =
        run_text(workspace, "elastic",
                 stretched("  set law = elastic\n"
                           "  set normal stiffness = 10 * E / L\n"));
    ASSERT_TRUE(elastic.completed());
    char number[32];
    std::snprintf(number, sizeof number, "%.17g", 1e12 * elastic_energy / 5e-3);
    const std::string given =
        "  set stiffness = 10 * E / L\n  set toughness = " +
        std::string(number) + " J/m^2\n";
    for (const std::string law : {"michel-suquet", "brittle"}) {
      SCOPED_TRACE(law);
      const Result result = run_text(
          workspace, law, stretched("  set law = " + law + "\n" + given));
      ASSERT_TRUE(result.completed());
      EXPECT_EQ(result.history["broken_area"].back(), 0.);
      for (const std::string array : {"displacement", "velocity", "stress"})
        expect_below(
            law + ", " + array,
            field_difference(elastic, result, "fields", array, "fields", array),
            1e-10, "the same springs");
      EXPECT_EQ(result.dissipated("damage"), 0.);
    }
  }

  namespace
  {
    /** escape.prm with a law whose traction jumps. */
    std::vector<std::string> jumping(const std::string &law,
                                     const std::string &step,
                                     const std::string &speed)
    {
      std::vector<std::string> set = {"Interface: well/law=" + law,
                                      "Interface: well/where=y > 0",
                                      "Time/step=" + step,
                                      "Time/end=1 ms",
                                      "Material: block/initial velocity y=" +
                                          speed,
                                      "Output/fields=false"};
      return set;
    }
  } // namespace

  // One step across the jump of a law: the block is out with the energy that
  // is left, or still in with all of it; never in between, and each time the
  // same.
  TEST(Extremes, OneStepAcrossTheJumpOfALaw)
  {
    const double G = 50., area = 0.01, mass = 2.;
    const Workspace workspace;
    unsigned int n = 0, n_broken = 0, n_held = 0;
    for (const std::string law : {"dugdale", "brittle"})
      for (const std::string step : {"2 us", "100 us", "250 us"})
        for (const std::string speed : {"0.7 m/s", "1 m/s"}) {
          SCOPED_TRACE(law + ", step " + step + ", speed " + speed);
          const std::string name = "run " + std::to_string(n++);
          const Launch what{scene("escape"), jumping(law, step, speed)};
          const Result result = good_run(workspace, name, what),
                       again = good_run(workspace, name + " again", what);
          ASSERT_TRUE(result.completed() && again.completed());
          EXPECT_EQ(result.history_text, again.history_text);
          EXPECT_EQ(result.counter("rejected_steps"), 0.);
          EXPECT_LE(result.number("steps"),
                    std::ceil(1e-3 / (std::stod(step) * 1e-6)) + 1.);
          const History &history = result.history;
          const double start = 0.5 * mass * std::stod(speed) * std::stod(speed);
          bool broken = false;
          for (std::size_t i = 0; i < history.size(); ++i) {
            const double damage = history["damage"][i] / (G * area);
            const double out = history["broken_area"][i] / area;
            EXPECT_TRUE(out < 1e-9 || std::abs(out - 1.) < 1e-9) << out;
            EXPECT_GE(damage, 0.);
            EXPECT_LE(damage, 1. + 1e-12);
            broken = out > 0.5;
            if (broken) {
              EXPECT_NEAR(damage, 1., 1e-12);
              EXPECT_NEAR(history["kinetic"][i], start - G * area,
                          1e-9 * start);
            }
          }
          ++(broken ? n_broken : n_held);
          // a step whose impulse R h stops the block lets no face go
          EXPECT_TRUE(!broken || start > G * area);
          const double impulse = 1e6 * area * std::stod(step) * 1e-6;
          EXPECT_TRUE(broken || start < G * area ||
                      mass * std::stod(speed) < impulse);
        }
    EXPECT_GT(n_broken, 0u);
    EXPECT_GT(n_held, 0u);
  }
} // namespace end_to_end::test_fracture_extremes
