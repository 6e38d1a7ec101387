#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ostream>

// Every scene of prm/verification runs as it is, writes what a user is
// promised, and meets its exact solution.

namespace end_to_end::test_scenes
{
  namespace
  {
    namespace fs = std::filesystem;

    /** |measured - value| <= tolerance; most are errors with the value 0. */
    struct Bound {
      std::string key;
      double tolerance;
      std::string reason;
      double value = 0.;
    };

    struct SceneRow {
      std::string name;
      std::vector<Bound> bounds;
      /// m, beyond the bound that the run reports for itself
      double overlap_at_start = 0.;
    };

    std::vector<Bound> bounds_of(const nlohmann::json &entry)
    {
      std::vector<Bound> bounds;
      for (const auto &[key, bound] : entry.at("bounds").items())
        bounds.push_back({key, bound.at("tolerance").get<double>(),
                          bound.at("reason").get<std::string>(),
                          bound.value("value", 0.)});
      return bounds;
    }

    /** source/verification/NAME/bounds.json, by scene. */
    nlohmann::json read_bounds()
    {
      nlohmann::json all = nlohmann::json::object();
      for (const auto &folder : fs::directory_iterator(
               fs::path(NSFD_SOURCE_DIR) / "source/verification"))
        if (fs::exists(folder.path() / "bounds.json")) {
          const auto scenes =
              nlohmann::json::parse(read_text(folder.path() / "bounds.json"));
          all.insert(scenes.begin(), scenes.end());
        }
      return all;
    }

    const nlohmann::json &all_bounds()
    {
      static const nlohmann::json all = read_bounds();
      return all;
    }

    SceneRow row_of(const std::string &name)
    {
      const auto row = all_bounds().find(name);
      if (row == all_bounds().end())
        return {name, {}};
      return {name, bounds_of(*row), row->value("overlap at start", 0.)};
    }

    std::vector<std::string> all_scenes()
    {
      std::vector<std::string> names;
      for (const auto &file :
           fs::directory_iterator(scene("ball").parent_path()))
        if (file.path().extension() == ".prm")
          names.push_back(file.path().stem().string());
      std::sort(names.begin(), names.end());
      return names;
    }

    /** The files every run promises, with the header of history.csv. */
    void expect_all_files(const Result &result)
    {
      for (const char *name :
           {"parameters.prm", "run.json", "history.csv", "summary.json",
            "fields.pvd", "interfaces.pvd", "report.html"})
        EXPECT_GT(fs::exists(result.directory / name)
                      ? fs::file_size(result.directory / name)
                      : 0,
                  0)
            << name;

      const std::string header =
          result.history_text.substr(0, result.history_text.find('\n'));
      EXPECT_EQ(header.rfind(
                    "step,time,time_step,kinetic,elastic,cohesive,damage,"
                    "friction,viscous,plastic,impact,numerical,work,"
                    "ledger_defect,broken_area,fragments,active,newton,krylov,"
                    "residual",
                    0),
                0)
          << header;
      const auto &names = result.history.names();
      const bool in_space = !names.empty() && names.back().back() == 'z';
      const std::size_t dim = in_space ? 3 : 2;
      EXPECT_EQ((names.size() - 20) % dim, 0);
      for (std::size_t i = 20; i < names.size(); ++i) {
        EXPECT_EQ(names[i].rfind("reaction_", 0), 0) << names[i];
        EXPECT_EQ(names[i].substr(names[i].size() - 2),
                  std::string("_") + "xyz"[(i - 20) % dim]);
      }
      EXPECT_EQ(double(result.history.size()), result.number("steps") + 1.)
          << "with the start";

      for (const char *key :
           {"completed", "steps", "dofs", "interface_points", "final_time",
            "wall_seconds", "peak_memory_mb", "energy", "dissipated", "work",
            "ledger_defect_max", "residual_max", "penetration_max", "counters",
            "errors", "fragments"})
        EXPECT_TRUE(result.summary.contains(key)) << key;
      for (const char *key : {"kinetic", "elastic", "cohesive"})
        EXPECT_TRUE(result.summary["energy"].contains(key)) << key;
      for (const char *key :
           {"damage", "friction", "viscous", "plastic", "impact", "numerical"})
        EXPECT_TRUE(result.summary["dissipated"].contains(key)) << key;
      const auto info =
          nlohmann::json::parse(read_text(result.directory / "run.json"));
      for (const char *key : {"version", "git_hash", "libraries",
                              "command_line", "ranks", "seeds", "parts"})
        EXPECT_TRUE(info.contains(key)) << key;

      // what the series name is there
      for (const std::string base : {"fields", "interfaces"}) {
        const std::string pvd = read_text(result.directory / (base + ".pvd"));
        std::size_t n_files = 0;
        for (std::size_t at = pvd.find("file=\""); at != std::string::npos;
             at = pvd.find("file=\"", at + 1), ++n_files) {
          const std::string name =
              pvd.substr(at + 6, pvd.find('"', at + 6) - at - 6);
          EXPECT_TRUE(fs::exists(result.directory / name)) << name;
        }
        EXPECT_GE(n_files, 2) << "start and end, " << base;
      }
    }

    /** No line of the energy balance does what physics forbids. */
    void expect_sound_history(const Result &result,
                              const double energy_scale = 0.)
    {
      const History &history = result.history;
      const double scale = std::max(history.largest_energy(), energy_scale);
      double healing = 0., gain = 0., rubbing_gain = 0., not_finite = 0.;
      const auto fall = [&](const char *name, const std::size_t i) {
        const auto &column = history[name];
        return (i ? column[i - 1] : 0.) - column[i];
      };
      for (std::size_t i = 0; i < history.size(); ++i) {
        healing = std::max(healing, fall("damage", i));
        healing = std::max(healing, fall("broken_area", i));
        gain = std::max(gain, fall("impact", i) / scale);
        rubbing_gain = std::max(rubbing_gain, fall("friction", i) / scale);
        for (const std::string &name : history.names())
          not_finite += !std::isfinite(history[name][i]);
      }
      EXPECT_EQ(not_finite, 0.);
      EXPECT_EQ(healing, 0.) << "damage never falls";
      const double tolerance = std::max(
          1e-12, 0.1 * std::strtod(entry(result.directory / "parameters.prm",
                                         "tolerance")
                                       .c_str(),
                                   nullptr));
      expect_below("energy gained at an impact, per step", gain, tolerance,
                   "theta <= 1/(1+e): no impact creates energy");
      // possible on slip reversal, but then summed and named
      expect_below("energy gained by friction, not named",
                   rubbing_gain -
                       result.number("positive_friction_work") / scale,
                   tolerance);
    }

    void expect_penetration_within_bound(const Result &result,
                                         const double overlap)
    {
      // of the largest displacement: what a closed contact drifts by
      double size = 0.;
      for (const Snapshot &snapshot : snapshots(result.directory, "fields"))
        for (const double u : snapshot.at("displacement"))
          size = std::max(size, std::abs(u));
      const double noise = 1e-9 * size;
      EXPECT_LE(result.number("penetration_max"),
                result.number("penetration_bound") + overlap + noise);
      EXPECT_LE(result.counter("penetration_excess"), overlap + noise)
          << "at one point";
    }

    class SceneTest : public testing::TestWithParam<std::string>
    {
    };
  } // namespace

  TEST(Scenes, EveryFileHasARow)
  {
    for (const std::string &name : all_scenes())
      EXPECT_FALSE(row_of(name).bounds.empty())
          << name << ".prm has no bounds.json in source/verification";
    for (const auto &[name, row] : all_bounds().items())
      EXPECT_TRUE(fs::exists(scene(name))) << name;
  }

  TEST_P(SceneTest, MeetsItsExactSolution)
  {
    const SceneRow row = row_of(GetParam());
    Launch what{scene(row.name)};
    what.report = true;
    const Workspace workspace;
    const Result result = good_run(workspace, row.name, what);
    ASSERT_TRUE(result.completed());
    for (const Bound &bound : row.bounds)
      expect_below(bound.key, std::abs(result.error(bound.key) - bound.value),
                   bound.tolerance, bound.reason);
    expect_all_files(result);
    expect_sound_history(result);
    expect_penetration_within_bound(result, row.overlap_at_start);
  }

  INSTANTIATE_TEST_SUITE_P(Table, SceneTest, testing::ValuesIn(all_scenes()),
                           [](const auto &info) { return info.param; });

  // Damage, contact and friction in one: no exact solution, but a energy
  // balance.
  TEST(Scenes, TornPlate)
  {
    Launch what{torn_plate()};
    what.report = true;
    const Workspace workspace;
    const Result result = good_run(workspace, "torn_plate", what);
    ASSERT_TRUE(result.completed());
    expect_all_files(result);
    expect_sound_history(result);
    EXPECT_GT(result.dissipated("damage"), 0.);
    EXPECT_GT(result.dissipated("friction"), 0.);
    EXPECT_GE(result.number("fragments"), 2);
    EXPECT_LE(result.number("penetration_max"),
              result.number("penetration_bound"));
  }

  // The scene every user runs first: a crack that branches and rubs, and all
  // lines of the certificate are ok.
  TEST(Scenes, Quickstart)
  {
    Launch what{prm_folder() / "quickstart.prm"};
    what.report = true;
    const Workspace workspace;
    const Result result = good_run(workspace, "quickstart", what);
    ASSERT_TRUE(result.completed());
    expect_all_files(result);
    expect_sound_history(result);
    EXPECT_TRUE(result.summary["certificate"]["ok"]);
    EXPECT_GT(result.dissipated("friction"), 0.);
    // the notch and two arms separate the plate into two halves and a wedge
    EXPECT_GE(result.number("fragments"), 3);
  }

  // Short steps only while a face softens: each of them has one solution, and
  // then none is rejected.
  TEST(Scenes, TornPlateWithAutomaticSteps)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "auto",
                 {torn_plate(), {"Time/step=auto", "Output/fields=false"}});
    ASSERT_TRUE(result.completed());
    expect_sound_history(result);
    EXPECT_EQ(result.counter("steps_beyond_uniqueness"), 0.);
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
    EXPECT_GE(result.number("fragments"), 2);
    // Courant number 1/2 before the crack, 1/8 while it runs
    const auto &steps = result.history["time_step"];
    const double longest = *std::max_element(steps.begin(), steps.end());
    EXPECT_EQ(steps[1], longest);
    EXPECT_DOUBLE_EQ(*std::min_element(steps.begin() + 1, steps.end()),
                     longest / 4.);
  }

  // A separation takes G at any step; with a fine one it also comes in time.
  class MidplaneStepTest : public testing::TestWithParam<double>
  {
  };

  TEST_P(MidplaneStepTest, TakesTheToughnessAtAnyStep)
  {
    const double courant = GetParam();
    const Workspace workspace;
    const Result result =
        good_run(workspace, "midplane",
                 {scene("midplane"),
                  {"Time/step=" + std::to_string(courant) + " courant",
                   "Output/fields=false"}});
    ASSERT_TRUE(result.completed());
    expect_below("damage over 5 uJ/m, less 1",
                 std::abs(result.dissipated("damage") / 5e-6 - 1.), 1e-4);
    EXPECT_EQ(result.number("fragments"), 2);
    // symmetric: both grips pull alike
    expect_below("asymmetry of the reactions",
                 column_difference(result.history, "reaction_right_x",
                                   result.history, "reaction_left_x", -1.),
                 1e-5, "solver tolerance 1e-8 per step");
    if (courant < 0.3) {
      expect_below("separation time over 5.63 ns, less 1",
                   std::abs(result.error("separation_time") / 5.63e-9 - 1.),
                   0.02);
      expect_below("peak force over 3.50 kN/m, less 1",
                   std::abs(result.error("peak_force") / 3.50e3 - 1.), 0.05);
    }
  }

  INSTANTIATE_TEST_SUITE_P(Crossings, MidplaneStepTest,
                           testing::Values(5., 1., 0.2), [](const auto &info) {
                             return "step_" + std::to_string(info.index);
                           });

  // The energy decides how fast a crack runs, not the shape of the law.
  TEST(Scenes, LawsOfEqualToughnessRunAtEqualSpeed)
  {
    const Workspace workspace;
    std::map<std::string, double> speed;
    for (const std::vector<std::string> &law :
         {std::vector<std::string>{"Interface: plane/law=camacho-ortiz"},
          {"Interface: plane/law=ppr-extrinsic", "Interface: plane/alpha=3"}}) {
      std::vector<std::string> set = {"Output/fields=false"};
      set.insert(set.end(), law.begin(), law.end());
      const Result result = good_run(workspace, "strip, " + law[0].substr(18),
                                     {scene("strip"), set});
      ASSERT_TRUE(result.completed());
      speed[law[0]] = result.error("speed_over_rayleigh");
      expect_below(law[0] + ": speed over Rayleigh speed", speed[law[0]], 1.);
      EXPECT_GT(speed[law[0]], 0.85);
    }
    expect_below("difference of the speeds",
                 std::abs(speed.begin()->second / speed.rbegin()->second - 1.),
                 0.02, "equal toughness");
  }

  // What the opening texts of the scenes say about other settings.
  struct Variant {
    std::string name, scene;
    std::vector<std::string> set;
    std::vector<Bound> bounds;
    double energy_scale = 0.; ///< J, where hardly anything moves
  };

  std::vector<Variant> all_variants()
  {
    std::vector<Variant> result;
    for (const auto &[scene, row] : all_bounds().items()) {
      const auto variants = row.value("variants", nlohmann::json::object());
      for (const auto &[name, variant] : variants.items())
        result.push_back(
            {name, scene, variant.at("set").get<std::vector<std::string>>(),
             bounds_of(variant), variant.value("energy scale", 0.)});
    }
    return result;
  }

  void PrintTo(const Variant &variant, std::ostream *stream)
  {
    *stream << variant.scene << " " << variant.name;
  }

  class SceneVariantTest : public testing::TestWithParam<Variant>
  {
  };

  TEST_P(SceneVariantTest, MeetsItsExactSolution)
  {
    const Variant &variant = GetParam();
    const Workspace workspace;
    Launch what{scene(variant.scene), variant.set};
    what.energy_scale = variant.energy_scale;
    const Result result = good_run(workspace, variant.name, what);
    ASSERT_TRUE(result.completed());
    for (const Bound &bound : variant.bounds)
      expect_below(bound.key, std::abs(result.error(bound.key) - bound.value),
                   bound.tolerance, bound.reason);
    expect_sound_history(result, variant.energy_scale);
  }

  INSTANTIATE_TEST_SUITE_P(Table, SceneVariantTest,
                           testing::ValuesIn(all_variants()),
                           [](const auto &info) {
                             return info.param.scene + "_" + info.param.name;
                           });

  // Six components of an array are, for ParaView, XX YY ZZ XY YZ XZ.
  TEST(Scenes, StressIsInTheOrderOfParaView)
  {
    const Workspace workspace;
    const auto file = workspace.path() / "strained.prm";
    write_text(file, R"(# strained - a cube with six different stresses.
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 1, 1, 1
  set cells        = 2, 1, 1
end
subsection Material: cube
  set Young modulus          = 2 MPa
  set Poisson ratio          = 0
  set density                = 1000
  set initial displacement x = 1e-6 * (x + 7 * y)
  set initial displacement y = 1e-6 * (2 * y + 8 * z)
  set initial displacement z = 1e-6 * (3 * z + 9 * x)
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end = 1 ns
end
)");
    const Result result = good_run(workspace, "strained", {file});
    ASSERT_TRUE(result.completed());
    const Snapshot start = snapshots(result.directory, "fields").front();
    // E e_ii = 2 e_ii and G gamma_ij = gamma_ij, in Pa
    const std::array<double, 6> exact = {{2., 4., 6., 7., 8., 9.}};
    const std::vector<double> &stress = start.at("stress");
    ASSERT_EQ(stress.size(), 2 * start.at("Points").size());
    for (std::size_t i = 0; i < stress.size(); ++i)
      ASSERT_NEAR(stress[i], exact[i % 6], 1e-9) << "component " << i % 6;
  }
} // namespace end_to_end::test_scenes
