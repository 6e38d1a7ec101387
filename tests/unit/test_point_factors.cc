#include "make_scene.h"

#include "discretization/point_factors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

// Strength and toughness from point to point of a scene.

namespace nsfd::test_point_factors
{
  namespace
  {
    const std::string text = R"(# graded - a block with cohesive faces.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 1
  set cells        = 8, 4
end
subsection Discretization
  set interface points = 1
end
subsection Material: block
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law       = michel-suquet
  set strength  = 2
  set toughness = 3
end
subsection Time
  set end = 1
end
)";

    using Factors = std::map<std::array<double, 2>, std::array<double, 2>>;

    /** Strength and toughness factors of all points by position. */
    Factors factors(const std::vector<std::string> &overrides)
    {
      test::Scene<2> scene(text, overrides);
      const auto &points = scene.discretization->points();
      Factors result;
      for (std::size_t i = 0; i < points.n_points; ++i) {
        const PointFactors f = point_factors<2>(scene.input->interfaces[0],
                                                &points.position[2 * i],
                                                scene.discretization->extent());
        // 1e-9: round-off of the position
        result[{{std::round(1e9 * points.position[2 * i]),
                 std::round(1e9 * points.position[2 * i + 1])}}] = {
            {f.strength, f.toughness}};
      }
      return result;
    }

    TEST(PointFactors, FollowTheExpressions)
    {
      const auto all = factors({"Interface: all/strength factor=1 + x",
                                "Interface: all/toughness factor=2 - y"});
      ASSERT_EQ(all.size(), 7u * 4u + 8u * 3u);
      for (const auto &[x, f] : all) {
        EXPECT_NEAR(f[0], 1. + 1e-9 * x[0], 1e-9);
        EXPECT_NEAR(f[1], 2. - 1e-9 * x[1], 1e-9);
      }
    }

    TEST(PointFactors, AreThoseOfThePositionOnEveryMesh)
    {
      // faces have one point in their middle: three times as many cells have
      // the middles of the coarse faces among theirs
      for (const std::vector<std::string> &scatter :
           {std::vector<std::string>{"strength scatter=0.2",
                                     "toughness scatter=0.3"},
            std::vector<std::string>{"scatter=weibull", "strength modulus=8",
                                     "toughness modulus=3"}}) {
        std::vector<std::string> overrides = {"Mesh/cells=8, 4"};
        for (const auto &entry : scatter)
          overrides.push_back("Interface: all/" + entry);
        const auto coarse = factors(overrides);
        overrides[0] = "Mesh/cells=24, 12";
        const auto fine = factors(overrides);
        unsigned int different = 0;
        for (const auto &[x, f] : coarse) {
          ASSERT_EQ(fine.count(x), 1u) << x[0] << ", " << x[1];
          EXPECT_EQ(fine.at(x), f) << x[0] << ", " << x[1];
          different += f[0] != f[1] && f[0] != 1.;
        }
        EXPECT_EQ(different, coarse.size()) << "numbers of their own";
        overrides.push_back("Interface: all/seed=2");
        EXPECT_NE(factors(overrides), fine);
      }
    }

    TEST(PointFactors, ScatterMultipliesTheExpression)
    {
      const auto plain = factors({"Interface: all/strength scatter=0.2"}),
                 graded = factors({"Interface: all/strength scatter=0.2",
                                   "Interface: all/strength factor=2 + 0*x"});
      for (const auto &[x, f] : plain) {
        EXPECT_EQ(graded.at(x)[0], 2. * f[0]);
        EXPECT_EQ(graded.at(x)[1], 1.);
      }
    }

    TEST(PointFactors, MustBePositive)
    {
      const auto problems = [](const std::vector<std::string> &overrides) {
        try {
          test::Scene<2> scene(text, overrides);
        } catch (const std::invalid_argument &refused) {
          return std::string(refused.what());
        }
        return std::string();
      };
      EXPECT_EQ(problems({"Interface: all/strength factor=1 + x"}), "");
      const std::string falls =
          problems({"Interface: all/strength factor=1 - x",
                    "Interface: all/toughness factor=sqrt(y - 0.5)"});
      EXPECT_NE(falls.find("Interface: all/strength factor = 1 - x must be "
                           "positive, but falls to -0.875 on its faces\n"),
                std::string::npos)
          << falls;
      EXPECT_NE(falls.find("is not a number"), std::string::npos) << falls;
    }
  } // namespace
} // namespace nsfd::test_point_factors
