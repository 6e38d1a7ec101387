#include "contact_detection/surface_search.h"

#include "separating_axes.h"

#include "contact_detection/ball_pairs.h"
#include "contact_detection/edge_pairs.h"
#include "contact_detection/near_candidates.h"
#include "contact_detection/point_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <type_traits>

namespace test_surface_search
{
  using namespace nsfd;

  const JoinedBodies apart = [](unsigned int, unsigned int) { return false; };

  template <int dim>
  struct Scene {
    static constexpr int dimension = dim;
    Surfaces<dim> surfaces;
    std::vector<double> x;

    unsigned int vertex(const Place<dim> &at)
    {
      x.insert(x.end(), at.begin(), at.end());
      return static_cast<unsigned int>(surfaces.n_vertices++);
    }

    void facet(const unsigned int body,
               const std::vector<unsigned int> &corners)
    {
      typename Surfaces<dim>::Facet result;
      std::copy(corners.begin(), corners.end(), result.vertex.begin());
      result.n_vertices = static_cast<unsigned int>(corners.size());
      result.body = body;
      result.key = 100 + surfaces.facets.size();
      surfaces.facets.push_back(result);
    }

    /** Every vertex of every facet. */
    void all_points()
    {
      for (unsigned int f = 0; f < surfaces.facets.size(); ++f)
        for (unsigned int i = 0; i < surfaces.facets[f].n_vertices; ++i)
          surfaces.points.push_back({surfaces.facets[f].vertex[i], f});
    }

    void all_edges()
    {
      set_edges<dim>(surfaces, x.data(), [](unsigned int) { return false; });
    }

    void ball(const unsigned int body, const Place<dim> &at,
              const double radius)
    {
      surfaces.balls.push_back(
          {body, radius, 10 + surfaces.balls.size(), vertex(at)});
    }

    NearPairs<dim> find(const double reach,
                        const JoinedBodies &joined = apart) const
    {
      SurfaceSearch<dim> search;
      NearPairs<dim> pairs;
      search.find(surfaces, x.data(), reach, joined, pairs);
      return pairs;
    }
  };

  /** A polygon, counter-clockwise. */
  void add_polygon(Scene<2> &scene, const unsigned int body,
                   const std::vector<Place<2>> &corners)
  {
    const auto first = static_cast<unsigned int>(scene.surfaces.n_vertices);
    const auto n = static_cast<unsigned int>(corners.size());
    for (const auto &corner : corners)
      scene.vertex(corner);
    for (unsigned int i = 0; i < n; ++i)
      scene.facet(body, {first + i, first + (i + 1) % n});
  }

  void add_box(Scene<2> &scene, const unsigned int body, const Place<2> &low,
               const Place<2> &high)
  {
    add_polygon(scene, body, {low, {high[0], low[1]}, high, {low[0], high[1]}});
  }

  /** Corner c has bit d of c as its place along d. */
  void add_box(Scene<3> &scene, const unsigned int body, const Place<3> &low,
               const Place<3> &high)
  {
    const auto first = static_cast<unsigned int>(scene.surfaces.n_vertices);
    for (unsigned int c = 0; c < 8; ++c)
      scene.vertex({c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1],
                    c & 4 ? high[2] : low[2]});
    for (const std::vector<unsigned int> &side :
         std::vector<std::vector<unsigned int>>{{0, 4, 6, 2},
                                                {1, 3, 7, 5},
                                                {0, 1, 5, 4},
                                                {2, 6, 7, 3},
                                                {0, 2, 3, 1},
                                                {4, 5, 7, 6}}) {
      auto corners = side;
      for (auto &corner : corners)
        corner += first;
      scene.facet(body, corners);
    }
  }

  /** Turned in the plane of the first two coordinates, about the origin. */
  template <int dim>
  std::vector<double> turned(std::vector<double> x, const double angle)
  {
    for (std::size_t i = 0; i < x.size(); i += dim) {
      const double a = x[i], b = x[i + 1];
      x[i] = std::cos(angle) * a - std::sin(angle) * b;
      x[i + 1] = std::sin(angle) * a + std::cos(angle) * b;
    }
    return x;
  }

  /** Vertex, own facet and facet of each pair. */
  template <int dim>
  using Names = std::set<std::array<std::uint64_t, 3>>;

  template <int dim>
  Names<dim> names(const Scene<dim> &scene, const NearPairs<dim> &pairs)
  {
    Names<dim> result;
    for (const auto &pair : pairs.points) {
      const auto &point = scene.surfaces.points[pair.index];
      result.insert({point.vertex, scene.surfaces.facets[point.facet].key,
                     scene.surfaces.facets[pair.facet].key});
    }
    return result;
  }

  /** Ball and facet of each pair. */
  template <int dim>
  std::set<std::array<std::uint64_t, 2>> ball_names(const Scene<dim> &scene,
                                                    const NearPairs<dim> &pairs)
  {
    std::set<std::array<std::uint64_t, 2>> result;
    for (const auto &pair : pairs.balls)
      result.insert({scene.surfaces.balls[pair.index].key,
                     scene.surfaces.facets[pair.facet].key});
    return result;
  }

  template <int dim>
  void expect_same(const FacetPair<dim> &a, const FacetPair<dim> &b)
  {
    EXPECT_EQ(a.index, b.index);
    EXPECT_EQ(a.facet, b.facet);
    EXPECT_EQ(a.gap, b.gap);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.closest, b.closest);
    EXPECT_EQ(a.weights, b.weights);
  }

  /** To the last bit. */
  template <int dim>
  void expect_same(const NearPairs<dim> &a, const NearPairs<dim> &b)
  {
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i)
      expect_same(a.points[i], b.points[i]);
    ASSERT_EQ(a.balls.size(), b.balls.size());
    for (std::size_t i = 0; i < a.balls.size(); ++i)
      expect_same(a.balls[i], b.balls[i]);
    ASSERT_EQ(a.ball_balls.size(), b.ball_balls.size());
    for (std::size_t i = 0; i < a.ball_balls.size(); ++i) {
      EXPECT_EQ(a.ball_balls[i].ball, b.ball_balls[i].ball);
      EXPECT_EQ(a.ball_balls[i].other, b.ball_balls[i].other);
      EXPECT_EQ(a.ball_balls[i].gap, b.ball_balls[i].gap);
    }
    ASSERT_EQ(a.edges.size(), b.edges.size());
    for (std::size_t i = 0; i < a.edges.size(); ++i) {
      EXPECT_EQ(a.edges[i].edge, b.edges[i].edge);
      EXPECT_EQ(a.edges[i].other, b.edges[i].other);
      EXPECT_EQ(a.edges[i].gap, b.edges[i].gap);
      EXPECT_EQ(a.edges[i].normal, b.edges[i].normal);
      EXPECT_EQ(a.edges[i].place, b.edges[i].place);
    }
  }

  /** A floor from (0,0) to (4,0), looked at by a point at `at` from above. */
  Scene<2> point_over_floor(const Place<2> &at)
  {
    Scene<2> scene;
    const unsigned int right = scene.vertex({4., 0.}),
                       left = scene.vertex({0., 0.});
    scene.facet(0, {right, left}); // outward: +y
    const unsigned int corner = scene.vertex(at),
                       next = scene.vertex({at[0] + 1., at[1]});
    scene.facet(1, {corner, next}); // outward: -y
    scene.surfaces.points.push_back({corner, 1});
    return scene;
  }

  /** All candidates there can be. */
  template <int dim>
  NearPairs<dim> all_against_all(const Scene<dim> &scene, const double reach)
  {
    const auto &surfaces = scene.surfaces;
    NearCandidates all;
    std::multimap<unsigned int, unsigned int> by_vertex;
    for (unsigned int p = 0; p < surfaces.points.size(); ++p)
      by_vertex.emplace(surfaces.points[p].vertex, p);
    const auto add_facets = [&](IndexLists &lists, const unsigned int body) {
      if (lists.first.empty())
        lists.first.push_back(0);
      for (unsigned int f = 0; f < surfaces.facets.size(); ++f)
        if (surfaces.facets[f].body != body)
          lists.entries.push_back(f);
      lists.first.push_back(lists.entries.size());
    };
    for (const auto &entry : by_vertex) {
      const auto &point = surfaces.points[entry.second];
      all.order.push_back(entry.second);
      add_facets(all.facets_of_points, surfaces.facets[point.facet].body);
    }
    all.balls_of_balls.first.push_back(0);
    for (unsigned int b = 0; b < surfaces.balls.size(); ++b) {
      add_facets(all.facets_of_balls, surfaces.balls[b].body);
      for (unsigned int c = b + 1; c < surfaces.balls.size(); ++c)
        if (surfaces.balls[b].body != surfaces.balls[c].body)
          all.balls_of_balls.entries.push_back(c);
      all.balls_of_balls.first.push_back(all.balls_of_balls.entries.size());
    }
    all.edges_of_edges.first.push_back(0);
    const auto body = [&](const auto &edge) {
      return surfaces.facets[edge.facet[0]].body;
    };
    for (const auto &edge : surfaces.edges) {
      for (unsigned int o = 0; o < surfaces.edges.size(); ++o)
        if (body(surfaces.edges[o]) > body(edge))
          all.edges_of_edges.entries.push_back(o);
      all.edges_of_edges.first.push_back(all.edges_of_edges.entries.size());
    }
    if constexpr (dim == 2)
      all.next_facets = next_facets(surfaces);
    std::vector<Plane<dim>> planes;
    set_planes<dim>(surfaces, scene.x.data(), planes);
    NearPairs<dim> pairs;
    find_point_pairs<dim>(surfaces, scene.x.data(), planes, reach, all,
                          pairs.points);
    find_ball_pairs<dim>(surfaces, scene.x.data(), planes, reach, all,
                         pairs.balls);
    find_ball_ball_pairs<dim>(surfaces, scene.x.data(), reach, all,
                              pairs.ball_balls);
    find_crossings<dim>(surfaces, scene.x.data(), planes, reach, all,
                        pairs.edges);
    settle_touches<dim>(surfaces, scene.x.data(), planes, pairs.points,
                        pairs.edges);
    return pairs;
  }

  /** Turned in each plane of two coordinates by a random angle. */
  void turn_at_random(std::vector<double> &x, std::mt19937 &random)
  {
    std::uniform_real_distribution<double> angle(0., 6.3);
    for (unsigned int k = 0; k < 3; ++k) {
      x = turned<3>(x, angle(random));
      for (std::size_t i = 0; i < x.size(); i += 3)
        std::rotate(&x[i], &x[i + 1], x.data() + i + 3);
    }
  }

  /** A turned box of random size, three numbers of centre and more. */
  template <int dim>
  void add_random_box(Scene<dim> &scene, const unsigned int body,
                      const double room, std::mt19937 &random)
  {
    std::uniform_real_distribution<double> unit(0., 1.);
    Scene<dim> box;
    Place<dim> low, high, at;
    for (int d = 0; d < dim; ++d) {
      high[d] = 0.3 + 0.4 * unit(random);
      low[d] = -high[d];
      at[d] = room * unit(random);
    }
    add_box(box, body, low, high);
    // corners of a hexahedron that is no box: its sides are warped
    for (auto &value : box.x)
      value += 0.04 * (unit(random) - 0.5);
    auto x = turned<dim>(box.x, 6.3 * unit(random));
    if constexpr (dim == 3)
      turn_at_random(x, random);
    const auto first = static_cast<unsigned int>(scene.surfaces.n_vertices);
    for (std::size_t i = 0; i < x.size(); ++i)
      scene.x.push_back(x[i] + at[i % dim]);
    scene.surfaces.n_vertices += box.surfaces.n_vertices;
    for (const auto &facet : box.surfaces.facets) {
      std::vector<unsigned int> corners;
      for (unsigned int i = 0; i < facet.n_vertices; ++i)
        corners.push_back(first + facet.vertex[i]);
      scene.facet(body, corners);
    }
  }

  template <int dim>
  Scene<dim> random_heap(const unsigned int n, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0., 1.);
    Scene<dim> scene;
    const double room = 0.9 * std::pow(n, 1. / dim);
    for (unsigned int body = 0; body < n; ++body)
      add_random_box<dim>(scene, body, room, random);
    scene.all_points();
    for (unsigned int body = n; body < n + n / 2; ++body) {
      Place<dim> at;
      for (auto &value : at)
        value = room * unit(random);
      scene.ball(body, at, 0.1 + 0.3 * unit(random));
    }
    scene.all_edges();
    return scene;
  }

  template <int dim>
  void expect_tree_finds_all()
  {
    std::size_t n_points = 0, n_balls = 0, n_ball_balls = 0, n_edges = 0;
    for (unsigned int seed = 0; seed < 20; ++seed) {
      const auto scene = random_heap<dim>(40, seed);
      for (const double reach : {0., 0.02, 0.3}) {
        const auto expected = all_against_all<dim>(scene, reach);
        expect_same<dim>(scene.find(reach), expected);
        n_points += expected.points.size();
        n_balls += expected.balls.size();
        n_ball_balls += expected.ball_balls.size();
        n_edges += expected.edges.size();
      }
    }
    EXPECT_GT(n_points, 500u);
    EXPECT_GT(n_balls, 500u);
    EXPECT_GT(n_ball_balls, 100u);
    EXPECT_EQ(n_edges > 500, dim == 3);
  }

  /** Bodies fly and turn, each on its own, `step` per step. */
  template <int dim>
  void move(Scene<dim> &scene, const std::vector<unsigned int> &body_of_vertex,
            const double step, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1., 1.);
    std::map<unsigned int, Place<dim>> velocity;
    for (unsigned int v = 0; v < body_of_vertex.size(); ++v) {
      auto entry = velocity.find(body_of_vertex[v]);
      if (entry == velocity.end()) {
        Place<dim> value;
        for (auto &component : value)
          component = unit(random);
        entry = velocity.emplace(body_of_vertex[v], value).first;
      }
      for (int d = 0; d < dim; ++d)
        scene.x[v * dim + d] += step * (entry->second[d] + 0.3 * unit(random));
    }
  }

  template <int dim>
  std::vector<unsigned int> bodies_of_vertices(const Surfaces<dim> &surfaces)
  {
    std::vector<unsigned int> result(surfaces.n_vertices);
    for (const auto &facet : surfaces.facets)
      for (unsigned int i = 0; i < facet.n_vertices; ++i)
        result[facet.vertex[i]] = facet.body;
    for (const auto &ball : surfaces.balls)
      result[ball.vertex] = ball.body;
    return result;
  }

  template <int dim>
  void expect_kept_candidates_find_all()
  {
    auto scene = random_heap<dim>(40, 7);
    const auto bodies = bodies_of_vertices(scene.surfaces);
    SurfaceSearch<dim> search;
    NearPairs<dim> pairs;
    for (unsigned int step = 0; step < 120; ++step) {
      // the reach grows and shrinks as that of a run with its velocities
      const double reach = 0.05 + 0.003 * std::sin(0.7 * step);
      search.find(scene.surfaces, scene.x.data(), reach, apart, pairs);
      expect_same<dim>(pairs, all_against_all<dim>(scene, reach));
      move<dim>(scene, bodies, 0.004, step / 50);
    }
    EXPECT_GE(search.n_searches(), 5u);
    EXPECT_LE(search.n_searches(), 60u);
  }

  /** Every list of entries, each with the list that it is in. */
  std::multiset<std::pair<std::size_t, unsigned int>>
  entries(const IndexLists &lists)
  {
    std::multiset<std::pair<std::size_t, unsigned int>> result;
    for (std::size_t i = 0; i + 1 < lists.first.size(); ++i)
      for (std::size_t k = lists.first[i]; k < lists.first[i + 1]; ++k)
        result.emplace(i, lists.entries[k]);
    return result;
  }

  /** Ranks that own some of the bodies each find together what one finds. */
  template <int dim>
  void expect_shares_make_the_whole()
  {
    static constexpr unsigned int n_ranks = 3;
    const auto scene = random_heap<dim>(60, 5);
    std::vector<Plane<dim>> planes;
    set_planes<dim>(scene.surfaces, scene.x.data(), planes);
    const auto search = [&](const std::function<bool(unsigned int)> &is_own) {
      return search_candidates<dim>(scene.surfaces, scene.x.data(), planes, 0.1,
                                    0.05, is_own, apart);
    };
    const auto all = search([](unsigned int) { return true; });
    const auto compare = [&](const IndexLists NearCandidates::*lists,
                             const bool has_some) {
      std::multiset<std::pair<std::size_t, unsigned int>> shares;
      for (unsigned int rank = 0; rank < n_ranks; ++rank) {
        const auto part = search([rank](const unsigned int body) {
          return body * 7u % n_ranks == rank;
        });
        EXPECT_EQ(part.order, all.order);
        EXPECT_EQ((part.*lists).first.size(), (all.*lists).first.size());
        EXPECT_LT((part.*lists).entries.size(),
                  std::max<std::size_t>(1, (all.*lists).entries.size()));
        shares.merge(entries(part.*lists));
      }
      EXPECT_EQ(shares, entries(all.*lists));
      EXPECT_EQ(shares.size() > 10, has_some);
    };
    compare(&NearCandidates::facets_of_points, true);
    compare(&NearCandidates::facets_of_balls, true);
    compare(&NearCandidates::balls_of_balls, true);
    compare(&NearCandidates::edges_of_edges, dim == 3);
  }

  /** n^dim coincident cells of size one, numbered row by row. */
  template <int dim>
  Scene<dim> cells(const unsigned int n)
  {
    Scene<dim> scene;
    for (unsigned int body = 0; body < std::pow(n, dim); ++body) {
      Place<dim> low, high;
      for (unsigned int d = 0, site = body; d < dim; ++d, site /= n) {
        low[d] = site % n;
        high[d] = low[d] + 1.;
      }
      add_box(scene, body, low, high);
    }
    scene.all_points();
    scene.all_edges();
    return scene;
  }

  /**
   * Each point finds the side of the cell on the other side of its own facet,
   * if there is one, at the same vertex.
   */
  template <int dim>
  void expect_opposite_sides(const Scene<dim> &scene,
                             const NearPairs<dim> &pairs, const unsigned int n)
  {
    std::vector<Plane<dim>> planes;
    set_planes<dim>(scene.surfaces, scene.x.data(), planes);
    EXPECT_TRUE(pairs.edges.empty()); // parallel, or they meet at corners
    const std::size_t per_side = dim == 2 ? 2 : 4;
    EXPECT_EQ(pairs.points.size(),
              2 * per_side * dim * (n - 1) *
                  static_cast<std::size_t>(std::pow(n, dim - 1)));
    for (const auto &pair : pairs.points) {
      const auto &point = scene.surfaces.points[pair.index];
      const Place<dim> at = place<dim>(scene.x.data(), point.vertex);
      EXPECT_EQ(planes[pair.facet].centre, planes[point.facet].centre);
      EXPECT_LE(std::abs(pair.gap), 1e-15);
      EXPECT_LE(norm(difference(pair.closest, at)), 1e-14);
      EXPECT_NEAR(*std::max_element(pair.weights.begin(), pair.weights.end()),
                  1., 1e-14);
    }
  }

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

  TEST(SurfaceSearch, PlaceBeyondTheEndIsTheEnd)
  {
    const auto pairs = point_over_floor({-0.005, 0.1}).find(0.5);
    ASSERT_EQ(pairs.points.size(), 1u);
    EXPECT_NEAR(pairs.points[0].gap, 0.1, 1e-15);
    EXPECT_NEAR(pairs.points[0].closest[0], 0., 1e-15);
    EXPECT_NEAR(pairs.points[0].weights[1], 1., 1e-15);
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
          point.last_key = last;
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
        point.last_key = last;
      const auto found = names(scene, scene.find(0.1));
      EXPECT_EQ(found.count({4, 104, 102}), 1u) << "the top";
      EXPECT_EQ(found.count({4, 104, 103}), 0u) << "the side";
    }
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

  TEST(SurfaceSearch, TreeFindsWhatAllPairsFind)
  {
    expect_tree_finds_all<2>();
    expect_tree_finds_all<3>();
  }

  TEST(SurfaceSearch, KeptCandidatesFindWhatAllPairsFind)
  {
    expect_kept_candidates_find_all<2>();
    expect_kept_candidates_find_all<3>();
  }

  TEST(SurfaceSearch, SharesOfRanksMakeTheWhole)
  {
    expect_shares_make_the_whole<2>();
    expect_shares_make_the_whole<3>();
  }

  // Two more floors through the place of the point: a flat one, found by its
  // key only, and before both in memory and by key a tilted one, less opposed.
  TEST(SurfaceSearch, EqualGapsAreDecidedByNormalsThenByKeys)
  {
    for (const std::uint64_t key : {90, 110}) {
      auto scene = point_over_floor({1., 0.});
      auto &facets = scene.surfaces.facets;
      scene.facet(2, {scene.vertex({4., 1.}), scene.vertex({-2., -1.})});
      scene.facet(3, {scene.vertex({3., 0.}), scene.vertex({-1., 0.})});
      facets[2].key = 80;
      facets[3].key = key;
      std::swap(facets[0], facets[2]);
      const auto pairs = scene.find(0.1);
      ASSERT_EQ(pairs.points.size(), 1u);
      EXPECT_EQ(facets[pairs.points[0].facet].key,
                std::min<std::uint64_t>(100, key));
    }
  }

  // Vertices keep their numbers; facets, points and balls are shuffled.
  TEST(SurfaceSearch, OrderInMemoryDoesNotMatter)
  {
    for (const auto &scene : {cells<2>(4), random_heap<2>(60, 3)}) {
      auto shuffled = scene;
      std::mt19937 random(5);
      auto &surfaces = shuffled.surfaces;
      std::vector<unsigned int> place(surfaces.facets.size());
      for (unsigned int f = 0; f < place.size(); ++f)
        place[f] = f;
      std::shuffle(place.begin(), place.end(), random);
      for (unsigned int f = 0; f < place.size(); ++f)
        surfaces.facets[place[f]] = scene.surfaces.facets[f];
      for (auto &point : surfaces.points)
        point.facet = place[point.facet];
      std::shuffle(surfaces.points.begin(), surfaces.points.end(), random);
      std::shuffle(surfaces.balls.begin(), surfaces.balls.end(), random);
      const auto before = scene.find(0.1), after = shuffled.find(0.1);
      EXPECT_GT(before.points.size(), 50u);
      EXPECT_EQ(names(scene, before), names(shuffled, after));
      EXPECT_EQ(ball_names(scene, before), ball_names(shuffled, after));
      EXPECT_EQ(before.ball_balls.size(), after.ball_balls.size());
    }
  }

  TEST(SurfaceSearch, TurnedScenes)
  {
    const double angle = 37. / 180. * std::acos(-1.);
    const auto check = [&](const auto &scene) {
      constexpr int dim = std::decay_t<decltype(scene)>::dimension;
      auto other = scene;
      other.x = turned<dim>(scene.x, angle);
      const auto a = scene.find(0.1), b = other.find(0.1);
      EXPECT_EQ(names(scene, a), names(other, b));
      EXPECT_EQ(ball_names(scene, a), ball_names(other, b));
      ASSERT_EQ(a.points.size(), b.points.size());
      for (std::size_t i = 0; i < a.points.size(); ++i)
        EXPECT_NEAR(a.points[i].gap, b.points[i].gap, 1e-12);
      for (std::size_t i = 0; i < a.balls.size(); ++i)
        EXPECT_NEAR(a.balls[i].gap, b.balls[i].gap, 1e-12);
    };
    check(cells<2>(4));
    check(cells<3>(3));
    check(random_heap<2>(60, 4));
    check(random_heap<3>(60, 4));
  }

  TEST(SurfaceSearch, ScalesOfLength)
  {
    const auto check = [](const auto &scene) {
      const auto expected = scene.find(0.1);
      EXPECT_GT(expected.points.size(), 50u);
      for (const double unit : {1e-9, 1e3}) {
        auto scaled = scene;
        for (auto &value : scaled.x)
          value *= unit;
        for (auto &ball : scaled.surfaces.balls)
          ball.radius *= unit;
        const auto pairs = scaled.find(0.1 * unit);
        EXPECT_EQ(names(scene, expected), names(scaled, pairs));
        EXPECT_EQ(ball_names(scene, expected), ball_names(scaled, pairs));
        EXPECT_EQ(expected.ball_balls.size(), pairs.ball_balls.size());
        for (std::size_t i = 0; i < pairs.points.size(); ++i)
          EXPECT_NEAR(pairs.points[i].gap, unit * expected.points[i].gap,
                      1e-13 * unit);
      }
    };
    check(cells<2>(4));
    check(cells<3>(2));
    check(random_heap<2>(60, 6));
    check(random_heap<3>(60, 6));
  }

  TEST(SurfaceSearch, CandidatesAreKeptWithinTheSkin)
  {
    auto scene = cells<2>(2);
    SurfaceSearch<2> search;
    NearPairs<2> pairs;
    const auto searches_at = [&](const double shift, const double reach) {
      auto x = scene.x;
      x[0] += shift;
      search.find(scene.surfaces, x.data(), reach, apart, pairs);
      return search.n_searches();
    };
    std::vector<Plane<2>> planes;
    set_planes<2>(scene.surfaces, scene.x.data(), planes);
    const double skin = skin_of<2>(scene.surfaces, planes), reach = 0.2;
    EXPECT_EQ(searches_at(0., reach), 1u);
    EXPECT_EQ(searches_at(0.49 * skin, reach), 1u);
    EXPECT_EQ(searches_at(0.49 * skin, 0.5 * reach), 1u);
    EXPECT_EQ(searches_at(0.2 * skin, reach + 0.5 * skin), 1u);
    EXPECT_EQ(searches_at(0.3 * skin, reach + 0.5 * skin), 2u);
    EXPECT_EQ(searches_at(0.81 * skin, reach), 3u); // 0.51 from the last one
    search.topology_changed();
    EXPECT_EQ(searches_at(0.81 * skin, reach), 4u);
  }

  TEST(SurfaceSearch, GluedBodiesOfAChangedTopology)
  {
    const auto scene = cells<2>(2);
    SurfaceSearch<2> search;
    NearPairs<2> pairs;
    bool glued = true;
    const JoinedBodies joined = [&](unsigned int, unsigned int) {
      return glued;
    };
    search.find(scene.surfaces, scene.x.data(), 0.1, joined, pairs);
    EXPECT_TRUE(pairs.points.empty());
    glued = false;
    search.topology_changed();
    search.find(scene.surfaces, scene.x.data(), 0.1, joined, pairs);
    expect_opposite_sides<2>(scene, pairs, 2);
  }

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

  /** Body 0 and body 1 with all their points and edges. */
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
    scene.all_points();
    scene.all_edges();
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
  TEST(SurfaceSearch, ShortestWayOutOfRandomSolids)
  {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1., 1.);
    constexpr double depth = 0.004, parallel = 0.998;
    unsigned int n_edges = 0, n_lost = 0, n_wrong = 0;
    for (unsigned int trial = 0; trial < 500; ++trial) {
      const Solid a = random_solid(random);
      Solid b = random_solid(random);
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
} // namespace test_surface_search
