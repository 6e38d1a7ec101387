#include "leapfrog_steps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nsfd::test_elastic_node
{
  namespace
  {
    // A square of springs between all cells, pulled at once at both ends: waves
    // open and close them, none softens until 25 ns.
    const std::string square = R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = 10 um, 10 um
  set cells        = 6, 6
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
end
subsection Interface: all
  set law             = michel-suquet
  set stiffness       = 1.7e18 Pa/m   # 21 E/L of a cell
  set toughness       = 0.5 J/m^2
  set friction        = 0.3
  set intact faces    = unilateral
end
subsection Boundary: left
  set velocity x = if(t < 10 ns, -2 m/s, 2 m/s)
end
subsection Boundary: right
  set velocity x = if(t < 10 ns, 2 m/s, -2 m/s)
end
subsection Time
  set end             = 20 ns
  set step            = auto
  set scheme          = leapfrog
  set front viscosity = 0
end
)";

    const std::vector<std::string> hexes = {
        "dimension=3", "Mesh/type=brick", "Mesh/lower corner=0, 0, 0",
        "Mesh/upper corner=10 um, 10 um, 10 um", "Mesh/cells=3, 3, 3"};

    double counter(const test::Steps<2> &run, const char *name)
    {
      std::map<std::string, double> counters;
      run.leapfrog->fill_counters(counters);
      return counters.at(name);
    }

    /** Nothing is given, from the first step on. */
    template <int dim>
    void expect_springs(const std::vector<std::string> &overrides)
    {
      test::Steps<dim> run(square, overrides);
      double residual = 0., closed = 0.;
      while (run.state.time < run.input->time.end) {
        const EnergyLines before = run.state.energy;
        const StepReport report = run.step();
        residual = std::max(residual, report.balance_residual);
        closed += report.active;
        const EnergyLines &after = run.state.energy;
        ASSERT_GE(after.numerical - before.numerical, -1e-15 * after.work);
        ASSERT_GE(after.impact - before.impact, -1e-15 * after.work);
      }
      EXPECT_GT(closed, 0.);
      EXPECT_LT(residual, 1e-13);
      EXPECT_LT(run.state.penetration, 1e-20); // m
    }

    TEST(ElasticNode, GivesNothingOnTriangles) { expect_springs<2>({}); }
    TEST(ElasticNode, GivesNothingOnQuads)
    {
      expect_springs<2>({"Mesh/type=rectangle"});
    }
    TEST(ElasticNode, GivesNothingOnHexes) { expect_springs<3>(hexes); }

    // As long as nothing softens there is nothing for Newton's method to do;
    // a point that rubs while it is intact needs it, and is solved alike.
    TEST(ElasticNode, IsWhatNewtonFinds)
    {
      test::Steps<2> springs(square),
          rubbing(square, {"Interface: all/friction=1e-12",
                           "Interface: all/friction exponent=0"});
      while (springs.state.time < 20e-9) {
        springs.step();
        rubbing.step();
      }
      EXPECT_EQ(counter(springs, "newton"), 0.);
      EXPECT_GT(counter(rubbing, "newton"), 0.);
      springs.leapfrog->show(springs.state);
      rubbing.leapfrog->show(rubbing.state);
      double difference = 0., size = 0.;
      for (std::size_t k = 0; k < springs.state.velocity.size(); ++k) {
        difference = std::max(difference, std::abs(springs.state.velocity[k] -
                                                   rubbing.state.velocity[k]));
        size = std::max(size, std::abs(springs.state.velocity[k]));
      }
      EXPECT_LT(difference, 1e-9 * size);
    }

    // Springs of 1e8 E/L are as good as common nodes.
    TEST(ElasticNode, StiffSpringsJoin)
    {
      const std::string law =
          square.substr(square.find("subsection Interface"));
      std::string joined = square;
      joined.erase(joined.find("subsection Interface"),
                   law.find("subsection Boundary"));
      joined += "subsection Interface: all\n  set law = rigid\nend\n";
      test::Steps<2> stiff(square, {"Interface: all/stiffness=8.1e24"}),
          nodes(joined);
      while (stiff.state.time < 10e-9) {
        stiff.step();
        nodes.step();
      }
      EXPECT_EQ(stiff.state.time, nodes.state.time);
      const EnergyLines &one = stiff.state.energy, &two = nodes.state.energy;
      EXPECT_NEAR(one.elastic, two.elastic, 1e-6 * two.elastic);
      EXPECT_NEAR(one.work, two.work, 1e-6 * two.work);
      EXPECT_LT(std::abs(one.numerical), 1e-13 * one.work);
    }
  } // namespace
} // namespace nsfd::test_elastic_node
