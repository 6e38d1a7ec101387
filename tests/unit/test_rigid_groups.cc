#include "leapfrog_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Rigid bodies in `scheme = explicit`.

namespace nsfd::test_rigid_groups
{
  namespace
  {
    using test::Steps;

    // a mass of 0.01 strikes a bar of Z A = 0.02
    const std::string strike = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = -0.1, 0
  set upper corner = 1, 0.02
  set cells        = 220, 2
end
subsection Material: mass
  set where              = x < 0
  set model              = rigid
  set density            = 5
  set initial velocity x = 0.01
end
subsection Material: bar
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: touch
  set where    = between materials [mass, bar]
  set law      = contact
  set friction = 0.2
end
subsection Interface: joints
  set where = all
  set law   = joined
end
subsection Time
  set end    = 0.9
  set step   = auto
  set scheme = explicit
end
)";

    template <int dim>
    double expect_balance(Steps<dim> &run)
    {
      double residual = 0.;
      while (run.state.time < run.input->time.end) {
        const StepReport report = run.step();
        residual = std::max(residual, report.balance_residual);
        EXPECT_GE(run.state.energy.kinetic, 0.);
        EXPECT_GE(run.state.energy.elastic, 0.);
      }
      EXPECT_LT(residual, 1e-13);
      return residual;
    }

    /** Of node 0 of the cell there. */
    template <int dim>
    std::array<double, dim> velocity_at(Steps<dim> &run, const double x)
    {
      run.leapfrog->show(run.state);
      const auto &cells = run.discretization->cells();
      std::array<double, dim> result{};
      for (std::size_t b = 0; b < cells.bodies.size(); ++b)
        if (std::abs(cells.centre(b)[0] - x) < 0.003)
          std::copy_n(&run.state.velocity[cells.bodies.first_dof[b]], dim,
                      result.begin());
      return result;
    }

    // V = V_0 exp(-Z A t / m), the first wave carries the momentum away
    TEST(RigidGroups, MassStrikesBar)
    {
      Steps<2> run(strike);
      expect_balance(run);
      const double exact = 0.01 * std::exp(-2. * run.state.time);
      EXPECT_NEAR(velocity_at(run, -0.0525)[0], exact, 0.01 * 0.01);
      EXPECT_NEAR(run.momentum()[0], 1e-4, 1e-15); // m V_0
      EXPECT_LT(run.state.penetration, 1e-16);
    }

    // common nodes: the body takes the end of the bar along
    TEST(RigidGroups, JoinedMassPushesBar)
    {
      Steps<2> run(strike, {"Interface: touch/where=x > 2"});
      expect_balance(run);
      const double exact = 0.01 * std::exp(-2. * run.state.time);
      EXPECT_NEAR(velocity_at(run, -0.0525)[0], exact, 0.01 * 0.01);
      EXPECT_NEAR(run.momentum()[0], 1e-4, 1e-15);
    }

    // Nodes that a rigid mass shares with a viscous bar move with it from the
    // start: there is no rate of strain in which its viscosity could act.
    TEST(RigidGroups, StartsViscousBarsWithoutForce)
    {
      Steps<2> run(strike,
                   {"Interface: touch/where=x > 2",
                    "Material: mass/initial velocity x=0.01 + 0.005 * cos(2 * "
                    "pi * y / 0.02)",
                    "Material: bar/initial velocity x=0.01",
                    "Material: bar/shear viscosity=1e-3",
                    "Material: bar/bulk viscosity=1e-3"});
      EXPECT_NEAR(velocity_at(run, -0.0525)[0], 0.01, 1e-15);
      const double start = run.state.energy.kinetic;
      for (unsigned int k = 0; k < 3; ++k)
        run.step();
      EXPECT_LT(run.state.energy.viscous, 1e-14 * start);
      EXPECT_NEAR(run.state.energy.kinetic, start, 1e-13 * start);
    }

    // the cells of a rigid body do not enter the bound of the step
    TEST(RigidGroups, DoesNotShortenTheStep)
    {
      const Steps<2> light(strike, {"Material: mass/density=1e-9"}),
          heavy(strike);
      EXPECT_EQ(light.time_step, heavy.time_step);
    }

    // held in all its unknowns: reaction and work are those of the wave
    TEST(RigidGroups, DrivenBodyPushesBar)
    {
      Steps<2> run(strike + R"(
subsection Boundary: left
  set velocity x = 0.01
  set velocity y = 0
end
)");
      expect_balance(run);
      const double t = run.state.time, force = 0.02 * 0.01;
      EXPECT_NEAR(run.state.energy.work, force * 0.01 * t, 0.01 * force * t);
      EXPECT_NEAR(run.leapfrog->reactions()[0], force, 0.01 * force);
    }

    // supports that leave the rotation free: a pendulum's first swing
    TEST(RigidGroups, SwingsWhereItIsHeld)
    {
      Steps<2> run(R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 0.1
  set cells        = 20, 1
end
subsection Material: rod
  set where   = x < 1
  set model   = rigid
  set density = 1
  set body force y = -1e-4
end
subsection Material: tail
  set model         = linear elastic
  set Young modulus = 1e-9
  set Poisson ratio = 0
  set density       = 1e-9
end
subsection Interface: none
  set where = between materials [rod, tail]
  set law   = contact
end
subsection Interface: joints
  set where = all
  set law   = joined
end
subsection Boundary: pin
  set where      = left
  set velocity y = 0
end
subsection Time
  set end    = 1
  set step   = auto
  set scheme = explicit
end
)");
      expect_balance(run);
      // torque over the inertia about the end, its exact one; the tail weighs
      // nothing
      const double alpha = -1e-4 * 0.5 / (1. / 3. + 0.01 / 12.),
                   t = run.state.time - run.state.last_step / 2.;
      EXPECT_NEAR(velocity_at(run, 0.95)[1], 0.9 * alpha * t, 1e-8 * 1e-4);
      EXPECT_NEAR(velocity_at(run, 0.05)[1], 0., 1e-8 * 1e-4);
      EXPECT_NEAR(run.leapfrog->reactions()[1],
                  1e-5 - 0.1 * std::abs(alpha) / 2., 1e-8 * 1e-5);
    }

    const std::string grips = R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = 4, 1
  set cells        = 16, 4
end
subsection Material: grip one
  set where   = x < 0.5
  set model   = rigid
  set density = 1
end
subsection Material: grip two
  set where   = x > 3.5
  set model   = rigid
  set density = 1
end
subsection Material: strip
  set model         = linear elastic
  set Young modulus = 1000
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: law
  set where     = all
  set law       = camacho-ortiz
  set strength  = 2
  set toughness = 0.004
  set friction  = 0.3
end
subsection Boundary: left
  set displacement x = 0
  set displacement y = 0
end
subsection Boundary: right
  set displacement x = 0.02 * t - 0.01 * t * (y - 0.5)
  set displacement y = 0.01 * t * (x - 4)
end
subsection Time
  set end    = 0.6
  set step   = auto
  set scheme = explicit
end
)";

    // a law everywhere: each grip is one body, and its border is released by
    // the traction of the strip
    TEST(RigidGroups, GripsPullAndTurn)
    {
      Steps<2> run(grips);
      expect_balance(run);
      EXPECT_GE(run.state.broken_area, 1.);
      EXPECT_GE(run.state.energy.damage, 0.004 * run.state.broken_area);
    }

    TEST(RigidGroups, RefusesMotionOfDeformingBodies)
    {
      EXPECT_THROW(
          Steps<2>(grips, {"Boundary: right/displacement y=0.01 * t * y"}),
          std::exception);
    }

    // everything at once, in space: what breaks, rubs and strikes
    TEST(RigidGroups, PunchBreaksPlate)
    {
      Steps<3> run(R"(
set dimension = 3
subsection Mesh
  set type         = tetrahedra
  set upper corner = 40 mm, 40 mm, 8 mm
  set cells        = 5, 5, 2
end
subsection Material: punch
  set where              = x > 8 mm && x < 24 mm && y > 16 mm && y < 32 mm && z > 4 mm
  set model              = rigid
  set density            = 7800 kg/m^3
  set initial velocity z = -30 m/s
  set initial velocity x = 10 m/s
end
subsection Material: plate
  set model         = linear elastic
  set Young modulus = 70 GPa
  set Poisson ratio = 0.2
  set density       = 2500 kg/m^3
end
subsection Interface: contact
  set where    = between materials [punch, plate]
  set law      = contact
  set friction = 0.3
end
subsection Interface: glass
  set where     = between materials [plate, plate]
  set law       = camacho-ortiz
  set strength  = 60 MPa
  set toughness = 50 J/m^2
  set friction  = 0.3
end
subsection Interface: within
  set where = all
  set law   = joined
end
subsection Time
  set end    = 15 us
  set step   = auto
  set scheme = explicit
end
)");
      const auto before = run.momentum();
      expect_balance(run);
      const auto after = run.momentum();
      const double size = std::hypot(before[0], before[2]);
      for (unsigned int c = 0; c < 3; ++c)
        EXPECT_NEAR(after[c], before[c], 1e-12 * size);
      EXPECT_GT(run.state.energy.damage, 0.);
      EXPECT_GT(run.state.energy.friction, 0.);
      EXPECT_LT(run.state.penetration, 1e-14 * 0.04); // m, of 40 mm
    }
  } // namespace
} // namespace nsfd::test_rigid_groups
