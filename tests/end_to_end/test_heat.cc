#include "program.h"
#include "restart.h"
#include "rubbing_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Scenes that become warm: what friction, damage and flow take is in the
// bodies, to the round-off of sums (1e-12), in every scheme, on any number of
// ranks with the same bits, and after a restart.

namespace end_to_end::test_heat
{
  namespace
  {
    Result warm_run(const Workspace &workspace, const std::string &name,
                    const std::vector<std::string> &set,
                    const unsigned int ranks = 1)
    {
      const auto file = workspace.path() / "block.prm";
      write_text(file, rubbing_block);
      Launch launch{file, set, ranks};
      return good_run(workspace, name, launch);
    }

    double heat(const Result &result, const std::string &name)
    {
      return result.summary.at("heat").at(name).get<double>();
    }

    TEST(Heat, IsWhatWasDissipated)
    {
      const Workspace workspace;
      for (const std::vector<std::string> &set :
           {std::vector<std::string>{"Time/scheme=explicit"},
            {"Time/scheme=moreau-jean", "Time/step=2 us"},
            {"Time/scheme=moreau-jean", "Time/step=2 us", "Time/theta=1"}}) {
        const Result result = warm_run(workspace, set.back().substr(5, 5), set);
        const double taken =
            result.dissipated("damage") + result.dissipated("friction");
        EXPECT_GT(result.dissipated("damage"), 0.02 * taken) << set.back();
        EXPECT_GT(result.dissipated("friction"), 0.02 * taken) << set.back();
        EXPECT_NEAR(heat(result, "made") / taken, 1., 1e-12) << set.back();
        EXPECT_NEAR(heat(result, "stored") / taken, 1., 1e-12) << set.back();
        EXPECT_GT(heat(result, "hottest"), 293.15 + 0.01) << set.back();
        EXPECT_EQ(result.history["heat"].back(), heat(result, "made"));
      }
    }

    // Conducted in every step. Implicit steps know the number of ranks to the
    // tolerance of the solver, 1e-8, in each of 100 steps; where faces break
    // that grows, and none does here.
    TEST(Heat, RanksAgree)
    {
      const Workspace workspace;
      const std::string fast = "Material: lining/conductivity=20000 W/m/K";
      for (const std::vector<std::string> &set :
           {std::vector<std::string>{"Time/scheme=explicit", fast},
            {"Time/scheme=moreau-jean", "Time/step=2 us", fast,
             "Interface: all/strength=1 GPa"}}) {
        const std::string name = set.front().substr(12, 4);
        const Result one = warm_run(workspace, name + "1", set);
        EXPECT_GT(one.counter("heat_iterations"), 10.);
        for (const unsigned int ranks : {2u, 3u}) {
          const Result several =
              warm_run(workspace, name + std::to_string(ranks), set, ranks);
          if (set.size() == 2) {
            EXPECT_EQ(several.history_text, one.history_text) << ranks;
          }
          for (const char *what : {"made", "stored", "hottest"})
            EXPECT_NEAR(heat(several, what) / heat(one, what), 1., 1e-6)
                << ranks << what;
        }
      }
    }

    TEST(Heat, GoesOnFromACheckpoint)
    {
      for (const std::vector<std::string> &set :
           {std::vector<std::string>{"Time/scheme=explicit"},
            {"Time/scheme=moreau-jean", "Time/step=2 us"}}) {
        const Workspace workspace;
        const auto file = workspace.path() / "block.prm";
        write_text(file, rubbing_block);
        const Launch launch{file, set};
        const Result whole = good_run(workspace, "whole", launch);
        Result resumed;
        ASSERT_NO_FATAL_FAILURE(
            go_on(workspace, launch, launch, whole, resumed));
        EXPECT_EQ(resumed.history_text, whole.history_text);
      }
    }

    // A bar that is pulled beyond its yield stress, adiabatic: Delta T =
    // share * plastic work / (rho c V), the same everywhere.
    TEST(Heat, OfFlowIsItsShareOfThePlasticWork)
    {
      const Workspace workspace;
      const auto file = workspace.path() / "bar.prm";
      write_text(file, R"(
set dimension = 2
set plane     = stress
subsection Mesh
  set type         = rectangle
  set upper corner = 20 mm, 10 mm
  set cells        = 4, 2
end
subsection Material: steel
  set model                       = j2 plastic
  set Young modulus               = 200 GPa
  set Poisson ratio               = 0.3
  set density                     = 7800 kg/m^3
  set yield stress                = 300 MPa
  set isotropic hardening modulus = 1 GPa
  set heat capacity               = 480 J/kg/K
  set plastic heat share          = 0.9
  set initial velocity x          = 50 m/s * x / 20 mm
end
subsection Interface: all
  set law = joined
end
subsection Boundary: left
  set velocity x = 0
end
subsection Boundary: right
  set velocity x = 50 m/s
end
subsection Time
  set end = 40 us
end
)");
      for (const std::vector<std::string> &set :
           {std::vector<std::string>{"Time/scheme=moreau-jean",
                                     "Time/step=0.4 us"},
            {"Time/scheme=explicit"}}) {
        const Result result =
            good_run(workspace, set.front().substr(12, 4), {file, set});
        const double made = heat(result, "made");
        EXPECT_GT(made, 0.);
        EXPECT_NEAR(heat(result, "stored") / made, 1., 1e-12);
        // explicit steps book the flow of a step with the next one
        const double plastic = result.dissipated("plastic");
        EXPECT_NEAR(made / (0.9 * plastic), 1., set.size() == 2 ? 1e-12 : 0.05);
        const double mean = made / (7800. * 480. * 20e-3 * 10e-3);
        EXPECT_NEAR((heat(result, "hottest") - 293.15) / mean, 1., 0.2);
      }
    }

    // A slab of 300 K whose left side is at 400 K from t = 0 on: its mean rise
    // is 1 - sum 8 / (m pi)^2 exp(-(m pi / 2)^2 kappa t / L^2) of it, m odd.
    // Steps of a 400th of t take backward Euler errors of 1e-3 of the sum, 20
    // cells less.
    TEST(Heat, OfAHotSideIsThatOfTheSeries)
    {
      const Workspace workspace;
      const auto file = workspace.path() / "slab.prm";
      write_text(file, R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 10 mm, 1 mm
  set cells        = 10, 1
end
subsection Material: steel
  set Young modulus       = 200 GPa
  set Poisson ratio       = 0.3
  set density             = 7800 kg/m^3
  set heat capacity       = 0.004 J/kg/K
  set conductivity        = 50 W/m/K
  set initial temperature = 300 K
end
subsection Interface: all
  set law = joined
end
subsection Boundary: left
  set temperature = 400 K
  set velocity x  = 0
end
subsection Boundary: right
  set velocity x = 1 m/s
end
subsection Time
  set end = 18.72 us
end
)");
      const double capacity = 7800. * 0.004 * 10e-3 * 1e-3,
                   fourier = 50. / (7800. * 0.004) * 18.72e-6 / 1e-4;
      double mean = 1.;
      for (unsigned int m = 1; m < 40; m += 2)
        mean -= 8. / std::pow(m * M_PI, 2) *
                std::exp(-std::pow(m * M_PI / 2., 2) * fourier);
      for (const std::vector<std::string> &set :
           {std::vector<std::string>{"Time/scheme=explicit"},
            {"Time/scheme=moreau-jean", "Time/step=0.1248 us"}}) {
        const std::string name = set.front().substr(12, 4);
        const Result result = good_run(workspace, name, {file, set});
        EXPECT_NEAR(heat(result, "given") / (100. * capacity * mean), 1., 5e-3)
            << name;
        EXPECT_NEAR(heat(result, "stored") / heat(result, "given"), 1., 1e-9)
            << name;
        EXPECT_EQ(result.history["heat_given"].back(), heat(result, "given"));
      }
      // a few steps on several ranks
      std::string on_one;
      for (const unsigned int ranks : {1u, 2u, 3u}) {
        const Result result = good_run(
            workspace, std::to_string(ranks),
            {file, {"Time/scheme=explicit", "Time/end=1.3 us"}, ranks});
        EXPECT_GT(result.counter("heat_iterations"), 10.);
        if (ranks == 1)
          on_one = result.history_text;
        EXPECT_EQ(result.history_text, on_one) << ranks;
      }
    }

    // Jaeger's band: see the scene.
    TEST(Heat, FlashTemperatureOfJaeger)
    {
      const Workspace workspace;
      const Result result =
          good_run(workspace, "band", {benchmark("flash_temperature")});
      const double q = 0.5 * 100e6 * 0.01, k = 50., kappa = k / (7500. * 500.),
                   V = 0.0266667, L = V * 1e-3 / (2. * kappa);
      const auto rise = [&](const double X) {
        constexpr unsigned int n = 4000;
        double sum = 0.; // the logarithm at 0 is between two places
        for (unsigned int i = 0; i < n; ++i) {
          const double u = X - L + 2. * L * (i + 0.5) / n;
          sum += std::exp(-u) * std::cyl_bessel_k(0., std::abs(u)) * 2. * L / n;
        }
        return 2. * q * kappa / (M_PI * k * V) * sum;
      };
      double hottest = 0.;
      for (double X = -1.; X < 1.; X += 0.0503)
        hottest = std::max(hottest, rise(X * L));
      EXPECT_NEAR(hottest, 9.91, 0.01);
      EXPECT_NEAR(heat(result, "hottest") / hottest, 1., 0.02);
    }

    TEST(Heat, IsReadOrRefused)
    {
      const Workspace workspace;
      const auto file = workspace.path() / "block.prm";
      write_text(file, rubbing_block);
      const auto message = [&](const std::vector<std::string> &set) {
        std::vector<std::string> words = {file.string(), "--check"};
        for (const std::string &one : set) {
          words.push_back("--set");
          words.push_back(one);
        }
        const Outcome outcome = nsfd(workspace, words);
        EXPECT_EQ(outcome.exit_code, 1);
        return outcome.err;
      };
      const auto has = [](const std::string &text, const std::string &words) {
        return text.find(words) != std::string::npos;
      };
      EXPECT_TRUE(has(message({"motion=large"}),
                      "motion = large has no temperatures yet"));
      EXPECT_TRUE(
          has(message({"Material: lining/heat capacity=0"}), "heat capacity"));
      EXPECT_TRUE(has(message({"Material: lining/heat capacity=2 Pa"}),
                      "an energy per mass and kelvin"));
      EXPECT_TRUE(has(message({"Material: lining/plastic heat share=1"}),
                      "the material does not flow"));
      EXPECT_TRUE(has(message({"Boundary: left/temperature=300 K",
                               "Boundary: left/heat flux=1 W/m^2"}),
                      "`temperature` and `heat flux` are both given"));
      EXPECT_TRUE(has(message({"Boundary: left/heat flux=1 W/m^2",
                               "Material: lining/conductivity=0"}),
                      "no material has a conductivity"));
    }
  } // namespace
} // namespace end_to_end::test_heat
