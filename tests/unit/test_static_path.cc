#include "make_law.h"
#include "make_scene.h"

#include "nsfd/cohesive_laws/cohesive_law.h"
#include "time_integration/step_control.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

// Bars that are too soft for the faces in them: what a step of the load must
// not do is to land on an equilibrium that no path leads to. All by formulas.

namespace nsfd::test_static_path
{
  namespace
  {
    constexpr double length = 60e-3, height = 2e-3;

    /** @p entries as a law states its examples. */
    std::string bar(const std::string &law, std::string entries,
                    const bool extrinsic, const double young, const double pull)
    {
      for (std::size_t at; (at = entries.find(';')) != std::string::npos;)
        entries.replace(at, 1, "\n  set");
      if (extrinsic)
        entries += "\n  set intact faces = rigid";
      return fmt::format(R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 60 mm, 2 mm
  set cells        = 4, 1
end
subsection Material: bar
  set Young modulus = {}
  set Poisson ratio = 0
  set density       = 1000
end
subsection Interface: faces
  set where           = x > 0
  set law             = {}
  set {}
  set strength factor = if(abs(x - 30 mm) < 1 mm, 1, 1.05)
end
subsection Boundary: left
  set displacement x = 0
  set displacement y = 0
end
subsection Boundary: right
  set displacement x = {} * t
end
subsection Time
  set scheme = quasi-static
  set end    = 1
  set step   = 0.1 s
end
)",
                         young, law, entries, pull);
    }

    struct Pull {
      double peak = 0., end = 0., missing = 0., defect = 0.;
      unsigned int jumps = 0;
      bool refused = false;
    };

    /** Down the step levels, as a run does. */
    Pull pull(const std::string &scene, const double step)
    {
      test::Scene<2> bar(scene);
      EquilibriumSearch<2> &statics = bar.equilibria->search();
      State state = statics.start(bar.state), next = state;
      StepControl control(1., step, 10);
      Pull result;
      while (!control.finished()) {
        EquilibriumReport found;
        bool exists = true;
        try {
          found = statics.advance(state, control.next_time(), next,
                                  control.can_bisect());
        } catch (const StepRejected &) {
          exists = false;
        }
        if (!exists || !found.accepted()) {
          const double limit = found.share * control.step();
          if (control.bisect()) {
            while (control.step() > limit && control.bisect()) {
            }
            continue;
          }
          if (!exists || !found.may_follow()) {
            result.refused = true;
            return result;
          }
          ++result.jumps;
        }
        control.accept();
        result.missing = std::max(result.missing, state.energy.numerical -
                                                      next.energy.numerical);
        result.defect = std::max(result.defect, found.step.balance_residual);
        std::swap(state, next);
        result.end = statics.reactions()[2];
        result.peak = std::max(result.peak, result.end);
      }
      return result;
    }

    /**
     * The bar is elastic up to R_max. With r = R_max^2 L/(2 E G) it stores r G
     * then. The middle face breaks; the two others have 1.05 R_max. False if
     * the run was refused: what it refused has not been wrong so far.
     */
    bool breaks_at_its_strength(const std::string &name,
                                const std::string &entries, const double r,
                                const double n_steps)
    {
      const auto made = test::make_law(name, test::entries_of(entries));
      const CohesiveLaw &law = *made;
      const double R_max = law.strength();
      const double young = R_max * R_max * length / (2. * law.toughness() * r);
      const double at_peak = R_max * length / young + 3. * law.peak_opening();
      const Pull broken =
          pull(bar(name, entries, law.extrinsic(), young, 1.6 * at_peak),
               1. / n_steps);
      const std::string what =
          fmt::format("{}: {}, r = {}, {} steps", name, entries, r, n_steps);
      EXPECT_LT(broken.peak / (R_max * height), 1.01) << what;
      if (!broken.refused) {
        EXPECT_GT(broken.peak / (R_max * height), 0.99) << what;
      }
      EXPECT_LE(broken.missing, 0.) << what;
      EXPECT_LT(broken.defect, 1e-9) << what;
      return !broken.refused;
    }

    constexpr double ratios[] = {1.01, 1.5, 5., 30., 1000.};

    TEST(StaticPath, SoftBarsBreakAtTheirStrength)
    {
      unsigned int refused = 0, step = 0;
      for (const auto &[name, entry] :
           CohesiveLawRegistry::instance().entries())
        for (const double r : ratios) {
          constexpr double steps[] = {2., 7., 50.};
          refused += !breaks_at_its_strength(name, entry.examples.front(), r,
                                             steps[step++ % 3]);
        }
      // five bars of each law; a run that refuses most of them is of no use
      EXPECT_LE(refused, CohesiveLawRegistry::instance().names().size());
    }

    // All examples of all laws by as many load steps as NSFD_LOAD_STEPS says.
    TEST(StaticPath, SoftBarsBreakAtTheirStrengthInManySteps)
    {
      const char *const steps = std::getenv("NSFD_LOAD_STEPS");
      if (steps == nullptr)
        GTEST_SKIP() << "NSFD_LOAD_STEPS is not set";
      for (const auto &[name, entry] :
           CohesiveLawRegistry::instance().entries())
        for (const std::string &entries : entry.examples)
          for (const double r : ratios)
            // an equilibrium has no rates: the reader refuses such laws
            if (!test::make_law(name, test::entries_of(entries))
                     ->rate_dependent() &&
                !breaks_at_its_strength(name, entries, r, std::stod(steps)))
              std::cout << name << ": " << entries << ", r = " << r
                        << ": refused\n";
    }
  } // namespace
} // namespace nsfd::test_static_path
