#include "surface_scene.h"

namespace surface_scene::test_surface_candidates
{
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

  TEST(SurfaceSearch, JoinedBodiesOfAChangedTopology)
  {
    const auto scene = cells<2>(2);
    SurfaceSearch<2> search;
    NearPairs<2> pairs;
    bool are_joined = true;
    const AreJoined joined = [&](unsigned int, unsigned int) {
      return are_joined;
    };
    search.find(scene.surfaces, scene.x.data(), 0.1, joined, pairs);
    EXPECT_TRUE(pairs.points.empty());
    are_joined = false;
    search.topology_changed();
    search.find(scene.surfaces, scene.x.data(), 0.1, joined, pairs);
    expect_opposite_sides<2>(scene, pairs, 2);
  }
} // namespace surface_scene::test_surface_candidates
