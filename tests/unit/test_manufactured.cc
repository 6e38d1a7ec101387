#include "make_scene.h"

#include "nsfd/verification/verification_case.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

// The manufactured motion solves the equations that it is said to solve: force
// balance, traction of the springs, continuity of the traction; derivatives by
// central differences of fourth order.

namespace nsfd::test_manufactured
{
  namespace
  {
    using Vector = std::array<double, 3>;

    std::string scene(const std::string &plane, const bool solid)
    {
      return (solid ? "set dimension = 3\n"
                    : "set dimension = 2\nset plane = " + plane + "\n") +
             std::string("subsection Mesh\n set type = ") +
             (solid ? "brick" : "rectangle") +
             "\n set lower corner = " + (solid ? "1, 2, 3" : "1, 2") +
             "\n set upper corner = " + (solid ? "3, 4.5, 5" : "3, 4.5") +
             "\n set cells = " + (solid ? "2, 2, 2" : "2, 2") + R"(
end
subsection Material: left
  set where = x < 2
  set Young modulus = 2.1
  set Poisson ratio = 0.3
  set density = 0.7
end
subsection Material: right
  set where = all
  set Young modulus = 2.1
  set Poisson ratio = 0.3
  set density = 0.7
end
subsection Interface: middle
  set where = between materials [left, right]
  set law = elastic
  set normal stiffness = 3
  set tangential stiffness = 2
end
subsection Interface: elsewhere
  set law = rigid
end
subsection Boundary: around
  set where = all
  set motion = exact
end
subsection Time
  set end = 1
  set step = 0.1
end
subsection Verification
  set case = manufactured
  set amplitude = 0.3
  set angular frequency = 1.7
end
)";
    }

    double derivative(const std::function<double(double)> &f, const double d)
    {
      return (8. * (f(d) - f(-d)) - (f(2. * d) - f(-2. * d))) / (12. * d);
    }

    Vector moved(Vector x, const unsigned int axis, const double by)
    {
      x[axis] += by;
      return x;
    }

    struct Kind {
      std::string plane;
      unsigned int dim;
    };

    class ManufacturedTest : public testing::TestWithParam<Kind>
    {
    protected:
      const unsigned int dim = GetParam().dim;
      const std::unique_ptr<SceneInput> input =
          test::make_input(scene(GetParam().plane, dim == 3));
      VerificationCase &exact = *input->verification;
      void SetUp() override { exact.initialise(*input); }

      /** Entry of the stress, from xx, yy, zz, xy, xz, yz. */
      double stress(const Vector &x, const double t, const unsigned int c,
                    const unsigned int d) const
      {
        static const unsigned int entry[3][3] = {
            {0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
        return exact.stress(x, t)[entry[c][d]];
      }
    };

    TEST_P(ManufacturedTest, ForcesBalance)
    {
      const double t = 0.4, d = 1e-3;
      for (const Vector &x : {Vector{1.3, 2.6, dim == 3 ? 3.4 : 0.},
                              Vector{2.4, 3.9, dim == 3 ? 4.7 : 0.}})
        for (unsigned int c = 0; c < dim; ++c) {
          const double inertia =
              0.7 *
              derivative(
                  [&](const double by) { return exact.velocity(x, t + by)[c]; },
                  d);
          double divergence = 0.;
          for (unsigned int k = 0; k < dim; ++k)
            divergence += derivative(
                [&](const double by) {
                  return stress(moved(x, k, by), t, c, k);
                },
                d);
          const auto &material = input->materials[x[0] < 2. ? 0 : 1];
          const double force = material.body_force[c](x[0], x[1], x[2], t);
          EXPECT_NEAR(force, inertia - divergence, 1e-9) << c;
          EXPECT_GT(std::abs(force), 1e-3) << "the check must see something";
        }
    }

    TEST_P(ManufacturedTest, StressIsThatOfTheMotion)
    {
      const double t = 0.4, d = 1e-3, E = 2.1, nu = 0.3;
      const Vector x = {2.3, 3.1, dim == 3 ? 4.2 : 0.};
      double strain[3][3] = {};
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int k = 0; k < dim; ++k) {
          const double gradient = derivative(
              [&](const double by) {
                return exact.displacement(moved(x, k, by), t)[c];
              },
              d);
          strain[c][k] += gradient / 2.;
          strain[k][c] += gradient / 2.;
        }
      if (GetParam().plane == "stress")
        strain[2][2] = -nu / (1. - nu) * (strain[0][0] + strain[1][1]);
      const double trace = strain[0][0] + strain[1][1] + strain[2][2];
      for (unsigned int c = 0; c < 3; ++c)
        for (unsigned int k = 0; k < 3; ++k)
          EXPECT_NEAR(
              stress(x, t, c, k),
              E / (1. + nu) *
                  (strain[c][k] + (c == k ? nu / (1. - 2. * nu) * trace : 0.)),
              1e-10)
              << c << k;
    }

    TEST_P(ManufacturedTest, SpringsCarryTheTraction)
    {
      const double t = 0.9, side = 1e-13;
      const Vector at = {2., 3.3, dim == 3 ? 4.1 : 0.};
      const Vector jump = exact.jump(at, {1., 0., 0.}, t);
      for (unsigned int c = 0; c < dim; ++c) {
        const double traction = stress(moved(at, 0, -side), t, 0, c);
        EXPECT_NEAR(traction, (c == 0 ? 3. : 2.) * jump[c], 1e-11);
        EXPECT_NEAR(traction, stress(moved(at, 0, side), t, 0, c), 1e-11);
        EXPECT_NEAR(jump[c],
                    exact.displacement(moved(at, 0, side), t)[c] -
                        exact.displacement(moved(at, 0, -side), t)[c],
                    1e-11);
        EXPECT_GT(std::abs(jump[c]), 1e-3) << "the check must see something";
      }
      EXPECT_EQ(exact.jump({1.5, 3.3, 0.}, {1., 0., 0.}, t)[0], 0.);
    }

    INSTANTIATE_TEST_SUITE_P(Kinds, ManufacturedTest,
                             testing::Values(Kind{"strain", 2},
                                             Kind{"stress", 2},
                                             Kind{"strain", 3}),
                             [](const auto &info) {
                               return info.param.plane +
                                      std::to_string(info.param.dim);
                             });

    TEST(ExactMotionTest, NeedsACaseThatMoves)
    {
      const std::string text = R"(
set dimension = 2
subsection Mesh
  set upper corner = 1, 1
  set lower corner = 0, 0
  set cells = 1, 1
end
subsection Material: all
  set Young modulus = 1
  set Poisson ratio = 0
  set density = 1
end
subsection Boundary: left
  set motion = exact
end
subsection Time
  set end = 1
end
)";
      InputErrors errors;
      EXPECT_EQ(read_scene_text(text, "test.prm", {}, errors), nullptr);
      EXPECT_NE(errors.report().find("motion = exact needs a verification "
                                     "case that moves boundaries"),
                std::string::npos)
          << errors.report();
    }
  } // namespace
} // namespace nsfd::test_manufactured
