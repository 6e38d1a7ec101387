#include "make_scene.h"

#include "discretization/cells.h"
#include "heat/body_heat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

// Temperatures of cells and what goes through their faces. A step of the
// backward Euler rule has formulas of its own: T - D kappa T'' = T_before.

namespace nsfd::test_heat
{
  namespace
  {
    using test::Scene;

    std::string interface(const std::string &name, const std::string &entries)
    {
      return "subsection Interface: " + name + "\n" + entries + "end\n";
    }
    const std::string joined = interface("all", "  set law = joined\n");

    /** A bar from 0 to 1 along x, of unit constants but for those given. */
    std::string bar(const std::string &mesh, const std::string &cells,
                    const std::string &conductivity, const std::string &start,
                    const std::string &faces, const unsigned int dim = 2)
    {
      return fmt::format(R"(set dimension = {}
subsection Mesh
  set type         = {}
  set lower corner = {}
  set upper corner = {}
  set cells        = {}
  set distortion   = {}
end
subsection Material: body
  set Young modulus       = 1
  set Poisson ratio       = 0.3
  set density             = 2
  set heat capacity       = 3
  set conductivity        = {}
  set initial temperature = {}
end
{}
subsection Time
  set end  = 1
  set step = 0.01 s
end
)",
                         dim, mesh, dim == 2 ? "0, 0" : "0, 0, 0",
                         dim == 2 ? "1, 0.25" : "1, 0.25, 0.25", cells,
                         // a plane in the middle stays where it is
                         faces == joined ? 0.2 : 0., conductivity, start,
                         faces);
    }

    template <int dim>
    State start(Scene<dim> &scene, BodyHeat<dim> &heat)
    {
      State state = scene.state;
      heat.start(state);
      return state;
    }

    /** Root of the mean square over corners of what they differ from @p exact,
        by their capacities. */
    template <int dim>
    double error(const Scene<dim> &scene, const std::vector<double> &T,
                 const std::function<double(double)> &exact)
    {
      const HeatCells<dim> cells(*scene.discretization);
      const unsigned int n = cells.n_corners();
      double wrong = 0., all = 0.;
      for (std::size_t k = 0; k < T.size(); ++k) {
        const double C = cells.of(k / n).capacity[k % n];
        const double x = scene.discretization->cells().corners[k / n][k % n][0];
        wrong += C * std::pow(T[k] - exact(x), 2);
        all += C;
      }
      return std::sqrt(wrong / all);
    }

    // cos(pi x): a step of length D leaves 1 / (1 + D kappa pi^2) of it.
    TEST(Heat, StepOfAModeConvergesWithTheSquareOfTheCells)
    {
      const double kappa = 5. / (2. * 3.), D = 0.3;
      const double left = 1. / (1. + D * kappa * M_PI * M_PI);
      for (const std::string type : {"rectangle", "diagonal triangles"}) {
        std::vector<double> errors;
        for (const unsigned int n : {8u, 16u, 32u}) {
          Scene<2> scene(bar(type, fmt::format("{}, {}", n, n / 4), "5",
                             "300 + cos(pi * x)", joined));
          BodyHeat<2> heat(*scene.discretization, scene.communicator);
          State state = start(scene, heat);
          HeatConduction<2> conduction(*scene.discretization,
                                       scene.communicator);
          conduction.conduct(D, state, state.heat.temperature);
          errors.push_back(
              error<2>(scene, state.heat.temperature, [&](const double x) {
                return 300. + left * std::cos(M_PI * x);
              }));
        }
        EXPECT_LT(errors[2], 1e-3) << type;
        for (unsigned int k = 0; k < 2; ++k)
          EXPECT_NEAR(std::log2(errors[k] / errors[k + 1]), 2., 0.35)
              << type << ' ' << errors[k] << ' ' << errors[k + 1];
      }
    }

    // Halves at 1 and 0 with a parted face between them. With A = 1 /
    // sqrt(kappa D): T = 1 - a cosh(A x) on the left, a cosh(A (1 - x)) on the
    // right, k A a sinh(A/2) = h (1 - 2 a cosh(A/2)).
    TEST(Heat, ThroughAClosedFaceGoesWhatItsConductanceSays)
    {
      const double k = 5., kappa = k / (2. * 3.), D = 0.05;
      const double A = 1. / std::sqrt(kappa * D);
      const auto solve = [&](const double h) { // 0: none, < 0: as the bodies
        const double flux = k * A * std::sinh(A / 2.),
                     both = 2. * std::cosh(A / 2.);
        return h < 0. ? 1. / both : h / (flux + h * both);
      };
      for (const double h : {-1., 0.01, 2., 300.}) {
        const std::string conductance =
            h > 0. ? fmt::format("  set contact conductance = {}\n", h) : "";
        Scene<2> scene(bar("rectangle", "64, 4", "5", "if(x < 0.5, 1, 0)",
                           interface("middle", "  set where = "
                                               "abs(x - 0.5) < 1e-6\n"
                                               "  set law = contact\n" +
                                                   conductance) +
                               interface("rest", "  set law = joined\n"),
                           2));
        // cells on both sides of x = 0.5 have their own values at its nodes
        BodyHeat<2> heat(*scene.discretization, scene.communicator);
        State state = start(scene, heat);
        auto &T = state.heat.temperature;
        const auto &cells = scene.discretization->cells();
        const unsigned int n = 4;
        for (std::size_t c = 0; c < T.size(); ++c)
          T[c] = cells.centre(c / n)[0] < 0.5 ? 1. : 0.;
        HeatConduction<2> conduction(*scene.discretization, scene.communicator);
        conduction.conduct(D, state, T);
        const double a = solve(h);
        double worst = 0.;
        for (std::size_t c = 0; c < T.size(); ++c) {
          const double x = cells.corners[c / n][c % n][0];
          const double exact = cells.centre(c / n)[0] < 0.5
                                   ? 1. - a * std::cosh(A * x)
                                   : a * std::cosh(A * (1. - x));
          worst = std::max(worst, std::abs(T[c] - exact));
        }
        // of second order: (A / 64)^2 / 12 of the largest curvature
        EXPECT_LT(worst, 2e-3) << h;
      }
    }

    // What opens conducts by its filling alone: h = k_g / u.
    TEST(Heat, ThroughAnOpenFaceGoesWhatItsFillingConducts)
    {
      Scene<2> scene(
          bar("rectangle", "8, 2", "5e6", "300",
              interface("middle", "  set where = abs(x - 0.5) < 1e-6\n"
                                  "  set law = contact\n"
                                  "  set gap conductivity = 0.4\n") +
                  interface("rest", "  set law = joined\n")));
      BodyHeat<2> heat(*scene.discretization, scene.communicator);
      State state = start(scene, heat);
      auto &T = state.heat.temperature;
      for (std::size_t c = 0; c < T.size(); ++c)
        T[c] = scene.discretization->cells().centre(c / 4)[0] < 0.5 ? 1. : 0.;
      for (std::size_t i = 0; i < state.kind.size(); ++i)
        state.jump[i * 2] = 0.02; // joined points do not look at it
      HeatConduction<2> conduction(*scene.discretization, scene.communicator);
      const double D = 0.1;
      conduction.conduct(D, state, T);
      // each half is at one temperature: rho c L dT/dt = h (T_2 - T_1)
      const double h = 0.4 / 0.02, jump = 1. / (1. + 2. * h * D / (6. * 0.5));
      const auto [low, high] = std::minmax_element(T.begin(), T.end());
      EXPECT_NEAR(*high - *low, jump, 1e-4);
      EXPECT_NEAR(*high + *low, 1., 1e-9);
    }

    // Any temperatures, cells of any shape, faces that hold, touch or part:
    // heat is kept, and its square falls.
    template <int dim>
    void keeps_heat(const std::string &type, const std::string &cells)
    {
      Scene<dim> scene(
          bar(type, cells, "0.7", "300",
              interface("middle", "  set where = abs(x - 0.5) < 1e-6\n"
                                  "  set law = contact\n"
                                  "  set contact conductance = 2\n") +
                  interface("rest", "  set law = joined\n"),
              dim));
      BodyHeat<dim> heat(*scene.discretization, scene.communicator);
      State state = start(scene, heat);
      auto &T = state.heat.temperature;
      std::mt19937 dice(7);
      for (double &one : T)
        one = 200. + double(dice() % 1000);
      const HeatCells<dim> tables(*scene.discretization);
      const unsigned int n = tables.n_corners();
      const auto sums = [&] {
        std::array<double, 2> result{};
        for (std::size_t k = 0; k < T.size(); ++k) {
          const double C = tables.of(k / n).capacity[k % n];
          result[0] += C * T[k];
          result[1] += C * T[k] * T[k];
        }
        return result;
      };
      HeatConduction<dim> conduction(*scene.discretization, scene.communicator);
      for (const double D : {1e-6, 1e-3, 1., 1e4}) {
        const auto before = sums();
        conduction.conduct(D, state, T);
        const auto after = sums();
        // sums of flows, which are D times the rate of a cell times its heat
        const double round_off = 1e-14 + 2e-16 * D * tables.fastest();
        EXPECT_NEAR(after[0] / before[0], 1., round_off + 1e-13)
            << type << ' ' << D;
        EXPECT_LE(after[1], before[1]) << type << ' ' << D;
      }
      // at last all of it is at one temperature
      const auto [low, high] = std::minmax_element(T.begin(), T.end());
      EXPECT_LT(*high - *low, 1e-2 * *high) << type;
    }

    TEST(Heat, IsKeptWhateverTheFacesDo)
    {
      keeps_heat<2>("rectangle", "6, 3");
      keeps_heat<2>("diagonal triangles", "6, 3");
      keeps_heat<3>("brick", "4, 2, 2");
      keeps_heat<3>("tetrahedra", "4, 2, 2");
    }

    std::string side(const std::string &name, const std::string &entries)
    {
      return "subsection Boundary: " + name + "\n" + entries + "end\n";
    }

    // In steps that last long enough T = T_g + q_g x / k, whatever the cells.
    TEST(Heat, SidesGiveALineInTheEnd)
    {
      for (const std::string type : {"rectangle", "diagonal triangles"}) {
        Scene<2> scene(bar(type, "8, 2", "5", "300",
                           joined + side("left", "  set temperature = 320\n") +
                               side("right", "  set heat flux = 40\n")));
        BodyHeat<2> heat(*scene.discretization, scene.communicator);
        State state = start(scene, heat);
        HeatConduction<2> conduction(*scene.discretization, scene.communicator);
        conduction.conduct(1e9, state, state.heat.temperature);
        // of the change of some 20 K, by 1e-13 of the residual
        EXPECT_LT(error<2>(scene, state.heat.temperature,
                           [](const double x) { return 320. + 8. * x; }),
                  1e-7)
            << type;
      }
    }

    // T = cosh(A (1 - x)) / cosh(A) and q cosh(A x) / (k A sinh(A)), with A = 1
    // / sqrt(kappa D), where 1 K and q are given on one side.
    TEST(Heat, OfSidesConvergesWithTheSquareOfTheCells)
    {
      const double k = 5., kappa = k / (2. * 3.), D = 0.1;
      const double A = 1. / std::sqrt(kappa * D);
      for (const bool is_flux : {false, true})
        for (const std::string type : {"rectangle", "diagonal triangles"}) {
          std::vector<double> errors;
          for (const unsigned int n : {8u, 16u, 32u}) {
            Scene<2> scene(bar(
                type, fmt::format("{}, {}", n, n / 4), "5", "0",
                joined + (is_flux ? side("right", "  set heat flux = 7\n")
                                  : side("left", "  set temperature = 1\n"))));
            BodyHeat<2> heat(*scene.discretization, scene.communicator);
            State state = start(scene, heat);
            auto &T = state.heat.temperature;
            HeatConduction<2> conduction(*scene.discretization,
                                         scene.communicator);
            const double given = conduction.conduct(D, state, T).given;
            errors.push_back(error<2>(scene, T, [&](const double x) {
              return is_flux ? 7. * std::cosh(A * x) / (k * A * std::sinh(A))
                             : std::cosh(A * (1. - x)) / std::cosh(A);
            }));
            double stored = 0.;
            const HeatCells<2> cells(*scene.discretization);
            for (std::size_t c = 0; c < T.size(); ++c)
              stored += cells.of(c / cells.n_corners())
                            .capacity[c % cells.n_corners()] *
                        T[c];
            EXPECT_NEAR(stored / given, 1., 1e-11) << type << n;
            if (is_flux) {
              EXPECT_NEAR(given / (7. * 0.25 * D), 1., 1e-12);
            }
          }
          for (unsigned int i = 0; i < 2; ++i)
            EXPECT_NEAR(std::log2(errors[i] / errors[i + 1]), 2., 0.35)
                << type << is_flux << ' ' << errors[i];
        }
    }

    // Between its points straight, beyond them constant.
    TEST(Heat, FactorsAreLinearInTheTemperature)
    {
      EXPECT_EQ(TemperatureFactor().at(300.), 1.);
      const TemperatureFactor factor = {{300., 400., 800.}, {1., 0.5, 0.25}};
      for (const auto &[T, exact] : {std::pair(0., 1.),
                                     {300., 1.},
                                     {350., 0.75},
                                     {400., 0.5},
                                     {600., 0.375},
                                     {800., 0.25},
                                     {1e4, 0.25}})
        EXPECT_DOUBLE_EQ(factor.at(T), exact) << T;
    }

    // That of a law follows the face until it is open, the temperature of the
    // face always.
    TEST(Heat, OpenLawsKeepTheirTemperature)
    {
      Scene<2> scene(bar("rectangle", "2, 1", "0", "if(x < 0.5, 300, 400)",
                         interface("all", "  set law = camacho-ortiz\n"
                                          "  set strength = 1\n"
                                          "  set toughness = 1\n"
                                          "  set strength at temperatures = "
                                          "300 : 1, 400 : 0.5\n")));
      BodyHeat<2> heat(*scene.discretization, scene.communicator);
      State state = start(scene, heat);
      const std::size_t n = scene.discretization->points().n_points;
      ASSERT_EQ(state.heat.of_laws.size(), n);
      const auto before = state.heat.of_laws;
      EXPECT_EQ(state.heat.at_faces, before);
      state.kind[0] = PointKind::cohesive;
      state.opening_max[0] = 0.1;
      state.heat.of_points.assign(n, 1.);
      heat.accept(state, [] {});
      EXPECT_EQ(state.heat.of_laws[0], before[0]);
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_GT(state.heat.at_faces[i], before[i] + 0.1);
        if (i > 0) {
          EXPECT_EQ(state.heat.of_laws[i], state.heat.at_faces[i]);
        }
      }
    }

    // rho c V dT = the heat of the points of a cell, in halves on both sides.
    TEST(Heat, OfPointsIsInTheirCells)
    {
      for (const char *conductivity : {"0", "5"}) {
        Scene<2> scene(bar("rectangle", "4, 2", conductivity, "300", joined));
        BodyHeat<2> heat(*scene.discretization, scene.communicator);
        State state = start(scene, heat);
        double sum = 0.;
        state.heat.of_points.assign(scene.discretization->points().n_points,
                                    0.);
        for (std::size_t i = 0; i < state.heat.of_points.size(); i += 3)
          sum += state.heat.of_points[i] = double(i % 7 + 1);
        heat.accept(state, [] {});
        EXPECT_NEAR(state.heat.made / sum, 1., 1e-14);
        EXPECT_NEAR(state.heat.stored / sum, 1., 1e-12);
        EXPECT_GT(state.heat.hottest, 300.);
      }
    }
  } // namespace
} // namespace nsfd::test_heat
