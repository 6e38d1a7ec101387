#include "hanging_nodes.h"
#include "leapfrog_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

// Explicit steps of cells of two sizes that are joined.

namespace nsfd::test_hanging_motion
{
  namespace
  {
    using test::of_degree;
    using test::refined_plate;
    template <int dim>
    using Parts = test::JoinedParts<dim>;

    using test::Steps;

    /** Momentum and that about the origin, by the masses of what moves. */
    template <int dim>
    std::array<double, 3> momenta(Steps<dim> &run, const Parts<dim> &parts)
    {
      run.leapfrog->show(run.state);
      std::array<double, 3> sum{};
      std::vector<char> seen(parts.groups.size(), 0);
      for (std::size_t i = 0; i < parts.mesh.n_corners(); ++i) {
        const unsigned int g = parts.groups.of(i);
        if (std::exchange(seen[g], 1))
          continue;
        const double m = parts.groups.mass[g];
        const double *v = &run.state.velocity[i * dim];
        const auto &x = parts.place[g];
        sum[0] += m * v[0];
        sum[1] += m * v[1];
        sum[2] += m * (x[0] * v[1] - x[1] * v[0]);
      }
      return sum;
    }

    // A free body that swings: nothing is lost in 2000 steps.
    template <int dim>
    void expect_free_vibration(std::vector<std::string> overrides)
    {
      overrides.insert(
          overrides.end(),
          {"Material: bulk/initial velocity x=0.1 * sin(2 * y) * cos(x) + 0.2",
           "Material: bulk/initial velocity y=0.1 * x * cos(3 * y)",
           "Time/front viscosity=0", "Time/end=1e4"});
      Steps<dim> run(refined_plate, overrides);
      const Parts<dim> parts(overrides);
      const auto before = momenta(run, parts);
      const double start = run.state.initial_energy;
      double worst = 0., moved = 0.;
      for (unsigned int k = 0; k < 2000; ++k) {
        worst = std::max(worst, run.step().balance_residual);
        const EnergyLines &e = run.state.energy;
        worst = std::max(worst, std::abs((e.kinetic + e.elastic) / start - 1.));
        moved = std::max(moved, e.elastic / start);
      }
      const auto after = momenta(run, parts);
      EXPECT_GT(moved, 0.1);
      EXPECT_LT(worst, 1e-12);
      for (unsigned int k = 0; k < 3; ++k)
        EXPECT_NEAR(after[k], before[k],
                    1e-12 * std::max(std::abs(before[0]), std::abs(before[2])));
    }

    TEST(HangingMotion, LoseNothingInFreeVibrations)
    {
      expect_free_vibration<2>(of_degree<2>(1));
      expect_free_vibration<2>(of_degree<2>(
          3, {"Adaptivity/levels=2", "Indicator: middle/cell size=0.25"}));
      expect_free_vibration<3>(of_degree<3>(2));
    }

    /** Of a packet of 20 cells per wavelength on its way to the right, at its
        nodes (x, y): the velocity after it has met x = 70. */
    std::map<std::pair<long, long>, double>
    packet(const unsigned int p, const char *region, const char *viscosity)
    {
      // u = w^2 sin(b y) / b, y = x - 35, v = -u'
      const std::string window = "(1 + cos(pi * (x - 35) / 30)) / 2",
                        inside = "if(abs(x - 35) < 30, ";
      Steps<2> run(
          refined_plate,
          {"Mesh/upper corner=160, 2", "Mesh/cells=160, 2",
           std::string("Indicator: middle/region=") + region,
           "Material: bulk/Poisson ratio=0", "Material: bulk/Young modulus=1",
           "Material: bulk/density=1",
           "Material: bulk/initial displacement x=" + inside + "(" + window +
               ")^2 * sin(pi * (x - 35) / 10) * 10 / pi, 0)",
           "Material: bulk/initial velocity x=" + inside + window +
               " * (sin(pi * (x - 35) / 30) / 3 * sin(pi * (x - 35) / 10) - " +
               window + " * cos(pi * (x - 35) / 10)), 0)",
           std::string("Time/front viscosity=") + viscosity,
           "Discretization/degree=" + std::to_string(p), "Time/end=1e4"});
      run.time_step = 0.3 / (p * p);
      while (run.state.time < 75.)
        run.step();
      run.leapfrog->show(run.state);
      std::map<std::pair<long, long>, double> result;
      const auto &cells = run.discretization->cells();
      for (std::size_t b = 0; b < cells.bodies.size(); ++b)
        for (unsigned int i = 0; i < cells.class_shape(b).n_nodes; ++i) {
          const auto x = cells.place(b, cells.class_shape(b).nodes[i]);
          result[{std::lround(1e4 * x[0]), std::lround(1e4 * x[1])}] =
              run.state.velocity[cells.bodies.first_dof[b] + 2 * i];
        }
      return result;
    }

    double reflected(const unsigned int p, const char *viscosity = "0")
    {
      const auto coarse = packet(p, "x < -1", viscosity),
                 fine = packet(p, "x > 70", viscosity);
      EXPECT_GT(fine.size(), 1.5 * coarse.size());
      double worst = 0.;
      for (const auto &[place, v] : coarse)
        if (place.first < 650000)
          worst = std::max(worst, std::abs(v - fine.at(place)));
      return worst; // of 1
    }

    // Chains of masses, of a plane wave with cells of 1 and of 1/2, reflect
    // (a - b) / (a + b), a = sin(k), b = 2 sin(k'/2), k and k' the wave numbers
    // of the same frequency: 0.0046, as k^2. The second derivative of the
    // packet is 1.33 times that of its wave. That is all that p = 1 reflects.
    TEST(HangingMotion, LetWavesPass)
    {
      const double linear = reflected(1);
      RecordProperty("linear", std::to_string(1e6 * linear));
      EXPECT_NEAR(linear, 1.33 * 0.0046, 2e-4);
      for (unsigned int p = 2; p <= 4; ++p) {
        const double share = reflected(p);
        RecordProperty("p" + std::to_string(p), std::to_string(1e6 * share));
        EXPECT_LT(share, p == 2 ? 1e-3 : 1e-5) << p;
      }
      EXPECT_LT(reflected(1, "auto"), 7e-3);
      EXPECT_LT(reflected(2, "auto"), 1e-3);
    }

    // Everywhere faces may open; those at hanging nodes do not.
    TEST(HangingMotion, HoldTheFacesTheyLieOn)
    {
      for (const unsigned int p : {1u, 2u}) {
        Parts<2> parts(of_degree<2>(p));
        const auto &points = parts.scene.discretization->points();
        unsigned int between = 0, held = 0;
        for (const auto &face : points.faces) {
          if (face.boundary)
            continue;
          bool hangs = false;
          for (unsigned int i = face.first; i < face.first + face.count; ++i)
            hangs |= parts.mesh.between_sizes(i) ||
                     parts.hanging.hangs(parts.mesh.a_corner(i));
          between += parts.mesh.between_sizes(face.first);
          held += parts.hanging.held()[face.first];
          EXPECT_EQ(hangs, parts.hanging.held()[face.first] != 0);
        }
        EXPECT_GT(between, 0u);
        // two small faces per large one, and the one between them, which has a
        // node of the large one if that has one in its middle
        EXPECT_EQ(2 * held, (p % 2 == 0 ? 2 : 3) * between);
      }
      // in space also those of large cells that have an edge with such nodes
      Parts<3> parts(of_degree<3>(1));
      const auto &points = parts.scene.discretization->points();
      bool large = false;
      for (const auto &face : points.faces) {
        bool hangs = face.boundary;
        for (unsigned int i = face.first; i < face.first + face.count; ++i)
          hangs |= parts.mesh.between_sizes(i) ||
                   parts.hanging.hangs(parts.mesh.a_corner(i));
        large |= !hangs && parts.hanging.held()[face.first];
      }
      EXPECT_TRUE(large);
    }

    // It cracks where cells are small, and next to them.
    TEST(HangingMotion, LetCellsCrack)
    {
      for (const unsigned int p : {1u, 3u}) {
        auto overrides = of_degree<2>(
            p, {"Interface: all/strength=2", "Interface: all/toughness=0.02",
                "Interface: all/strength scatter=0.1",
                "Interface: all/friction=0.3",
                "Material: bulk/initial velocity x=0.2 * (x - 2)",
                "Material: bulk/initial velocity y=0.1 * (y - 1.5)",
                "Time/end=4"});
        Steps<2> run(refined_plate, overrides);
        const Parts<2> parts(overrides);
        const auto before = run.momentum();
        double residual = 0.;
        while (run.state.time < run.input->time.end) {
          residual = std::max(residual, run.step().balance_residual);
          ASSERT_GE(run.state.energy.kinetic, 0.);
        }
        const auto after = run.momentum();
        EXPECT_LT(residual, 1e-12);
        EXPECT_GT(run.state.energy.damage, 0.05 * run.state.initial_energy);
        const double size = std::sqrt(2. * run.state.initial_energy * 7. * 12.);
        for (unsigned int c = 0; c < 2; ++c)
          EXPECT_NEAR(after[c], before[c], 1e-12 * size);
        const auto held = run.leapfrog->held_faces();
        ASSERT_TRUE(held.has_value());
        EXPECT_GT(held->share, 1.); // it breaks everywhere else
        for (std::size_t i = 0; i < run.state.kind.size(); ++i)
          EXPECT_TRUE(!parts.hanging.held()[i] ||
                      run.state.kind[i] == PointKind::bonded);
      }
    }

    // What viscous materials take is what the bodies lose, and no momentum.
    template <int dim>
    void expect_loss(std::vector<std::string> overrides)
    {
      overrides.insert(
          overrides.end(),
          {"Material: bulk/initial velocity x=0.1 * sin(2 * y) * cos(x) + 0.2",
           "Material: bulk/initial velocity y=0.1 * x * cos(3 * y)",
           "Material: bulk/shear viscosity=1.5",
           "Material: bulk/bulk viscosity=3", "Time/front viscosity=0",
           "Time/end=1e4"});
      Steps<dim> run(refined_plate, overrides);
      const Parts<dim> parts(overrides);
      const auto before = momenta(run, parts);
      double residual = 0.;
      for (unsigned int k = 0; k < 400; ++k) {
        const double taken = run.state.energy.viscous;
        residual = std::max(residual,
                            run.step(k % 3 == 0 ? 0.4 : 1.).balance_residual);
        EXPECT_GE(run.state.energy.viscous, taken);
        EXPECT_GE(run.state.energy.kinetic, 0.);
        EXPECT_GE(run.state.energy.elastic, 0.);
      }
      EXPECT_LT(residual, 1e-12);
      EXPECT_GT(run.state.energy.viscous, 0.05 * run.state.initial_energy);
      const auto after = momenta(run, parts);
      for (unsigned int k = 0; k < 3; ++k)
        EXPECT_NEAR(after[k], before[k],
                    1e-12 * std::max(std::abs(before[0]), std::abs(before[2])));
    }

    TEST(HangingMotion, LoseWhatViscousMaterialsTake)
    {
      expect_loss<2>(of_degree<2>(1));
      expect_loss<2>(of_degree<2>(3));
      expect_loss<3>(of_degree<3>(2));
    }

    const std::string with_rigid = R"(
subsection Material: block
  set model              = rigid
  set density            = 20
  set where              = x > 3
  set initial velocity x = -0.1
end
)" + refined_plate;

    // Away from what hangs a rigid body does what it does elsewhere.
    TEST(HangingMotion, LeaveRigidBodiesAlone)
    {
      for (const unsigned int p : {1u, 2u}) {
        Steps<2> run(with_rigid,
                     of_degree<2>(p, {"Indicator: middle/region=x < 0.9",
                                      "Time/end=1e4"}));
        ASSERT_TRUE(run.leapfrog->held_faces().has_value());
        const auto before = run.momentum();
        double residual = 0.;
        for (unsigned int k = 0; k < 200; ++k)
          residual = std::max(residual, run.step().balance_residual);
        EXPECT_LT(residual, 1e-12);
        EXPECT_GT(run.state.energy.elastic, 1e-3 * run.state.initial_energy);
        const auto after = run.momentum();
        for (unsigned int c = 0; c < 2; ++c)
          EXPECT_NEAR(after[c], before[c], 1e-12 * std::abs(before[0]));
      }
    }

    TEST(HangingMotion, RefuseWhatCouldNotLast)
    {
      const auto problem = [](const std::vector<std::string> &overrides,
                              const std::string &text = refined_plate) {
        try {
          Steps<2> run(text, overrides);
        } catch (const std::invalid_argument &error) {
          return std::string(error.what());
        }
        return std::string("none");
      };
      EXPECT_EQ(problem({}), "none");
      EXPECT_NE(problem({}, with_rigid).find("is at a rigid cell"),
                std::string::npos);
      EXPECT_NE(problem({"Interface: all/law=xu-needleman",
                         "Adaptivity/springs=constant stiffness"})
                    .find("must be extrinsic"),
                std::string::npos);
      EXPECT_NE(problem({"Indicator: middle/type=energy"})
                    .find("does not change in a run"),
                std::string::npos);
    }
  } // namespace
} // namespace nsfd::test_hanging_motion
