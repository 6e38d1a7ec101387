#include "postprocess/crack_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

// Length, direction and extent of cracks whose faces are known.

namespace nsfd::test_crack_shape
{
  namespace
  {
    using Vector = std::array<double, 3>;

    Vector between(const Vector &a, const Vector &b, const double share)
    {
      Vector x;
      for (unsigned int c = 0; c < 3; ++c)
        x[c] = a[c] + share * (b[c] - a[c]);
      return x;
    }

    /** The two Gauss points of the face from a to b. */
    void add_face(std::vector<BrokenPoint> &points, const Vector &a,
                  const Vector &b)
    {
      const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
      for (unsigned int i = 0; i < 2; ++i) {
        BrokenPoint point;
        point.position =
            between(a, b, 0.5 + (i == 0 ? -0.5 : 0.5) / std::sqrt(3.));
        point.normal = {(b[1] - a[1]) / length, (a[0] - b[0]) / length, 0.};
        point.area = length / 2.;
        point.ends = {between(a, b, i / 2.), between(a, b, (i + 1) / 2.)};
        points.push_back(point);
      }
    }

    /** From (1, 2) on, along an angle in degrees: faces of 0.3, n of them. */
    std::vector<BrokenPoint> straight(const double angle, const unsigned int n)
    {
      std::vector<BrokenPoint> points;
      const double c = std::cos(angle * M_PI / 180.),
                   s = std::sin(angle * M_PI / 180.);
      for (unsigned int i = 0; i < n; ++i)
        add_face(points, {1. + 0.3 * i * c, 2. + 0.3 * i * s, 0.},
                 {1. + 0.3 * (i + 1) * c, 2. + 0.3 * (i + 1) * s, 0.});
      return points;
    }

    /** Right and up in turn. */
    std::vector<BrokenPoint> staircase(const unsigned int n_steps,
                                       const double right, const double up)
    {
      std::vector<BrokenPoint> points;
      for (unsigned int i = 0; i < n_steps; ++i) {
        const Vector a = {i * right, i * up, 0.},
                     b = {(i + 1) * right, i * up, 0.},
                     c = {(i + 1) * right, (i + 1) * up, 0.};
        add_face(points, a, b);
        add_face(points, b, c);
      }
      return points;
    }

    const double round_off = 1e-12;
  } // namespace

  TEST(CrackShape, StraightCracksAreMeasuredExactly)
  {
    for (const double angle : {-89., -45., 0., 15., 30., 45., 90.})
      for (const unsigned int n : {1u, 7u}) {
        SCOPED_TRACE(std::to_string(angle) + " degrees");
        const CrackShape shape = crack_shape(straight(angle, n), 2);
        EXPECT_NEAR(shape.area, 0.3 * n, round_off);
        EXPECT_NEAR(shape.extent, 0.3 * n, round_off);
        EXPECT_NEAR(shape.tortuosity, 1., round_off);
        EXPECT_NEAR(angle_between(crack_angle(shape), angle), 0., 1e-9);
      }
  }

  // Length |cos| + |sin| per unit of a way that is cut into steps; the axis of
  // n steps misses the diagonal by O(1/n^2), here for 40 of them.
  TEST(CrackShape, StaircasesAreAsLongAsTheirStepsAndPointAlongTheDiagonal)
  {
    for (const double angle : {15., 30., 45.}) {
      SCOPED_TRACE(std::to_string(angle) + " degrees");
      const double c = std::cos(angle * M_PI / 180.),
                   s = std::sin(angle * M_PI / 180.);
      const CrackShape shape = crack_shape(staircase(40, c, s), 2);
      EXPECT_NEAR(shape.area, 40. * (c + s), 40. * round_off);
      EXPECT_NEAR(crack_angle(shape), angle, 0.1);
      EXPECT_NEAR(shape.tortuosity, c + s, 1e-3);
    }
  }

  TEST(CrackShape, TurnedCracksTurnTheirAngle)
  {
    const double turn = 25. * M_PI / 180.;
    auto points = staircase(5, 1., 0.4);
    const CrackShape before = crack_shape(points, 2);
    const auto turned = [&](const Vector &x) {
      return Vector{std::cos(turn) * x[0] - std::sin(turn) * x[1],
                    std::sin(turn) * x[0] + std::cos(turn) * x[1], 0.};
    };
    for (BrokenPoint &point : points) {
      point.position = turned(point.position);
      point.normal = turned(point.normal);
      for (Vector &end : point.ends)
        end = turned(end);
    }
    const CrackShape after = crack_shape(points, 2);
    EXPECT_NEAR(crack_angle(after) - crack_angle(before), 25., 1e-9);
    EXPECT_NEAR(after.extent, before.extent, 10. * round_off);
    EXPECT_NEAR(after.area, before.area, 10. * round_off);
  }

  TEST(CrackShape, GapsAreNotCounted)
  {
    std::vector<BrokenPoint> points;
    add_face(points, {0., 0., 0.}, {1., 0., 0.});
    add_face(points, {2., 0., 0.}, {2.5, 0., 0.});
    const CrackShape shape = crack_shape(points, 2);
    EXPECT_NEAR(shape.area, 1.5, round_off);
    EXPECT_NEAR(shape.extent, 2.5, round_off);
    EXPECT_NEAR(shape.projected, 1.5, round_off);
    EXPECT_NEAR(shape.tortuosity, 1., round_off);
  }

  // Two crack faces of length 2 above each other: twice as long as what they
  // cover.
  TEST(CrackShape, ParallelCracksCoverOnce)
  {
    std::vector<BrokenPoint> points;
    for (const double y : {0., 0.1}) {
      add_face(points, {0., y, 0.}, {1., y, 0.});
      add_face(points, {1., y, 0.}, {2., y, 0.});
    }
    const CrackShape shape = crack_shape(points, 2);
    EXPECT_NEAR(shape.projected, 2., round_off);
    EXPECT_NEAR(shape.tortuosity, 2., round_off);
    EXPECT_NEAR(crack_angle(shape), 0., round_off);
  }

  // z = x over a rectangle of 2 x 1, and the same in steps of two directions.
  TEST(CrackShape, SurfacesInSpace)
  {
    std::vector<BrokenPoint> plane, steps;
    const unsigned int n = 40;
    for (unsigned int i = 0; i < 2 * n; ++i)
      for (unsigned int j = 0; j < n; ++j) {
        BrokenPoint point;
        const double x = (i + 0.5) / n, y = (j + 0.5) / n;
        point.position = {x, y, x};
        point.ends = {point.position, point.position};
        point.normal = {-std::sqrt(0.5), 0., std::sqrt(0.5)};
        point.area = std::sqrt(2.) / (n * n);
        plane.push_back(point);
        point.area = 1. / (n * n);
        point.normal = {0., 0., 1.};
        steps.push_back(point);
        point.normal = {1., 0., 0.};
        steps.push_back(point);
      }
    const CrackShape flat = crack_shape(plane, 3);
    EXPECT_NEAR(flat.area, 2. * std::sqrt(2.), 1e-10);
    EXPECT_NEAR(flat.projected, flat.area, 1e-10);
    EXPECT_NEAR(flat.tortuosity, 1., 1e-10);
    EXPECT_NEAR(std::abs(flat.axes[2][0]), std::sqrt(0.5), 1e-10);
    EXPECT_NEAR(std::abs(flat.axes[0][0]), std::sqrt(0.5), 1e-10);
    const CrackShape stepped = crack_shape(steps, 3);
    EXPECT_NEAR(stepped.area, 4., 1e-10);
    EXPECT_NEAR(stepped.tortuosity, std::sqrt(2.), 1e-10);
  }

  TEST(CrackShape, NothingBrokenHasNoShape)
  {
    const CrackShape shape = crack_shape({}, 2);
    EXPECT_EQ(shape.area, 0.);
    EXPECT_EQ(shape.extent, 0.);
    EXPECT_EQ(shape.tortuosity, 0.);
  }

  TEST(CrackShape, AnglesBetweenLinesDoNotKnowTheirSense)
  {
    EXPECT_NEAR(angle_between(10., 190.), 0., round_off);
    EXPECT_NEAR(angle_between(89., -89.), 2., round_off);
    EXPECT_NEAR(angle_between(0., 90.), 90., round_off);
    EXPECT_NEAR(angle_between(-30., 45.), 75., round_off);
  }
} // namespace nsfd::test_crack_shape
