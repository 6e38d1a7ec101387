#include "leapfrog_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Viscous materials in `scheme = explicit`.

namespace nsfd::test_viscous_forces
{
  namespace
  {
    using test::Steps;

    const std::string bar = R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = 1, 0.25
  set cells        = 8, 2
end
subsection Material: polymer
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set shear viscosity    = 0.01
  set bulk viscosity     = 0.02
  set initial velocity x = 0.01 * sin(40 * x) * cos(50 * y)
  set initial velocity y = 0.01 * cos(70 * x + 3)
end
subsection Interface: all
  set law = joined
end
subsection Time
  set end    = 5
  set step   = auto
  set scheme = explicit
end
)";

    const std::vector<std::string> quads = {"Mesh/type=rectangle"},
                                   quadratic = {"Mesh/type=rectangle",
                                                "Discretization/degree=2"};
    const std::vector<std::string> tetrahedra = {
        "dimension=3", "Mesh/type=tetrahedra", "Mesh/lower corner=0, 0, 0",
        "Mesh/upper corner=1, 0.25, 0.25", "Mesh/cells=4, 1, 1"};

    /** What a free body has is kept or taken, near the bound of the step, and
        where steps change. */
    template <int dim>
    void expect_loss(const std::vector<std::string> &overrides)
    {
      for (const bool changing : {false, true}) {
        Steps<dim> run(bar, overrides);
        const double start = run.state.energy.kinetic;
        const auto momentum = run.momentum();
        double residual = 0.;
        for (unsigned int k = 0; k < 400; ++k) {
          const EnergyLines before = run.state.energy;
          const double share = changing && k % 3 == 0 ? 0.4 : 0.999 / 0.9;
          residual = std::max(residual, run.step(share).balance_residual);
          const EnergyLines &after = run.state.energy;
          EXPECT_GE(after.viscous, before.viscous);
          EXPECT_GE(after.kinetic, 0.);
          EXPECT_GE(after.elastic, 0.);
          if (!changing && k > 0) {
            EXPECT_EQ(after.numerical, before.numerical);
          }
        }
        EXPECT_LT(residual, 1e-13);
        EXPECT_GT(run.state.energy.viscous, 0.5 * start);
        const auto now = run.momentum();
        for (unsigned int c = 0; c < dim; ++c)
          EXPECT_NEAR(now[c], momentum[c], 1e-16);
      }
    }

    TEST(ViscousForces, TakeEnergyOfTriangles) { expect_loss<2>({}); }
    TEST(ViscousForces, TakeEnergyOfQuads) { expect_loss<2>(quads); }
    TEST(ViscousForces, TakeEnergyOfQuadraticQuads)
    {
      expect_loss<2>(quadratic);
    }
    TEST(ViscousForces, TakeEnergyOfTetrahedra) { expect_loss<3>(tetrahedra); }

    // the bound knows the damping: far beyond critical it is m / c
    TEST(ViscousForces, ShortenTheStep)
    {
      const Steps<2> little(bar, {"Material: polymer/shear viscosity=1e-9",
                                  "Material: polymer/bulk viscosity=1e-9"}),
          none(bar, {"Material: polymer/shear viscosity=0",
                     "Material: polymer/bulk viscosity=0"}),
          much(bar, {"Material: polymer/shear viscosity=10",
                     "Material: polymer/bulk viscosity=10"}),
          more(bar, {"Material: polymer/shear viscosity=20",
                     "Material: polymer/bulk viscosity=20"});
      EXPECT_NEAR(little.time_step / none.time_step, 1., 1e-6);
      EXPECT_NEAR(more.time_step / much.time_step, 0.5, 1e-3);
    }
  } // namespace
} // namespace nsfd::test_viscous_forces
