#include "leapfrog_steps.h"

#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Explicit steps from an equilibrium.

namespace nsfd::test_explicit_equilibrium
{
  namespace
  {
    using test::Steps;

    const std::string plate = R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = 20 mm, 10 mm
  set cells        = 16, 8
end
subsection Material: glass
  set Young modulus = 70 GPa
  set Poisson ratio = 0.2
  set density       = 2500 kg/m^3
  set body force x  = 1e9
end
subsection Interface: open
  set where = x > 1
  set law   = contact
end
subsection Interface: all
  set where     = all
  set law       = camacho-ortiz
  set strength  = 60 MPa
  set toughness = 20 J/m^2
end
subsection Boundary: left
  set displacement x = 0
  set displacement y = 0
end
subsection Boundary: right
  set traction x = 5 MPa
  set traction y = 1 MPa
end
subsection Time
  set end    = 1
  set step   = auto
  set scheme = explicit
  set start  = equilibrium
end
)";
    const std::vector<std::string> quads = {"Mesh/type=rectangle"};
    const std::vector<std::string> space = {
        "dimension=3", "Mesh/upper corner=20 mm, 10 mm, 5 mm",
        "Mesh/cells=6, 3, 2", "Boundary: left/displacement z=0"};

    std::vector<std::string> with(std::vector<std::string> first,
                                  const std::vector<std::string> &more)
    {
      first.insert(first.end(), more.begin(), more.end());
      return first;
    }

    /** Stays for 1000 steps; returns the elastic energy. */
    template <int dim>
    double expect_rest(const std::vector<std::string> &overrides)
    {
      Steps<dim> run(plate, overrides);
      const double elastic = run.state.energy.elastic;
      EXPECT_GT(elastic, 0.);
      double kinetic = run.state.energy.kinetic, residual = 0.;
      for (unsigned int k = 0; k < 1000; ++k) {
        residual = std::max(residual, run.step().balance_residual);
        kinetic = std::max(kinetic, run.state.energy.kinetic);
      }
      EXPECT_LT(kinetic, 1e-20 * elastic);
      EXPECT_NEAR(run.state.energy.elastic, elastic, 1e-9 * elastic);
      EXPECT_EQ(run.state.energy.damage, 0.);
      EXPECT_LT(residual, 1e-12);
      return elastic;
    }

    TEST(ExplicitEquilibrium, StaysAtRest)
    {
      expect_rest<2>({});
      expect_rest<2>(quads);
      expect_rest<2>(with(quads, {"Discretization/degree=3"}));
      expect_rest<2>({"Mesh/distortion=0.3"});
      expect_rest<3>(with(space, {"Mesh/type=tetrahedra"}));
      expect_rest<3>(with(space, {"Mesh/type=brick"}));
    }

    // Cells of two sizes, a front viscosity and a viscous material take no part
    // in it.
    TEST(ExplicitEquilibrium, StaysAtRestWhereMuchComesTogether)
    {
      const double plain = expect_rest<2>(quads);
      // sums of BLAS may depend on where its vectors begin: the last digits
      EXPECT_NEAR(expect_rest<2>(with(quads, {"Time/front viscosity=0.3",
                                              "Material: glass/shear viscosity="
                                              "10 Pa*s",
                                              "Material: glass/bulk viscosity="
                                              "10 Pa*s"})),
                  plain, 1e-13 * plain);
      const double finer = expect_rest<2>(
          with(quads, {"Adaptivity/levels=1", "Indicator: near/type=region",
                       "Indicator: near/region=x < 5 mm",
                       "Indicator: near/cell size=0.7 mm"}));
      EXPECT_NEAR(finer, plain, 0.02 * plain);
    }

    // sigma^2 / 2E of a bar under a traction
    TEST(ExplicitEquilibrium, IsThatOfABar)
    {
      Steps<2> run(plate, {"Material: glass/body force x=0",
                           "Material: glass/Poisson ratio=0",
                           "Boundary: right/traction y=0"});
      const double exact = 5e6 * 5e6 / (2. * 70e9) * 20e-3 * 10e-3;
      EXPECT_NEAR(run.state.energy.elastic, exact, 1e-10 * exact);
      EXPECT_EQ(run.state.energy.kinetic, 0.);
    }

    const std::vector<std::string> springs = {
        "Interface: all/law=geubelle-baylor",
        "Interface: all/initial strength parameter=0.9"};

    // Laws below their limit and joints are springs.
    TEST(ExplicitEquilibrium, StaysAtRestOnSprings)
    {
      expect_rest<2>(springs);
      expect_rest<2>(with(quads, springs));
      expect_rest<2>(with(with(quads, springs), {"Discretization/degree=2"}));
      expect_rest<3>(with(with(space, springs), {"Mesh/type=tetrahedra"}));
      const std::string joints = plate.substr(0, plate.find("law       = ")) +
                                 "law = elastic\n  set normal stiffness = "
                                 "1e14 Pa/m\n" +
                                 plate.substr(plate.find("end\nsubsection "
                                                         "Boundary: left"));
      Steps<2> run(joints);
      EXPECT_GT(run.state.energy.cohesive, 0.);
      for (unsigned int k = 0; k < 1000; ++k)
        run.step();
      EXPECT_LT(run.state.energy.kinetic, 1e-20 * run.state.energy.elastic);
    }

    // sigma^2 / 2C at each of 15 faces, beside sigma^2 / 2E of the bar
    TEST(ExplicitEquilibrium, StretchesSprings)
    {
      Steps<2> run(
          plate, with(with(quads, springs), {"Material: glass/body force x=0",
                                             "Material: glass/Poisson ratio=0",
                                             "Boundary: right/traction y=0"}));
      const double sigma = 5e6, height = 10e-3,
                   C = run.input->interfaces[1].law->normal_stiffness();
      const double bar = sigma * sigma / (2. * 70e9) * 20e-3 * height,
                   faces = 15. * sigma * sigma / (2. * C) * height;
      EXPECT_NEAR(run.state.energy.elastic, bar, 1e-9 * bar);
      EXPECT_NEAR(run.state.energy.cohesive, faces, 1e-9 * faces);
    }

    // A bar that is held at both ends, in two halves, with fluid between them:
    // each is compressed by p.
    TEST(ExplicitEquilibrium, HoldsPressureInCracks)
    {
      const std::vector<std::string> fluid = {
          "Interface: open/where=abs(x - 10 mm) < 1 um",
          "Interface: open/crack pressure=3 MPa",
          "Material: glass/body force x=0", "Material: glass/Poisson ratio=0"};
      const std::string held =
          plate.substr(0, plate.find("  set traction x")) +
          "  set displacement x = 0\n  set displacement y = 0\n" +
          plate.substr(plate.find("end\nsubsection Time"));
      for (const auto &more : {std::vector<std::string>{}, quads}) {
        Steps<2> run(held, with(more, fluid));
        const double p = 3e6, exact = p * p / (2. * 70e9) * 20e-3 * 10e-3;
        EXPECT_NEAR(run.state.energy.elastic, exact, 1e-9 * exact);
        double opening = 0.;
        for (std::size_t i = 0; i < run.state.jump.size(); i += 2)
          opening = std::max(opening, run.state.jump[i]);
        EXPECT_NEAR(opening, p * 20e-3 / 70e9, 1e-9 * opening);
        for (unsigned int k = 0; k < 1000; ++k)
          run.step();
        EXPECT_LT(run.state.energy.kinetic, 1e-20 * exact);
        EXPECT_NEAR(run.state.energy.elastic, exact, 1e-9 * exact);
      }
    }

    // A plate that is strained and held, with a notch that is open in it: the
    // crack runs by what the plate has stored, and no more.
    TEST(ExplicitEquilibrium, CrackStartsFromIt)
    {
      const std::string strained =
          plate.substr(0, plate.find("subsection Boundary")) + R"(
subsection Boundary: bottom
  set displacement x = 0
  set displacement y = 0
end
subsection Boundary: top
  set displacement x = 0
  set displacement y = 6 um
end
)" + plate.substr(plate.find("subsection Time"));
      Steps<2> run(strained,
                   {"Material: glass/body force x=0", "Mesh/cells=32, 16",
                    "Interface: open/where=abs(y - 5 mm) < 1 um && x < 6 mm"});
      const double start = run.state.energy.elastic;
      EXPECT_EQ(run.state.energy.kinetic, 0.);
      // less than without a notch: plane strain, height 10 mm, held sideways
      const double nu = 0.2, E = 70e9,
                   modulus = E * (1. - nu) / ((1. + nu) * (1. - 2. * nu)),
                   whole = modulus * 6e-4 * 6e-4 / 2. * 20e-3 * 10e-3;
      EXPECT_LT(start, whole);
      EXPECT_GT(start, 0.5 * whole);
      double residual = 0.;
      while (run.state.time < 8e-6)
        residual = std::max(residual, run.step().balance_residual);
      const EnergyLines &e = run.state.energy;
      EXPECT_GT(run.state.broken_area, 5e-3);
      EXPECT_GT(e.damage, 20. * 5e-3);
      EXPECT_NEAR(e.work, 0., 1e-12 * start);
      EXPECT_LT(e.elastic, 0.9 * start);
      EXPECT_LT(residual, 1e-12);
    }

    TEST(ExplicitEquilibrium, SaysWhyThereIsNone)
    {
      const auto failure = [](const std::vector<std::string> &overrides) {
        try {
          Steps<2> run(plate, overrides);
        } catch (const StepRejected &rejected) {
          return std::string(rejected.what());
        }
        return std::string();
      };
      // nothing holds the right half
      EXPECT_NE(failure({"Interface: open/where=abs(x - 10 mm) < 1 um"})
                    .find("left over"),
                std::string::npos);
      EXPECT_NE(
          failure({"Interface: open/where=abs(y - 5 mm) < 1 um && x > 5 mm",
                   "Boundary: right/traction y=if(y > 5 mm, -1 MPa, 1 "
                   "MPa)"})
              .find("would close"),
          std::string::npos);
      // springs hold it, and would soften
      EXPECT_NE(failure(with(springs, {"Interface: all/strength=4 MPa"}))
                    .find("beyond the straight part"),
                std::string::npos);
      // the contact of a one-sided one is not known
      EXPECT_NE(failure(with(springs, {"Interface: all/intact faces=unilateral",
                                       "Boundary: right/traction x=-5 MPa",
                                       "Material: glass/body force x=0"}))
                    .find("would close"),
                std::string::npos);
    }

    TEST(ExplicitEquilibrium, RefusesWhatItDoesNotKnow)
    {
      const auto problem = [](const std::vector<std::string> &overrides) {
        InputErrors errors;
        read_scene_text(plate, "test.prm", overrides, errors);
        return errors.report();
      };
      EXPECT_EQ(problem({}), "");
      const auto expect = [&](const std::vector<std::string> &overrides,
                              const char *what) {
        const std::string report = problem(overrides);
        for (const char *part : {what, "start  = equilibrium", "write given"})
          EXPECT_NE(report.find(part), std::string::npos) << report;
      };
      expect({"Interface: all/law=tvergaard"}, "without a straight part");
      expect({"Material: grip/where=x < 2 mm", "Material: grip/model=rigid",
              "Material: grip/density=1", "Material: glass/where=x > 2 mm"},
             "rigid bodies yet");
    }
  } // namespace
} // namespace nsfd::test_explicit_equilibrium
