#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>

// fragments.csv: what the pieces of a run are, whoever computed it.

namespace end_to_end::test_fragments
{
  namespace
  {
    // a plate that falls to pieces within a second or two
    const Launch breaking = {torn_plate(),
                             {"Mesh/cells=12, 9", "Time/step=0.4 us",
                              "Constants/turn=60 us", "Constants/pull=4 m/s",
                              "Time/end=120 us", "Output/fields every=20 us"}};

    std::string fragments_text(const Result &result)
    {
      return read_text(result.directory / "fragments.csv");
    }
  } // namespace

  TEST(FragmentTables, AddUpToTheRun)
  {
    const Workspace workspace;
    const Result result = good_run(workspace, "breaking", breaking);
    const History rows(fragments_text(result)); // a table like the other
    ASSERT_GT(rows.size(), 0u);
    std::map<double, std::vector<std::size_t>> times;
    for (std::size_t k = 0; k < rows.size(); ++k)
      times[rows["time"][k]].push_back(k);
    EXPECT_EQ(times.size(), 7u) << "at the start, every 20 us, at the end once";
    for (const auto &[time, fragments] : times) {
      double mass = 0., kinetic = 0., cells = 0., surface = 0.;
      for (std::size_t k = 0; k < fragments.size(); ++k) {
        EXPECT_EQ(rows["fragment"][fragments[k]], double(k));
        mass += rows["mass"][fragments[k]];
        kinetic += rows["kinetic"][fragments[k]];
        cells += rows["cells"][fragments[k]];
        surface += rows["surface"][fragments[k]];
        EXPECT_LE(rows["kinetic_translation"][fragments[k]] +
                      rows["kinetic_spin"][fragments[k]],
                  rows["kinetic"][fragments[k]] * (1. + 1e-12));
      }
      EXPECT_EQ(cells, result.number("cells"));
      const double all = rows["mass"][0];
      expect_below("mass", std::abs(mass - all) / all, 1e-14, "round-off");
      const auto &steps = result.history["time"];
      for (std::size_t k = 1; k < steps.size(); ++k) // it starts at rest
        if (steps[k] == time) {
          const double energy = result.history["kinetic"][k];
          expect_below("kinetic energy", std::abs(kinetic - energy) / energy,
                       1e-12, "the same masses and velocities");
          EXPECT_EQ(double(fragments.size()), result.history["fragments"][k]);
          const double broken = result.history["broken_area"][k];
          expect_below("surface", std::abs(surface - 2. * broken),
                       1e-12 * broken, "two sides of what is broken");
        }
    }
    const auto &sizes = result.summary.at("fragment_sizes");
    const auto &last = times.rbegin()->second;
    EXPECT_GT(last.size(), 1u);
    EXPECT_EQ(result.number("fragments"), double(last.size()));
    double numbers = 0.;
    for (const auto &number : sizes.at("histogram").at("numbers"))
      numbers += number.get<double>();
    EXPECT_EQ(numbers, double(last.size()));
    expect_below(
        "total mass",
        std::abs(sizes.at("total_mass").get<double>() - rows["mass"][0]) /
            rows["mass"][0],
        1e-14, "round-off");
    EXPECT_GT(result.summary["cost"]["parts"]["motion of fragments"]["calls"],
              6);
  }

  TEST(FragmentTables, AreTheSameOnSeveralRanks)
  {
    const Workspace workspace;
    Launch what = breaking;
    const std::string one = fragments_text(good_run(workspace, "one", what));
    for (const unsigned int ranks : {2u, 3u}) {
      what.ranks = ranks;
      EXPECT_TRUE(one == fragments_text(
                             good_run(workspace, std::to_string(ranks), what)))
          << ranks << " ranks";
    }
  }

  TEST(FragmentTables, AreOfScenesThatMayBreak)
  {
    const Workspace workspace;
    for (const char *whole : {"bar_wall", "rigid_motion", "mode"}) {
      const Result result = good_run(workspace, whole, {scene(whole)});
      EXPECT_FALSE(std::filesystem::exists(result.directory / "fragments.csv"))
          << whole;
      EXPECT_FALSE(result.summary.contains("fragment_sizes")) << whole;
    }
    const Result two = good_run(workspace, "two", {scene("two_body")});
    const History rows(fragments_text(two));
    EXPECT_EQ(rows["fragment"][0], 0.);
    EXPECT_EQ(rows["fragment"][1], 1.);
  }
} // namespace end_to_end::test_fragments
