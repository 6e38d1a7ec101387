#include "make_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

// Interior points on steps that Newton's method and sweeps find hard: broken,
// closed and rubbing faces, long steps, rigid rows, large friction,
// kappa(beta). Judged by the natural map; where the step has one solution, all
// solvers agree on velocities.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_interior_point
{
  /** A square hit by a pulse, a share of its faces broken and closed. */
  std::string square(const std::string &interface, const std::string &more = "")
  {
    return R"(
      set dimension = 2
      subsection Mesh
        set type         = rectangle
        set lower corner = 0, 0
        set upper corner = 1, 1
        set cells        = 5, 5
      end
      subsection Material: bulk
        set model              = linear elastic
        set Young modulus      = 1
        set Poisson ratio      = 0.3
        set density            = 1
        set initial velocity x = if(x < 0.4, 1e-3 * sin(pi * x / 0.4)^2, 0)
      end
      subsection Interface: faces
        set where = all
    )" + interface +
           R"(
      end
      subsection Time
        set end   = 100
        set theta = 1
        set step  = 2 courant
        set cohesion rule = end point
      end
    )" + more;
  }

  const std::string springs = R"(
        set law       = michel-suquet
        set stiffness = 105
        set strength  = 10
        set broken    = random(3, floor(5 * x + 1e-6), floor(5 * y + 1e-6), abs(5 * x - rint(5 * x)) < 1e-6) < 0.4
    )";

  std::vector<std::string> with(const std::string &method,
                                std::vector<std::string> overrides)
  {
    overrides.push_back("Solver/method=" + method);
    return overrides;
  }

  TEST(InteriorPoint, SolvesStepsOfManyRubbingFaces)
  {
    for (const std::string mu : {"0.1", "0.5", "1", "10"})
      for (const std::string step : {"0.5", "2", "20"}) {
        Scene<2> scene(
            square(springs),
            with("interior point", {"Interface: faces/friction=" + mu,
                                    "Time/step=" + step + " courant"}));
        for (unsigned int k = 0; k < 4; ++k) {
          StepReport report;
          ASSERT_NO_THROW(report = scene.advance())
              << "mu " << mu << ", step " << step;
          EXPECT_LE(report.solver.residual, 1e-8);
        }
      }
  }

  TEST(InteriorPoint, AgreesWithNewtonWithoutFriction)
  {
    // a convex step: one solution for the velocities; both to 1e-8 of the
    // impulses, velocities of the bodies to some orders less
    for (const std::string faces : {"spring", "unilateral"}) {
      const std::vector<std::string> common = {
          "Interface: faces/friction=0", "Solver/tolerance=1e-11",
          "Interface: faces/intact faces=" + faces};
      Scene<2> newton(square(springs), with("dual newton", common)),
          path(square(springs), with("interior point", common));
      for (unsigned int k = 0; k < 3; ++k) {
        newton.advance();
        path.advance();
        double largest = 0., difference = 0.;
        for (std::size_t i = 0; i < newton.state.velocity.size(); ++i) {
          largest = std::max(largest, std::abs(newton.state.velocity[i]));
          difference = std::max(difference, std::abs(newton.state.velocity[i] -
                                                     path.state.velocity[i]));
        }
        EXPECT_LE(difference, 1e-7 * largest) << faces << ", step " << k;
      }
    }
  }

  TEST(InteriorPoint, SolvesStiffUnilateralFaces)
  {
    // C L/E = 1e3 and 1e5, every face in contact or open
    for (const std::string stiffness : {"5e3", "5e5"}) {
      Scene<2> scene(
          square(springs),
          with("interior point", {"Interface: faces/friction=0.5",
                                  "Interface: faces/stiffness=" + stiffness,
                                  "Interface: faces/intact faces=unilateral"}));
      for (unsigned int k = 0; k < 3; ++k)
        EXPECT_NO_THROW(scene.advance()) << stiffness << ", step " << k;
    }
  }

  TEST(InteriorPoint, TakesRigidRowsThatDependOnEachOther)
  {
    // rigid faces all around: W is singular by a condition per inner vertex
    const std::string contact = R"(
        set law      = contact
        set friction = 0.5
      end
      subsection Interface: joints
        set where = all
        set law   = rigid
    )";
    Scene<2> scene(
        square(contact),
        with("interior point", {"Interface: faces/where=abs(x - 0.4) < 1e-6 || "
                                "abs(y - 0.6) < 1e-6"}));
    for (unsigned int k = 0; k < 4; ++k) {
      StepReport report;
      ASSERT_NO_THROW(report = scene.advance()) << k;
      EXPECT_LE(report.balance_residual, 1e-9);
    }
  }

  TEST(InteriorPoint, KeepsEnergyWithRestitution)
  {
    // broken faces with e = 0.5, theta in the allowed range
    Scene<2> scene(
        square(springs),
        with("interior point", {"Interface: faces/friction=0.3",
                                "Interface: faces/restitution=0.5",
                                "Time/theta=0.5", "Time/step=0.5 courant"}));
    const double start = scene.energy();
    for (unsigned int k = 0; k < 6; ++k) {
      scene.advance();
      EXPECT_LE(scene.energy(), start * (1. + 1e-9));
    }
  }

  TEST(InteriorPoint, FrictionGrowsWithDamage)
  {
    // soft faces that damage while they rub: kappa(beta) in the local laws
    Scene<2> scene(square(springs),
                   with("interior point", {"Interface: faces/friction=0.5",
                                           "Interface: faces/strength=2e-5",
                                           "Time/step=0.5 courant"}));
    for (unsigned int k = 0; k < 4; ++k) {
      EXPECT_NO_THROW(scene.advance_bisecting()) << k;
      for (const double beta : scene.state.beta)
        EXPECT_LE(beta, 1.);
    }
    EXPECT_GT(scene.state.energy.damage, 0.);
  }

  TEST(InteriorPoint, SolvesABrickOfBrokenFaces)
  {
    Scene<3> scene(R"(
      set dimension = 3
      subsection Mesh
        set type         = brick
        set lower corner = 0, 0, 0
        set upper corner = 1, 1, 1
        set cells        = 3, 3, 3
      end
      subsection Material: bulk
        set model              = linear elastic
        set Young modulus      = 1
        set Poisson ratio      = 0.3
        set density            = 1
        set initial velocity x = if(x < 0.4, 1e-3, 0)
        set initial velocity y = if(x < 0.4, 2e-4 * z, 0)
      end
      subsection Interface: faces
        set where    = all
        set law      = contact
        set friction = 0.5
      end
      subsection Time
        set end   = 100
        set theta = 1
        set step  = 2 courant
      end
      subsection Solver
        set method = interior point
      end
    )");
    for (unsigned int k = 0; k < 3; ++k) {
      StepReport report;
      ASSERT_NO_THROW(report = scene.advance()) << k;
      EXPECT_LE(report.solver.residual, 1e-8);
    }
  }

  TEST(Chain, HandsOverWhatNewtonLeaves)
  {
    // at long steps the interior points come first, and no hand-over is needed
    Scene<2> scene(square(springs),
                   with("cascade", {"Interface: faces/friction=0.5",
                                    "Time/step=20 courant"}));
    for (unsigned int k = 0; k < 4; ++k)
      EXPECT_NO_THROW(scene.advance()) << k;
  }
} // namespace test_interior_point
