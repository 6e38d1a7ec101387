#include "make_scene.h"
#include "relaxation_scene.h"

#include "time_integration/step_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace nsfd;
using namespace nsfd::test;

TEST(StepControl, BaseStepMeetsTheEnd)
{
  StepControl control(1., 0.3, 10);
  EXPECT_DOUBLE_EQ(control.base_step(), 0.25);
  unsigned int n = 0;
  for (; !control.finished(); ++n)
    control.accept();
  EXPECT_EQ(n, 4u);
  EXPECT_EQ(control.time(), 1.);
}

// Of a run that goes on to another end, with the steps that it has.
TEST(StepControl, KeepsALengthBeyondTheEnd)
{
  StepControl control = StepControl::of_length(0.3, 2., 1.);
  EXPECT_EQ(control.step(), 0.3);
  unsigned int n = 0;
  for (; !control.finished(); ++n)
    control.accept();
  EXPECT_EQ(n, 4u);
  EXPECT_DOUBLE_EQ(control.time(), 2.2);
  EXPECT_FALSE(control.bisect());
  EXPECT_EQ(StepControl::of_length(0.1, 1.3, 1.).step(), 0.1);
}

// Down as far as the limit asks for at once, up one level per step where the
// time is a multiple of the longer step.
TEST(StepControl, DownAtOnceUpOneLevelPerStep)
{
  StepControl control(2., 1., 10);
  control.limit(0.13);
  EXPECT_EQ(control.level(), 3u);
  EXPECT_EQ(control.step(), 0.125);
  control.set_ceiling(0.13);
  for (unsigned int n = 0; n < 4; ++n)
    control.accept();
  EXPECT_EQ(control.time(), 0.5);
  EXPECT_EQ(control.level(), 3u) << "the ceiling holds";

  control.set_ceiling(std::numeric_limits<double>::infinity());
  const double steps[] = {0.125, 0.125, 0.25, 0.5, 0.5};
  double time = 0.5;
  for (const double step : steps) {
    EXPECT_EQ(control.time(), time);
    EXPECT_EQ(control.step(), step) << time;
    time += control.step();
    control.accept();
  }
  EXPECT_TRUE(control.finished());
  EXPECT_EQ(control.bisections(), 0u) << "no step was rejected";
}

// What is hard over many steps costs few attempts: of 256 short steps, where
// each of twice their length is rejected, the waits are 2, 4, 8, ... 64.
TEST(StepControl, WaitsWhereLongerStepsAreRejected)
{
  StepControl control(321., 1., 10);
  ASSERT_TRUE(control.bisect());
  unsigned int rejected = 0;
  while (control.time() < 128.)
    if (control.level() == 0) {
      ++rejected;
      ASSERT_TRUE(control.bisect());
    } else
      control.accept();
  EXPECT_EQ(rejected, 8u);
  // one that is taken proves nothing
  while (control.level() > 0)
    control.accept();
  control.accept();
  ASSERT_TRUE(control.bisect());
  unsigned int waited = 0;
  for (; control.level() > 0; ++waited)
    control.accept();
  EXPECT_EQ(waited, 64u);
  // where as many were taken as it was waited for, the wait is half as long
  for (unsigned int n = 0; n < 64; ++n)
    control.accept();
  ASSERT_TRUE(control.bisect());
  for (waited = 0; control.level() > 0; ++waited)
    control.accept();
  EXPECT_EQ(waited, 32u);
}

TEST(StepControl, TheLadderEnds)
{
  StepControl control(1., 1., 2);
  control.limit(1e-9);
  EXPECT_EQ(control.step(), 0.25);
  EXPECT_FALSE(control.bisect());
}

TEST(AutomaticStep, IsShortWherePointsSoften)
{
  Scene<2> scene(relaxation_scene, {"Time/step=10 us"});
  State state = scene.state;
  const double h = 10e-6, bound = 3.1062e-6, share = 0.95 * bound;
  const double peak =
      scene.stepper->problem().interactions[0].law->peak_opening();
  const auto step = [&](const double opening, const double largest,
                        const double time_to_peak) {
    for (std::size_t i = 0; i < state.opening_max.size(); ++i) {
      state.jump[2 * i] = opening * peak;
      state.relative_velocity[2 * i] = peak / time_to_peak;
      state.opening_max[i] = largest * peak;
    }
    return scene.stepper->automatic_step(state, h);
  };
  EXPECT_EQ(step(0., 0., 1.), h) << "far from the peak";
  EXPECT_EQ(step(0., 0., 20.1e-6), h) << "not before 2 h";
  EXPECT_NEAR(step(0., 0., 12e-6), 6e-6, 0.01e-6) << "half of the time";
  EXPECT_NEAR(step(0., 0., 3e-6), share, 1e-4 * share) << "the bound allows it";
  EXPECT_NEAR(step(2., 2., 1e-6), share, 1e-4 * share) << "softens";
  EXPECT_EQ(step(2., 2., -1e-6), h) << "past the peak, but closing";
  EXPECT_EQ(step(1.5, 2., 1.), h) << "open, but far from the largest opening";

  // by what happened in a step
  State before = state, after = state;
  for (double &d : before.opening_max)
    d = 0.9 * peak;
  for (double &d : after.opening_max)
    d = 1.1 * peak;
  EXPECT_NEAR(scene.stepper->unique_step(before, after), bound, 1e-4 * bound);
  EXPECT_TRUE(std::isinf(scene.stepper->unique_step(before, before)));
}
