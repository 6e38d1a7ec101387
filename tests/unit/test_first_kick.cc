#include "leapfrog_steps.h"
#include "make_law.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

// The first step of explicit scenes: no law gives energy in it, however far it
// opens.

namespace nsfd::test_first_kick
{
  namespace
  {
    using test::Steps;

    /**
     * A block that flies off while one side of it is held. The first step opens
     * the faces beside that side by the share @p opening of toughness over
     * strength, where the cells are small enough for springs that are softer
     * than they are.
     */
    std::string block(const std::string &name, const std::string &example,
                      const double opening)
    {
      const auto law = test::make_law(name, test::entries_of(example));
      const double d = law->toughness() / law->strength(), L = 1000. * d,
                   E = 3e3 * law->strength(), rho = 1000.;
      const double v = opening * d * std::sqrt(E / rho) / (0.2 * L);
      std::string entries;
      for (const auto &[entry, value] : test::entries_of(example))
        entries += "  set " + entry + " = " + value + "\n";
      return fmt::format(R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = {0}, {0}
  set cells        = 4, 4
end
subsection Material: bulk
  set Young modulus      = {1}
  set Poisson ratio      = 0.2
  set density            = {2}
  set initial velocity x = {3}
  set initial velocity y = 0.5 * {3} * sin(y / {0})
end
subsection Interface: all
  set law      = {4}
  set friction = 0.3
{5}end
subsection Boundary: left
  set velocity x = 0
  set velocity y = 0
end
subsection Time
  set end    = {6}
  set step   = auto
  set scheme = explicit
end
)",
                         4. * L, E, rho, v, name, entries,
                         100. * L * std::sqrt(rho / E));
    }

    /** The damage of the first step; @p most: of all energy, what a line may
        lose by round-off in one step. */
    double expect_no_gift(const std::string &scene, const double most)
    {
      Steps<2> run(scene);
      double first = 0.;
      const double all = run.state.energy.kinetic;
      for (unsigned int k = 0; k < 30; ++k) {
        const EnergyLines before = run.state.energy;
        const double residual = run.step().balance_residual;
        const EnergyLines &after = run.state.energy;
        if (k == 0)
          first = after.damage;
        EXPECT_LT(residual, 1e-12);
        for (const auto line : {&EnergyLines::numerical, &EnergyLines::damage,
                                &EnergyLines::friction, &EnergyLines::impact,
                                &EnergyLines::viscous})
          EXPECT_GT(after.*line - before.*line, -most * all) << "step " << k;
      }
      return first;
    }

    TEST(FirstKick, NoLawGivesEnergy)
    {
      for (const auto &[name, entry] :
           CohesiveLawRegistry::instance().entries())
        for (const std::string &example : entry.examples)
          for (const double opening : {0.1, 1., 10.}) {
            SCOPED_TRACE(fmt::format("{}: {}, {}", name, example, opening));
            const auto law = test::make_law(name, test::entries_of(example));
            const double damage =
                expect_no_gift(block(name, example, opening), 1e-12);
            if (!law->extrinsic() && opening > 1.) {
              EXPECT_GT(damage, 0.);
            }
          }
    }
  } // namespace
} // namespace nsfd::test_first_kick
