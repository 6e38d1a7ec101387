#include "../unit/make_law.h"

#include "nsfd/obstacles/obstacle_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

// What every registered shape of an obstacle must satisfy.

namespace test_obstacles_contract
{
  using namespace nsfd;
  using nsfd::test::entries_of;
  using Vector = ObstacleShape::Vector;

  struct ReadShape {
    ObstacleInput input;
    std::shared_ptr<ObstacleShape> shape;
  };

  ReadShape read_shape(const std::string &name, const std::string &example)
  {
    std::string text = "subsection Obstacle: test\n";
    for (const auto &[entry, value] : entries_of(example))
      text += "  set " + entry + " = " + value + "\n";
    InputErrors errors;
    ParameterFile file;
    file.read_text(text + "end\n", "test.prm", errors);
    SectionReader reader(file.open("Obstacle: test"), errors);
    ReadShape result;
    result.shape = ObstacleShapeRegistry::instance().create(name);
    const ObstacleSetting setting{3, true};
    result.shape->demand(reader, setting);
    result.shape->read(reader, setting, result.input);
    file.report_stray(errors);
    EXPECT_FALSE(errors.has_errors()) << errors.report();
    return result;
  }

  double product(const Vector &a, const Vector &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  Vector along(const Vector &x, const Vector &n, const double way)
  {
    return {{x[0] + way * n[0], x[1] + way * n[1], x[2] + way * n[2]}};
  }

  // The gap is a distance: its gradient is the normal, of unit length, and a
  // way along the normal changes it by the way.
  TEST(ObstaclesContract, GapIsTheDistanceAlongTheNormal)
  {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-3., 3.);
    for (const auto &[name, entry] :
         ObstacleShapeRegistry::instance().entries()) {
      EXPECT_FALSE(entry.examples.empty()) << name;
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        const auto [input, shape] = read_shape(name, example);
        for (unsigned int k = 0; k < 200; ++k) {
          const Vector x{{place(random), place(random), place(random)}};
          const Vector n = shape->normal(input, x);
          const double gap = shape->gap(input, x);
          ASSERT_NEAR(product(n, n), 1., 1e-14);
          const double h = 1e-4;
          for (unsigned int d = 0; d < 3; ++d) {
            Vector e{};
            e[d] = 1.;
            // round-off 1e-12, curvature h^2 / r^2
            ASSERT_NEAR((shape->gap(input, along(x, e, h)) -
                         shape->gap(input, along(x, e, -h))) /
                            (2. * h),
                        n[d], 1e-5);
          }
          // out of the obstacle; in a drum not beyond its centre or axis
          ASSERT_NEAR(shape->gap(input, along(x, n, 1e-2)), gap + 1e-2, 1e-14);
          // on the surface by its own distance, from the outside
          if (gap > 0.) {
            ASSERT_NEAR(shape->gap(input, along(x, n, -gap)), 0., 1e-14);
          }
        }
        EXPECT_GT(shape->thickness(input), 0.);
        EXPECT_FALSE(shape->point_text().empty());
        EXPECT_FALSE(shape->text(3).empty());
      }
    }
  }

  TEST(ObstaclesContract, HollowShapesAreTheOthersInsideOut)
  {
    const auto solid = read_shape("sphere", "radius = 2 m"),
               shell = read_shape("sphere", "radius = 2 m; hollow = true");
    const Vector x{{0.3, -1., 0.4}};
    EXPECT_EQ(shell.shape->gap(shell.input, x),
              -solid.shape->gap(solid.input, x));
    EXPECT_NEAR(shell.shape->gap(shell.input, x), 2. - std::sqrt(1.25), 1e-15);
    EXPECT_EQ(solid.shape->thickness(solid.input), 4.);
    EXPECT_TRUE(std::isinf(shell.shape->thickness(shell.input)));
    // at the centre no direction is the normal
    EXPECT_EQ(solid.shape->normal(solid.input, {}), Vector{});
  }

  TEST(ObstaclesContract, ListsBeginWithThePlane)
  {
    const auto names = obstacle_shape_names();
    ASSERT_GE(names.size(), 3u);
    EXPECT_EQ(names[0], "plane");
    EXPECT_EQ(names.size(), ObstacleShapeRegistry::instance().entries().size());
  }
} // namespace test_obstacles_contract
