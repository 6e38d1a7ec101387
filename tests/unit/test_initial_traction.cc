#include "leapfrog_steps.h"

#include "simulation/stress_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Faults that carry another stress than the cells beside them.

namespace nsfd::test_initial_traction
{
  namespace
  {
    using test::Scene;
    using test::Steps;
    using Overrides = std::vector<std::string>;

    const Overrides explicit_steps = {"Time/scheme=explicit", "Time/step=auto"};

    Overrides operator+(Overrides a, const Overrides &b)
    {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    }

    /** What a stress of 30 MPa would store in a block of this size, about. */
    constexpr double size = 30e6 * 30e6 / (2. * 70e9) * 20e-3 * 10e-3;

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
  set friction          = 0.6
  set initial stress xy = if(x < 10 mm, 5 MPa, 3 MPa)
end
subsection Interface: all
  set law = joined
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

    /** Pa, at the points of the fault: P over w and the time it took. */
    template <int dim>
    void expect_carried(const Scene<dim> &run, const double time)
    {
      const auto &points = run.discretization->points();
      unsigned int n = 0;
      for (std::size_t i = 0; i < points.n_points; ++i) {
        if (run.discretization->origins()[i].kind !=
                PointOrigin::Kind::interface ||
            run.discretization->origins()[i].block != 0)
          continue;
        const auto &face = points.faces[points.face_of[i]];
        if (std::abs(face.centre[0] - 10e-3) < 2.5e-3)
          continue; // where the stress jumps two points share a node
        const double *P = &run.state.impulse[i * dim],
                     wt = points.weight[i] * time,
                     shear = face.centre[0] < 10e-3 ? 5e6 : 3e6;
        EXPECT_NEAR(P[0] / wt, 10e6, 1e-7 * 10e6);
        EXPECT_NEAR(std::abs(P[1]) / wt, shear, 1e-7 * 10e6);
        ++n;
      }
      EXPECT_EQ(n, 12u);
    }

    // A fault carries what its block says, the other faces what the cells do:
    // at rest while friction holds it, with a stress drop of 5 - 1 MPa and 3 -
    // 1 MPa from the first step on if it does not.
    TEST(InitialTraction, OfAFault)
    {
      Scene<2> run(fault, {"Solver/tolerance=1e-12"});
      for (unsigned int k = 0; k < 5; ++k)
        run.advance();
      EXPECT_LT(run.state.energy.kinetic, 1e-18 * size);
      expect_carried(run, run.time_step);

      Scene<2> weak(
          fault, {"Interface: fault/friction=0.1", "Solver/tolerance=1e-12"});
      const double before = weak.state.energy.work;
      const auto report = weak.advance();
      EXPECT_LT(report.balance_residual, 1e-10);
      EXPECT_GT(weak.state.energy.work, before);
      EXPECT_GT(weak.state.energy.friction, 0.);
    }

    TEST(InitialTraction, OfAFaultInExplicitSteps)
    {
      Steps<2> run(fault, explicit_steps);
      for (unsigned int k = 0; k < 50; ++k)
        run.step();
      EXPECT_LT(run.state.energy.kinetic, 1e-24 * size);
      Steps<2> weak(fault, explicit_steps +
                               Overrides{"Interface: fault/friction=0.1"});
      double residual = 0.;
      for (unsigned int k = 0; k < 300; ++k)
        residual = std::max(residual, weak.step().balance_residual);
      EXPECT_LT(residual, 1e-12);
      EXPECT_GT(weak.state.energy.friction, 0.);
      EXPECT_NEAR(weak.state.energy.numerical, 0.,
                  1e-12 * weak.state.largest_energy);
    }

    TEST(InitialTraction, WhatIsBeyondFrictionIsReported)
    {
      Scene<2> slips(fault, {"Interface: fault/friction=0.4"});
      const std::string report = initial_stress_report<2>(
          *slips.input, *slips.discretization, slips.communicator);
      EXPECT_NE(report.find("on 8 of 16 points of Interface: fault"),
                std::string::npos)
          << report;
    }
  } // namespace
} // namespace nsfd::test_initial_traction
