// Explicit steps in which bodies pass each other by many times their
// thickness: what touches on the way is not missed.
#include "fast_scenes.h"
#include "leapfrog_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace nsfd;
using namespace nsfd::test;
using namespace nsfd::test::fast;

namespace test_fast_explicit
{
  template <int dim>
  class Flight : public Steps<dim>
  {
  public:
    Flight(const std::string &text, std::vector<std::string> overrides)
        : Steps<dim>(text, with_scheme(std::move(overrides)))
    {
      this->leapfrog->show(this->state);
    }

    /** One step, bisected as a run does; its length. */
    double advance()
    {
      double share = 1.;
      while (true)
        try {
          this->step(share);
          this->leapfrog->show(this->state);
          return share;
        } catch (const StepRejected &rejected) {
          if (rejected.cure() != StepRejected::Cure::shorter_step ||
              share < 1. / 1024.)
            throw;
          share /= 2.;
        }
    }
    void run_to(const double end)
    {
      while (this->state.time < end)
        advance();
    }
    double centre(const std::size_t body, const unsigned int component = 0)
    {
      return this->state.rigid[13 * body + component];
    }
    double velocity(const std::size_t body, const unsigned int component = 0)
    {
      return this->state.rigid[13 * body + 3 + component];
    }

  private:
    static std::vector<std::string>
    with_scheme(std::vector<std::string> overrides)
    {
      overrides.emplace_back("Time/scheme=explicit");
      return overrides;
    }
  };

  std::string step_of(const double value, const std::string &unit)
  {
    return "Time/step=" + std::to_string(value) + " " + unit;
  }

  TEST(FastExplicit, FoilIsNotPassed)
  {
    for (const double aside : {0., 8.})
      for (const double e : {0., 1.})
        for (const double step :
             {0.5, 1., 2., 3., 5.2, 7.5, 8., 8.5, 9., 9.5, 15., 30., 40.}) {
          SCOPED_TRACE(std::to_string(step) + " ms, e " + std::to_string(e));
          Flight<2> run(
              shot_and_foil,
              {step_of(step, "ms"),
               "Contact: all/restitution=" + std::to_string(e),
               "Material: shot/initial velocity y=" + std::to_string(aside)});
          while (run.state.time < 0.08) {
            run.advance();
            // no deeper than half of the foil
            EXPECT_LT(run.state.penetration, 0.5 * 0.01 * (1. + 1e-9));
          }
          if (aside == 0.) {
            EXPECT_NEAR(run.velocity(0), 5. * (1. - e), 1e-8);
            EXPECT_NEAR(run.velocity(1), 5. * (1. + e), 1e-8);
            EXPECT_NEAR(run.state.energy.impact, 250. * (1. - e * e), 1e-6);
          }
          EXPECT_GT(run.velocity(1), 1.); // hit somewhere else, it turns
          EXPECT_LT(run.state.energy.kinetic,
                    5. * (100. + aside * aside) * (1. + 1e-12));
        }
  }

  TEST(FastExplicit, BallsMeet)
  {
    for (const double step : {0.3, 4., 7., 20., 60.}) {
      SCOPED_TRACE(step);
      Flight<3> run(balls, {step_of(step, "s")});
      run.run_to(61.);
      EXPECT_NEAR(run.velocity(0), 0.25, 1e-9);
      EXPECT_NEAR(run.velocity(1), 0.25, 1e-9);
      EXPECT_LT(run.centre(0), run.centre(1));
    }
  }

  TEST(FastExplicit, ThinObstacleIsNotPassed)
  {
    for (const double step : {0.7, 8., 50., 200.}) {
      SCOPED_TRACE(step);
      const std::string length = step_of(step, "ms");
      // a disc stops, a disc at rest is taken along by a wire that moves
      Flight<2> thrown(wire, {length});
      thrown.run_to(0.3);
      EXPECT_NEAR(thrown.velocity(0), 0., 1e-9);
      EXPECT_LT(thrown.centre(0), 0.8);
      Flight<2> swept(wire, {length, "Material: m/initial velocity x=0",
                             "Obstacle: wire/velocity x=-10"});
      swept.run_to(0.3);
      EXPECT_NEAR(swept.velocity(0), -10., 1e-9);
      EXPECT_LT(swept.centre(0), 0.8 - 10. * swept.state.time);
    }
  }

  // its ends are on chords that do not come near the disc
  TEST(FastExplicit, TurningRodHitsADisc)
  {
    for (const double step : {0.05, 1., 2.2}) {
      SCOPED_TRACE(step);
      Flight<2> run(rod_and_disc,
                    {step_of(step, "s"), "Contact: all/restitution=1"});
      while (run.velocity(1) == 0. && run.state.time < 2.4)
        run.advance();
      const double r = 0.05 * std::sqrt(2.), d = 0.7, half = 0.02,
                   arm = std::sqrt(d * d - (r + half) * (r + half));
      const double M = 80., I = M * (4. + 0.0016) / 12., m = 20.;
      const double P = 2. * arm / (1. / m + 1. / M + arm * arm / I);
      const double speed = std::hypot(run.velocity(1), run.velocity(1, 1));
      // where they are when they meet is known as from the start of the step
      EXPECT_NEAR(m * speed, P, (step < 0.1 ? 0.02 : 0.5) * P);
      EXPECT_NEAR(m * run.velocity(1) + M * run.velocity(0), 0., 1e-9);
      EXPECT_NEAR(m * run.velocity(1, 1) + M * run.velocity(0, 1), 0., 1e-9);
    }
  }
} // namespace test_fast_explicit
