#include "leapfrog_steps.h"

#include "nsfd/bodies/rigid_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>

// Rigid bodies in explicit steps of large motions.

namespace nsfd
{
  namespace
  {
    using namespace space;
    using test::Steps;

    RigidState body(const State &state, const unsigned int number)
    {
      return rigid_state(&state.rigid[13 * number]);
    }

    /** A brick that tumbles about its middle axis: both momenta and the energy
        stay, and with equal second and third moments its axis goes around the
        angular momentum with |L| / I_2. */
    TEST(LargeRigid, FreeBrickKeepsMomentaAndEnergy)
    {
      const double a = 0.3, b = 0.2, m = 1000. * 0.3 * 0.2 * 0.1;
      for (const double c : {0.1, 0.2}) {
        const double mass = m * c / 0.1;
        const RigidInertia inertia{mass,
                                   {{{mass / 12. * (b * b + c * c), 0., 0.},
                                     {0., mass / 12. * (a * a + c * c), 0.},
                                     {0., 0., mass / 12. * (a * a + b * b)}}}};
        Steps<3> scene(fmt::format(R"(
set dimension = 3
set motion    = large
subsection Mesh
  set type         = brick
  set upper corner = 0.3, 0.2, {}
  set cells        = 3, 2, 1
end
subsection Material: stone
  set model   = rigid
  set bodies  = connected
  set density = 1000 kg/m^3
  set initial velocity x = 2 - 10 * (z - {})
  set initial velocity y = - 4 * (z - {})
  set initial velocity z = 10 * (x - 0.15) + 4 * (y - 0.1)
end
subsection Interface: all
  set law = joined
end
subsection Time
  set scheme = explicit
  set step   = 1 ms
  set end    = 2 s
end
)",
                                   c, c / 2., c / 2.));
        scene.leapfrog->show(scene.state);
        const RigidState first = body(scene.state, 0);
        const Vec3 L = angular_momentum(inertia, first);
        const double energy = scene.state.energy.kinetic;
        EXPECT_NEAR(energy, kinetic_energy(inertia, first), 1e-12 * energy);
        // omega = (4, -10, 0)
        EXPECT_NEAR(L[0], inertia.inertia[0][0] * 4., 1e-12 * norm(L));
        EXPECT_NEAR(L[1], -inertia.inertia[1][1] * 10., 1e-12 * norm(L));
        Vec3 axis{};
        for (unsigned int k = 0; k < 2000; ++k) {
          ASSERT_LT(scene.step().balance_residual, 1e-12);
          scene.leapfrog->show(scene.state);
          const RigidState now = body(scene.state, 0);
          ASSERT_LT(norm(angular_momentum(inertia, now) - L), 1e-11 * norm(L));
          ASSERT_NEAR(scene.state.energy.kinetic, energy, 1e-12 * energy);
          axis = rotation(now.orientation) * Vec3{1., 0., 0.};
        }
        const RigidState last = body(scene.state, 0);
        EXPECT_NEAR(last.centre[0] - first.centre[0], 2. * 2., 1e-11);
        if (c != b)
          continue;
        // a whole turn takes 0.6 s: with 1 ms the angle is right to (h w)^2/12
        const double rate = norm(L) / inertia.inertia[1][1], t = 2.,
                     angle = rate * t;
        const Vec3 n = (1. / norm(L)) * L, x{1., 0., 0.},
                   wanted = std::cos(angle) * x +
                            std::sin(angle) * cross(n, x) +
                            ((1. - std::cos(angle)) * dot(n, x)) * n;
        EXPECT_LT(norm(axis - wanted), angle * 1e-4 / 12. * 2.);
      }
    }

    /** A square whose corner points down falls on a rod that floats, 0.3 m from
        its middle: P = (1 + e) v / (1/m_1 + 1/m_2 + d^2/I_2). */
    std::string corner_on_rod(const double e)
    {
      return fmt::format(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: rod
  set type         = rectangle
  set lower corner = -0.5, 0
  set upper corner = 0.5, 0.1
  set cells        = 5, 1
end
subsection Body: square
  set type         = rectangle
  set lower corner = 0.25, 0.2
  set upper corner = 0.35, 0.3
  set cells        = 1, 1
end
subsection Material: rod
  set where   = rod
  set model   = rigid
  set bodies  = connected
  set density = 1000 kg/m^3
end
subsection Material: square
  set where   = square
  set model   = rigid
  set bodies  = connected
  set density = 3000 kg/m^3
  set initial displacement x = 0.3 + (x - 0.3 - (y - 0.25)) / sqrt(2) - x
  set initial displacement y = 0.25 + (x - 0.3 + y - 0.25) / sqrt(2) - y
  set initial velocity y     = -1
end
subsection Interface: all
  set law = joined
end
subsection Contact: all
  set restitution = {}
end
subsection Time
  set scheme = explicit
  set step   = 1 ms
  set end    = 0.15 s
end
)",
                         e);
    }

    TEST(LargeRigid, CornerThatHitsARodTurnsIt)
    {
      const double m_1 = 3000. * 0.01, m_2 = 1000. * 0.1, d = 0.3,
                   I_2 = m_2 / 12. * (1. + 0.01);
      for (const double e : {0., 0.5, 1.}) {
        Steps<2> scene(corner_on_rod(e));
        const double start = scene.state.energy.kinetic;
        EXPECT_NEAR(start, m_1 / 2., 1e-12 * m_1);
        // without restitution they stay together, and turn: two steps, the
        // gap that is left and the blow
        unsigned int left = e > 0. ? 1000 : 2;
        while (scene.state.time < 0.15 * (1. - 1e-9) && left > 0) {
          ASSERT_LT(scene.step().balance_residual, 1e-13);
          left -= e == 0. && scene.state.energy.impact > 0.;
        }
        scene.leapfrog->show(scene.state);
        const double P = (1. + e) / (1. / m_1 + 1. / m_2 + d * d / I_2),
                     share = e > 0. ? 1e-9 : 1e-3 * d;
        const RigidState rod = body(scene.state, 0),
                         square = body(scene.state, 1);
        EXPECT_NEAR(square.velocity[1], -1. + P / m_1, share);
        EXPECT_NEAR(rod.velocity[1], -P / m_2, share);
        EXPECT_NEAR(rod.spin[2], -P * d / I_2, share);
        EXPECT_NEAR(scene.state.energy.impact,
                    (1. - e) / 2. * P, // P (U+ + U-)/2
                    share * start);
        EXPECT_LT(std::abs(scene.state.energy.numerical), 1e-12 * start);
      }
    }

    /** A rod whose left side turns as told: its far end is where it is to be,
        and the work is what it has. */
    TEST(LargeRigid, DrivenSideTurnsTheBody)
    {
      double off[2];
      for (const unsigned int k : {0u, 1u}) {
        Steps<2> scene(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = 0, -0.05
  set upper corner = 1, 0.05
  set cells        = 5, 1
end
subsection Material: rod
  set model   = rigid
  set bodies  = connected
  set density = 1000 kg/m^3
end
subsection Interface: all
  set law = joined
end
subsection Boundary: axle
  set where          = left
  set displacement x = -y * sin(t * t)
  set displacement y = y * (cos(t * t) - 1)
end
subsection Time
  set scheme = explicit
  set step   = 2 ms
  set end    = 3
end
)",
                       {fmt::format("Time/step={} ms", 2. / (k + 1))});
        const double m = 100., I = m / 12. * 1.01 + m / 4.;
        while (scene.state.time < 3. * (1. - 1e-9)) {
          ASSERT_LT(scene.step().balance_residual, 1e-13);
          ASSERT_NEAR(scene.state.energy.work, scene.state.energy.kinetic,
                      1e-12 * scene.state.largest_energy);
        }
        const double t = scene.state.time, w = 2. * (t - 1e-3 / (k + 1));
        EXPECT_NEAR(scene.state.energy.kinetic, I * w * w / 2.,
                    1e-3 * I * w * w);
        scene.leapfrog->show(scene.state);
        const RigidState now = body(scene.state, 0);
        off[k] = std::hypot(now.centre[0] - 0.5 * std::cos(t * t),
                            now.centre[1] - 0.5 * std::sin(t * t));
      }
      EXPECT_LT(off[0], 1e-3);
      EXPECT_LT(off[1], off[0] / 3.);
    }

    /** A rigid half and a rubber one with common nodes, tumbling and ringing:
        momenta stay, the energy to second order. */
    TEST(LargeRigid, HalfRigidBlockKeepsMomenta)
    {
      double worst[2] = {};
      for (const unsigned int k : {0u, 1u}) {
        Steps<3> scene(R"(
set dimension = 3
set motion    = large
subsection Mesh
  set type         = brick
  set upper corner = 0.4, 0.2, 0.2
  set cells        = 4, 2, 1
end
subsection Material: stone
  set where   = x < 0.2
  set model   = rigid
  set bodies  = connected
  set density = 2000 kg/m^3
  set initial velocity x = 1 + 20 * (y - 0.1)
  set initial velocity y = -20 * (x - 0.2) + 8 * (z - 0.1)
  set initial velocity z = -8 * (y - 0.1)
end
subsection Material: rubber
  set model         = neo-hookean
  set Young modulus = 1 MPa
  set Poisson ratio = 0.3
  set density       = 1000 kg/m^3
  set initial velocity x = 1 + 20 * (y - 0.1) + 5 * (x - 0.2)
  set initial velocity y = -20 * (x - 0.2) + 8 * (z - 0.1)
  set initial velocity z = -8 * (y - 0.1)
end
subsection Interface: all
  set law = joined
end
subsection Time
  set scheme = explicit
  set step   = 0.2 ms
  set end    = 0.3 s
end
)",
                       {fmt::format("Time/step={} ms", 0.2 / (k + 1))});
        const auto &cells = scene.discretization->cells();
        const double mass = 2000. * 0.2 * 0.2 * 0.2;
        const RigidInertia stone{mass,
                                 {{{mass / 12. * 0.08, 0., 0.},
                                   {0., mass / 12. * 0.08, 0.},
                                   {0., 0., mass / 12. * 0.08}}}};
        // of the stone, and of the nodes of the rubber
        const auto momenta = [&] {
          scene.leapfrog->show(scene.state);
          const RigidState s = body(scene.state, 0);
          Vec3 p = mass * s.velocity,
               L = angular_momentum(stone, s) + cross(s.centre, p);
          for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
            if (cells.body_class(b).undeformed)
              continue;
            const auto shape = cells.shape(b);
            for (unsigned int i = 0; i < shape->n_nodes; ++i) {
              const std::size_t at = cells.bodies.first_dof[b] + 3 * i;
              const auto rest = cells.place(b, shape->nodes[i]);
              Vec3 x, v;
              for (unsigned int c = 0; c < 3; ++c) {
                x[c] = rest[c] + scene.state.displacement[at + c];
                v[c] = scene.state.velocity[at + c];
              }
              const double m = lumped_mass(*shape, i);
              p = p + m * v;
              L = L + m * cross(x, v);
            }
          }
          return std::pair(p, L);
        };
        scene.step();
        const auto first = momenta();
        for (unsigned int i = 0; i < 1000 * (k + 1); ++i) {
          ASSERT_LT(scene.step().balance_residual, 1e-12);
          worst[k] = std::max(worst[k], std::abs(scene.state.energy.numerical) /
                                            scene.state.largest_energy);
        }
        const auto last = momenta();
        EXPECT_LT(norm(last.first - first.first), 1e-11 * norm(first.first));
        EXPECT_LT(norm(last.second - first.second), 1e-11 * norm(first.second));
      }
      EXPECT_LT(worst[0], 2e-3);
      EXPECT_LT(worst[1], worst[0] / 3.);
    }

    /** A rigid block breaks a plate: nothing is created, and no momentum is
        lost. */
    TEST(LargeRigid, ProjectileBreaksAPlateWithoutEnergyFromNothing)
    {
      Steps<2> scene(R"(
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
  set model              = rigid
  set bodies             = connected
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
subsection Contact: all
  set friction = 0.3
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 30 us
end
)");
      const double mass = 7800. * 80e-6;
      EnergyLines before = scene.state.energy;
      EXPECT_NEAR(before.kinetic, mass * 50. * 50. / 2.,
                  1e-12 * before.kinetic);
      while (scene.state.time < 30e-6 * (1. - 1e-9)) {
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
        before = now;
      }
      EXPECT_GT(scene.state.broken_area, 10e-3);
      scene.leapfrog->show(scene.state);
      double momentum = mass * body(scene.state, 0).velocity[0];
      const auto &cells = scene.discretization->cells();
      for (std::size_t b = 0; b < cells.bodies.size(); ++b)
        for (unsigned int i = 0;
             !cells.body_class(b).undeformed && i < cells.shape(b)->n_nodes;
             ++i)
          momentum += lumped_mass(*cells.shape(b), i) *
                      scene.state.velocity[cells.bodies.first_dof[b] + 2 * i];
      EXPECT_NEAR(momentum, mass * 50., 1e-10 * mass * 50.);
    }
    /** A rod of 2 m, pinned at its end, is let go where it is level: it passes
        below the pin with I w^2 / 2 = m g l / 2, and the pin holds. */
    TEST(LargeRigid, PinnedRodSwings)
    {
      for (const double step : {2., 1.}) {
        Steps<2> scene(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = 0, -0.05
  set upper corner = 2, 0.05
  set cells        = 4, 1
end
subsection Material: rod
  set model             = rigid
  set bodies            = connected
  set density           = 1000 kg/m^3
  set mass              = 300
end
subsection Interface: all
  set law = joined
end
subsection Pin: end
  set material = rod
  set at       = 0, 0
end
subsection Loads
  set gravity = 0, -10 m/s^2
end
subsection Time
  set scheme = explicit
  set step   = 2 ms
  set end    = 3
end
)",
                       {fmt::format("Time/step={} ms", step)});
        const double m = 300., I = m / 12. * (4. + 0.01) + m;
        double largest = 0., at_most = 0.;
        while (scene.state.time < 1.2) {
          ASSERT_LT(scene.step().balance_residual, 1e-12);
          scene.leapfrog->show(scene.state);
          const RigidState rod = body(scene.state, 0);
          const Vec3 pin =
              rod.centre + rotation(rod.orientation) * Vec3{-1., 0., 0.};
          at_most = std::max(at_most, norm(pin));
          largest = std::max(largest, std::abs(rod.spin[2]));
        }
        EXPECT_LT(at_most, 1e-5);
        // it falls by 1 m; its weight acts at the centre
        EXPECT_NEAR(largest / std::sqrt(2. * m * 10. / I), 1.,
                    1e-4 * step * step / 4.);
      }
    }
    /** A side that turns is one of a rigid body however fast and long it
        does, and one that also becomes longer by a thousandth is not. */
    TEST(LargeRigid, MotionsOfSidesAreCompared)
    {
      for (const double rate : {1e-6, 1., 1e4})
        for (const double longer : {1., 1.001}) {
          SCOPED_TRACE(rate * longer);
          const auto build = [&] {
            Steps<2> scene(fmt::format(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = 0, -0.05
  set upper corner = 1, 0.05
  set cells        = 5, 2
end
subsection Material: rod
  set model   = rigid
  set bodies  = connected
  set density = 1000 kg/m^3
end
subsection Interface: all
  set law = joined
end
subsection Boundary: axle
  set where          = left
  set displacement x = -(y + 0.05) * sin({0:g} * t)
  set displacement y = (y + 0.05) * (cos({0:g} * t) - 1 + ({1:g} - 1) * t * {0:g})
end
subsection Time
  set scheme = explicit
  set step   = 1e-4
  set end    = 1e3
end
)",
                                       rate, longer));
          };
          if (longer > 1.)
            EXPECT_ANY_THROW(build());
          else
            EXPECT_NO_THROW(build());
        }
    }

  } // namespace
} // namespace nsfd
