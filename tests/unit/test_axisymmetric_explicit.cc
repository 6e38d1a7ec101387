#include "breathing_mode.h"
#include "leapfrog_steps.h"

#include "discretization/body_frequency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

// Explicit steps of joined rings: x is the radius r, y the height z, all
// measures are per radian. Against formulas of rings and cylinders, and against
// implicit steps. Sums of round-off are 1e-12 of what is compared.

namespace nsfd::test_axisymmetric_explicit
{
  namespace
  {
    using test::Steps;
    using Place = dealii::Point<2>;

    constexpr double E = 1., nu = 0.3, mu = E / (2. * (1. + nu)),
                     lambda = E * nu / ((1. + nu) * (1. - 2. * nu));

    struct Section {
      std::string upper, cells, type = "rectangle", lower = "0, 0";
    };

    /** Of a mesh with distorted cells, in explicit steps. */
    std::string scene(const Section &section, const std::string &motion,
                      const std::string &faces)
    {
      return fmt::format(R"(set dimension = 2
set plane = axisymmetric
subsection Mesh
  set type         = {}
  set lower corner = {}
  set upper corner = {}
  set cells        = {}
  set distortion   = 0.2
end
subsection Material: body
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
{}end
subsection Interface: all
{}end
subsection Time
  set end    = 1000
  set step   = auto
  set scheme = explicit
end
)",
                         section.type, section.lower, section.upper,
                         section.cells, motion, faces);
    }

    const std::vector<std::string> mesh_types = {
        "rectangle", "diagonal triangles", "crossed triangles"};

    const std::string joined = "  set law = joined\n";
    const std::string breaks = R"(  set law       = camacho-ortiz
  set strength  = 0.05
  set toughness = 1e-4
  set friction  = 0.3
)";
    const std::string held_ends = R"(subsection Boundary: bottom
  set displacement y = 0
end
subsection Boundary: top
  set displacement y = 0
end
)";

    using Field = std::function<std::array<double, 2>(const Place &)>;

    /** Of the displacement, relative, in L2 of the rings. */
    double error(Steps<2> &run, const Field &exact)
    {
      run.show();
      double wrong = 0., all = 0.;
      run.discretization->visit_quadrature(
          run.discretization->to_nodal(run.state.displacement),
          [&](unsigned int, const Place &x, const double JxW,
              const double *value, const double *) {
            const auto known = exact(x);
            for (unsigned int c = 0; c < 2; ++c) {
              wrong += JxW * (value[c] - known[c]) * (value[c] - known[c]);
              all += JxW * known[c] * known[c];
            }
          });
      return std::sqrt(wrong / all);
    }

    // Points of faces are at nodes, also on the axis, and have the areas of
    // their nodes: the sum over a section is its area, R^2 / 2 per radian.
    TEST(AxisymmetricExplicit, PointsHaveTheAreaOfTheirFace)
    {
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        Steps<2> run(scene({"1, 0.5", "4, 3", type}, "", joined) + held_ends);
        const auto &points = run.discretization->points();
        const auto &origins = run.discretization->origins();
        double area = 0., length = 0.;
        unsigned int on_axis = 0;
        for (std::size_t i = 0; i < points.n_points; ++i) {
          EXPECT_GT(points.weight[i], 0.);
          if (origins[i].kind != PointOrigin::Kind::motion)
            continue;
          area += points.weight[i];
          length += points.measure(i);
          on_axis += points.position[2 * i] < 1e-12;
        }
        EXPECT_NEAR(area, 2. * 0.5, 1e-13);
        EXPECT_NEAR(length, 2. * 1., 1e-13);
        EXPECT_EQ(on_axis, 2u);
      }
    }

    // u_r = a r under the pressure 2 (lambda + mu) a, u_z = 0: every mesh has
    // this equilibrium exactly and stays in it.
    TEST(AxisymmetricExplicit, UniformStrainIsAnEquilibrium)
    {
      const double pressure = 0.01;
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        Steps<2> run(scene({"1, 0.5", "4, 3", type}, "", joined) + held_ends +
                         "subsection Boundary: right\n  set pressure = 0.01\n"
                         "end\n",
                     {"Time/start=equilibrium"});
        const double a = -pressure / (2. * (lambda + mu));
        const auto exact = [a](const Place &x) {
          return std::array<double, 2>{{a * x[0], 0.}};
        };
        EXPECT_LT(error(run, exact), 1e-10);
        // energy per radian: (rr + hoop) a / 2 times R^2 H / 2
        EXPECT_NEAR(run.state.energy.elastic, -2. * pressure * a / 2. * 0.25,
                    1e-10 * pressure * -a);
        for (unsigned int step = 0; step < 50; ++step)
          run.step();
        EXPECT_LT(error(run, exact), 1e-10);
        EXPECT_LT(run.state.energy.kinetic, 1e-18 * run.state.energy.elastic);
      }
    }

    // As a whole along z nothing strains; what breaks by its own motion keeps
    // its momentum along z and its energy.
    TEST(AxisymmetricExplicit, KeepsMomentumAlongTheAxis)
    {
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        Steps<2> flying(scene({"1, 1", "5, 5", type},
                              "  set initial velocity y = 1\n", breaks));
        for (unsigned int step = 0; step < 50; ++step)
          flying.step();
        EXPECT_NEAR(flying.momentum()[1], 0.5, 1e-12);
        // round-off of displacements of 1
        EXPECT_LT(flying.state.energy.elastic, 1e-13);

        Steps<2> run(scene({"1, 1", "5, 5", type},
                           "  set initial velocity x = 0.2 * x * cos(2 * y)\n"
                           "  set initial velocity y = 0.1 + 0.4 * y * y\n",
                           breaks));
        const double before = run.momentum()[1],
                     start = run.state.initial_energy;
        double residual = 0.;
        for (unsigned int step = 0; step < 150; ++step) {
          residual = std::max(residual, run.step().balance_residual);
          ASSERT_GE(run.state.energy.kinetic, 0.);
          ASSERT_GE(run.state.energy.elastic, 0.);
        }
        const EnergyLines &e = run.state.energy;
        EXPECT_NEAR(run.momentum()[1], before, 1e-12 * before);
        EXPECT_LT(residual, 1e-12);
        EXPECT_NEAR(run.energy() + e.damage + e.friction + e.impact +
                        e.numerical + e.viscous,
                    start, 1e-11 * start);
        EXPECT_GT(e.damage, 1e-3 * start);
        // what the velocities say, halfway between the places
        const auto &cells = run.discretization->cells();
        for (std::size_t b = 0; b < cells.bodies.size(); ++b)
          for (unsigned int i = 0; i < cells.class_shape(b).n_nodes; ++i) {
            const std::size_t k = cells.bodies.first_dof[b] + 2 * i;
            if (cells.class_shape(b).on_axis[i]) {
              ASSERT_EQ(run.state.velocity[k], 0.);
              ASSERT_EQ(run.state.displacement[k], 0.);
            }
          }
      }
    }

    // A cylinder falls on a rough plane, breaks and rubs.
    TEST(AxisymmetricExplicit, BreakingOnAPlaneKeepsTheBalance)
    {
      const std::string ground = R"(subsection Obstacle: ground
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.5
end
)";
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        Steps<2> run(scene({"1, 1", "5, 5", type},
                           "  set initial velocity y = -0.25\n"
                           "  set initial velocity x = 0.3 * x * y\n",
                           breaks) +
                     ground);
        double residual = 0., gift = 0.;
        for (unsigned int step = 0; step < 200; ++step) {
          const EnergyLines before = run.state.energy;
          residual = std::max(residual, run.step().balance_residual);
          for (const auto line : {&EnergyLines::damage, &EnergyLines::friction,
                                  &EnergyLines::impact})
            gift = std::max(gift, before.*line - run.state.energy.*line);
        }
        const EnergyLines &e = run.state.energy;
        const double start = run.state.initial_energy;
        EXPECT_LT(residual, 1e-12);
        EXPECT_LT(gift, 1e-13 * start);
        EXPECT_GT(e.damage, 1e-3 * start);
        EXPECT_GT(e.friction, 1e-4 * start);
        EXPECT_LT(std::abs(e.numerical), 1e-3 * e.damage);
        EXPECT_LT(run.state.penetration, 1e-12);
      }
    }

    // One section of a full cylinder breaks: toughness times R^2 / 2, whatever
    // the step, the part of the axis included.
    TEST(AxisymmetricExplicit, TakesTheToughnessOfTheArea)
    {
      for (const double share : {1., 0.5}) {
        Steps<2> run(scene({"1, 2", "5, 10"}, "",
                           "  set where     = abs(y - 1) < 1e-6\n"
                           "  set law       = camacho-ortiz\n"
                           "  set strength  = 0.01\n  set toughness = 1e-4\n") +
                         "subsection Interface: others\n  set law = joined\n"
                         "end\n"
                         "subsection Boundary: bottom\n"
                         "  set velocity y = -0.02\nend\n"
                         "subsection Boundary: top\n"
                         "  set velocity y = 0.02\nend\n",
                     {"Mesh/distortion=0"});
        while (run.state.time < 5.)
          run.step(share);
        // the second chain of a point starts at 1e-9 of its law
        EXPECT_NEAR(run.state.energy.damage, 1e-4 / 2., 1e-9 * 1e-4);
      }
    }

    // The lowest radial mode of a full cylinder whose length is held:
    // u_r = J_1(k r), (lambda + 2 mu) k R J_0(k R) = 2 mu J_1(k R). With
    // omega h = 2 sin(theta / 2) the scheme has q_n = h v_0 sin(n theta) /
    // sin(theta): what is left is the error of the cells, of order 2.
    TEST(AxisymmetricExplicit, BreathingMode)
    {
      const test::BreathingMode mode(lambda, mu);
      const std::string &bessel = mode.formula;
      const double k = mode.k, omega = k * std::sqrt(lambda + 2. * mu),
                   h = 0.01;
      const auto left_after = [&](const std::string &type,
                                  const unsigned int refinements) {
        Steps<2> run(scene({"1, 0.5", "6, 3", type},
                           "  set initial velocity x = " + bessel + "\n",
                           joined) +
                         held_ends,
                     {fmt::format("Mesh/refinements={}", refinements),
                      fmt::format("Time/step={} s", h)});
        const unsigned int n = 150; // 0.5 periods
        for (unsigned int step = 0; step < n; ++step)
          run.step();
        const double theta = 2. * std::asin(omega * h / 2.),
                     q = h * std::sin(n * theta) / std::sin(theta);
        return error(run, [&](const Place &x) {
          return std::array<double, 2>{
              {q * std::cyl_bessel_j(1., k * x[0]), 0.}};
        });
      };
      for (const std::string &type : mesh_types) {
        const double coarse = left_after(type, 0), fine = left_after(type, 1);
        EXPECT_LT(fine, 0.01) << type;
        EXPECT_GT(std::log2(coarse / fine), 1.7)
            << type << " " << coarse << " " << fine;
      }
    }

    // A thin ring of radius 1 that is set moving outwards is a spring of
    // E A / R^2 for its mass rho A R: u_r = v / omega sin(omega t), omega =
    // sqrt(E / rho) / R. The thickness t changes omega^2 by some (t / R)^2.
    TEST(AxisymmetricExplicit, RingThatIsThrownOutwards)
    {
      Steps<2> run(scene({"1.01, 0.02", "2, 2", "rectangle", "0.99, 0"},
                         "  set initial velocity x = 0.01\n", joined),
                   {"Mesh/distortion=0"});
      double largest = 0., when = 0.;
      const double quarter = std::acos(0.);
      while (run.state.time < 1.2 * quarter) {
        EXPECT_LT(run.step().balance_residual, 1e-12);
        run.show();
        double mean = 0.;
        for (std::size_t i = 0; i < run.state.displacement.size(); i += 2)
          mean += run.state.displacement[i] * 2. /
                  double(run.state.displacement.size());
        if (mean > largest) {
          largest = mean;
          when = run.state.time;
        }
      }
      EXPECT_NEAR(largest, 0.01, 1e-3 * 0.01);
      EXPECT_NEAR(when, quarter, 2e-3 * quarter + run.time_step);
    }

    // Distorted cells at the axis at the longest step keep their energy; the
    // bound is that of the cell with the highest frequency, whose stiffness
    // along the hoops makes it higher than that of the same cell in the plane.
    TEST(AxisymmetricExplicit, TheStableStepIsStable)
    {
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        const std::string text =
            scene({"1, 1", "6, 6", type},
                  "  set initial velocity x = x * sin(40 * y)\n"
                  "  set initial velocity y = cos(50 * x)\n",
                  joined);
        const std::vector<std::string> sharp = {"Time/front viscosity=0"};
        Steps<2> run(text, sharp);
        const double omega = highest_frequency(run.discretization->cells());
        const double share = 0.999 * 2. / omega / run.time_step;
        run.step(share);
        const EnergyLines &e = run.state.energy;
        const double energy = e.kinetic + e.elastic;
        for (unsigned int step = 0; step < 500; ++step) {
          run.step(share);
          ASSERT_NEAR(e.kinetic + e.elastic, energy, 1e-11 * energy);
          ASSERT_GE(e.kinetic, 0.);
        }
      }
      const std::string one =
          scene({"1.1, 1", "1, 1", "rectangle", "0.1, 0"}, "", joined);
      const Steps<2> ring(one), plate(one, {"plane=strain"});
      EXPECT_GT(highest_frequency(ring.discretization->cells()),
                1.01 * highest_frequency(plate.discretization->cells()));
    }

    // Smooth motions: explicit and implicit steps are of order 2, and so is
    // their difference.
    TEST(AxisymmetricExplicit, ImplicitStepsGiveTheSame)
    {
      const auto places = [](const std::string &type, const std::string &scheme,
                             const double h) {
        Steps<2> run(scene({"1, 1", "4, 4", type},
                           "  set initial velocity x = 0.1 * x * cos(2 * y)\n"
                           "  set initial velocity y = 0.2 * sin(3 * x) * y\n",
                           joined),
                     {"Time/scheme=" + scheme, "Discretization/mass=lumped",
                      fmt::format("Time/step={} s", h)});
        while (run.state.time < 1. - h / 2.)
          run.step();
        run.show();
        return run.state.displacement;
      };
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        std::array<double, 2> difference{};
        double size = 0.;
        for (const unsigned int k : {0u, 1u}) {
          const double h = 0.01 / (k + 1.);
          const auto one = places(type, "explicit", h),
                     other = places(type, "moreau-jean", h);
          ASSERT_EQ(one.size(), other.size());
          for (std::size_t i = 0; i < one.size(); ++i) {
            difference[k] += (one[i] - other[i]) * (one[i] - other[i]);
            size += one[i] * one[i];
          }
        }
        EXPECT_LT(std::sqrt(difference[1] / size), 1e-3);
        EXPECT_NEAR(std::log2(difference[0] / difference[1]) / 2., 2., 0.2);
      }
    }

    // A long bar without lateral contraction strikes a wall: rho c v on its
    // section R^2 / 2 until the wave is back, then it leaves as fast as it
    // came.
    TEST(AxisymmetricExplicit, BarStrikesAWall)
    {
      Steps<2> run(scene({"0.1, 1", "3, 60"},
                         "  set initial velocity y = -0.01\n", joined) +
                       "subsection Obstacle: wall\n  set point = 0, 0\n"
                       "  set normal = 0, 1\nend\n",
                   {"Material: body/Poisson ratio=0", "Mesh/distortion=0"});
      const double before = run.momentum()[1];
      double residual = 0., half = 0.;
      while (run.state.time < 2.2) {
        residual = std::max(residual, run.step().balance_residual);
        if (half == 0. && run.state.time >= 1.)
          half = run.momentum()[1];
      }
      EXPECT_LT(residual, 1e-12);
      // the first half of the time stops it; a node has a step to be stopped
      EXPECT_LT(std::abs(half), 0.02 * std::abs(before));
      EXPECT_NEAR(run.momentum()[1], -before, 0.02 * std::abs(before));
    }

    TEST(AxisymmetricExplicit, OfDegreeOneAlone)
    {
      InputErrors errors;
      EXPECT_FALSE(read_scene_text(scene({"1, 1", "2, 2"}, "", joined),
                                   "test.prm", {"Discretization/degree=2"},
                                   errors));
      EXPECT_NE(errors.report().find("nodes on the axis of plane = "
                                     "axisymmetric would have no lumped"),
                std::string::npos)
          << errors.report();
    }
  } // namespace
} // namespace nsfd::test_axisymmetric_explicit
