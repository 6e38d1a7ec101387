#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

// Orders of convergence on smooth solutions: p + 1 for the displacement, p for
// the stress, 2 in the step for theta = 1/2 and 1 beyond, with bonded faces.

namespace end_to_end::test_orders
{
  namespace
  {
    double rate(const double coarse, const double fine)
    {
      return std::log2(coarse / fine);
    }

    Result manufactured(const Workspace &workspace, const std::string &name,
                        const unsigned int degree, const unsigned int cells,
                        std::vector<std::string> more)
    {
      const std::string n = std::to_string(cells);
      more.insert(more.end(),
                  {"Discretization/degree=" + std::to_string(degree),
                   "Mesh/cells=" + n + ", " + n, "Output/fields=false"});
      return good_run(workspace, name, {scene("manufactured"), more});
    }
  } // namespace

  // The pairs of ARKODE leave no error of the time: what is seen is space.
  TEST(OrdersTest, SpaceWithBondedFaces)
  {
    const Workspace workspace;
    for (const unsigned int degree : {1u, 2u, 3u}) {
      const unsigned int coarse = 8;
      const std::string name = "p" + std::to_string(degree) + "_";
      const std::vector<std::string> exact_time = {
          "Time/scheme=arkode", "Time/end=0.1 ms", "Time/step=0.1 ms",
          "Time/integration tolerance=1e-11"};
      const Result a =
          manufactured(workspace, name + "coarse", degree, coarse, exact_time);
      const Result b = manufactured(workspace, name + "fine", degree,
                                    2 * coarse, exact_time);
      const double u = rate(a.error("displacement_L2"),
                            b.error("displacement_L2")),
                   stress = rate(a.error("stress_L2"), b.error("stress_L2")),
                   jump = rate(a.error("jump_L2"), b.error("jump_L2"));
      std::printf("  p = %u: u %.2f (%.2e), stress %.2f, jump %.2f\n", degree,
                  u, b.error("displacement_L2"), stress, jump);
      EXPECT_NEAR(u, degree + 1., 0.15);
      EXPECT_NEAR(stress, degree, 0.15);
      // on a line, where |e|^2 <= C |e| |grad e| of the square: p + 1/2 at
      // least
      EXPECT_GT(jump, degree + 0.5 - 0.15);
    }
  }

  // Joined cells in explicit steps, which fall like L^((p + 1) / 2).
  TEST(OrdersTest, SpaceWithJoinedCells)
  {
    const Workspace workspace;
    for (const unsigned int degree : {1u, 2u, 3u, 4u}) {
      const auto mode = [&](const unsigned int n) {
        const double step = 0.05 * std::pow(8. / n, (degree - 1) / 2.) /
                            double(degree * degree);
        return good_run(workspace,
                        "p" + std::to_string(degree) + "_" + std::to_string(n),
                        {scene("mode"),
                         {"Time/scheme=explicit",
                          "Discretization/degree=" + std::to_string(degree),
                          "Mesh/cells=" + std::to_string(n) + ", 1",
                          "Time/step=" + std::to_string(step) + " courant",
                          "Output/fields=false"}});
      };
      const Result fine = mode(16);
      const double u =
          rate(mode(8).error("displacement_L2"), fine.error("displacement_L2"));
      std::printf("  p = %u: u %.2f (%.2e)\n", degree, u,
                  fine.error("displacement_L2"));
      EXPECT_NEAR(u, degree + 1., 0.25);
    }
  }

  // The same mode, seen by both: what is left is the error of space, and the
  // energy balance, the frequency and the motion of joints of the pairs.
  TEST(OrdersTest, PairsOfArkode)
  {
    const Workspace workspace;
    for (const std::string pairs : {"explicit", "implicit"}) {
      const Result result =
          good_run(workspace, pairs,
                   {scene("mode"),
                    {"Time/scheme=arkode", "Time/pairs=" + pairs,
                     "Time/integration tolerance=1e-11", "Time/step=20 us",
                     "Output/fields=false"}});
      // 32 quadratic cells, less than with Courant number 0.05
      expect_below(pairs + ": displacement", result.error("displacement_L2"),
                   4e-5);
      expect_below(pairs + ": frequency", result.error("frequency"), 2e-6);
      expect_below(pairs + ": energy", result.error("energy"), 1e-9);
      expect_below(pairs + ": drift of joints",
                   result.number("rigid_drift_max"), 1e-6 * 1e-6);
      EXPECT_GT(result.counter("arkode_steps"), 20.);
    }
  }

  // The bound of the step is that of free cells, or of all that bonds join:
  // just below it is stable, and just above it refused.
  TEST(OrdersTest, StableStepOfTheSymplecticScheme)
  {
    const Workspace workspace;
    for (const std::string law : {"rigid", "bonded"}) {
      const auto with_step = [&law](const std::string &step) {
        return Launch{scene("mode"),
                      {"Time/scheme=symplectic", "Time/step=" + step,
                       "Interface: joints/law=" + law, "Output/fields=false"}};
      };
      const Result refused =
          run(workspace, "refused_" + law, with_step("10 us"));
      EXPECT_EQ(refused.outcome.exit_code, 1);
      const std::string &text = refused.outcome.err;
      const std::string before = "stable up to ";
      const std::size_t at = text.find(before);
      ASSERT_NE(at, std::string::npos) << text;
      const double limit = std::stod(text.substr(at + before.size()));
      const Result good =
          good_run(workspace, "good_" + law,
                   with_step(std::to_string(0.99 * limit * 1e9) + " ns"));
      // order 1 at the times of the steps, no energy lost
      expect_below(law + ": frequency", good.error("frequency"), 0.1);
    }
  }

  // Waves along the axis of a transversely isotropic body, across it and
  // oblique, of both polarisations: speeds by hand, order p + 1 in space.
  TEST(OrdersTest, WavesOfATransverselyIsotropicBody)
  {
    const Workspace workspace;
    struct Row {
      std::string name, axis, wave;
      double speed; // m/s: roots of Christoffel's matrix over the density
    };
    for (const Row &row : {Row{"along", "1, 0, 0", "fast", 9465.43263},
                           Row{"across", "0, 1, 0", "fast", 2823.64863},
                           Row{"shear", "1, 0, 0", "slow", 1767.76695},
                           Row{"oblique", "sqrt(3), 1, 0", "fast", 8252.62085},
                           Row{"slow", "sqrt(3), 1, 0", "slow", 2051.41614}})
      for (const unsigned int degree : {1u, 2u}) {
        // per period: the error of the step is a tenth of that of space
        const double steps = degree == 1 ? 400. : 1600.;
        const auto error = [&](const unsigned int n) {
          const Result result = good_run(
              workspace, row.name + std::to_string(degree) + std::to_string(n),
              {scene("transverse_wave"),
               {"Material: laminate/axis=" + row.axis,
                "Verification/wave=" + row.wave,
                "Discretization/degree=" + std::to_string(degree),
                "Constants/n=" + std::to_string(n),
                "Time/end=" + std::to_string(1.125e6 / row.speed) + " us",
                "Time/step=" + std::to_string(1e6 / row.speed / steps) + " us",
                "Output/fields=false"}});
          EXPECT_NEAR(result.error("exact_speed"), row.speed, 1e-7 * row.speed);
          return result.error("displacement_L2");
        };
        const unsigned int n = degree == 1 ? 32 : 8;
        const double coarse = error(n), fine = error(2 * n);
        std::printf("  %s, p = %u: %.2e %.2e, order %.2f\n", row.name.c_str(),
                    degree, coarse, fine, rate(coarse, fine));
        EXPECT_GT(rate(coarse, fine), degree + 0.8);
      }
  }

  // At this degree rigid and driven rows ask for the same; with theta = 1 their
  // impulses drift on the local path, in elastic bodies as well, and the
  // energy balance says so: the assembled one.
  TEST(OrdersTest, StepOfADampedWave)
  {
    const Workspace workspace;
    for (const std::string law : {"rigid", "bonded"})
      for (const auto &[theta, order] :
           {std::pair("0.5", 2.), std::pair("1", 1.)}) {
        const auto error = [&, theta = theta,
                            order = order](const std::string &step) {
          return good_run(
                     workspace, law + theta + step,
                     {scene("damped_wave"),
                      {"Discretization/degree=4", "Constants/n=8",
                       std::string("Time/theta=") + theta,
                       "Time/step=" + step + " us", "Interface: all/law=" + law,
                       std::string("Solver/path=") +
                           (order == 1. && law == "rigid" ? "assembled"
                                                          : "auto"),
                       "Output/fields=false"}})
              .error("displacement_L2");
        };
        const double coarse = error("5"), fine = error("2.5");
        std::printf("  %s, theta = %s: %.2e %.2e, order %.2f\n", law.c_str(),
                    theta, coarse, fine, rate(coarse, fine));
        EXPECT_NEAR(rate(coarse, fine), order, 0.15);
      }
  }

  TEST(OrdersTest, GradedModulus)
  {
    const Workspace workspace;
    for (const unsigned int degree : {1u, 2u, 3u}) {
      const auto error = [&](const unsigned int n) {
        return good_run(workspace,
                        std::to_string(degree) + "_" + std::to_string(n),
                        {scene("graded_bar"),
                         {"Discretization/degree=" + std::to_string(degree),
                          "Constants/n=" + std::to_string(n),
                          "Output/fields=false"}})
            .error("displacement_L2");
      };
      const double coarse = error(4), fine = error(8);
      std::printf("  p = %u: %.2e %.2e, order %.2f\n", degree, coarse, fine,
                  rate(coarse, fine));
      EXPECT_NEAR(rate(coarse, fine), degree + 1., 0.15);
    }
  }

  TEST(OrdersTest, TimeStep)
  {
    const Workspace workspace;
    struct Row {
      std::string theta;
      double order;
    };
    for (const Row &row : {Row{"0.5", 2.}, Row{"0.75", 1.}}) {
      const auto error = [&](const std::string &step) {
        return manufactured(
                   workspace, "theta" + row.theta + "_" + step, 4, 4,
                   {"Time/theta=" + row.theta, "Time/step=" + step + " us"})
            .error("displacement_L2");
      };
      const double coarse = error("12.5"), fine = error("6.25");
      std::printf("  theta = %s: %.2e %.2e, order %.2f\n", row.theta.c_str(),
                  coarse, fine, rate(coarse, fine));
      EXPECT_NEAR(rate(coarse, fine), row.order, 0.15);
    }
  }
} // namespace end_to_end::test_orders
