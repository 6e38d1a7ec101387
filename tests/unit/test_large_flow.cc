#include "leapfrog_steps.h"

#include "joined/finite_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <random>

// Explicit steps of large motions of materials with a history.

namespace nsfd
{
  namespace
  {
    using test::Steps;

    /** A block whose cells flow; with `law = joined` they have common nodes. */
    std::string block(const std::string &mesh, const std::string &rest,
                      const double poisson = 0.3)
    {
      const unsigned int dim = mesh.find("brick") != std::string::npos ||
                                       mesh.find("tetra") != std::string::npos
                                   ? 3
                                   : 2;
      return fmt::format(R"(
set dimension = {}
set motion    = large
subsection Mesh
{}
end
subsection Material: metal
  set model                       = j2 plastic
  set Young modulus               = 100 GPa
  set Poisson ratio               = {}
  set density                     = 8000 kg/m^3
  set yield stress                = 400 MPa
  set isotropic hardening modulus = 1 GPa
end
subsection Interface: all
  set law = joined
end
subsection Time
  set scheme = explicit
  set step   = auto
  set end    = 1.2 ms
end
{})",
                         dim, mesh, poisson, rest);
    }

    /** Cells of a scene with groups of their corners, all joined. */
    template <int dim>
    struct JoinedCells {
      explicit JoinedCells(const std::string &text)
          : scene(text), mesh(*scene.discretization),
            groups(mesh, std::vector<std::uint8_t>(
                             scene.discretization->points().n_points, 1)),
            forces(*scene.discretization, mesh, FrontViscosity())
      {
      }

      double energy()
      {
        forces.set_forces(groups);
        EXPECT_LT(forces.inverted(), 0);
        return std::accumulate(forces.stored().begin(), forces.stored().end(),
                               0.);
      }

      test::Scene<dim> scene;
      JoinedMesh<dim> mesh;
      CornerGroups<dim> groups;
      FiniteForces<dim> forces;
    };

    /** f = -dU/dq, after some of the cells have flown. */
    template <int dim>
    void expect_forces_of_an_energy(const std::string &mesh)
    {
      JoinedCells<dim> cells(block(mesh, ""));
      std::mt19937 engine(7);
      std::uniform_real_distribution<double> random(-1., 1.);
      cells.energy();
      // by several yield strains of a cell
      for (double &u : cells.groups.displacement)
        u = 0.02 * random(engine);
      cells.forces.histories().begin_step(1e-6);
      cells.energy();
      double taken = 0.;
      for (const double x : cells.forces.taken())
        taken += x;
      EXPECT_GT(taken, 0.);
      for (double &u : cells.groups.displacement)
        u += 2e-3 * random(engine);
      cells.energy();
      const std::vector<double> force = cells.groups.force,
                                place = cells.groups.displacement;
      double largest = 0., sum[dim] = {};
      for (std::size_t k = 0; k < force.size(); ++k) {
        largest = std::max(largest, std::abs(force[k]));
        sum[k % dim] += force[k];
      }
      for (const double of_all : sum)
        EXPECT_LT(std::abs(of_all), 1e-12 * largest);
      for (std::size_t k = 0; k < force.size(); ++k) {
        constexpr double way = 1e-5; // of the third order in it
        double ends[2];
        for (const int side : {0, 1}) {
          cells.groups.displacement = place;
          cells.groups.displacement[k] += way * (2 * side - 1);
          ends[side] = cells.energy();
        }
        EXPECT_NEAR(force[k], -(ends[1] - ends[0]) / (2. * way),
                    1e-6 * largest);
      }
    }

    TEST(FiniteForces, OfFlowingCellsAreThoseOfTheirEnergy)
    {
      expect_forces_of_an_energy<2>("  set type = rectangle\n"
                                    "  set upper corner = 1, 1\n"
                                    "  set cells = 3, 2\n"
                                    "  set distortion = 0.2\n");
      expect_forces_of_an_energy<2>("  set type = crossed triangles\n"
                                    "  set upper corner = 1, 1\n"
                                    "  set cells = 2, 1\n");
      expect_forces_of_an_energy<3>("  set type = brick\n"
                                    "  set upper corner = 1, 1, 1\n"
                                    "  set cells = 2, 1, 1\n"
                                    "  set distortion = 0.2\n");
      expect_forces_of_an_energy<3>("  set type = tetrahedra\n"
                                    "  set upper corner = 1, 1, 1\n"
                                    "  set cells = 1, 1, 1\n");
    }

    /** u_x = c x y keeps the mean dilatation of a square cell: its energy is
        (4/3) mu c^2 a^4, whatever the bulk modulus. Without the mean it would
        be 2.5e4 times as much for this Poisson ratio. */
    TEST(FiniteForces, FlowingCellsBendWithoutLocking)
    {
      const double nu = 0.49999, mu = 100e9 / 2. / (1. + nu), c = 1e-5;
      JoinedCells<2> cells(block("  set type = rectangle\n"
                                 "  set lower corner = -1, -1\n"
                                 "  set upper corner = 1, 1\n"
                                 "  set cells = 1, 1\n",
                                 "", nu));
      const auto &nodes = cells.scene.discretization->cells().shape(0)->nodes;
      for (std::size_t i = 0; i < nodes.size(); ++i)
        cells.groups.displacement[cells.groups.of(i) * 2] =
            c * (nodes[i][0] - 1.) * (nodes[i][1] - 1.);
      EXPECT_NEAR(cells.energy(), 4. / 3. * mu * c * c,
                  1e-4 * mu * c * c); // strains of 1e-5
    }

    /** A bar of cells is drawn to 1.55 of its length, slowly. Uniaxial
        tension: Kirchhoff's stress is E (ln l - p) = Y + H p. */
    TEST(LargeFlow, DrawnBarHardensByItsLogarithmicStrain)
    {
      Steps<3> scene(block("  set type = brick\n"
                           "  set upper corner = 10 mm, 5 mm, 5 mm\n"
                           "  set cells = 2, 1, 1\n",
                           R"(
subsection Boundary: foot
  set where      = x < 1 um
  set velocity x = 0
end
subsection Boundary: head
  set where      = x > 9.999 mm
  set velocity x = 5 m/s * min(t / (0.2 ms), 1)
end
subsection Boundary: below
  set where      = y < 1 um
  set velocity y = 0
end
subsection Boundary: behind
  set where      = z < 1 um
  set velocity z = 0
end
)"));
      const double E = 100e9, Y = 400e6, H = 1e9, area = 25e-6, length = 10e-3;
      double plastic = 0.;
      while (scene.state.time < 1.2e-3 * (1. - 1e-9)) {
        ASSERT_LT(scene.step().balance_residual, 1e-12);
        EXPECT_GE(scene.state.energy.plastic, plastic);
        plastic = scene.state.energy.plastic;
      }
      const double t = scene.state.time,
                   stretch = 1. + 5. * (t - 0.1e-3) / length,
                   p = (std::log(stretch) - Y / E) / (1. + H / E),
                   stress = Y + H * p;
      // the head is pulled by 5 m/s: the bar takes rho v^2 / Y = 5e-4 of the
      // stress to follow, and rings by less
      const double share = 1e-3;
      EXPECT_NEAR(scene.leapfrog->reactions()[3], stress * area / stretch,
                  share * stress * area);
      const double volume = area * length;
      EXPECT_NEAR(plastic, Y * p * volume, share * Y * p * volume);
      const EnergyLines &e = scene.state.energy;
      const double stored =
          (stress * stress / (2. * E) + H * p * p / 2.) * volume;
      EXPECT_NEAR(e.elastic, stored, share * Y * p * volume);
      EXPECT_LT(std::abs(e.numerical), 1e-4 * plastic);
    }

    /** What is accounted for as plastic has no trend beside the work: the
        trapezoidal rule's error falls with the square of the step. */
    TEST(LargeFlow, BalanceOfABlowClosesWithTheSquareOfTheStep)
    {
      double given[2];
      for (const unsigned int k : {0u, 1u}) {
        Steps<2> scene(block("  set type = rectangle\n"
                             "  set upper corner = 20 mm, 10 mm\n"
                             "  set cells = 8, 4\n",
                             R"(
subsection Boundary: foot
  set where      = left
  set velocity x = 0
end
subsection Boundary: head
  set where      = right
  set velocity x = if(t < 20 us, -100 m/s * sin(t / (20 us) * pi), 0)
end
)"),
                       {fmt::format("Time/step={} us", 0.2 / (k + 1))});
        while (scene.state.time < 40e-6 * (1. - 1e-9))
          ASSERT_LT(scene.step().balance_residual, 1e-12);
        EXPECT_GT(scene.state.energy.plastic, 0.8 * scene.state.energy.work);
        given[k] =
            std::abs(scene.state.energy.numerical) / scene.state.energy.plastic;
      }
      EXPECT_LT(given[0], 1e-3);
      EXPECT_LT(given[1], given[0] / 3.);
    }
  } // namespace
} // namespace nsfd
