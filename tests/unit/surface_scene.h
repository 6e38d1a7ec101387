#pragma once

#include "contact_detection/surface_search.h"

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

namespace surface_scene
{
  using namespace nsfd;

  const AreJoined apart = [](unsigned int, unsigned int) { return false; };

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
      result.key = result.side = 100 + surfaces.facets.size();
      surfaces.facets.push_back(result);
    }

    /** Every vertex of every facet that touches. */
    void all_points()
    {
      for (unsigned int f = 0; f < surfaces.facets.size(); ++f)
        for (unsigned int i = 0;
             surfaces.facets[f].touches && i < surfaces.facets[f].n_vertices;
             ++i)
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
                        const AreJoined &joined = apart) const
    {
      SurfaceSearch<dim> search;
      NearPairs<dim> pairs;
      search.find(surfaces, x.data(), reach, joined, pairs);
      return pairs;
    }
  };

  /** A polygon, counter-clockwise. */
  inline void add_polygon(Scene<2> &scene, const unsigned int body,
                          const std::vector<Place<2>> &corners)
  {
    const auto first = static_cast<unsigned int>(scene.surfaces.n_vertices);
    const auto n = static_cast<unsigned int>(corners.size());
    for (const auto &corner : corners)
      scene.vertex(corner);
    for (unsigned int i = 0; i < n; ++i)
      scene.facet(body, {first + i, first + (i + 1) % n});
  }

  inline void add_box(Scene<2> &scene, const unsigned int body,
                      const Place<2> &low, const Place<2> &high)
  {
    add_polygon(scene, body, {low, {high[0], low[1]}, high, {low[0], high[1]}});
  }

  /** Corner c has bit d of c as its place along d. */
  inline void add_box(Scene<3> &scene, const unsigned int body,
                      const Place<3> &low, const Place<3> &high)
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
  inline Scene<2> point_over_floor(const Place<2> &at)
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

  /** Turned in each plane of two coordinates by a random angle. */
  inline void turn_at_random(std::vector<double> &x, std::mt19937 &random)
  {
    std::uniform_real_distribution<double> angle(0., 6.3);
    for (unsigned int k = 0; k < 3; ++k) {
      x = turned<3>(x, angle(random));
      for (std::size_t i = 0; i < x.size(); i += 3)
        std::rotate(&x[i], &x[i + 1], x.data() + i + 3);
    }
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
} // namespace surface_scene
