#include "changing_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

// Meshes that change by chance: what a change keeps, and what it may not do.

namespace nsfd::test_adaptivity
{
  using namespace test;

  namespace
  {
    NSFD_REGISTER(IndicatorRegistry, Chance, "chance", "For tests");

    struct Case {
      unsigned int dim, degree;
      bool bonded, distorted;
    };

    std::string text(const Case &c)
    {
      const bool space = c.dim == 3;
      return "set dimension = " + std::to_string(c.dim) +
             "\nsubsection Mesh\n  set type = " +
             (space ? "brick" : "rectangle") +
             "\n  set upper corner = " + (space ? "3, 2, 1" : "4, 3") +
             "\n  set cells = " + (space ? "3, 2, 1" : "4, 3") +
             (c.distorted ? "\n  set distortion = 0.15" : "") +
             "\nend\nsubsection Discretization\n  set degree = " +
             std::to_string(c.degree) + R"(
end
subsection Material: block
  set Young modulus = 10
  set Poisson ratio = 0.3
  set density       = 2
end
subsection Interface: all
)" +
             (c.bonded ? "  set law = camacho-ortiz\n  set toughness = 1\n"
                       : "  set law = michel-suquet\n  set stiffness = 100\n") +
             R"(  set strength = 1
end
subsection Obstacle: floor
  set where  = bottom
  set point  = )" +
             (space ? "0, -0.1, 0" : "0, -0.1") + R"(
  set normal = )" +
             (space ? "0, 1, 0" : "0, 1") + R"(
end
subsection Boundary: roof
  set where      = top
  set traction y = 3 * x
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
subsection Adaptivity
  set levels              = 2
  set coarsen every steps = 1
  set springs = constant stiffness
end
subsection Indicator: any
  set type = chance
end
)";
    }

    template <int dim>
    void keeps_what_it_must(const Case &c, const unsigned int rounds)
    {
      Chance::round = 0;
      Changing<dim> mesh(text(c));
      mesh.damage();
      const auto momenta = mesh.momenta();
      const auto betas = mesh.betas();
      const double area = mesh.damaged_area();
      unsigned int changes = 0;
      std::set<std::size_t> sizes;
      for (unsigned int k = 0; k < rounds; ++k) {
        const EnergyLines before = mesh.state.energy;
        if (!mesh.change())
          continue;
        ++changes;
        sizes.insert(mesh.model.discretization->bodies().size());
        const auto now = mesh.momenta();
        for (unsigned int d = 0; d + 1 < now.size(); ++d)
          ASSERT_NEAR(now[d], momenta[d], 1e-12 * momenta.back()) << d;
        ASSERT_LE(mesh.state.energy.kinetic, before.kinetic * (1. + 1e-12));
        // the energy balance stay closed
        ASSERT_NEAR(closed(mesh.state.energy), closed(before),
                    1e-12 * before.kinetic);
        // 3 x over an edge of 4 (an area of 3 x 1)
        const auto load = mesh.load();
        ASSERT_NEAR(load[0], dim == 2 ? 24. : 13.5, 1e-11);
        ASSERT_NEAR(load[1], dim == 2 ? 64. : 27., 1e-11);
        ASSERT_EQ(mesh.betas(), betas);
        ASSERT_LT(mesh.jump_of_motion(), 1e-13);
        if (!c.distorted && c.degree == 1) {
          ASSERT_NEAR(mesh.damaged_area(), area, 1e-12 * area);
          ASSERT_NEAR(mesh.state.energy.damage, 0., 1e-12);
        }
      }
      EXPECT_GT(changes, rounds / 2);
      EXPECT_GT(sizes.size(), rounds > 5 ? 3u : 1u);
    }
  } // namespace

  TEST(Adaptivity, ManyChangesOfAPlaneMeshKeepMomentumAndDamage)
  {
    keeps_what_it_must<2>({2, 1, false, false}, 1000);
  }

  TEST(Adaptivity, ChangesOfDistortedQuadraticCells)
  {
    keeps_what_it_must<2>({2, 2, false, true}, 50);
  }

  TEST(Adaptivity, ChangesOfBondedMeshes)
  {
    keeps_what_it_must<2>({2, 1, true, false}, 20);
    keeps_what_it_must<2>({2, 2, true, true}, 10);
    keeps_what_it_must<3>({3, 1, true, false}, 4);
  }

  /** All faces without damage are faces of one continuous function. */
  template <int dim>
  void is_continuous(const Case &c, const unsigned int rounds)
  {
    Chance::round = 0;
    Changing<dim> mesh(text(c));
    std::set<std::size_t> sizes;
    for (unsigned int k = 0; k < rounds; ++k) {
      mesh.change();
      const auto &discretization = *mesh.model.discretization;
      const auto &faces = discretization.points().faces;
      sizes.insert(discretization.bodies().size());
      double size = 0.;
      for (const double u : mesh.state.displacement)
        size = std::max(size, std::abs(u));
      std::vector<double> jump(mesh.state.jump.size());
      mesh.model.delassus->relative_velocity(mesh.state.displacement.data(),
                                             jump.data());
      for (std::size_t f = 0; f < faces.size(); ++f) {
        if (faces[f].boundary)
          continue;
        ASSERT_TRUE(mesh.model.bonded->shares_nodes()[f]) << f;
        for (std::size_t i = faces[f].first * dim;
             i < std::size_t(faces[f].first + faces[f].count) * dim; ++i)
          ASSERT_NEAR(jump[i], 0., 1e-13 * size);
      }
    }
    EXPECT_GT(sizes.size(), 2u);
  }

  TEST(Adaptivity, BondedCellsOfTwoSizesShareNodes)
  {
    is_continuous<2>({2, 1, true, false}, 20);
    is_continuous<2>({2, 2, true, true}, 20);
    is_continuous<2>({2, 3, true, false}, 5);
    is_continuous<3>({3, 1, true, true}, 6);
    is_continuous<3>({3, 2, true, false}, 3);
  }

  TEST(Adaptivity, ChangesOfBricks)
  {
    keeps_what_it_must<3>({3, 1, false, false}, 10);
    keeps_what_it_must<3>({3, 1, true, true}, 4);
  }

  // A state of smaller cells that came from larger ones is the same function;
  // made larger again, it is the old one. Before anything is damaged.
  void go_there_and_back(const bool bonded)
  {
    Chance::round = 0;
    Changing<2> mesh(text({2, 2, bonded, true}));
    // continuous, or the larger cells could not have it
    mesh.state.displacement = mesh.model.discretization->interpolate(
        [](const dealii::Point<2> &x, unsigned int, double *u) {
          u[0] = 0.01 * x[0] + 0.003 * x[1];
          u[1] = -0.02 * x[0] + 0.005 * x[1];
        });
    mesh.state.velocity = mesh.state.displacement;
    std::vector<double> gap = mesh.model.stepper->initial_state().jump;
    mesh.set_jumps(gap);
    const EnergyLines start = mesh.state.energy;
    ASSERT_GT(start.elastic, 0.);
    for (unsigned int k = 0; k < 30; ++k) {
      mesh.change();
      const EnergyLines &now = mesh.state.energy;
      ASSERT_NEAR(now.kinetic, start.kinetic, 1e-12 * start.kinetic);
      ASSERT_NEAR(now.elastic, start.elastic, 1e-12 * start.elastic);
      ASSERT_NEAR(now.cohesive, start.cohesive, 1e-12 * start.elastic);
      for (std::size_t i = 0; i < mesh.state.displacement.size(); ++i)
        // round-off of thirty projections times the condition of M, 1e2
        ASSERT_NEAR(mesh.state.velocity[i], mesh.state.displacement[i], 1e-12);
    }
  }

  TEST(Adaptivity, ThereAndBackAgain)
  {
    go_there_and_back(false);
    go_there_and_back(true);
  }
} // namespace nsfd::test_adaptivity
