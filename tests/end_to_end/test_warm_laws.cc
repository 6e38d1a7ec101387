#include "program.h"
#include "restart.h"
#include "rubbing_block.h"

#include <gtest/gtest.h>

#include <cmath>

// Strength, toughness and friction that depend on temperature: against
// formulas, in every scheme; heat and energy are kept as without them.

namespace end_to_end::test_warm_laws
{
  namespace
  {
    Result warm_run(const Workspace &workspace, const std::string &name,
                    const std::string &scene,
                    const std::vector<std::string> &set,
                    const unsigned int ranks = 1)
    {
      const auto file = workspace.path() / (name + ".prm");
      write_text(file, scene);
      return good_run(workspace, name, {file, set, ranks});
    }

    double heat(const Result &result, const std::string &name)
    {
      return result.summary.at("heat").at(name).get<double>();
    }

    const std::vector<std::string> explicit_steps = {"Time/scheme=explicit"};
    std::vector<std::string> implicit_steps(const std::string &step)
    {
      return {"Time/scheme=moreau-jean", "Time/step=" + step};
    }

    std::vector<std::string> and_more(std::vector<std::string> one,
                                      const std::vector<std::string> &more)
    {
      one.insert(one.end(), more.begin(), more.end());
      return one;
    }

    /** A cell that is dragged as a whole over a plane. */
    std::string dragged(const unsigned int dim)
    {
      const std::string more = dim == 2 ? "" : ", 1 mm",
                        zero = dim == 2 ? "" : ", 0";
      return "set dimension = " + std::to_string(dim) + R"(
subsection Mesh
  set type         = )" +
             (dim == 2 ? "rectangle" : "brick") + R"(
  set upper corner = 1 mm, 1 mm)" +
             more + R"(
  set cells        = 1, 1)" +
             (dim == 2 ? "" : ", 1") + R"(
end
subsection Material: lining
  set Young modulus       = 2 GPa
  set Poisson ratio       = 0
  set density             = 2000 kg/m^3
  set heat capacity       = 0.1 J/kg/K
  set initial temperature = 300 K
  set initial velocity x  = 10 m/s
end
subsection Interface: all
  set law = joined
end
subsection Obstacle: disc
  set where                    = bottom
  set point                    = 0, 0)" +
             zero + R"(
  set normal                   = 0, 1)" +
             zero + R"(
  set friction                 = 0.4
  set friction at temperatures = 300 K : 1, 900 K : 0.25
end
subsection Boundary: left
  set velocity x = 10 m/s
end
subsection Boundary: right
  set velocity x = 10 m/s
end
subsection Boundary: top
  set pressure = 10 kPa * min(1, t / 0.1 ms)
end
subsection Time
  set end = 1 ms
end
)";
    }

    // The corners at the plane have the heat: rho c H / 2 dT/dt = mu(T) p V
    // with mu = mu_0 (1 - a (T - T_0)), so that a (T - T_0) = 1 - exp(-a s int
    // p dt), s = 2 mu_0 V / (rho c H).
    TEST(WarmLaws, FrictionThatFadesWarmsByAnExponential)
    {
      const Workspace workspace;
      const double capacity = 2000. * 0.1 * 1e-3 / 2., a = 0.75 / 600.,
                   pushed = 10e3 * (1e-3 - 0.1e-3 / 2.);
      const double s = 0.4 * 10. / capacity;
      const double rise = (1. - std::exp(-a * s * pushed)) / a;
      for (const unsigned int dim : {2u, 3u})
        for (const auto &set : {explicit_steps, implicit_steps("1 us")}) {
          const Result result = warm_run(
              workspace, set.front().substr(12, 4) + std::to_string(dim),
              dragged(dim), set);
          const std::string what = set.front() + result.description();
          // steps of h take friction at their start: a share a s p h / 2
          EXPECT_NEAR((heat(result, "hottest") - 300.) / rise, 1., 5e-4)
              << what;
          const double area = dim == 2 ? 1e-3 : 1e-6;
          EXPECT_NEAR(heat(result, "made") / (capacity * area * rise), 1., 5e-4)
              << what;
          EXPECT_NEAR(heat(result, "stored") / heat(result, "made"), 1., 1e-12)
              << what;
        }
    }

    /** Pulled apart in the middle, where it is at 450 K. */
    const std::string bar = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 10 mm, 1 mm
  set cells        = 10, 1
end
subsection Material: bar
  set Young modulus       = 20 GPa
  set Poisson ratio       = 0
  set density             = 2000 kg/m^3
  set heat capacity       = 0.5 J/kg/K
  set initial temperature = 450 K
end
subsection Interface: middle
  set where     = abs(x - 5 mm) < 1 um
  set law       = camacho-ortiz
  set strength  = 10 MPa
  set toughness = 50 J/m^2
end
subsection Interface: rest
  set law = joined
end
subsection Boundary: left
  set velocity x = 0
end
subsection Boundary: right
  set velocity x = 0.2 m/s
end
subsection Time
  set end = 0.2 ms
end
)";

    const std::vector<std::string> warm_bar = {
        "Interface: middle/strength at temperatures=300 K : 1, 600 K : 0.7",
        "Interface: middle/toughness at temperatures="
        "300 K : 1, 500 K : 0.6, 900 K : 0.2"};
    const double strength_at_450 = 0.85, toughness_at_450 = 0.7;

    // It is that of a law with 0.85 of the strength and 0.7 of the toughness.
    // What breaks warms its faces by 35 K: they dissipate the
    // toughness of the temperature at which they began to soften.
    TEST(WarmLaws, BarBreaksAtTheStrengthOfItsTemperature)
    {
      const Workspace workspace;
      const double toughness = toughness_at_450 * 50. * 1e-3;
      for (const auto &scheme : {explicit_steps, implicit_steps("0.1 us")}) {
        const std::string name = scheme.front().substr(12, 4);
        const Result warm =
            warm_run(workspace, name, bar, and_more(scheme, warm_bar));
        const Result scaled =
            warm_run(workspace, name + "_scaled", bar,
                     and_more(scheme, {"Interface: middle/strength=8.5 MPa",
                                       "Interface: middle/toughness=35"}));
        EXPECT_GT(heat(warm, "hottest"), 480.) << name;
        EXPECT_NEAR(warm.dissipated("damage") / toughness, 1., 1e-9) << name;
        ASSERT_EQ(warm.history.size(), scaled.history.size()) << name;
        // softening magnifies the round-off of scaled laws by 1e7 until the end
        const double largest = scaled.history.largest_energy();
        for (const char *line : {"kinetic", "elastic", "damage", "heat"})
          for (std::size_t k = 0; k < warm.history.size() &&
                                  scaled.history["damage"][k] < 0.9 * toughness;
               ++k)
            ASSERT_NEAR(warm.history[line][k], scaled.history[line][k],
                        1e-8 * largest)
                << name << line << k;
        // and is not that of 293 K
        const Result cold = warm_run(workspace, name + "_cold", bar, scheme);
        EXPECT_NEAR(cold.dissipated("damage") / (50. * 1e-3), 1., 1e-9) << name;
      }
    }

    // In equilibrium the joint is rigid up to U = s L / E; then the force falls
    // along a line to 0 at U = d_c = 2 G / s.
    TEST(WarmLaws, BarSoftensInEquilibriumAsItsTemperatureSays)
    {
      const Workspace workspace;
      const Result result =
          warm_run(workspace, "static", bar,
                   and_more(warm_bar, {"Time/scheme=quasi-static",
                                       "Time/end=1 s", "Time/step=0.02 s",
                                       "Boundary: right/velocity x=10 um/s"}));
      const double s = strength_at_450 * 10e6, G = toughness_at_450 * 50.,
                   peak = s * 10e-3 / 20e9, end = 2. * G / s;
      EXPECT_NEAR(result.dissipated("damage") / (G * 1e-3), 1., 1e-8);
      for (std::size_t k = 0; k < result.history.size(); ++k) {
        const double U = 10e-6 * result.history["time"][k];
        const double part = U < peak  ? U / peak
                            : U < end ? (end - U) / (end - peak)
                                      : 0.;
        EXPECT_NEAR(result.history["reaction_right_x"][k] / (s * 1e-3), part,
                    1e-7)
            << U;
      }
    }

    /** The rubbing block, whose faces become warm and weak at once. */
    const std::vector<std::string> warm_block = {
        "Material: lining/heat capacity=2 J/kg/K",
        "Interface: all/strength at temperatures=293 K : 1, 320 K : 0.5",
        "Interface: all/toughness at temperatures=293 K : 1, 320 K : 0.7",
        "Interface: all/friction at temperatures=293 K : 1, 350 K : 0.2",
        "Obstacle: disc/friction at temperatures=293 K : 1, 350 K : 0.5"};

    const std::vector<std::string> cold_block = {
        "Material: lining/heat capacity=2 J/kg/K",
        "Interface: all/strength at temperatures=293 K : 1",
        "Interface: all/toughness at temperatures=293 K : 1",
        "Interface: all/friction at temperatures=293 K : 1",
        "Obstacle: disc/friction at temperatures=293 K : 1"};

    TEST(WarmLaws, KeepHeatAndEnergy)
    {
      const Workspace workspace;
      for (const auto &scheme :
           {explicit_steps, implicit_steps("2 us"),
            and_more(implicit_steps("2 us"), {"Time/theta=1"})}) {
        const std::string name = scheme.back().substr(5, 5);
        const Result warm = warm_run(workspace, name, rubbing_block,
                                     and_more(scheme, warm_block));
        const double taken =
            warm.dissipated("damage") + warm.dissipated("friction");
        EXPECT_GT(warm.dissipated("damage"), 0.02 * taken) << name;
        EXPECT_GT(warm.dissipated("friction"), 0.02 * taken) << name;
        EXPECT_NEAR(heat(warm, "made") / taken, 1., 1e-12) << name;
        EXPECT_NEAR(heat(warm, "stored") / taken, 1., 1e-12) << name;
        const Result cold = warm_run(workspace, name + "_cold", rubbing_block,
                                     and_more(scheme, cold_block));
        EXPECT_LT(warm.dissipated("friction"),
                  0.9 * cold.dissipated("friction"))
            << name;
        EXPECT_GT(warm.history["broken_area"].back(),
                  1.05 * cold.history["broken_area"].back())
            << name;
      }
    }

    TEST(WarmLaws, AreTheSameOnAnyRanks)
    {
      const Workspace workspace;
      const auto set = and_more(explicit_steps, warm_block);
      const Result one = warm_run(workspace, "1", rubbing_block, set);
      for (const unsigned int ranks : {2u, 3u})
        EXPECT_EQ(warm_run(workspace, std::to_string(ranks), rubbing_block, set,
                           ranks)
                      .history_text,
                  one.history_text)
            << ranks;
    }

    TEST(WarmLaws, GoOnFromACheckpoint)
    {
      for (const auto &scheme : {explicit_steps, implicit_steps("2 us")}) {
        const Workspace workspace;
        const auto file = workspace.path() / "block.prm";
        write_text(file, rubbing_block);
        const Launch launch{file, and_more(scheme, warm_block)};
        const Result whole = good_run(workspace, "whole", launch);
        Result resumed;
        ASSERT_NO_FATAL_FAILURE(
            go_on(workspace, launch, launch, whole, resumed));
        EXPECT_EQ(resumed.history_text, whole.history_text);
      }
    }

    TEST(WarmLaws, AreReadOrRefused)
    {
      const Workspace workspace;
      const auto file = workspace.path() / "block.prm";
      write_text(file, rubbing_block);
      const auto message = [&](const std::string &set) {
        std::vector<std::string> words{file.string(), "--check"};
        const std::string entry = set.substr(0, set.find('=') + 1);
        for (const auto &one : and_more(warm_block, {set}))
          if (one == set || one.compare(0, entry.size(), entry) != 0)
            words.insert(words.end(), {"--set", one});
        const Outcome outcome = nsfd(workspace, words);
        EXPECT_EQ(outcome.exit_code, 1) << set;
        return outcome.err;
      };
      const auto has = [](const std::string &text, const std::string &words) {
        return text.find(words) != std::string::npos;
      };
      const std::string all = "Interface: all/";
      EXPECT_TRUE(has(message(all + "strength at temperatures=293 K : 1, 280 K "
                                    ": 0.5"),
                      "280 K comes after 293 K"));
      EXPECT_TRUE(has(message(all + "toughness at temperatures=293 K : 0"),
                      "must be positive"));
      EXPECT_TRUE(has(message(all + "friction at temperatures=293 K, 1"),
                      "is not a temperature and a factor"));
      EXPECT_TRUE(has(message(all + "friction at temperatures=293 Pa : 1"),
                      "a temperature"));
      EXPECT_TRUE(has(message(all + "law=brittle"),
                      "the law brittle is intrinsic: its springs hold energy"));
      EXPECT_TRUE(has(message(all + "friction=0"), "there is no `friction`"));
      EXPECT_TRUE(has(message(all + "dilatancy=0.2"),
                      "dilatancy = 0.2 is above the least friction, 0.08"));
    }
  } // namespace
} // namespace end_to_end::test_warm_laws
