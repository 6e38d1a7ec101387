#include "breaking_plate.h"
#include "discretization/cells.h"
#include "make_scene.h"
#include "time_integration/stable_step.h"

#include <deal.II/lac/lapack_full_matrix.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd::test_schemes
{
  namespace
  {
    const std::string plate = R"(
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 1
  set cells        = 3, 2
  set distortion   = 0.2
end
subsection Material: plate
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 0.8 * sin(4 * x)
  set initial displacement y = 0.01 * x * y
end
subsection Interface: all
  set law              = contact
end
subsection Time
  set end    = 1
  set step   = 0.2 courant
  set scheme = symplectic
end
)";

    using Operator = DelassusOperator<2>::Operator;

    // v.Mv/2 + q.Kq/2 - h^2 v.Kv/8: what steps up to the length h keep.
    double kept_energy(const test::Scene<2> &scene)
    {
      const State &s = scene.state;
      const std::size_t n = s.velocity.size();
      std::vector<double> Mv(n), Kq(n), Kv(n);
      scene.delassus->apply(Operator::mass, s.velocity.data(), Mv.data());
      scene.delassus->apply(Operator::stiffness, s.displacement.data(),
                            Kq.data());
      scene.delassus->apply(Operator::stiffness, s.velocity.data(), Kv.data());
      const double h = scene.delassus->terms().kept_step;
      double sum = 0.;
      for (std::size_t i = 0; i < n; ++i)
        sum += (s.velocity[i] * Mv[i] + s.displacement[i] * Kq[i] -
                h * h / 4. * s.velocity[i] * Kv[i]) /
               2.;
      return sum;
    }

    void expect_energy_kept(test::Scene<2> &scene,
                            const std::vector<double> &lengths = {1.})
    {
      const double start = kept_energy(scene), longest = scene.time_step;
      EXPECT_NEAR(scene.delassus->terms().kept_step, longest, 0.1 * longest);
      for (unsigned int step = 0; step < 500; ++step) {
        const StepReport report =
            scene.advance(longest * lengths[step % lengths.size()]);
        ASSERT_EQ(report.active, 0u);
        EXPECT_NEAR(kept_energy(scene), start, 1e-12 * start);
        EXPECT_LT(report.balance_residual, 1e-12);
        // and it is the one of the balance
        EXPECT_NEAR(scene.energy(), start, 1e-12 * start);
        EXPECT_GT(scene.state.energy.kinetic, 0.);
      }
    }

    TEST(SymplecticTest, KeepsItsEnergyWhereNothingTouches)
    {
      // contact within a plate that is torn apart: nothing closes
      test::Scene<2> scene(plate, {"Material: plate/initial velocity x=9 * x",
                                   "Material: plate/initial velocity y=7 * y"});
      expect_energy_kept(scene);
    }

    // 0.9 of the bound of the step: what M lacks of h_0^2 K / 4 is a fifth in
    // the fastest mode.
    TEST(SymplecticTest, KeepsItsEnergyInStepsOfAnyLength)
    {
      test::Scene<2> apart(plate, {"Material: plate/initial velocity x=9 * x",
                                   "Material: plate/initial velocity y=7 * y",
                                   "Time/step=auto"});
      expect_energy_kept(apart, {1., 0.5, 0.125, 0.7, 0.7});
      test::Scene<2> bonded(
          plate, {"Interface: all/law=bonded", "Time/step=0.04 courant"});
      expect_energy_kept(bonded, {1., 0.5, 0.125, 0.7, 0.7});
    }

    // Positions pass through the middle of a step with the mean velocity:
    // whatever the steps, a free fall is q = g t^2/2 at their ends.
    TEST(SymplecticTest, FallsExactlyWithAnySteps)
    {
      test::Scene<2> scene(plate +
                               "subsection Loads\n  set gravity = 0, -2\nend\n",
                           {"Material: plate/initial velocity x=0",
                            "Material: plate/initial displacement y=0"});
      const double first = scene.time_step;
      double t = 0.;
      for (unsigned int step = 0; step < 60; ++step) {
        const double h = first * std::array{1., 0.5, 0.7}[step % 3];
        EXPECT_LT(scene.advance(h).balance_residual, 1e-12);
        t += h;
      }
      const auto &d = *scene.discretization;
      const auto nodal = d.to_nodal(scene.state.displacement);
      const double fall = -t * t;
      for (unsigned int b = 0; b < d.bodies().size(); ++b) {
        const auto u = d.cells().at_corners(b, nodal);
        for (std::size_t k = 0; k < u.size(); k += 2) {
          EXPECT_NEAR(u[k], 0., 1e-12 * std::abs(fall));
          EXPECT_NEAR(u[k + 1], fall, 1e-12 * std::abs(fall));
        }
      }
    }

    TEST(SymplecticTest, KeepsItsEnergyWithBonds)
    {
      test::Scene<2> scene(
          plate, {"Interface: all/law=bonded", "Time/step=0.04 courant"});
      expect_energy_kept(scene);
    }

    // Against all eigenvalues of M^{-1} K: from below, and not by much.
    TEST(SymplecticTest, StableStepOfCommonNodes)
    {
      test::Scene<2> scene(
          plate, {"Interface: all/law=bonded", "Time/step=0.04 courant"});
      const unsigned int n = unsigned(scene.state.velocity.size());
      dealii::LAPACKFullMatrix<double> matrix(n);
      std::vector<double> unit(n, 0.), joined(n), force(n), column(n);
      for (unsigned int j = 0; j < n; ++j) {
        unit[j] = 1.;
        joined = unit;
        scene.bonded->join_motion(joined);
        scene.delassus->apply(Operator::stiffness, joined.data(), force.data());
        scene.delassus->apply(Operator::inverse, force.data(), column.data());
        unit[j] = 0.;
        for (unsigned int i = 0; i < n; ++i)
          matrix(i, j) = column[i];
      }
      matrix.compute_eigenvalues();
      double largest = 0.;
      for (unsigned int j = 0; j < n; ++j)
        largest = std::max(largest, matrix.eigenvalue(j).real());
      const double exact = 2. / std::sqrt(largest),
                   found = stable_step(scene.discretization->bodies());
      EXPECT_LE(found, exact * (1. + 1e-10));
      EXPECT_GE(found, 0.5 * exact);
    }

    // Every face is bonded until it breaks.
    TEST(SymplecticTest, BondsBreakWithClosedBalance)
    {
      std::string text = test::breaking_plate;
      const std::string intrinsic =
          "michel-suquet\n  set stiffness        = 2000";
      text.replace(text.find(intrinsic), intrinsic.size(),
                   "camacho-ortiz\n  set toughness        = 0.02");
      test::Scene<2> scene(
          text, {"Time/scheme=symplectic", "Time/step=0.02 courant"});
      ASSERT_NE(scene.bonded, nullptr);
      for (unsigned int step = 0; step < 1500; ++step) {
        const EnergyLines before = scene.state.energy;
        scene.advance_bisecting();
        const auto &e = scene.state.energy;
        EXPECT_GE(e.damage, before.damage - 1e-14);
        EXPECT_GE(e.impact, before.impact - 1e-9);
        const double sum = e.kinetic + e.elastic + e.cohesive + e.damage +
                           e.friction + e.impact + e.numerical - e.work;
        EXPECT_LT(std::abs(sum - scene.state.initial_energy),
                  1e-12 * scene.state.largest_energy);
      }
      EXPECT_GT(scene.state.energy.damage, 0.);
      EXPECT_GT(scene.state.energy.friction, 0.);
      const auto &kind = scene.state.kind;
      EXPECT_NE(std::find(kind.begin(), kind.end(), PointKind::bonded),
                kind.end())
          << "and some points have to stay bonded";
    }

    // e = 1 gives back what an impact takes, e = 0 does not.
    TEST(SymplecticTest, ImpactsAreBookedAsTheyAre)
    {
      for (const double e : {0., 0.5, 1.}) {
        test::Scene<2> scene(R"(
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 1, 1
  set cells        = 1, 1
end
subsection Material: block
  set model              = rigid
  set density            = 2
  set initial velocity y = -3
end
subsection Interface: none
  set law = rigid
end
subsection Obstacle: floor
  set where       = bottom
  set point       = 0, -0.05
  set normal      = 0, 1
  set restitution = )" + std::to_string(e) +
                             R"(
end
subsection Time
  set end    = 1
  set step   = 0.01
  set scheme = symplectic
end
)");
        for (unsigned int step = 0; step < 20; ++step)
          scene.advance();
        EXPECT_NEAR(scene.state.velocity[1], 3. * e, 1e-8);
        EXPECT_NEAR(scene.state.energy.impact, 9. * (1. - e * e), 1e-7);
        EXPECT_NEAR(scene.state.energy.numerical, 0., 1e-7);
      }
    }

    TEST(SymplecticTest, BalanceThroughFracture)
    {
      test::Scene<2> scene(test::breaking_plate, {"Time/scheme=symplectic",
                                                  "Time/step=0.05 courant"});
      double defect = 0.;
      for (unsigned int step = 0; step < 400; ++step) {
        scene.advance_bisecting();
        const auto &e = scene.state.energy;
        EXPECT_GE(e.damage, scene.next.energy.damage - 1e-14);
        EXPECT_GE(e.impact, scene.next.energy.impact - 1e-9);
        // steps make no energy; the first takes h^2 v.Kv/8, and
        // springs that begin to carry on one side only take their overlap
        EXPECT_GE(e.numerical, scene.next.energy.numerical -
                                   1e-9 * scene.state.largest_energy);
        const double sum = e.kinetic + e.elastic + e.cohesive + e.damage +
                           e.friction + e.impact + e.numerical - e.work;
        defect = std::max(defect, std::abs(sum - scene.state.initial_energy));
      }
      EXPECT_LT(defect, 1e-12 * scene.state.largest_energy);
      EXPECT_GT(scene.state.energy.damage, 0.);
      EXPECT_GT(scene.state.energy.friction, 0.);
    }

    TEST(SymplecticTest, RefusesABoundOfTheOvershoot)
    {
      const auto report = [](const char *scheme) {
        InputErrors errors;
        read_scene_text(
            plate, "test.prm",
            {"Interface: all/law=camacho-ortiz", "Interface: all/strength=1",
             "Interface: all/toughness=1", "Interface: all/intact faces=bonded",
             std::string("Time/scheme=") + scheme,
             "Time/largest overshoot=0.1"},
            errors);
        return errors.report();
      };
      EXPECT_NE(
          report("symplectic").find("explicit steps are not bisected for it"),
          std::string::npos)
          << report("symplectic");
      EXPECT_EQ(report("moreau-jean"), "");
    }

    TEST(ArkodeTest, RefusesWhatIsNotSmooth)
    {
      InputErrors errors;
      EXPECT_EQ(read_scene_text(test::breaking_plate, "test.prm",
                                {"Time/scheme=arkode"}, errors),
                nullptr);
      EXPECT_NE(
          errors.report().find("faces of `Interface: all` can open, close "
                               "or slip"),
          std::string::npos)
          << errors.report();
    }
  } // namespace
} // namespace nsfd::test_schemes
