#include "make_scene.h"

#include "discretization/cells.h"
#include "momenta.h"
#include "separating_axes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

// Whole steps of scenes with large motions. Energies and momenta are computed
// here from states and masses, not taken from the energy balance.

using namespace nsfd;
using namespace nsfd::test;

namespace test_large_motion
{
  /** With bodies that do not strain. */
  std::string rigid(std::string text, const std::string &entries)
  {
    const std::size_t begin = text.find("  set model "),
                      end = text.find("  set density");
    return text.replace(begin, end - begin, "  set model = rigid\n" + entries);
  }

  template <int dim>
  void keeps_energy_and_momenta(const std::string &text,
                                const std::vector<std::string> &overrides,
                                const unsigned int n_steps,
                                const double tolerance)
  {
    Scene<dim> scene(text, overrides);
    const double energy = scene.energy();
    const auto start = momenta(scene);
    for (unsigned int k = 0; k < n_steps; ++k) {
      const StepReport report = scene.advance();
      EXPECT_LT(report.balance_residual, 1e-10);
      ASSERT_NEAR(scene.energy(), energy, tolerance * energy) << "step " << k;
    }
    const auto end = momenta(scene);
    const double size = norm(start[0]) + 1e-3 * norm(start[1]);
    EXPECT_LT(norm(difference(end[0], start[0])), tolerance * size);
    EXPECT_LT(norm(difference(end[1], start[1])), tolerance * norm(start[1]));
  }

  // --- tumbling

  /** Springs of equal stiffness in both directions store what they are given
      whichever way they look. */
  const std::string block = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 4, 2
end
subsection Material: rubber
  set model              = neo-hookean
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 1 - 2 * (y - 0.5) + 0.3 * x
  set initial velocity y = 2 * (x - 1)
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e4
  set tangential stiffness = 1e4
end
subsection Time
  set end   = 1000
  set step  = 0.01
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-13
end
)";

  TEST(LargeMotion, TumblingBlockKeepsEnergyAndMomenta)
  {
    keeps_energy_and_momenta<2>(block, {}, 10000, 1e-9);
    keeps_energy_and_momenta<2>(
        block, {"Material: rubber/model=saint-venant kirchhoff"}, 200, 1e-10);
  }

  TEST(LargeMotion, TumblingBlockInSpace)
  {
    const std::string text = R"(
set dimension = 3
set motion    = large
subsection Mesh
  set type         = brick
  set upper corner = 3, 2, 1
  set cells        = 3, 2, 1
end
subsection Material: rubber
  set model              = neo-hookean
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 0.1 * (z - 0.5) - 0.2 * (y - 1)
  set initial velocity y = 0.2 * (x - 1.5) - 1 * (z - 0.5)
  set initial velocity z = 1 * (y - 1) - 0.1 * (x - 1.5)
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e4
  set tangential stiffness = 1e4
end
subsection Time
  set end   = 1000
  set step  = 0.02
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-13
end
)";
    keeps_energy_and_momenta<3>(text, {}, 60, 1e-10);
  }

  TEST(LargeMotion, RigidCellsOnSpringsTumble)
  {
    keeps_energy_and_momenta<2>(rigid(block, ""),
                                {"Interface: all/normal stiffness=1e3",
                                 "Interface: all/tangential stiffness=1e3"},
                                300, 1e-10);
  }

  TEST(LargeMotion, MoreDampingThanHalfIsBooked)
  {
    Scene<2> scene(block, {"Time/theta=0.75"});
    const double energy = scene.energy();
    for (unsigned int k = 0; k < 50; ++k)
      EXPECT_LT(scene.advance().balance_residual, 1e-10);
    EXPECT_LT(scene.energy(), energy);
    EXPECT_GT(scene.state.energy.numerical, 0.);
    EXPECT_NEAR(scene.energy() + scene.state.energy.numerical, energy,
                1e-9 * energy);
  }

  // --- a turned scene is the same scene

  TEST(LargeMotion, TurnedSceneIsTheSame)
  {
    // by 170 degrees about the origin, at rest and in motion
    const std::vector<std::string> turned = {
        "Constants/c=cos(170/180 * pi)",
        "Constants/s=sin(170/180 * pi)",
        "Material: rubber/initial displacement x=(c - 1) * x - s * y",
        "Material: rubber/initial displacement y=s * x + (c - 1) * y",
        "Material: rubber/initial velocity x="
        "c * (1 - 2 * (y - 0.5) + 0.3 * x) - s * (2 * (x - 1))",
        "Material: rubber/initial velocity y="
        "s * (1 - 2 * (y - 0.5) + 0.3 * x) + c * (2 * (x - 1))"};
    Scene<2> one(block), other(block, turned);
    EXPECT_NEAR(other.state.energy.elastic, 0., 1e-12 * one.energy());
    for (unsigned int k = 0; k < 100; ++k) {
      one.advance();
      other.advance();
    }
    EXPECT_NEAR(one.state.energy.elastic, other.state.energy.elastic,
                1e-8 * one.energy());
    EXPECT_NEAR(one.state.energy.cohesive, other.state.energy.cohesive,
                1e-8 * one.energy());
    EXPECT_NEAR(one.state.energy.kinetic, other.state.energy.kinetic,
                1e-8 * one.energy());
    for (std::size_t i = 0; i < one.state.jump.size(); ++i)
      EXPECT_NEAR(one.state.jump[i], other.state.jump[i], 1e-9);
  }

  // --- contact

  /** Two blocks; the upper one falls on the lower one and slides. */
  const std::string blocks = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: low
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 4, 1
  set cells        = 4, 1
end
subsection Body: high
  set type         = rectangle
  set lower corner = 0.3, 1.05
  set upper corner = 1.3, 1.55
  set cells        = 2, 1
end
subsection Material: all
  set model              = neo-hookean
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = if(y > 1, 2, 0)
  set initial velocity y = if(y > 1, -1, 0)
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e4
  set tangential stiffness = 1e4
end
subsection Contact: all
  set between  = all
  set friction = 0.3
end
subsection Time
  set end   = 1000
  set step  = 0.005
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-12
end
)";

  TEST(LargeMotion, ContactKeepsMomenta)
  {
    Scene<2> scene(blocks);
    const auto start = momenta(scene);
    const double energy = scene.energy();
    bool touched = false;
    for (unsigned int k = 0; k < 300; ++k) {
      const StepReport report = scene.advance();
      EXPECT_LT(report.balance_residual, 1e-9);
      touched = touched || report.active > 0;
      ASSERT_LE(scene.energy(), energy * (1. + 1e-9));
    }
    EXPECT_TRUE(touched);
    EXPECT_GT(scene.state.energy.friction, 0.);
    const auto end = momenta(scene);
    EXPECT_LT(norm(difference(end[0], start[0])), 1e-10 * norm(start[0]));
    EXPECT_LT(norm(difference(end[1], start[1])), 1e-9 * norm(start[1]));
    EXPECT_LE(scene.state.penetration_excess, 1e-12);
  }

  /** A rigid block slides over the joints of a row of loose ones. */
  const std::string row = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: low
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 4, 1
  set cells        = 4, 1
end
subsection Body: high
  set type         = rectangle
  set lower corner = 0.3, 1
  set upper corner = 1.3, 1.5
  set cells        = 2, 1
end
subsection Material: row
  set where   = y < 1
  set model   = rigid
  set density = 1
end
subsection Material: block
  set model              = rigid
  set bodies             = connected
  set density            = 1
  set initial velocity x = 2
end
subsection Interface: loose
  set law = contact
end
subsection Contact: all
  set friction = 0
end
subsection Obstacle: ground
  set point  = 0, 1e-12
  set normal = 0, 1
end
subsection Loads
  set gravity = 0, -1
end
subsection Time
  set end   = 1000
  set step  = 0.005
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-12
end
)";

  TEST(LargeMotion, SlidesFromFacetToFacet)
  {
    Scene<2> scene(row);
    for (unsigned int k = 0; k < 200; ++k) {
      scene.advance();
      ASSERT_NEAR(scene.state.energy.kinetic, 0.5 * 0.5 * 4., 1e-10)
          << "step " << k;
    }
    EXPECT_LT(scene.state.penetration, 1e-9);
  }

  // Nothing moves and nothing pulls: the energies of the step begin at zero.
  TEST(LargeMotion, BodyAtRestIsHitByAPlate)
  {
    Scene<2> scene(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Material: rubber
  set model         = neo-hookean
  set Young modulus = 100
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: all
  set law = rigid
end
subsection Obstacle: plate
  set point      = 0, 0
  set normal     = 0, 1
  set velocity y = 0.5
end
subsection Time
  set end  = 100
  set step = 0.01
end
)");
    for (unsigned int k = 0; k < 5; ++k)
      EXPECT_LT(scene.advance().balance_residual, 1e-9) << "step " << k;
    EXPECT_GT(scene.state.energy.kinetic, 0.);
    EXPECT_GE(scene.state.energy.impact, 0.);
  }

  // --- no two bodies overlap, whoever they are

  using Corners = std::array<dealii::Point<2>, 4>;

  /** Corners of the cells as they are now, in a circle. */
  std::vector<Corners> quads(const Scene<2> &scene)
  {
    std::vector<Corners> result;
    const auto &d = *scene.discretization;
    const auto nodal = d.to_nodal(scene.state.displacement);
    for (unsigned int b = 0; b < d.bodies().size(); ++b) {
      const auto at_rest = d.cells().corners[b];
      const auto u = d.cells().at_corners(b, nodal);
      Corners now;
      const unsigned int circle[4] = {0, 1, 3, 2};
      for (unsigned int k = 0; k < 4; ++k)
        for (unsigned int c = 0; c < 2; ++c)
          now[k][c] = at_rest[circle[k]][c] + u[circle[k] * 2 + c];
      result.push_back(now);
    }
    return result;
  }

  /** How far one has to move for two convex quads to be apart; 0 if they are.
   */
  double overlap(const Corners &a, const Corners &b)
  {
    double depth = 1e300;
    for (const Corners *of : {&a, &b})
      for (unsigned int k = 0; k < 4; ++k) {
        const dealii::Tensor<1, 2> edge = (*of)[(k + 1) % 4] - (*of)[k];
        dealii::Tensor<1, 2> n;
        n[0] = edge[1] / edge.norm();
        n[1] = -edge[0] / edge.norm();
        double end_a = -1e300, begin_b = 1e300;
        for (unsigned int l = 0; l < 4; ++l) {
          const Corners &other = of == &a ? b : a;
          end_a = std::max(end_a, n * ((*of)[l] - dealii::Point<2>()));
          begin_b = std::min(begin_b, n * (other[l] - dealii::Point<2>()));
        }
        depth = std::min(depth, end_a - begin_b);
      }
    return std::max(0., depth);
  }

  const std::string heap = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 4, 5
  set cells        = 4, 5
end
subsection Material: blocks
  set model   = rigid
  set density = 1
  set initial displacement x = 0.3 * floor(x) + 0.2 * sin(3 * floor(y))
  set initial displacement y = 0.3 * floor(y)
  set initial velocity x = sin(5 * floor(y) + 2 * floor(x)) + 2 * cos(x - floor(x)) * (y - floor(y))
  set initial velocity y = -2
end
subsection Interface: loose
  set law = contact
end
subsection Contact: any
  set friction = 0.3
end
subsection Obstacle: ground
  set point    = 0, -0.2
  set normal   = 0, 1
  set friction = 0.3
end
subsection Loads
  set gravity = 0, -9.81
end
subsection Time
  set end   = 1000
  set step  = 0.002
  set theta = 0.5
end
)";

  TEST(LargeMotion, NothingOverlapsInAHeap)
  {
    Scene<2> scene(heap);
    double deepest = 0.;
    for (unsigned int k = 0; k < 700; ++k) {
      scene.advance_bisecting();
      if (k % 10 != 0)
        continue;
      const auto now = quads(scene);
      for (std::size_t a = 0; a < now.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
          deepest = std::max(deepest, overlap(now[a], now[b]));
    }
    double bound = 0.;
    const State &state = scene.state;
    for (std::size_t i = 0; i < state.surface_approach.size(); ++i)
      bound =
          std::max(bound, state.surface_overlap[i] + state.surface_approach[i]);
    EXPECT_GT(bound, 0.);
    // a corner that meets a corner is seen once it is inside: h v more
    EXPECT_LE(deepest, 2. * bound);
    EXPECT_LT(deepest, 0.02);
    // it has come to rest on the ground
    EXPECT_LT(scene.state.energy.kinetic, 1.);
  }
} // namespace test_large_motion
