#include "leapfrog_steps.h"
#include "momenta.h"
#include "two_blocks.h"

#include "joined/finite_forces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

// Explicit steps of motions of any size: energies, momenta, contact.

namespace nsfd
{
  namespace
  {
    using test::Steps;

    /** A soft block that flies, spins and rings: no loads and no contact. */
    std::string tumbling(const unsigned int dim)
    {
      return fmt::format(R"(
set dimension = {}
set motion    = large
subsection Mesh
  set type         = {}
  set upper corner = {}
  set cells        = {}
end
subsection Material: rubber
  set model         = neo-hookean
  set Young modulus = 1 MPa
  set Poisson ratio = 0.3
  set density       = 1000 kg/m^3
  set initial velocity x = 1 + 40 * (y - 0.1) + 15 * x
  set initial velocity y = -40 * (x - 0.2)
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set scheme = explicit
  set step   = 0.2 ms
  set end    = 0.2 s
end
)",
                         dim, dim == 2 ? "rectangle" : "brick",
                         dim == 2 ? "0.4, 0.2" : "0.4, 0.2, 0.2",
                         dim == 2 ? "4, 2" : "3, 2, 1");
    }

    /** The kick of a step ends half of it before its places: momenta are those
        of these velocities at these places, since forces have no moment. */
    template <int dim>
    void expect_momenta_and_energy()
    {
      double worst[2] = {};
      for (const unsigned int k : {1u, 2u}) {
        Steps<dim> scene(tumbling(dim),
                         {fmt::format("Time/step={} ms", 0.2 / k)});
        const auto momenta = [&scene] {
          scene.leapfrog->show(scene.state);
          return test::momenta(scene);
        };
        scene.step();
        const auto first = momenta();
        for (unsigned int i = 0; i < 500 * k; ++i) {
          const StepReport report = scene.step();
          ASSERT_LT(report.balance_residual, 1e-13);
          worst[k - 1] =
              std::max(worst[k - 1], std::abs(scene.state.energy.numerical) /
                                         scene.state.largest_energy);
        }
        const auto last = momenta();
        for (unsigned int which = 0; which < 2; ++which)
          EXPECT_LT(test::norm(test::difference(last[which], first[which])),
                    1e-11 * test::norm(first[which]))
              << which;
        // it has turned by more than a revolution
        EXPECT_GT(scene.state.time * 40. / 2., 1.);
      }
      EXPECT_LT(worst[0], 2e-3);
      // of second order, without a trend over as many oscillations
      EXPECT_LT(worst[1], worst[0] / 3.);
    }

    TEST(LargeLeapfrog, TumblingBlockKeepsMomentaAndEnergy)
    {
      expect_momenta_and_energy<2>();
      expect_momenta_and_energy<3>();
    }

    /** Two blocks of different meshes, one of them with a velocity. */
    const std::string pair = test::two_blocks + R"(
subsection Material: lower
  set where         = outer
  set model         = saint-venant kirchhoff
  set Young modulus = 1 GPa
  set Poisson ratio = 0
  set density       = 1000 kg/m^3
end
subsection Material: upper
  set where         = inner
  set model         = saint-venant kirchhoff
  set Young modulus = 1 GPa
  set Poisson ratio = 0
  set density       = 1000 kg/m^3
end
subsection Interface: all
  set law = rigid
end
subsection Contact: all
  set friction = 0.4
end
)";

    // Opposite sides of a plate thinner than a quarter of a facet do not touch
    // each other through the plate.
    TEST(LargeLeapfrog, ThinPlateDoesNotTouchItself)
    {
      Steps<2> scene(R"(
set dimension = 2
set motion = large
subsection Mesh
  set upper corner = 4 mm, 0.15 mm
  set cells = 4, 3
end
subsection Material: m
  set model = neo-hookean
  set Young modulus = 1 GPa
  set Poisson ratio = 0.3
  set density = 1000 kg/m^3
  set initial velocity y = 2 m/s * sin(1000 * x)
end
subsection Interface: all
  set law = camacho-ortiz
  set strength = 1 GPa
  set toughness = 1 kJ/m^2
end
subsection Contact: all
  set between = all
end
subsection Time
  set end = 5 us
  set scheme = explicit
end
)");
      for (unsigned int i = 0; i < 150; ++i)
        EXPECT_EQ(scene.step().active, 0u);
      EXPECT_EQ(scene.state.penetration, 0.);
    }

    /** Both halves of each reaction balance E A eps of a bar of two parts. */
    TEST(LargeLeapfrog, PressedBlocksCarryTheForceOfABar)
    {
      Steps<2> scene(pair + R"(
subsection Boundary: foot
  set where      = y < 1 um
  set velocity y = 0
end
subsection Boundary: head
  set where      = y > 99.999 mm
  set velocity y = -10 mm/s
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 10 ms
end
)");
      double foot = 0.;
      unsigned int n = 0;
      while (scene.state.time < 10e-3 * (1. - 1e-9)) {
        const StepReport report = scene.step();
        ASSERT_LT(report.balance_residual, 1e-12);
        if (scene.state.time < 9e-3)
          continue;
        foot += scene.leapfrog->reactions()[1];
        ++n;
      }
      // mean strain 9.5e-4 of the last millisecond; waves ring by 1e-2 m/s
      // times the impedance, 2e2 N/m
      EXPECT_NEAR(foot / n, 1e9 * 20e-3 * 9.5e-4, 0.02 * 2e4);
      const EnergyLines &e = scene.state.energy;
      EXPECT_NEAR(e.work, 0.5 * 1e9 * 20e-3 * 0.1 * 1e-6, 0.02);
      EXPECT_LT(std::abs(e.friction), 1e-9 * e.work);
      EXPECT_GE(e.impact, -1e-9 * e.work);
    }

    /** The foot of what is dragged takes the friction of its normal force. */
    TEST(LargeLeapfrog, DraggedBlockRubs)
    {
      Steps<2> scene(pair + R"(
subsection Boundary: foot
  set where      = y < 1 um
  set velocity x = 0
  set velocity y = 0
end
subsection Boundary: head
  set where      = y > 99.999 mm
  set velocity x = 2 m/s * min(t / (0.5 ms), 1)
  set velocity y = if(t < 0.5 ms, -0.2 m/s, 0)
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 4 ms
end
)");
      double shear = 0., normal = 0., gained = 0.;
      while (scene.state.time < 4e-3 * (1. - 1e-9)) {
        const double before = scene.state.energy.friction;
        ASSERT_LT(scene.step().balance_residual, 1e-12);
        gained = std::max(gained, before - scene.state.energy.friction);
        if (scene.state.time < 2e-3)
          continue;
        shear += scene.leapfrog->reactions()[0];
        normal += scene.leapfrog->reactions()[1];
      }
      // it rings, and sticks where that turns it back
      EXPECT_LE(std::abs(shear / normal), 0.4 + 1e-3);
      EXPECT_GE(std::abs(shear / normal), 0.36);
      EXPECT_LE(gained, 1e-10 * scene.state.energy.friction);
    }

    /** A soft ball of two bodies that break: nothing is created. */
    const std::string projectile = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: plate
  set type         = rectangle
  set lower corner = 0, -15 mm
  set upper corner = 10 mm, 15 mm
  set cells        = 4, 12
end
subsection Body: projectile
  set type         = rectangle
  set lower corner = -10.1 mm, -4 mm
  set upper corner = -0.1 mm, 4 mm
  set cells        = 4, 3
end
subsection Material: glass
  set where         = plate
  set model         = neo-hookean
  set Young modulus = 70 GPa
  set Poisson ratio = 0.22
  set density       = 2500 kg/m^3
end
subsection Material: steel
  set where              = projectile
  set model              = neo-hookean
  set Young modulus      = 210 GPa
  set Poisson ratio      = 0.3
  set density            = 7800 kg/m^3
  set initial velocity x = 50 m/s
end
subsection Interface: glass
  set where     = plate
  set law       = camacho-ortiz
  set strength  = 60 MPa
  set toughness = 10 J/m^2
  set friction  = 0.3
end
subsection Interface: steel
  set law = rigid
end
subsection Contact: all
  set friction = 0.3
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 30 us
end
)";

    TEST(LargeLeapfrog, ProjectileBreaksAPlateWithoutEnergyFromNothing)
    {
      Steps<2> scene(projectile);
      const auto momentum = scene.momentum();
      const double end = scene.input->time.end;
      EnergyLines before = scene.state.energy;
      while (scene.state.time < end * (1. - 1e-9)) {
        const double h =
            scene.time_step *
            std::min(1., std::pow(0.5, std::ceil(-std::log2(
                                           scene.leapfrog->stable_share()))));
        ASSERT_LT(scene.step(h / scene.time_step).balance_residual, 1e-12);
        const EnergyLines &now = scene.state.energy;
        const double least = -1e-12 * scene.state.largest_energy;
        EXPECT_GE(now.friction - before.friction, least);
        EXPECT_GE(now.damage - before.damage, least);
        EXPECT_GE(now.impact - before.impact, least);
        EXPECT_GE(now.viscous - before.viscous, least);
        before = now;
        // crack faces that are left to the search hold nothing in either chain
        scene.leapfrog->show(scene.state);
        for (std::size_t i = 0; i < scene.state.kind.size(); ++i)
          if (scene.state.kind[i] == PointKind::separated) {
            ASSERT_LE(scene.state.beta[i], 0.);
          }
      }
      EXPECT_GT(scene.state.broken_area, 10e-3);
      EXPECT_GT(before.friction, 0.);
      const auto after = scene.momentum();
      EXPECT_NEAR(after[0], momentum[0], 1e-10 * momentum[0]);
      EXPECT_NEAR(after[1], 0., 1e-10 * momentum[0]);
    }

    /** Tractions are nominal, along and across where the face has turned to. */
    TEST(FiniteForces, TractionsTurnWithTheFace)
    {
      for (const double angle : {0., 0.7, 2.5}) {
        Steps<2> scene(fmt::format(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 1, 1
  set cells        = 2, 1
end
subsection Material: steel
  set model         = saint-venant kirchhoff
  set Young modulus = 200 GPa
  set Poisson ratio = 0
  set density       = 7800 kg/m^3
  set initial displacement x = 1.001 * x * cos({0}) - y * sin({0}) - x
  set initial displacement y = 1.001 * x * sin({0}) + y * cos({0}) - y
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1 GPa
  set toughness = 1 kJ/m^2
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 1 ms
end
)",
                                   angle));
        scene.leapfrog->show(scene.state);
        // F S of E_xx = (1.001^2 - 1)/2
        const double stress = 1.001 * 200e9 * (1.001 * 1.001 - 1.) / 2.;
        bool found = false;
        for (std::size_t i = 0; i < scene.state.kind.size(); ++i)
          if (scene.state.kind[i] == PointKind::bonded) {
            found = true;
            EXPECT_NEAR(scene.state.bond_traction[2 * i], stress,
                        1e-9 * stress);
            EXPECT_NEAR(scene.state.bond_traction[2 * i + 1], 0.,
                        1e-9 * stress);
          }
        EXPECT_TRUE(found);
      }
    }

    /** A block of few cells is thrown against the floor and rings: steps in
        which its forces change much are rejected until they are short enough,
        and what its front viscosity holds comes back when it rebounds. */
    TEST(LargeLeapfrog, FastImpactsGiveLittle)
    {
      double slow = 0.; // given at the speed before
      for (const double speed : {0.05, 1., 10.}) {
        Steps<2> scene(fmt::format(R"(
set motion = large
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0.001
  set upper corner = 0.3, 0.201
  set cells        = 3, 2
end
subsection Material: rubber
  set model         = neo-hookean
  set Young modulus = 5 MPa
  set Poisson ratio = 0.45
  set density       = 1100 kg/m^3
  set initial velocity y = -{}
end
subsection Interface: all
  set law = rigid
end
subsection Obstacle: floor
  set point  = 0, 0
  set normal = 0, 1
end
subsection Time
  set scheme          = explicit
  set front viscosity = 0.2
  set step            = auto
  set end             = 20 ms
end
)",
                                   speed));
        double share = 1.;
        EnergyWatch watch;
        unsigned int rejected = 0;
        while (scene.state.time < 0.001 / speed + 0.015) {
          try {
            const StepReport report = scene.step(share);
            ASSERT_LT(report.balance_residual, 1e-12);
            watch.add(report.changes);
          } catch (const StepRejected &) {
            share /= 2.;
            ASSERT_LT(++rejected, 4u);
          }
        }
        EXPECT_GT(scene.state.energy.impact, 0.);
        const double given =
            watch.given[std::size_t(WatchedLine::large_motion)] /
            scene.state.largest_energy;
        EXPECT_LT(given, 1e-3) << speed; // what the certificate allows
        EXPECT_EQ(rejected > 0, speed > 5.) << speed;
        // the error of the bulk goes with the strain, and so with the speed;
        // what a viscosity gives would be the same share of the energy
        if (speed == 1.) {
          EXPECT_LT(slow, 0.1 * given);
        }
        slow = given;
      }
    }

    /** A block is pulled so fast that the forces of a stable step are far from
        linear: it is not taken, however often it is tried. */
    TEST(LargeLeapfrog, NoStepGivesWhatARunMayNot)
    {
      Steps<2> scene(tumbling(2),
                     {"Material: rubber/initial velocity x=300 * x",
                      "Material: rubber/initial velocity y=0", "Time/step=auto",
                      "Time/end=0.02 s"});
      for (unsigned int attempt = 0; attempt < 8; ++attempt)
        EXPECT_THROW(scene.step(), StepRejected) << attempt;
      double share = 0.5;
      unsigned int taken = 0;
      while (taken < 20)
        try {
          const StepReport report = scene.step(share);
          const auto line = std::size_t(WatchedLine::large_motion);
          EXPECT_GE(report.changes.taken[line],
                    -most_of_large_motion * scene.state.largest_energy);
          ++taken;
        } catch (const StepRejected &) {
          share /= 2.;
          ASSERT_GT(share, 1e-3);
        }
      EXPECT_LT(share, 0.5);
    }
  } // namespace
} // namespace nsfd
