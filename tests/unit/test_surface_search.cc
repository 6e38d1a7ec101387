#include "surface_scene.h"

namespace surface_scene::test_surface_search
{
  TEST(SurfaceSearch, PointOverAnEdge)
  {
    for (const double gap : {0.3, 0., -0.1}) {
      const auto pairs = point_over_floor({1., gap}).find(0.5);
      ASSERT_EQ(pairs.points.size(), 1u);
      const auto &pair = pairs.points[0];
      EXPECT_EQ(pair.index, 0u);
      EXPECT_EQ(pair.facet, 0u);
      EXPECT_NEAR(pair.gap, gap, 1e-15);
      EXPECT_NEAR(pair.normal[0], 0., 1e-15);
      EXPECT_NEAR(pair.normal[1], 1., 1e-15);
      EXPECT_NEAR(pair.closest[0], 1., 1e-15);
      EXPECT_NEAR(pair.closest[1], 0., 1e-15);
      EXPECT_NEAR(pair.weights[0], 0.25, 1e-15); // the right end comes first
      EXPECT_NEAR(pair.weights[1], 0.75, 1e-15);
    }
  }

  // Beyond the reach, too deep (a quarter of the smaller facet, which is 1
  // long) and beyond the end by more than the inset, which is 1 % of the own
  // facet.
  TEST(SurfaceSearch, LimitsOfAPoint)
  {
    const auto count = [](const Place<2> &at) {
      return point_over_floor(at).find(0.5).points.size();
    };
    EXPECT_EQ(count({1., 0.499}), 1u);
    EXPECT_EQ(count({1., 0.501}), 0u);
    EXPECT_EQ(count({1., -0.249}), 1u);
    EXPECT_EQ(count({1., -0.251}), 0u);
    EXPECT_EQ(count({3.98, 0.1}), 1u);
    EXPECT_EQ(count({4., 0.1}), 0u);
    EXPECT_EQ(count({-0.01, 0.1}), 1u); // moved to the end itself
    EXPECT_EQ(count({-0.011, 0.1}), 0u);
  }

  // Both bodies get their impulse at one place, a little past the end of the
  // facet (by 0.005 of 4).
  TEST(SurfaceSearch, PlaceBeyondTheEndIsAcross)
  {
    const auto pairs = point_over_floor({-0.005, 0.1}).find(0.5);
    ASSERT_EQ(pairs.points.size(), 1u);
    EXPECT_NEAR(pairs.points[0].gap, 0.1, 1e-15);
    EXPECT_NEAR(pairs.points[0].closest[0], -0.005, 1e-15);
    EXPECT_NEAR(pairs.points[0].weights[0], -0.00125, 1e-15);
    EXPECT_NEAR(pairs.points[0].weights[1], 1.00125, 1e-15);
  }

  TEST(SurfaceSearch, FacetsThatDoNotOpposeNeverTouch)
  {
    auto scene = point_over_floor({1., 0.1});
    std::swap(scene.surfaces.facets[1].vertex[0],
              scene.surfaces.facets[1].vertex[1]);
    EXPECT_TRUE(scene.find(0.5).points.empty());
  }

  TEST(SurfaceSearch, JoinedBodiesNeverTouch)
  {
    const auto scene = point_over_floor({1., 0.1});
    EXPECT_TRUE(scene
                    .find(0.5, [](unsigned int a,
                                  unsigned int b) { return a + b == 1; })
                    .points.empty());
    auto same = scene;
    same.surfaces.facets[1].body = 0;
    EXPECT_TRUE(same.find(0.5).points.empty());
  }

  TEST(SurfaceSearch, FlushAndStaggeredBoxes)
  {
    for (const double shift : {0., 0.3}) {
      Scene<2> scene;
      add_box(scene, 0, {0., 0.}, {1., 1.});            // facets 100 to 103
      add_box(scene, 1, {shift, 1.}, {1. + shift, 2.}); // facets 104 to 107
      scene.all_points();
      Names<2> expected{
          {3, 102, 104}, {2, 102, 104}, {4, 104, 102}, {5, 104, 102}};
      if (shift > 0.)
        expected = {{2, 102, 104}, {4, 104, 102}};
      EXPECT_EQ(names(scene, scene.find(0.2)), expected);
    }
  }

  TEST(SurfaceSearch, BoxesThatMeetInACornerDoNotTouch)
  {
    Scene<2> scene;
    add_box(scene, 0, {0., 0.}, {1., 1.});
    add_box(scene, 1, {1., 1.}, {2., 2.});
    add_box(scene, 2, {1., -1.}, {2., 0.});
    scene.all_points();
    EXPECT_TRUE(scene.find(0.3).points.empty());
  }

  TEST(SurfaceSearch, CornerEntersASide)
  {
    Scene<2> scene;
    add_box(scene, 0, {0., 0.}, {4., 1.});
    // a square on its tip, 0.05 deep in the upper side of the box
    add_polygon(scene, 1, {{2., 0.95}, {3., 1.95}, {2., 2.95}, {1., 1.95}});
    scene.all_points();
    const auto pairs = scene.find(0.2);
    // two points of the tip, equally deep and opposed: the lower key stays
    EXPECT_EQ(names(scene, pairs), (Names<2>{{4, 104, 102}}));
    EXPECT_NEAR(pairs.points[0].gap, -0.05, 1e-15);
    EXPECT_NEAR(pairs.points[0].normal[1], 1., 1e-15);
  }

  // Two acute tips pass each other, flank along flank: the one of body 1 is
  // 0.2 below the upper side of body 0, where this is thinner.
  TEST(SurfaceSearch, InFrontOfTheOtherSideOfAnAcuteTip)
  {
    Scene<2> scene;
    add_polygon(scene, 0, {{0., 0.}, {4., -2.3}, {4., 0.}}); // 100 to 102
    add_polygon(scene, 1, {{0.3, -0.2}, {4.3, -3.6}, {4.3, -2.5}});
    scene.all_points();
    EXPECT_EQ(names(scene, scene.find(0.1)),
              (Names<2>{{1, 100, 105}, {3, 105, 100}}));
    // what came in through the upper side is held there
    for (auto &point : scene.surfaces.points)
      if (point.vertex == 3 && point.facet == 3)
        point.last_side = 102;
    const auto held = names(scene, scene.find(0.1));
    EXPECT_EQ(held.count({3, 103, 102}), 1u);
  }

  // A tip rests on the right side of another one, as near to it as round-off
  // of the longer one of its own sides is, and not of the shorter one. It is
  // not below the left side, however deep that is over there.
  TEST(SurfaceSearch, TipThatRestsBesideAnotherTip)
  {
    for (const double gap : {0., 5e-13, 1e-12, 2e-12, 5e-12, 1e-11, 1e-10}) {
      Scene<2> scene;
      add_polygon(scene, 0, {{-1., -2.}, {1., -2.}, {0., 0.}}); // 100 to 102
      const double x = 0.02 + gap * std::sqrt(5.) / 2.;
      add_polygon(scene, 1, {{x, -0.04}, {x + 0.2, 0.5}, {x - 0.5, 1.}});
      scene.all_points();
      std::set<std::uint64_t> touched;
      for (const auto &pair : scene.find(0.01).points)
        if (scene.surfaces.points[pair.index].vertex == 3)
          touched.insert(scene.surfaces.facets[pair.facet].key);
      EXPECT_EQ(touched, (std::set<std::uint64_t>{101})) << gap;
    }
  }

  // Two acute tips pass through each other like the blades of scissors: both
  // are in front of the other's lower side, which goes down to its end by
  // `fall`, and below its upper one.
  TEST(SurfaceSearch, BladesOfScissors)
  {
    for (const double fall : {0.3, 0.05}) {
      Scene<2> scene;
      add_polygon(scene, 0, {{-3., fall}, {0.2, 0.}, {-3., 1.6}}); // 100 to 102
      add_polygon(scene, 1, {{-0.2, 0.}, {3., fall}, {3., 1.6}});  // 103 to 105
      scene.all_points();
      std::set<unsigned int> inside;
      for (const auto &pair : scene.find(0.01).points) {
        if (pair.gap > 0.) // the lower side is near
          continue;
        const unsigned int vertex = scene.surfaces.points[pair.index].vertex;
        inside.insert(vertex);
        // across the upper side, which the tip has come through
        EXPECT_EQ(scene.surfaces.facets[pair.facet].key,
                  vertex == 3 ? 101u : 105u);
        EXPECT_NEAR(pair.gap, -0.4 / std::sqrt(5.), 1e-15);
      }
      EXPECT_EQ(inside, (std::set<unsigned int>{1, 3})) << fall;
    }
  }

  // A crack ends where the tip of body 2 presses on the front of body 0: the
  // tip is in the mouth of the crack, below its lower face and outside of body
  // 0, whose own tip it has passed. It is held by both, or the fronts would
  // pass through each other.
  TEST(SurfaceSearch, BladesOfScissorsInTheMouthOfACrack)
  {
    Scene<2> scene;
    add_polygon(scene, 0, {{0.015, -1.}, {0.015, 1.}, {-1., 0.}}); // 100 to 102
    add_polygon(scene, 1, {{0.05, -1.04}, {-0.95, -0.04}, {-1., -1.04}});
    add_polygon(scene, 2, {{-0.002, -0.995}, {1., 0.}, {-0.002, 0.995}});
    for (auto &facet : scene.surfaces.facets)
      facet.whole = facet.body == 2 ? 1 : 0; // cracked, in one piece
    scene.all_points();
    std::map<std::uint64_t, double> gaps; // of the tip
    for (const auto &pair : scene.find(1e-3).points)
      if (scene.surfaces.points[pair.index].vertex == 6)
        gaps[scene.surfaces.facets[pair.facet].key] = pair.gap;
    ASSERT_EQ(gaps.size(), 2u);
    EXPECT_NEAR(gaps.at(100), -0.017, 1e-15);
    EXPECT_NEAR(gaps.at(103), -0.007 / std::sqrt(2.), 1e-15);
  }

  // Two sides lie on each other, by 0.0006 at one end and 0.02 at the other,
  // where their tips have passed each other: neither is in the other body, and
  // no end of a side is in front of the other side.
  TEST(SurfaceSearch, FlushSidesWhoseTipsHavePassed)
  {
    Scene<2> scene;
    add_polygon(scene, 0, {{0., 0.}, {3.8, 0.}, {1., 3.}}); // 100 to 102
    add_polygon(scene, 1, {{3., -0.5}, {3.9, 1e-4}, {-0.05, 0.02}}); // to 105
    scene.all_points();
    std::set<unsigned int> inside;
    for (const auto &pair : scene.find(0.01).points)
      if (pair.gap < 0.) {
        inside.insert(scene.surfaces.points[pair.index].vertex);
        EXPECT_EQ(scene.surfaces.facets[pair.facet].key, 104u);
      }
    EXPECT_EQ(inside, (std::set<unsigned int>{0, 1}));
  }

  // A corner below a side, but outside of its cell: beyond a face that still
  // holds, which touches nothing itself.
  TEST(SurfaceSearch, FaceThatHoldsEndsASurface)
  {
    for (const bool known : {false, true}) {
      Scene<2> scene;
      add_polygon(scene, 0, {{0., 0.}, {-4., 0.}, {-3., -3.}}); // 100 to 102
      add_polygon(scene, 1, {{-0.05, -0.5}, {2.35, -2.3}, {3., -0.5}});
      if (known)
        scene.surfaces.facets[2].touches = false;
      else
        scene.surfaces.facets.erase(scene.surfaces.facets.begin() + 2);
      scene.all_points();
      const auto pairs = scene.find(0.01);
      EXPECT_EQ(pairs.points.size(), known ? 0u : 1u);
    }
  }

  // The tip of body 0 is a little above the bottom of body 1 and far below its
  // right side. It came in through the bottom, with the side that looks there,
  // also while that is a face that holds at its other end and touches nothing.
  TEST(SurfaceSearch, CornerNextToFaceThatHolds)
  {
    enum Face { unknown, holds, surface };
    for (const Face face : {unknown, holds, surface}) {
      Scene<2> scene;
      add_polygon(scene, 0, {{0., 4e-4}, {0., -6.8}, {5.1, -4.7}}); // to 102
      add_polygon(scene, 1, {{0.63, 0.}, {-2.2, 4.5}, {-6.6, 0.}}); // to 105
      if (face == holds)
        scene.surfaces.facets[2].touches = false;
      else if (face == unknown)
        scene.surfaces.facets.erase(scene.surfaces.facets.begin() + 2);
      scene.all_points();
      const auto pairs = scene.find(0.01).points;
      ASSERT_EQ(pairs.size(), face == holds ? 0u : 1u);
      if (face == unknown) {
        EXPECT_EQ(scene.surfaces.facets[pairs[0].facet].key, 103u);
      }
      if (face == surface) {
        EXPECT_EQ(scene.surfaces.facets[pairs[0].facet].key, 105u);
        EXPECT_NEAR(pairs[0].gap, -4e-4, 1e-15);
      }
    }
  }

  // The tip of body 0 is a little inside the left side of body 1, whose lower
  // corner is in front of the tip's lower side: it does not touch the upper
  // one, although the side that leads to it cuts the tip.
  TEST(SurfaceSearch, CornerBesideATipInItsSide)
  {
    Scene<2> scene;
    add_polygon(scene, 0, {{0., 0.}, {-4., 0.7}, {-4., -5.}});    // 100 to 102
    add_polygon(scene, 1, {{-0.3, -0.8}, {3., -0.4}, {1., 2.7}}); // 103 to 105
    scene.all_points();
    const auto pairs = scene.find(0.01);
    ASSERT_EQ(pairs.points.size(), 1u);
    EXPECT_EQ(scene.surfaces.points[pairs.points[0].index].vertex, 0u);
    EXPECT_EQ(scene.surfaces.facets[pairs.points[0].facet].key, 105u);
  }

  // A box has sunk in by 0.03 and rests on its support by 0.02 or 0.04 only:
  // the side of the support is nearer to the corner than its top, or the other
  // way round.
  TEST(SurfaceSearch, CornerOverAnEdgeTouchesTheNearerFacet)
  {
    for (const double inside : {0.02, 0.04}) {
      Scene<2> scene;
      add_box(scene, 0, {0., 0.}, {1., 1.});
      add_box(scene, 1, {1. - inside, 1. - 0.03}, {2. - inside, 1.97});
      scene.all_points();
      const auto pairs = scene.find(0.2);
      const std::uint64_t side = 101, top = 102;
      std::set<std::uint64_t> touched;
      for (const auto &pair : pairs.points)
        if (scene.surfaces.points[pair.index].vertex == 4) {
          touched.insert(scene.surfaces.facets[pair.facet].key);
          EXPECT_NEAR(pair.gap, -std::min(inside, 0.03), 1e-15);
        }
      EXPECT_EQ(touched, std::set<std::uint64_t>{inside < 0.03 ? side : top});
    }
  }

  // The same: depths next to a corner do not tell which way it came in, the
  // facet of the step before does, also where nothing but the end of it is
  // left.
  TEST(SurfaceSearch, CornerKeepsTheFacetOfTheLastStep)
  {
    const std::uint64_t side = 101, top = 102;
    for (const std::uint64_t last : {side, top})
      for (const double inside : {0.005, 0.02, 0.04}) {
        Scene<2> scene;
        add_box(scene, 0, {0., 0.}, {1., 1.});
        add_box(scene, 1, {1. - inside, 1. - 0.03}, {2. - inside, 1.97});
        scene.all_points();
        for (auto &point : scene.surfaces.points)
          point.last_side = last;
        for (const auto &pair : scene.find(0.2).points)
          if (scene.surfaces.points[pair.index].vertex == 4) {
            EXPECT_EQ(scene.surfaces.facets[pair.facet].key, last);
            EXPECT_NEAR(pair.gap, last == side ? -inside : -0.03, 1e-15);
          }
      }
  }

  // The tip of a wedge is beside the box, its inset is over it; what the wedge
  // has come in through is the corner of the box.
  TEST(SurfaceSearch, CornerBesideABodyIsNotBelowItsTop)
  {
    Scene<2> scene;
    add_box(scene, 0, {0., 0.}, {1., 1.});
    add_polygon(scene, 1, {{1.004, 0.93}, {2., 1.2}, {2., 2.}, {0., 1.6}});
    scene.all_points();
    const auto pairs = scene.find(0.2);
    const auto found = names(scene, pairs);
    EXPECT_EQ(found.count({4, 107, 102}), 0u); // the top
    EXPECT_EQ(found.count({4, 107, 101}), 0u); // the side
    EXPECT_EQ(found.count({2, 101, 107}) + found.count({2, 102, 107}), 1u);
  }

  // A box has sunk into the top of another one, its left side nearly flush: the
  // corner is a hair inside of the side, which it cannot have come in through.
  TEST(SurfaceSearch, CornerThatLeansOverASideIsBelowTheTop)
  {
    const double turn = 0.12, c = std::cos(turn), s = std::sin(turn);
    const double x = 0.0004, y = 0.95;
    for (const std::uint64_t last : {Surfaces<2>::no_key, std::uint64_t(103)}) {
      Scene<2> scene;
      add_box(scene, 0, {0., 0.}, {1., 1.});
      add_polygon(
          scene, 1,
          {{x, y}, {x + c, y + s}, {x + c - s, y + s + c}, {x - s, y + c}});
      scene.all_points();
      for (auto &point : scene.surfaces.points)
        point.last_side = last;
      const auto found = names(scene, scene.find(0.1));
      EXPECT_EQ(found.count({4, 104, 102}), 1u) << "the top";
      EXPECT_EQ(found.count({4, 104, 103}), 0u) << "the side";
    }
  }

  // The same corner, which has been below the side in the step before, and has
  // turned meanwhile: it does not come out of it on another side.
  TEST(SurfaceSearch, CornerThatHasComeInStaysWhileItTurns)
  {
    const double turn = 0.12, c = std::cos(turn), s = std::sin(turn);
    const double x = 0.02, y = 0.9;
    for (const bool was_below : {false, true}) {
      Scene<2> scene;
      add_box(scene, 0, {0., 0.}, {1., 1.});
      add_polygon(
          scene, 1,
          {{x, y}, {x + c, y + s}, {x + c - s, y + s + c}, {x - s, y + c}});
      scene.all_points();
      for (auto &point : scene.surfaces.points) {
        point.last_side = 103;
        point.was_below = was_below;
      }
      const auto found = names(scene, scene.find(0.1));
      EXPECT_EQ(found.count({4, 104, 103}) + found.count({4, 107, 103}),
                was_below ? 1u : 0u);
    }
  }

  // A corner that slides on one body runs into another one, which is never the
  // nearer one.
  TEST(SurfaceSearch, CornerBetweenTwoBodiesTouchesBoth)
  {
    Scene<2> scene;
    add_box(scene, 0, {-1., -1.}, {3., 0.});
    add_polygon(scene, 1, {{0., 0.001}, {0.3, 0.401}, {-0.3, 0.401}});
    add_box(scene, 2, {-1., -0.5}, {0.003, 0.5});
    for (auto &facet : scene.surfaces.facets)
      facet.whole = facet.body;
    scene.all_points();
    std::set<unsigned int> touched;
    for (const auto &pair : scene.find(0.1).points)
      if (scene.surfaces.points[pair.index].vertex == 4)
        touched.insert(scene.surfaces.facets[pair.facet].body);
    EXPECT_EQ(touched, (std::set<unsigned int>{0, 2}));
  }

  // A box in the corner of an L touches the floor and the wall, both of one
  // body.
  TEST(SurfaceSearch, CornerInANotchTouchesBothSides)
  {
    for (const double overlap : {-0.01, 0., 0.01}) {
      Scene<2> scene;
      add_polygon(
          scene, 0,
          {{-1., -1.}, {3., -1.}, {3., 0.}, {0., 0.}, {0., 3.}, {-1., 3.}});
      add_box(scene, 1, {-overlap, -overlap}, {1., 1.});
      scene.all_points();
      const auto found = names(scene, scene.find(0.1));
      EXPECT_EQ(found.count({6, 106, 102}), 1u); // lower side on the floor
      EXPECT_EQ(found.count({6, 109, 103}), 1u); // left side on the wall
    }
  }

  TEST(SurfaceSearch, CoincidentCells)
  {
    const auto plane = cells<2>(4);
    expect_opposite_sides<2>(plane, plane.find(0.2), 4);
    const auto space = cells<3>(3);
    expect_opposite_sides<3>(space, space.find(0.2), 3);
  }

  TEST(SurfaceSearch, StaggeredBoxesInSpace)
  {
    Scene<3> scene;
    add_box(scene, 0, {0., 0., 0.}, {1., 1., 1.});
    add_box(scene, 1, {0.4, 0.2, 1.1}, {1.4, 1.2, 2.1}); // one corner is over 0
    add_box(scene, 2, {1., 1., -1.}, {2., 2., 0.});      // meets a corner of 0
    scene.all_points();
    const auto pairs = scene.find(0.2);
    // lower corner of box 1 on the top of box 0, and the other way round
    EXPECT_EQ(names(scene, pairs), (Names<3>{{8, 110, 105}, {7, 105, 110}}));
    for (const auto &pair : pairs.points) {
      EXPECT_NEAR(pair.gap, 0.1, 1e-15);
      const bool upper = pair.facet == 5;
      EXPECT_NEAR(pair.normal[2], upper ? 1. : -1., 1e-15);
      EXPECT_NEAR(pair.closest[0], upper ? 0.4 : 1., 1e-15);
      EXPECT_NEAR(pair.closest[1], upper ? 0.2 : 1., 1e-15);
    }
  }

  // Weights give back the closest place and sum up to one; the way to a point
  // over the inside is along the normal.
  TEST(SurfaceSearch, PlacesOnTrianglesAndWarpedQuadrilaterals)
  {
    for (const bool four : {false, true}) {
      Scene<3> scene;
      std::vector<unsigned int> corners{scene.vertex({0., 0., 0.05}),
                                        scene.vertex({2., 0.2, -0.05})};
      corners.push_back(scene.vertex({1.7, 1.8, 0.08}));
      if (four)
        corners.push_back(scene.vertex({0.1, 1.5, -0.02}));
      scene.facet(0, corners);
      const unsigned int tip = scene.vertex({1.2, 0.8, 0.3});
      scene.facet(1, {tip, scene.vertex({1.2, 1.8, 0.35}),
                      scene.vertex({2.2, 0.8, 0.35})}); // outward: down
      scene.surfaces.points.push_back({tip, 1});
      const auto pairs = scene.find(0.5);
      ASSERT_EQ(pairs.points.size(), 1u);
      const auto &pair = pairs.points[0];
      Place<3> on{};
      double total = 0.;
      for (unsigned int i = 0; i < corners.size(); ++i) {
        on = sum(on, pair.weights[i], place<3>(scene.x.data(), corners[i]));
        total += pair.weights[i];
        EXPECT_GT(pair.weights[i], 0.);
      }
      EXPECT_NEAR(total, 1., 1e-14);
      EXPECT_LE(norm(difference(on, pair.closest)), 1e-14);
      const Place<3> back = sum(pair.closest, pair.gap, pair.normal);
      EXPECT_LE(norm(difference(back, place<3>(scene.x.data(), tip))), 1e-13);
      EXPECT_NEAR(norm(pair.normal), 1., 1e-15);
      EXPECT_GT(pair.gap, 0.2);
    }
  }
} // namespace surface_scene::test_surface_search
