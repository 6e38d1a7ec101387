#include "visualization/body_view.h"

#include "visualization/svg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

// Pictures of cracks inside a body in space.

namespace nsfd::test_crack_picture
{
  namespace
  {
    /** The six sides of a box. */
    void add_box(Snapshot &snapshot, const Vector3 &lower, const Vector3 &upper,
                 const bool triangles)
    {
      for (int side = 0; side < 6; ++side) {
        const unsigned int a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        const auto corner = [&](const bool far_b, const bool far_c) {
          Vector3 x;
          x[a] = side % 2 == 0 ? lower[a] : upper[a];
          x[b] = far_b ? upper[b] : lower[b];
          x[c] = far_c ? upper[c] : lower[c];
          return x;
        };
        const auto add = [&](const std::vector<Vector3> &corners) {
          Snapshot::Polygon polygon;
          polygon.reference = corners;
          polygon.displacement.assign(corners.size(), Vector3{});
          snapshot.polygons.push_back(polygon);
        };
        if (triangles) {
          add({corner(false, false), corner(true, false), corner(true, true)});
          add({corner(false, false), corner(true, true), corner(false, true)});
        } else
          add({corner(false, false), corner(true, false), corner(true, true),
               corner(false, true)});
      }
    }

    Snapshot body()
    {
      Snapshot snapshot;
      snapshot.dimension = 3;
      return snapshot;
    }

    double length_of_edges(const Snapshot &snapshot)
    {
      double length = 0.;
      for (const auto &edge : sharp_edges(snapshot, crack_flanks(snapshot),
                                          Projection(snapshot, 1.)))
        length += std::hypot(edge[1][0] - edge[0][0], edge[1][1] - edge[0][1],
                             edge[1][2] - edge[0][2]);
      return length;
    }
  } // namespace

  // Twelve edges, each found from two sides; diagonals of triangles are none.
  TEST(CrackPicture, OutlineOfABox)
  {
    for (const bool triangles : {false, true}) {
      Snapshot snapshot = body();
      add_box(snapshot, {0., 0., 0.}, {3e-3, 2e-3, 1e-3}, triangles);
      EXPECT_NEAR(length_of_edges(snapshot), 2. * 4. * 6e-3, 1e-12);
    }
  }

  // Two halves of a box that a crack divides: where it meets the surface, the
  // sides go on, and its flanks are not of the surface.
  TEST(CrackPicture, CracksHaveNoOutline)
  {
    Snapshot snapshot = body();
    add_box(snapshot, {0., 0., 0.}, {1e-3, 2e-3, 1e-3}, true);
    add_box(snapshot, {1e-3, 0., 0.}, {3e-3, 2e-3, 1e-3}, true);
    EXPECT_NEAR(length_of_edges(snapshot), 2. * 4. * 6e-3, 1e-12);
  }

  TEST(CrackPicture, FlanksAreTwins)
  {
    Snapshot snapshot = body();
    add_box(snapshot, {0., 0., 0.}, {1e-3, 2e-3, 1e-3}, false);
    add_box(snapshot, {1e-3, 0., 0.}, {3e-3, 2e-3, 1e-3}, false);
    const auto flanks = crack_flanks(snapshot);
    // sides in the order left, right, bottom, ...: right of one, left of two
    for (std::size_t p = 0; p < flanks.size(); ++p)
      EXPECT_EQ(bool(flanks[p]), p == 1 || p == 6) << p;
  }

  TEST(CrackPicture, AllPolygonsTurnTheSameWay)
  {
    Snapshot snapshot = body();
    add_box(snapshot, {0., 0., 0.}, {1e-3, 2e-3, 1e-3}, true);
    const Projection projection(snapshot, 1.);
    for (const auto &polygon : snapshot.polygons) {
      const auto corners = corners_to_eye(polygon, projection, Seen::both);
      double area = 0.;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3 p = projection.to_plane(corners[i]),
                      q = projection.to_plane(corners[(i + 1) % 3]);
        area += p[0] * q[1] - p[1] * q[0];
      }
      EXPECT_GT(area, 0.);
    }
  }

  // Three sides of a box face the eye, which is at (1, -1, 1).
  TEST(CrackPicture, WhatFacesAwayIsNotDrawn)
  {
    Snapshot snapshot = body();
    add_box(snapshot, {0., 0., 0.}, {1e-3, 2e-3, 1e-3}, false);
    // add_box goes round from outside on every other side only
    for (std::size_t p = 0; p < 6; p += 2)
      std::reverse(snapshot.polygons[p].reference.begin(),
                   snapshot.polygons[p].reference.end());
    const Projection projection(snapshot, 1.);
    // left, right, front (low y), back, bottom, top
    const std::array<bool, 6> seen = {false, true, true, false, false, true};
    for (std::size_t p = 0; p < 6; ++p)
      EXPECT_EQ(!corners_to_eye(snapshot.polygons[p], projection, Seen::front)
                     .empty(),
                seen[p])
          << p;
  }

  TEST(CrackPicture, ShowsNothingButCracks)
  {
    Snapshot whole = body(), cracked = body();
    add_box(whole, {0., 0., 0.}, {3e-3, 2e-3, 1e-3}, true);
    add_box(cracked, {0., 0., 0.}, {1e-3, 2e-3, 1e-3}, true);
    add_box(cracked, {1e-3, 0., 0.}, {3e-3, 2e-3, 1e-3}, true);
    const auto cells = [](const Snapshot &snapshot) {
      PictureOptions options = picture_options({snapshot});
      options.colouring = PictureOptions::Colouring::crack;
      const std::string svg = body_picture(snapshot, options, SvgUse::file);
      const std::size_t begin = svg.find("<g class=\"cells\">");
      return svg.substr(begin, svg.find("</g>", begin) - begin);
    };
    EXPECT_EQ(cells(whole).find("<path"), std::string::npos);
    EXPECT_NE(cells(cracked).find("<path"), std::string::npos);
  }
} // namespace nsfd::test_crack_picture
