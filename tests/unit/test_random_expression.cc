#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

using namespace nsfd;

namespace test_random_expression
{
  Expression broken_where(const std::string &condition)
  {
    InputErrors errors;
    const auto input = read_scene_text(R"(
      set dimension = 2
      subsection Mesh
        set type         = rectangle
        set lower corner = 0, 0
        set upper corner = 1, 1
        set cells        = 1, 1
      end
      subsection Material: bulk
        set model         = linear elastic
        set Young modulus = 1
        set Poisson ratio = 0.3
        set density       = 1
      end
      subsection Interface: faces
        set where  = all
        set law       = michel-suquet
        set stiffness = 1
        set strength  = 1
        set broken = )" + condition + R"(
      end
      subsection Time
        set end = 1
      end
    )",
                                       "test.prm", {}, errors);
    if (!input)
      throw std::invalid_argument(errors.report());
    return input->interfaces[0].broken;
  }

  // Uniform in [0, 1): mean 1/2 and variance 1/12 of n numbers within four
  // standard deviations; seeds and arguments matter, -0 is 0.
  TEST(RandomExpression, IsUniformAndReproducible)
  {
    const Expression f = broken_where("random(1, x, y)"),
                     again = broken_where("random(1, x, y)"),
                     other = broken_where("random(2, x, y)");
    const int n = 100;
    double sum = 0., squares = 0., product = 0.;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double value = f(i, j, 0.);
        ASSERT_GE(value, 0.);
        ASSERT_LT(value, 1.);
        ASSERT_EQ(value, again(i, j, 0.));
        sum += value;
        squares += value * value;
        product += (value - 0.5) * (other(i, j, 0.) - 0.5);
      }
    const double count = n * n, mean = sum / count;
    EXPECT_NEAR(mean, 0.5, 4. / std::sqrt(12. * count));
    EXPECT_NEAR(squares / count - mean * mean, 1. / 12.,
                4. / std::sqrt(180. * count));
    EXPECT_NEAR(product / count, 0., 4. / (12. * std::sqrt(count)));
    EXPECT_EQ(f(-0., 3., 0.), f(0., 3., 0.));
    EXPECT_NE(f(1., 3., 0.), f(3., 1., 0.));
  }
} // namespace test_random_expression
