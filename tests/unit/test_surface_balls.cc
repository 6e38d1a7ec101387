#include "surface_scene.h"

namespace surface_scene::test_surface_balls
{
  TEST(SurfaceSearch, BallOnABox)
  {
    Scene<3> scene;
    add_box(scene, 0, {0., 0., 0.}, {2., 2., 1.});
    scene.ball(1, {0.5, 1., 1.55}, 0.5); // over the upper side
    scene.ball(2, {2.3, 1., 1.4}, 0.5);  // off an edge
    scene.ball(3, {1., 1., 0.9}, 0.2);   // centre inside: not from outside
    const auto pairs = scene.find(0.1);
    ASSERT_EQ(pairs.balls.size(), 2u);
    const auto &over = pairs.balls[0], &edge = pairs.balls[1];
    EXPECT_EQ(over.index, 0u);
    EXPECT_EQ(over.facet, 5u);
    EXPECT_NEAR(over.gap, 0.05, 1e-15);
    EXPECT_NEAR(over.normal[2], 1., 1e-15);
    EXPECT_NEAR(over.closest[0], 0.5, 1e-15);
    const double expected[4] = {0.375, 0.125, 0.125, 0.375};
    for (unsigned int i = 0; i < 4; ++i)
      EXPECT_NEAR(over.weights[i], expected[i], 1e-15);
    EXPECT_EQ(edge.index, 1u);
    EXPECT_NEAR(edge.gap, 0., 1e-15);
    EXPECT_NEAR(edge.normal[0], 0.6, 1e-15);
    EXPECT_NEAR(edge.normal[2], 0.8, 1e-15);
    EXPECT_NEAR(edge.closest[0], 2., 1e-15);
    EXPECT_NEAR(edge.closest[2], 1., 1e-15);
  }

  TEST(SurfaceSearch, BallInAWedge)
  {
    Scene<2> scene;
    const unsigned int left = scene.vertex({-2., 2.}),
                       bottom = scene.vertex({0., 0.}),
                       right = scene.vertex({2., 2.});
    scene.facet(0, {bottom, left});
    scene.facet(0, {right, bottom});
    const double c = std::sqrt(0.5);
    scene.ball(1, {0., 1.}, c - 0.01);
    const auto pairs = scene.find(0.1);
    ASSERT_EQ(pairs.balls.size(), 2u);
    for (const auto &pair : pairs.balls) {
      EXPECT_NEAR(pair.gap, 0.01, 1e-15);
      EXPECT_NEAR(pair.normal[0], pair.facet == 0 ? c : -c, 1e-15);
      EXPECT_NEAR(pair.normal[1], c, 1e-15);
    }
  }

  TEST(SurfaceSearch, BallOnASharedVertexIsOnePair)
  {
    Scene<2> scene;
    add_polygon(scene, 0, {{-1., -1.}, {1., -1.}, {0., 0.}}); // a roof
    scene.ball(1, {0., 0.5}, 0.45);
    auto pairs = scene.find(0.1);
    ASSERT_EQ(pairs.balls.size(), 1u);
    EXPECT_EQ(scene.surfaces.facets[pairs.balls[0].facet].key, 101u);
    EXPECT_NEAR(pairs.balls[0].gap, 0.05, 1e-15);
    EXPECT_NEAR(pairs.balls[0].normal[1], 1., 1e-15);
  }

  // A floor of ten facets, of one body or of ten loose ones: a ball that rolls
  // meets one normal everywhere, no edges. At a joint of two bodies it is on
  // both.
  TEST(SurfaceSearch, BallOnAFloorOfManyFacets)
  {
    for (const bool loose : {false, true}) {
      Scene<2> scene;
      if (loose)
        for (unsigned int i = 0; i < 10; ++i)
          add_box(scene, i, {i + 0., -1.}, {i + 1., 0.});
      else
        for (unsigned int i = 0, last = scene.vertex({0., 0.}); i < 10; ++i) {
          const unsigned int next = scene.vertex({i + 1., 0.});
          scene.facet(0, {next, last});
          last = next;
        }
      scene.ball(10, {0., 0.5}, 0.5);
      for (double at = 2.; at <= 8.; at += 0.125) {
        scene.x[scene.x.size() - 2] = at;
        const auto pairs = scene.find(0.4);
        EXPECT_EQ(pairs.balls.size(), loose && at == std::floor(at) ? 2u : 1u)
            << at;
        for (const auto &pair : pairs.balls) {
          EXPECT_NEAR(pair.normal[1], 1., 1e-15);
          EXPECT_NEAR(pair.gap, 0., 1e-15);
        }
      }
    }
  }

  TEST(SurfaceSearch, BallAndBall)
  {
    Scene<3> scene;
    scene.ball(0, {3., 4., 0.}, 2.);
    scene.ball(1, {0., 0., 0.}, 2.5);
    scene.ball(2, {0., 0., 5.2}, 2.);
    scene.ball(2, {0., 0., 6.}, 2.); // of the same body
    const auto pairs = scene.find(0.6);
    ASSERT_EQ(pairs.ball_balls.size(), 1u);
    const auto &pair = pairs.ball_balls[0];
    EXPECT_EQ(pair.ball, 0u);
    EXPECT_EQ(pair.other, 1u);
    EXPECT_NEAR(pair.gap, 0.5, 1e-15);
    EXPECT_NEAR(pair.normal[0], 0.6, 1e-15);
    EXPECT_NEAR(pair.normal[1], 0.8, 1e-15);
    EXPECT_NEAR(pair.closest[0], 1.5, 1e-15);
    EXPECT_NEAR(pair.closest[1], 2., 1e-15);
    EXPECT_EQ(scene.find(0.8).ball_balls.size(), 2u);
  }
} // namespace surface_scene::test_surface_balls
