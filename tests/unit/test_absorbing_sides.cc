#include "leapfrog_steps.h"

#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Sides through which waves leave: dashpots rho c per area.

namespace nsfd::test_absorbing_sides
{
  namespace
  {
    using test::Scene;
    using test::Steps;
    using Overrides = std::vector<std::string>;

    // A pulse that runs to the right in a bar of plane strain whose long sides
    // do not move across: P, or along: S. v = -c u' of u = exp(-((x-x0)/w)^2).
    constexpr double E = 70e9, nu = 0.2, rho = 2500.;
    const double shear = E / (2. * (1. + nu)),
                 c_p = std::sqrt(E * (1. - nu) / (1. + nu) / (1. - 2. * nu) /
                                 rho),
                 c_s = std::sqrt(shear / rho);

    std::string bar(const bool is_p)
    {
      const char *along = is_p ? "x" : "y", *across = is_p ? "y" : "x";
      return fmt::format(R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 1, 0.02
  set cells        = 100, 2
end
subsection Material: rock
  set Young modulus = 70 GPa
  set Poisson ratio = 0.2
  set density       = 2500 kg/m^3
  set initial displacement {0} = 1e-6 * exp(-(((x - 0.5)/0.06)^2))
  set initial velocity {0} = 1e-6 * {2} * 2 * (x - 0.5)/0.06^2 * exp(-(((x - 0.5)/0.06)^2))
end
subsection Interface: all
  set law = joined
end
subsection Boundary: right
  set absorbing = true
end
subsection Boundary: left
  set absorbing = true
end
subsection Boundary: bottom
  set velocity {1} = 0
end
subsection Boundary: top
  set velocity {1} = 0
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)",
                         along, across, is_p ? c_p : c_s);
    }

    struct Left {
      double energy;   ///< over that at the start
      double residual; ///< of the balance
      double absorbed, numerical;
    };

    /** After the pulse has gone 0.75 m: all of it is out. */
    template <typename Run, typename Step>
    Left after(Run &run, const double c, const Step &step)
    {
      const double start = run.energy();
      Left left{};
      while (run.state.time < 0.75 / c) {
        const double before = run.state.energy.absorbed;
        left.residual = std::max(left.residual, step().balance_residual);
        EXPECT_GE(run.state.energy.absorbed, before); // it never gives
      }
      left.energy = run.energy() / start;
      left.absorbed = run.state.energy.absorbed / start;
      left.numerical = run.state.energy.numerical / start;
      return left;
    }

    const Overrides explicit_steps = {"Time/scheme=explicit", "Time/step=auto"};

    Left explicit_left(const bool is_p, Overrides overrides = {})
    {
      overrides.insert(overrides.begin(), explicit_steps.begin(),
                       explicit_steps.end());
      Steps<2> run(bar(is_p), overrides);
      return after(run, is_p ? c_p : c_s, [&] { return run.step(); });
    }
    Left implicit_left(const bool is_p, const Overrides &overrides = {})
    {
      Scene<2> run(bar(is_p), overrides);
      return after(run, is_p ? c_p : c_s, [&] { return run.advance(); });
    }

    /**
     * A wave of number k has the impedance rho c (1 + a (k l)^2), l the cell: a
     * <= 1/8 for lumped mass (that of a chain, cos(k l/2)), 1/12 for consistent
     * mass and 1/12 (c h/l)^2 more of the step. A side of the impedance rho c
     * reflects the amplitude a (k l)^2 / 2; the energy of the pulse has k^4 of
     * 15 (1/w)^4 in the mean, w = 0.06 m. So the share a^2 / 4 15 (l/w)^4 <=
     * 4.5e-5 is left for l = 0.01 m; what the discrete pulse sends backwards at
     * the start, as its velocity belongs to k l = 0, is of the same order and
     * leaves on the other side.
     */
    constexpr double bound = 15. / 4. / 64. * (1. / 1296.);

    TEST(AbsorbingSides, LetWavesOut)
    {
      for (const bool is_p : {true, false}) {
        const Left by_nodes = explicit_left(is_p);
        EXPECT_LT(by_nodes.energy, bound) << "explicit, P: " << is_p;
        EXPECT_LT(by_nodes.residual, 1e-12);
        // the first kick of explicit steps has a numerical part
        EXPECT_NEAR(by_nodes.absorbed + by_nodes.numerical, 1., bound);
        const Left joined = implicit_left(is_p);
        EXPECT_LT(joined.energy, bound) << "implicit, P: " << is_p;
        EXPECT_LT(joined.residual, 1e-12);
        EXPECT_NEAR(joined.absorbed, 1., bound);
      }
    }

    // Of order 4 in the cell: half as large, a sixteenth is left.
    TEST(AbsorbingSides, ReflectLessOnFinerMeshes)
    {
      const double coarse = explicit_left(true).energy,
                   fine = explicit_left(true, {"Mesh/cells=200, 2"}).energy;
      EXPECT_LT(fine, coarse / 10.);
    }

    TEST(AbsorbingSides, OfOtherCellsAndSchemes)
    {
      for (const bool is_p : {true, false}) {
        // with two kinds of nodes the start excites vibrations of one kind
        // against the other, which do not travel: of order 2 in the energy
        EXPECT_LT(
            explicit_left(is_p,
                          {"Mesh/type=crossed triangles", "Mesh/cells=200, 4"})
                .energy,
            explicit_left(is_p, {"Mesh/type=crossed triangles"}).energy / 3.);
        EXPECT_LT(explicit_left(is_p, {"Discretization/degree=2"}).energy,
                  bound);
        EXPECT_LT(implicit_left(is_p, {"Discretization/degree=2"}).energy,
                  bound);
        // cells that are bodies of their own, on stiff springs
        const Left split = implicit_left(is_p, {"Interface: all/law=rigid",
                                                "Solver/path=local",
                                                "Solver/tolerance=1e-10"});
        EXPECT_LT(split.energy, bound);
        EXPECT_LT(split.residual, 1e-9);
        const Left symplectic = implicit_left(
            is_p, {"Time/scheme=symplectic", "Time/step=0.4 courant"});
        EXPECT_LT(symplectic.energy, bound);
        EXPECT_LT(symplectic.residual, 1e-10);
      }
    }

    // What stands does not move: a prestressed bar under its tractions.
    TEST(AbsorbingSides, LeaveAPrestressAlone)
    {
      const std::string stressed = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 20 mm, 10 mm
  set cells        = 8, 4
end
subsection Material: rock
  set Young modulus     = 70 GPa
  set Poisson ratio     = 0.2
  set density           = 2500 kg/m^3
  set initial stress xx = -30 MPa
  set initial stress xy = 8 MPa
end
subsection Interface: all
  set law = joined
end
subsection Boundary: left
  set absorbing  = true
  set traction x = 30 MPa
  set traction y = -8 MPa
end
subsection Boundary: right
  set absorbing  = true
  set traction x = -30 MPa
  set traction y = 8 MPa
end
subsection Boundary: bottom
  set absorbing  = true
  set traction x = -8 MPa
end
subsection Boundary: top
  set absorbing  = true
  set traction x = 8 MPa
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";
      const double size = 30e6 * 30e6 / (2. * 70e9) * 20e-3 * 10e-3;
      Steps<2> by_nodes(stressed, explicit_steps);
      Scene<2> joined(stressed);
      for (unsigned int k = 0; k < 100; ++k) {
        by_nodes.step();
        joined.advance();
      }
      for (const Scene<2> *run :
           {static_cast<Scene<2> *>(&by_nodes), &joined}) {
        EXPECT_LT(run->state.energy.kinetic, 1e-24 * size);
        EXPECT_LT(run->state.energy.absorbed, 1e-22 * size);
      }
    }

    // A fault that slips and reaches the side: its points push what the side
    // holds.
    TEST(AbsorbingSides, MeetFaults)
    {
      const std::string fault = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = 0, -10 mm
  set upper corner = 20 mm, 10 mm
  set cells        = 8, 8
end
subsection Material: rock
  set Young modulus     = 70 GPa
  set Poisson ratio     = 0.2
  set density           = 2500 kg/m^3
  set initial stress yy = -10 MPa
end
subsection Interface: fault
  set where             = abs(y) < 1 um
  set law               = contact
  set friction          = 0.1
  set initial stress xy = 3 MPa
end
subsection Interface: all
  set law = joined
end
subsection Boundary: around
  set where     = all
  set absorbing = true
end
subsection Boundary: bottom
  set traction y = 10 MPa
end
subsection Boundary: top
  set traction y = -10 MPa
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";
      Steps<2> by_nodes(fault, explicit_steps);
      Scene<2> joined(fault, {"Solver/tolerance=1e-11"});
      for (unsigned int k = 0; k < 200; ++k)
        EXPECT_LT(by_nodes.step().balance_residual, 1e-12);
      for (unsigned int k = 0; k < 40; ++k)
        EXPECT_LT(joined.advance().balance_residual, 1e-9);
      for (const Scene<2> *run :
           {static_cast<Scene<2> *>(&by_nodes), &joined}) {
        EXPECT_GT(run->state.energy.friction, 0.);
        EXPECT_GT(run->state.energy.absorbed, 0.);
        EXPECT_NEAR(run->state.energy.numerical, 0.,
                    1e-9 * run->state.largest_energy);
      }
    }

    // A side that is held along x alone absorbs along y.
    TEST(AbsorbingSides, PartlyHeld)
    {
      const std::string held =
          bar(true).substr(0, bar(true).find("subsection Boundary: right")) +
          R"(
subsection Boundary: around
  set where     = all
  set absorbing = true
end
subsection Boundary: left
  set velocity x = 0.01 * sin(t/(1e-5 s))
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";
      Steps<2> by_nodes(held, explicit_steps);
      Scene<2> joined(held);
      for (unsigned int k = 0; k < 100; ++k) {
        EXPECT_LT(by_nodes.step().balance_residual, 1e-12);
        EXPECT_LT(joined.advance().balance_residual, 1e-12);
      }
      EXPECT_GT(by_nodes.state.energy.absorbed, 0.);
      EXPECT_GT(joined.state.energy.absorbed, 0.);
    }

    // The sides of a disc are inclined: both components of a node are braked
    // together.
    TEST(AbsorbingSides, Inclined)
    {
      const std::string disc = R"(
set dimension = 2
subsection Mesh
  set type        = hyper_ball
  set arguments   = 0, 0 : 1 : false
  set refinements = 4
end
subsection Material: rock
  set Young modulus      = 70 GPa
  set Poisson ratio      = 0.2
  set density            = 2500 kg/m^3
  set initial velocity x = exp(-(((x^2 + y^2)/0.05)))
end
subsection Interface: all
  set law = joined
end
subsection Boundary: around
  set where     = all
  set absorbing = true
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";
      Steps<2> by_nodes(disc, explicit_steps);
      Scene<2> joined(disc);
      const double start = by_nodes.energy();
      while (by_nodes.state.time < 1.5 / c_s)
        EXPECT_LT(by_nodes.step().balance_residual, 1e-12);
      while (joined.state.time < 1.5 / c_s)
        EXPECT_LT(joined.advance().balance_residual, 1e-12);
      // waves of the middle meet the side nearly along its normal
      EXPECT_GT(by_nodes.state.energy.absorbed, 0.9 * start);
      EXPECT_NEAR(by_nodes.state.energy.absorbed, joined.state.energy.absorbed,
                  0.03 * start);
      // a fault that reaches it would couple both components of its points
      EXPECT_THROW(
          Steps<2>(disc.substr(0, disc.find("  set law = joined")) +
                       "  set law = contact\n" +
                       disc.substr(disc.find("end\nsubsection Boundary")),
                   explicit_steps),
          std::exception);
    }

    TEST(AbsorbingSides, InSpace)
    {
      const std::string block = R"(
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 4 mm, 4 mm, 4 mm
  set cells        = 4, 4, 4
end
subsection Material: rock
  set Young modulus      = 70 GPa
  set Poisson ratio      = 0.2
  set density            = 2500 kg/m^3
  set initial velocity x = exp(-(x^2 + y^2 + z^2)/(1 mm)^2)
end
subsection Interface: all
  set law = joined
end
subsection Boundary: around
  set where     = all
  set absorbing = true
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";
      Steps<3> by_nodes(block, explicit_steps);
      Steps<3> by_tetrahedra(block, {"Time/scheme=explicit", "Time/step=auto",
                                     "Mesh/type=tetrahedra"});
      Scene<3> joined(block);
      const double start = by_nodes.energy(), start_joined = joined.energy();
      for (unsigned int k = 0; k < 100; ++k) {
        EXPECT_LT(by_nodes.step().balance_residual, 1e-12);
        EXPECT_LT(by_tetrahedra.step().balance_residual, 1e-12);
        EXPECT_LT(joined.advance().balance_residual, 1e-12);
      }
      // the block as a whole keeps a speed that its sides brake like exp(-t/T)
      EXPECT_GT(by_nodes.state.energy.absorbed, 0.9 * start);
      EXPECT_GT(joined.state.energy.absorbed, 0.9 * start_joined);
    }

    TEST(AbsorbingSides, AreRefusedWhereTheyAreUnknown)
    {
      const auto refused = [](const Overrides &overrides,
                              const std::string &reason) {
        InputErrors errors;
        EXPECT_FALSE(read_scene_text(bar(true), "test.prm", overrides, errors));
        EXPECT_NE(errors.report().find(reason), std::string::npos)
            << errors.report();
      };
      refused({"motion=large"}, "linear elastic bodies in small motions");
      refused({"Boundary: right/velocity x=1"}, "absorbs nothing");
      refused({"Time/scheme=arkode"}, "knows no absorbing sides");
    }
  } // namespace
} // namespace nsfd::test_absorbing_sides
