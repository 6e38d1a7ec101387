#include "leapfrog_steps.h"

#include "make_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Slip weakening of a fault: a block that is pushed along another one.

namespace nsfd::test_slip_weakening
{
  namespace
  {
    using test::Scene;
    using test::Steps;
    using Overrides = std::vector<std::string>;

    constexpr double sigma_n = 10e6, mu_s = 0.6, mu_d = 0.2;

    const std::string blocks = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = 0, -10 mm
  set upper corner = 40 mm, 10 mm
  set cells        = 8, 4
end
subsection Material: rock
  set Young modulus     = 70 GPa
  set Poisson ratio     = 0
  set density           = 2500 kg/m^3
  set initial stress yy = -10 MPa
  set initial stress xy = 5.9 MPa
end
subsection Interface: fault
  set where           = abs(y) < 1 um
  set law             = slip-weakening
  set static friction = 0.6
  set friction        = 0.2
  set normal traction = 10 MPa
  set slip distance   = 1 um
end
subsection Interface: all
  set law = joined
end
subsection Boundary: bottom
  set traction x = -5.9 MPa
  set traction y = 10 MPa
end
subsection Boundary: top
  set traction x = 5.9 MPa
  set traction y = -10 MPa
end
subsection Boundary: left
  set traction y = -5.9 MPa
end
subsection Boundary: right
  set traction y = 5.9 MPa
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";
    const Overrides explicit_steps = {"Time/scheme=explicit", "Time/step=auto"};

    Overrides shear(const double stress)
    {
      const auto pa = [](const double value) {
        return fmt::format("{} Pa", value);
      };
      return {"Material: rock/initial stress xy=" + pa(stress),
              "Boundary: bottom/traction x=" + pa(-stress),
              "Boundary: top/traction x=" + pa(stress),
              "Boundary: left/traction y=" + pa(-stress),
              "Boundary: right/traction y=" + pa(stress)};
    }

    Overrides operator+(Overrides a, const Overrides &b)
    {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    }

    TEST(SlipWeakening, IsTheLinearLaw)
    {
      const auto law = test::make_law(
          "slip-weakening",
          test::entries_of("static friction = 0.6; friction = 0.2; normal "
                           "traction = 10 MPa; slip distance = 1 um; opening "
                           "strength = 1 MPa"));
      const double cohesion = (mu_s - mu_d) * sigma_n, D_c = 1e-6;
      EXPECT_DOUBLE_EQ(law->toughness(), cohesion * D_c / 2.);
      EXPECT_DOUBLE_EQ(law->strength(), 1e6);
      EXPECT_EQ(law->friction_exponent(), 0.);
      // in slip: r T(r |u|)
      const double r = std::sqrt(law->shear_weight());
      EXPECT_NEAR(r * law->traction(r * 0.25 * D_c), 0.75 * cohesion,
                  1e-12 * cohesion);
      EXPECT_EQ(law->beta(r * D_c), 0.);
    }

    // Slip begins at mu_s sigma_n, and friction counts on what is intact:
    // just below it nothing moves.
    TEST(SlipWeakening, BeginsAtTheStaticStrength)
    {
      for (const double share : {0.999, 1.001}) {
        const Overrides loaded = shear(share * mu_s * sigma_n);
        Steps<2> by_nodes(blocks, explicit_steps + loaded);
        Scene<2> joined(blocks, loaded);
        for (unsigned int k = 0; k < 60; ++k)
          EXPECT_LT(by_nodes.step().balance_residual, 1e-12);
        for (unsigned int k = 0; k < 30; ++k)
          joined.advance_bisecting();
        for (const Scene<2> *run :
             {static_cast<Scene<2> *>(&by_nodes), &joined}) {
          if (share < 1.) {
            EXPECT_EQ(run->state.energy.damage, 0.);
          } else {
            EXPECT_GT(run->state.energy.damage, 0.);
          }
        }
      }
    }

    // All of the fault slips by more than D_c: what cohesion dissipates is G
    // per area, in steps of any length.
    TEST(SlipWeakening, TakesItsToughness)
    {
      const double taken = (mu_s - mu_d) * sigma_n * 1e-6 / 2. * 40e-3;
      Steps<2> run(blocks, explicit_steps + shear(1.01 * mu_s * sigma_n));
      while (run.state.time < 12e-6)
        EXPECT_LT(run.step().balance_residual, 1e-12);
      run.leapfrog->show(run.state);
      const auto &points = run.discretization->points();
      for (std::size_t i = 0; i < points.n_points; ++i)
        if (run.discretization->origins()[i].kind ==
                PointOrigin::Kind::interface &&
            run.discretization->origins()[i].block == 0) {
          EXPECT_GT(std::abs(run.state.jump[2 * i + 1]), 1e-6);
        }
      EXPECT_NEAR(run.state.energy.damage, taken, 1e-9 * taken);
      EXPECT_GT(run.state.energy.friction, taken);
      EXPECT_NEAR(run.state.energy.numerical, 0.,
                  1e-9 * run.state.largest_energy);

      Scene<2> joined(blocks, shear(1.01 * mu_s * sigma_n));
      while (joined.state.time < 12e-6)
        joined.advance_bisecting();
      EXPECT_NEAR(joined.state.energy.damage, taken, 1e-8 * taken);
    }
  } // namespace
} // namespace nsfd::test_slip_weakening
