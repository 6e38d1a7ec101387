#include "separating_axes.h"
#include "surface_scene.h"

#include "contact_detection/flat_sides.h"

#include <functional>

namespace surface_scene::test_surface_edges
{
  /** A body of its own: moved by hand. */
  struct Solid {
    Scene<3> scene;

    void shift(const Place<3> &by)
    {
      for (std::size_t i = 0; i < scene.x.size(); ++i)
        scene.x[i] += by[i % 3];
    }
    test::Convex convex() const
    {
      test::Convex result;
      const double *x = scene.x.data();
      for (unsigned int v = 0; v < scene.surfaces.n_vertices; ++v)
        result.corners.push_back(place<3>(x, v));
      for (const auto &facet : scene.surfaces.facets) {
        result.normals.push_back(plane_of<3>(facet, x).normal);
        for (unsigned int i = 0; i < facet.n_vertices; ++i)
          result.edges.push_back(
              difference(place<3>(x, facet.vertex[(i + 1) % facet.n_vertices]),
                         place<3>(x, facet.vertex[i])));
      }
      return result;
    }
  };

  Solid box(const Place<3> &half)
  {
    Solid result;
    add_box(result.scene, 0, {-half[0], -half[1], -half[2]}, half);
    return result;
  }

  Solid tetrahedron(std::mt19937 &random)
  {
    std::uniform_real_distribution<double> unit(-0.2, 0.2);
    Solid result;
    const double corners[4][3] = {
        {-1., -1., -1.}, {1., -1., 1.}, {-1., 1., 1.}, {1., 1., -1.}};
    for (const auto &corner : corners)
      result.scene.vertex({corner[0] + unit(random), corner[1] + unit(random),
                           corner[2] + unit(random)});
    for (const std::vector<unsigned int> &side :
         std::vector<std::vector<unsigned int>>{
             {0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})
      result.scene.facet(0, side);
    return result;
  }

  Solid random_solid(std::mt19937 &random)
  {
    std::uniform_real_distribution<double> unit(0.5, 1.5);
    Solid result = random() % 2
                       ? tetrahedron(random)
                       : box({unit(random), unit(random), unit(random)});
    turn_at_random(result.scene.x, random);
    return result;
  }

  /** Sides of two triangles, cut along either diagonal. */
  Solid of_triangles(const Solid &solid, std::mt19937 &random)
  {
    Solid result = solid;
    result.scene.surfaces.facets.clear();
    for (const auto &facet : solid.scene.surfaces.facets) {
      const auto &v = facet.vertex;
      const unsigned int k = random() % 2;
      result.scene.facet(0, {v[k], v[k + 1], v[(k + 2) % 4]});
      result.scene.facet(0, {v[k], v[(k + 2) % 4], v[(k + 3) % 4]});
    }
    return result;
  }

  /** Body 0 and body 1 with all their points and edges, one point of a corner
      per side. */
  Scene<3> together(const Solid &a, const Solid &b)
  {
    Scene<3> scene;
    for (const Solid *solid : {&a, &b}) {
      const auto first = static_cast<unsigned int>(scene.surfaces.n_vertices);
      scene.x.insert(scene.x.end(), solid->scene.x.begin(),
                     solid->scene.x.end());
      scene.surfaces.n_vertices += solid->scene.surfaces.n_vertices;
      for (const auto &facet : solid->scene.surfaces.facets) {
        std::vector<unsigned int> corners;
        for (unsigned int i = 0; i < facet.n_vertices; ++i)
          corners.push_back(first + facet.vertex[i]);
        scene.facet(solid == &b, corners);
      }
    }
    const auto keeps_shape = [](unsigned int) { return true; };
    set_flat_sides<3>(scene.surfaces, scene.x.data(), keeps_shape);
    std::set<std::pair<unsigned int, std::uint64_t>> known;
    for (unsigned int f = 0; f < scene.surfaces.facets.size(); ++f) {
      const auto &facet = scene.surfaces.facets[f];
      for (unsigned int i = 0; i < facet.n_vertices; ++i)
        if (known.insert({facet.vertex[i], facet.side}).second)
          scene.surfaces.points.push_back({facet.vertex[i], f});
    }
    set_edges<3>(scene.surfaces, scene.x.data(), keeps_shape);
    return scene;
  }

  /** Two bricks turned by 45 degrees about their axes x and y: an upper edge of
   * the one crosses a lower edge of the other, `gap` above. */
  Scene<3> crossed_bricks(const double gap, const double aside = 0.)
  {
    Solid low = box({2., 0.5, 0.5}), high = box({0.5, 2., 0.5});
    const auto turn = [](Solid &solid, const unsigned int d) {
      auto &x = solid.scene.x;
      const double c = std::sqrt(0.5);
      for (std::size_t i = 0; i < x.size(); i += 3) {
        const double a = x[i + d], b = x[i + 2];
        x[i + d] = c * (a - b);
        x[i + 2] = c * (a + b);
      }
    };
    turn(low, 1);
    turn(high, 0);
    high.shift({aside, 0., std::sqrt(2.) + gap});
    return together(low, high);
  }

  TEST(SurfaceSearch, CrossedEdges)
  {
    for (const double gap : {0.05, 1e-3, 0., -1e-3, -0.05}) {
      const auto scene = crossed_bricks(gap, 0.3);
      const auto pairs = scene.find(0.1);
      EXPECT_TRUE(pairs.points.empty());
      ASSERT_EQ(pairs.edges.size(), 1u) << gap;
      const auto &pair = pairs.edges[0];
      EXPECT_NEAR(pair.gap, gap, 1e-14);
      // from the upper one, body 1, to the lower one
      EXPECT_NEAR(pair.normal[2], -1., 1e-14);
      EXPECT_NEAR(pair.closest[0], 0.3, 1e-14);
      EXPECT_NEAR(pair.closest[1], 0., 1e-14);
      EXPECT_NEAR(pair.closest[2], std::sqrt(0.5) + gap, 1e-14);
      const auto &way = scene.surfaces.edges[pair.edge].vertex;
      const bool forth = scene.x[3 * way[0]] < scene.x[3 * way[1]];
      EXPECT_NEAR(pair.place, forth ? 0.575 : 0.425, 1e-14);
      EXPECT_NEAR(pair.other_place, 0.5, 1e-14);
    }
    EXPECT_TRUE(crossed_bricks(0.11).find(0.1).edges.empty());
    EXPECT_TRUE(crossed_bricks(-0.3).find(0.1).edges.empty());    // too deep
    EXPECT_TRUE(crossed_bricks(0., 2.1).find(0.1).edges.empty()); // beyond
  }

  // Bricks that lie crosswise on each other touch at the four corners of the
  // square between them, where no corner of a brick is.
  TEST(SurfaceSearch, BricksThatLieCrosswise)
  {
    for (const double gap : {0.01, 0., -0.01}) {
      Solid low = box({2., 0.5, 0.5}), high = box({0.5, 2., 0.5});
      high.shift({0., 0., 1. + gap});
      const auto pairs = together(low, high).find(0.1);
      EXPECT_TRUE(pairs.points.empty());
      ASSERT_EQ(pairs.edges.size(), 4u);
      for (const auto &pair : pairs.edges) {
        EXPECT_NEAR(pair.gap, gap, 1e-14);
        EXPECT_NEAR(pair.normal[2], -1., 1e-14);
        EXPECT_NEAR(std::abs(pair.closest[0]), 0.5, 1e-14);
        EXPECT_NEAR(std::abs(pair.closest[1]), 0.5, 1e-14);
      }
    }
  }

  // Boxes on each other, the upper one shifted in both directions: a corner of
  // each and two crossings are the corners of what they share. A crossing next
  // to a corner says the same as it: it is left out.
  TEST(SurfaceSearch, ShiftedBoxesShareFourPlaces)
  {
    for (const double shift : {0.005, 0.04, 0.3}) {
      Solid low = box({0.5, 0.5, 0.5}), high = box({0.5, 0.5, 0.5});
      high.shift({shift, 0.3, 1.});
      const auto pairs = together(low, high).find(0.1);
      std::set<std::array<long, 2>> places;
      const auto note = [&](const Place<3> &at) {
        places.insert({std::lround(1e6 * at[0]), std::lround(1e6 * at[1])});
      };
      for (const auto &pair : pairs.points)
        note(pair.closest);
      for (const auto &pair : pairs.edges)
        note(pair.closest);
      EXPECT_EQ(pairs.edges.size(), shift > 0.01 ? 2u : 0u) << shift;
      EXPECT_EQ(pairs.points.size() + pairs.edges.size(), 4u) << shift;
      EXPECT_EQ(places.size(), 4u) << shift;
    }
  }

  TEST(SurfaceSearch, EdgesOfACubeAndOfAPlate)
  {
    for (const bool rigid : {false, true}) {
      Scene<3> scene;
      add_box(scene, 0, {0., 0., 0.}, {1., 1., 1.});
      // a plate of two facets on each side, flat where they meet
      const auto v = [&](const double x, const double y, const double z) {
        return scene.vertex({x, y, z});
      };
      const unsigned int a = v(3., 0., 0.), b = v(4., 0., 0.),
                         c = v(5., 0., 0.), d = v(3., 1., 0.),
                         e = v(4., 1., 0.), f = v(5., 1., 0.);
      scene.facet(1, {a, b, e, d}); // up
      scene.facet(1, {b, c, f, e});
      scene.all_points();
      set_edges<3>(scene.surfaces, scene.x.data(),
                   [&](unsigned int) { return rigid; });
      EXPECT_EQ(scene.surfaces.edges.size(), rigid ? 12u : 13u);
      const double *x = scene.x.data();
      for (const auto &edge : scene.surfaces.edges) {
        if (scene.surfaces.facets[edge.facet[0]].body == 1)
          continue;
        const auto plane = plane_of<3>(scene.surfaces.facets[edge.facet[0]], x),
                   next = plane_of<3>(scene.surfaces.facets[edge.facet[1]], x);
        const Place<3> way = segment_of(edge, x).way;
        EXPECT_NEAR(nsfd::dot(nsfd::cross(plane.normal, next.normal), way), 1.,
                    1e-14);
      }
    }
  }

  // Two convex bodies, a little inside each other: one of the touches found is
  // the shortest way out, that of the separating axes, and none that is inside
  // leads another way. Almost parallel normals are one touch, see
  // touching_rules.h. In a step as short as the overlap nothing turns: with a
  // longer reach edges are found that may come to cross.
  void expect_shortest_ways(const std::function<Solid(std::mt19937 &)> &solid)
  {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1., 1.);
    constexpr double depth = 0.004, parallel = 0.998;
    unsigned int n_edges = 0, n_lost = 0, n_wrong = 0;
    for (unsigned int trial = 0; trial < 500; ++trial) {
      const Solid a = solid(random);
      Solid b = solid(random);
      const Place<3> way{unit(random), unit(random), unit(random)};
      double near = 0., far = 8. / norm(way);
      for (unsigned int k = 0; k < 60; ++k) {
        Solid at = b;
        at.shift(sum({}, 0.5 * (near + far), way));
        const double distance =
            test::separation(a.convex(), at.convex()).distance;
        (distance < -depth ? near : far) = 0.5 * (near + far);
      }
      b.shift(sum({}, near, way));
      const auto expected = test::separation(a.convex(), b.convex());
      ASSERT_NEAR(expected.distance, -depth, 1e-12);
      n_edges += expected.of_edges;
      const auto scene = together(a, b);
      const auto pairs = scene.find(depth);
      bool found = false;
      const auto judge = [&](const double gap, const Place<3> &normal,
                             const double sign) { // +1: leads to body 1
        const bool is_parallel = sign * dot(normal, expected.normal) > parallel;
        found = found || (is_parallel && std::abs(gap + depth) < depth);
        n_wrong += gap < -1e-9 && !is_parallel;
      };
      for (const auto &pair : pairs.edges)
        judge(pair.gap, pair.normal, -1.);
      for (const auto &pair : pairs.points)
        judge(pair.gap, pair.normal,
              scene.surfaces.facets[pair.facet].body == 0 ? 1. : -1.);
      n_lost += !found;
    }
    EXPECT_GT(n_edges, 200u);
    // a corner within the inset of an edge is taken for one over the next facet
    EXPECT_LE(n_lost, 2u);
    EXPECT_LE(n_wrong, 2u);
  }

  TEST(SurfaceSearch, ShortestWayOutOfRandomSolids)
  {
    expect_shortest_ways(random_solid);
  }

  // Which triangle of a side a corner is over says nothing.
  TEST(SurfaceSearch, ShortestWayOutOfBoxesOfTriangles)
  {
    expect_shortest_ways([](std::mt19937 &random) {
      std::uniform_real_distribution<double> unit(0.5, 1.5);
      Solid result =
          of_triangles(box({unit(random), unit(random), unit(random)}), random);
      turn_at_random(result.scene.x, random);
      return result;
    });
  }

  /** A brick slides off a table and tips over its end: the corner behind is
      above the table by less than the search tells from none, and the upright
      edge there has not come through the end of the table from the side. */
  TEST(SurfaceEdges, UprightEdgeAboveATable)
  {
    for (const double height : {-1e-10, 0., 1e-9, 1e-6}) {
      Scene<3> scene;
      add_box(scene, 0, {-2., -1., -1.}, {0., 2., 0.});
      add_box(scene, 1, {-0.1, 0., 0.}, {1.9, 1., 1.});
      // about the end of the table, then up
      for (std::size_t v = 8; v < 16; ++v) {
        double *x = &scene.x[3 * v];
        const double a = x[0], b = x[2], c = 0.9999975, s = 0.00223;
        x[0] = c * a + s * b;
        x[2] = -s * a + c * b + height - 0.1 * s;
      }
      scene.all_points();
      scene.all_edges();
      const auto pairs = scene.find(0.2);
      for (const auto &pair : pairs.edges)
        EXPECT_GT(std::abs(pair.normal[2]), 0.9) << height;
      for (const auto &pair : pairs.points)
        EXPECT_GT(std::abs(pair.normal[2]), 0.9) << height;
    }
  }
} // namespace surface_scene::test_surface_edges
