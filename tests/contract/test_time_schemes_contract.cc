#include "../unit/make_law.h"
#include "../unit/make_scene.h"

#include "simulation/time_stepping.h"
#include "time_integration/step_rule.h"
#include "time_integration/time_scheme.h"

#include <fmt/format.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

// What every registered time integrator and every rule of the step must
// satisfy.

namespace test_time_schemes_contract
{
  using namespace nsfd;
  using nsfd::test::entries_of;
  using nsfd::test::make_input;
  using nsfd::test::Scene;

  /** A bar that every scheme can take: held, pulled, without any event. */
  const char *const pulled_bar = R"(# bar - a bar of two cells, pulled.
subsection Mesh
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Material: rubber
  set Young modulus = 1
  set Poisson ratio = 0.2
  set density       = 1
end
subsection Interface: all
  set law = rigid
end
subsection Boundary: left
  set velocity x = 0
  set velocity y = 0
end
subsection Boundary: right
  set traction x = 0.01 * t
end
subsection Time
  set end  = 1
  set step = 0.05
end
)";

  std::vector<std::string> overrides(const std::string &scheme,
                                     const std::string &example)
  {
    std::vector<std::string> result = {"Time/scheme=" + scheme};
    for (const auto &[entry, value] : entries_of(example)) {
      const std::size_t begin = entry.find_first_not_of(' '),
                        end = entry.find_last_not_of(' ');
      result.push_back("Time/" + entry.substr(begin, end - begin + 1) + "=" +
                       value);
    }
    return result;
  }

  /** Names of the entries of section Time that the echo has. */
  std::set<std::string> echoed_entries(const std::string &echo)
  {
    std::set<std::string> names;
    std::istringstream lines(echo);
    bool inside = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("subsection", 0) == 0 || line == "end")
        inside = line == "subsection Time";
      const std::size_t begin = line.find("set "), end = line.find('=');
      if (inside && begin != std::string::npos && end != std::string::npos)
        names.insert(line.substr(
            begin + 4, line.find_last_not_of(' ', end - 1) - begin - 3));
    }
    return names;
  }

  /** Calls @p check with scheme, name and example. */
  template <typename Check>
  void for_all_examples(const Check &check)
  {
    for (const auto &[name, entry] : TimeSchemeRegistry::instance().entries()) {
      EXPECT_FALSE(entry.examples.empty()) << name;
      EXPECT_FALSE(entry.text.empty()) << name;
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        check(*find_time_scheme(name), name, example);
      }
    }
  }

  TEST(TimeSchemesContract, ReadsTheEntriesThatItNamesAndNoOthers)
  {
    // what every scheme has
    const std::set<std::string> common = {"end", "scheme", "step", "start",
                                          "equilibrium tolerance"};
    for_all_examples([&](const TimeScheme &scheme, const std::string &name,
                         const std::string &example) {
      const auto input = make_input(pulled_bar, overrides(name, example));
      EXPECT_EQ(input->time.scheme_name, name);
      const auto echoed = echoed_entries(input->echo);
      const std::vector<std::string> own = scheme.entries();
      for (const std::string &entry : echoed)
        EXPECT_TRUE(common.count(entry) ||
                    std::find(own.begin(), own.end(), entry) != own.end())
            << entry << " is read, and entries() does not name it";
      for (const std::string &entry : own)
        // where bonded faces may break
        EXPECT_TRUE(echoed.count(entry) || entry == "largest overshoot")
            << entry << " is not read";
    });
  }

  TEST(TimeSchemesContract, RefusesTheEntriesOfOthers)
  {
    std::set<std::string> all;
    for (const std::string &name : time_scheme_names())
      for (const std::string &entry : find_time_scheme(name)->entries())
        all.insert(entry);
    for (const std::string &name : time_scheme_names()) {
      const std::vector<std::string> own = find_time_scheme(name)->entries();
      for (const std::string &entry : all) {
        if (std::find(own.begin(), own.end(), entry) != own.end())
          continue;
        InputErrors errors;
        read_scene_text(pulled_bar, "test.prm",
                        {"Time/scheme=" + name, "Time/" + entry + "=1"},
                        errors);
        const std::string report = errors.report();
        EXPECT_EQ(errors.n_errors(), 1u) << report;
        EXPECT_NE(report.find(entry), std::string::npos) << report;
        EXPECT_NE(report.find("scheme = "), std::string::npos) << report;
      }
    }
  }

  // To the end, with every example; what the loads have done is in the bodies
  // and in the lines of the balance.
  TEST(TimeSchemesContract, StepsBalanceTheEnergy)
  {
    for_all_examples([&](const TimeScheme &scheme, const std::string &name,
                         const std::string &example) {
      Scene<2> scene(pulled_bar, overrides(name, example));
      TimeStepping<2> stepping(*scene.input, scene, scene.communicator);
      State state = scene.state, next = state;
      stepping.start(state);
      double worst = 0.;
      while (!stepping.finished(state)) {
        StepReport report;
        std::string failure;
        ASSERT_EQ(stepping.step(state, next, report, failure),
                  TimeStepping<2>::Outcome::taken)
            << failure;
        worst = std::max(worst, report.balance_residual);
        std::swap(state, next);
        stepping.accept();
      }
      stepping.integrator().show(state);
      EXPECT_NEAR(state.time, 1., 1e-12);
      EXPECT_GT(state.energy.work, 0.);
      // the error of Runge-Kutta pairs of 1e-7 while the energy is still small,
      // else of the solver
      EXPECT_LT(worst, scheme.traits().smooth ? 1e-4 : 1e-9);
      std::map<std::string, double> counters;
      stepping.fill_counters(counters);
      EXPECT_FALSE(counters.empty());
    });
  }

  TEST(TimeSchemesContract, LongStepsAreRefusedWhereTheyAreUnstable)
  {
    for (const std::string &name : time_scheme_names()) {
      const auto scheme = find_time_scheme(name);
      if (scheme->is_static())
        continue;
      const auto input = make_input(
          pulled_bar, {"Time/scheme=" + name, "Time/step=10 courant"});
      const Communicator communicator(MPI_COMM_WORLD);
      Model<2> model;
      const auto problems = model.build(*input, communicator);
      EXPECT_EQ(problems.empty(), !scheme->traits().has_stable_step()) << name;
    }
  }

  /** Two halves of a step may have one solution each. */
  struct HalfOfTheStep final : StepLimits {
    double step = 1.;
    double unique_step(const State &, const State &) const override
    {
      return 0.5 * step;
    }
  };

  TEST(StepRulesContract, RepeatedStepsAreShorter)
  {
    TimeInput time;
    EXPECT_TRUE(step_rules(time).empty()); // a step of a given length
    time.step_kind = StepKind::automatic;
    time.largest_overshoot = 0.05;
    const StepRules rules = step_rules(time);
    EXPECT_EQ(rules.size(), StepRuleRegistry::instance().entries().size());
    EXPECT_EQ(rules.size(), all_step_rules().size());
    const StepControl control(1., 0.1, 10);
    HalfOfTheStep limits;
    limits.step = control.step();
    const State state;
    const PresentStep view{time, limits, control, state};
    for (const auto &rule : rules) {
      if (const auto longest = rule->longest(view)) {
        EXPECT_GT(*longest, 0.);
        EXPECT_LE(*longest, control.base_step());
      }
      EXPECT_FALSE(rule->repeat(view, StepReport(), state).has_value());
      StepReport report;
      report.beyond_unique = true;
      report.overshoot = 1.;
      report.share = 0.9;
      const auto shorter = rule->repeat(view, report, state);
      ASSERT_TRUE(shorter.has_value());
      EXPECT_GT(shorter->length, 0.);
      EXPECT_LE(shorter->length, 0.5 * control.step());
    }
  }
} // namespace test_time_schemes_contract
