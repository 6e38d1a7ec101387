#include "breathing_mode.h"
#include "make_scene.h"

#include "discretization/cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

// Axisymmetric scenes: x is the radius r, y the height z, all measures are per
// radian. Against formulas of full and hollow cylinders and of a penny-shaped
// crack; the round-off of linear solves is 1e-12 to 1e-11 of the motion.

namespace nsfd::test_axisymmetric
{
  namespace
  {
    using test::Scene;
    using Place = dealii::Point<2>;

    constexpr double E = 1., nu = 0.3, mu = E / (2. * (1. + nu)),
                     lambda = E * nu / ((1. + nu) * (1. - 2. * nu));

    /** A section of @p cells from @p lower to @p upper, "r, z" each. */
    std::string section(const std::string &lower, const std::string &upper,
                        const std::string &cells, const unsigned int degree,
                        const std::string &type = "rectangle")
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
subsection Discretization
  set degree = {}
end
)",
                         type, lower, upper, cells, degree);
    }

    std::string material(const std::string &rest = "")
    {
      return "subsection Material: body\n  set Young modulus = 1\n"
             "  set Poisson ratio = 0.3\n  set density = 1\n" +
             rest + "end\n";
    }

    std::string faces(const std::string &law)
    {
      return "subsection Interface: all\n  set law = " + law + "\nend\n";
    }

    /** Of a block, `displacement x = 0` and the like. */
    std::string side(const std::string &name, const std::string &entry)
    {
      return "subsection Boundary: " + name + "\n  set " + entry + "\nend\n";
    }

    const std::string held_ends = side("bottom", "displacement y = 0") +
                                  side("top", "displacement y = 0");

    const std::string slowly = R"(
subsection Time
  set scheme = quasi-static
  set end    = 1
  set step   = 1 s
end
)";

    std::string in_time(const std::string &step, const std::string &theta)
    {
      return fmt::format("subsection Time\n  set end = 1000\n  set step = {}\n"
                         "  set theta = {}\nend\n",
                         step, theta);
    }

    State equilibrium(Scene<2> &scene)
    {
      auto &statics = scene.equilibria->search();
      const State start = statics.start(scene.state);
      State next = start;
      const auto report = statics.advance(start, 1., next);
      EXPECT_LT(report.step.balance_residual, 1e-9);
      return next;
    }

    using Field = std::function<std::array<double, 2>(const Place &)>;

    /** Of a field of the bodies, relative, in L2 of the rings. */
    double error(const Scene<2> &scene, const std::vector<double> &unknowns,
                 const Field &exact)
    {
      double wrong = 0., all = 0.;
      scene.discretization->visit_quadrature(
          scene.discretization->to_nodal(unknowns),
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

    /** Integral over the bodies of a number of velocity and place. */
    double
    integral(const Scene<2> &scene, const std::vector<double> &unknowns,
             const std::function<double(const Place &, const double *)> &f)
    {
      double sum = 0.;
      scene.discretization->visit_quadrature(
          scene.discretization->to_nodal(unknowns),
          [&](unsigned int, const Place &x, const double JxW,
              const double *value,
              const double *) { sum += JxW * f(x, value); });
      return sum;
    }

    const std::vector<std::string> mesh_types = {"rectangle",
                                                 "diagonal triangles"};

    // A full cylinder of radius 1 and height 1/2: R^2 H / 2 per radian, its
    // side R H, its ends R^2 / 2; nothing is on the axis.
    TEST(Axisymmetric, MeasuresArePerRadian)
    {
      for (const std::string &type : mesh_types)
        for (const unsigned int degree : {1u, 2u}) {
          const Scene<2> scene(section("0, 0", "1, 0.5", "4, 3", degree, type) +
                               material() + faces("joined") +
                               side("right", "displacement x = 0") +
                               side("top", "displacement y = 0") +
                               side("left", "displacement x = 0") + slowly);
          const auto &mesh = *scene.discretization;
          double volume = 0.;
          std::array<double, 2> area{};
          for (std::size_t b = 0; b < mesh.bodies().size(); ++b)
            volume += mesh.cells().volume(b);
          for (std::size_t i = 0; i < mesh.points().n_owned; ++i)
            if (mesh.origins()[i].kind == PointOrigin::Kind::motion) {
              ASSERT_NE(mesh.origins()[i].block, 2u);
              area[mesh.origins()[i].block] += mesh.points().weight[i];
            }
          // cells of one shape are one, to the round-off of their places
          EXPECT_NEAR(volume, 0.25, 1e-13);
          EXPECT_NEAR(area[0], 0.5, 1e-13);
          EXPECT_NEAR(area[1], 0.5, 1e-13);
        }
    }

    // u_r = a r, u_z = b z is a uniform strain: every mesh has it exactly, with
    // the stress (2 lambda + 2 mu) a + lambda b along r and the hoops.
    TEST(Axisymmetric, PatchTest)
    {
      const double a = 0.01, b = -0.02;
      for (const std::string &type : mesh_types)
        for (const unsigned int degree : {1u, 2u, 3u})
          for (const std::string law : {"joined", "rigid"}) {
            if (degree == 3 && type != "rectangle")
              continue;
            SCOPED_TRACE(fmt::format("{} {} {}", type, degree, law));
            Scene<2> scene(section("0, 0", "1, 0.5", "4, 3", degree, type) +
                           material() + faces(law) +
                           side("right", "displacement x = 0.01 * t") +
                           side("bottom", "displacement y = 0") +
                           side("top", "displacement y = -0.01 * t") + slowly);
            const State state = equilibrium(scene);
            EXPECT_LT(
                error(scene, state.displacement,
                      [&](const Place &x) {
                        return std::array<double, 2>{{a * x[0], b * x[1]}};
                      }),
                1e-12);
            const double rr = 2. * (lambda + mu) * a + lambda * b,
                         zz = 2. * lambda * a + (lambda + 2. * mu) * b;
            const auto check = [&](const unsigned int body, const Place &x,
                                   const double *u, const double *gradient) {
              const auto s = scene.discretization->stress(body, x, u, gradient);
              EXPECT_NEAR(s[0], rr, 1e-11 * std::abs(zz));
              EXPECT_NEAR(s[1], zz, 1e-11 * std::abs(zz));
              EXPECT_NEAR(s[2], rr, 1e-11 * std::abs(zz));
              EXPECT_NEAR(s[3], 0., 1e-11 * std::abs(zz));
            };
            scene.discretization->visit_quadrature(
                scene.discretization->to_nodal(state.displacement),
                [&](const unsigned int body, const Place &x, double,
                    const double *u,
                    const double *gradient) { check(body, x, u, gradient); });
            const double at_axis[] = {0., 0.}, uniform[] = {a, 0., 0., b};
            check(0, Place(0., 0.2), at_axis, uniform);
            // energy per radian: s:e / 2 times R^2 H / 2
            EXPECT_NEAR(state.energy.elastic,
                        0.25 * (2. * rr * a + zz * b) / 2.,
                        1e-12 * state.energy.elastic);
          }
    }

    // A long full cylinder that spins at omega, by its centrifugal force:
    // u_r = C ((3 - 2 nu) R^2 r - r^3), C = rho omega^2 / (8 (lambda + 2 mu)),
    // a polynomial of degree 3.
    TEST(Axisymmetric, SpinningCylinderIsExact)
    {
      for (const std::string law : {"joined", "rigid"}) {
        Scene<2> scene(section("0, 0", "1, 0.5", "3, 2", 3) +
                       material("  set body force x = x * t\n") + faces(law) +
                       held_ends + slowly);
        const State state = equilibrium(scene);
        const double C = 1. / (8. * (lambda + 2. * mu));
        // cells are distorted: of them only bilinear maps of r^3 are exact
        EXPECT_LT(error(scene, state.displacement,
                        [&](const Place &x) {
                          const double r = x[0];
                          return std::array<double, 2>{
                              {C * ((3. - 2. * nu) * r - r * r * r), 0.}};
                        }),
                  1e-11);
      }
    }

    // A tube of radii 1 and 2 under pressure inside (Lame): half the size of
    // the cells, 2^(p + 1) less of the error.
    TEST(Axisymmetric, TubeConvergesWithOrderPPlus1)
    {
      const auto tube = [&](const std::string &type, const unsigned int degree,
                            const unsigned int refinements) {
        Scene<2> scene(section("1, 0", "2, 0.5", "4, 2", degree, type) +
                           material() + faces("joined") + held_ends +
                           side("left", "pressure = t") + slowly,
                       {fmt::format("Mesh/refinements={}", refinements)});
        const State state = equilibrium(scene);
        return error(scene, state.displacement, [](const Place &x) {
          return std::array<double, 2>{
              {(1. + nu) / 3. * ((1. - 2. * nu) * x[0] + 4. / x[0]), 0.}};
        });
      };
      for (const std::string &type : mesh_types)
        for (const unsigned int degree : {1u, 2u, 3u}) {
          if (degree == 3 && type != "rectangle")
            continue;
          const double coarse = tube(type, degree, 2),
                       fine = tube(type, degree, 3);
          EXPECT_LT(fine, 1e-2);
          EXPECT_NEAR(std::log2(coarse / fine), degree + 1., 0.2)
              << type << " " << degree << ": " << coarse << ", " << fine;
        }
    }

    // As a whole along z nothing strains, and what strains keeps its momentum
    // along z.
    TEST(Axisymmetric, MomentumAlongTheAxis)
    {
      const std::string flying = "  set initial velocity y = 1\n",
                        strained =
                            "  set initial velocity y = sin(3 * x) * y\n"
                            "  set initial velocity x = x * cos(2 * y)\n";
      for (const std::string theta : {"0.5", "0.7", "1"})
        for (const std::string law : {"joined", "rigid"})
          for (const std::string &motion : {flying, strained}) {
            SCOPED_TRACE(theta + law + motion);
            Scene<2> scene(section("0, 0", "1, 1", "4, 4", 2) +
                           material(motion) + faces(law) +
                           in_time("0.5 courant", theta));
            const auto momentum = [&] {
              return integral(
                  scene, scene.state.velocity,
                  [](const Place &, const double *v) { return v[1]; });
            };
            const double before = momentum(), kinetic = scene.energy();
            for (unsigned int step = 0; step < 20; ++step)
              EXPECT_LT(scene.advance().balance_residual, 1e-9);
            EXPECT_NEAR(momentum(), before, 1e-12);
            if (motion != flying) {
              EXPECT_GT(scene.state.energy.elastic, 1e-3 * kinetic);
              continue;
            }
            EXPECT_NEAR(before, 0.5, 1e-13);
            EXPECT_NEAR(scene.state.energy.kinetic, 0.25, 1e-12);
            EXPECT_LT(scene.state.energy.elastic, 1e-13);
          }
    }

    // The lowest radial mode of a full cylinder whose length is held:
    // u_r = J_1(k r), (lambda + 2 mu) k R J_0(k R) = 2 mu J_1(k R). The
    // trapezoidal rule turns it in each step by 2 atan(omega h / 2).
    TEST(Axisymmetric, BreathingMode)
    {
      const test::BreathingMode mode(lambda, mu);
      const std::string &bessel = mode.formula;
      const double k = mode.k, omega = k * std::sqrt(lambda + 2. * mu);
      const auto left_after = [&](const unsigned int refinements) {
        Scene<2> scene(
            section("0, 0", "1, 0.5", "3, 2", 2) +
                material("  set initial velocity x = " + bessel + "\n") +
                faces("joined") + held_ends + in_time("0.05 s", "0.5"),
            {fmt::format("Mesh/refinements={}", refinements)});
        unsigned int n = 0;
        for (; n < 60; ++n)
          scene.advance();
        const double turn = std::cos(2. * n * std::atan(omega * 0.05 / 2.));
        return error(scene, scene.state.velocity, [&](const Place &x) {
          return std::array<double, 2>{
              {turn * std::cyl_bessel_j(1., k * x[0]), 0.}};
        });
      };
      const double coarse = left_after(0), fine = left_after(1);
      EXPECT_LT(fine, 1e-3);
      EXPECT_GT(std::log2(coarse / fine), 2.5) << coarse << " " << fine;
    }

    // A cylinder falls on a rough plane, breaks and rubs: energies of the
    // balance are those of its matrices, and nothing is lost.
    TEST(Axisymmetric, BreakingKeepsTheBalance)
    {
      const std::string body =
          material("  set initial velocity y = -0.25\n"
                   "  set initial velocity x = 0.3 * x * y\n") +
          R"(subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 0.05
  set toughness = 1e-4
  set friction  = 0.3
end
subsection Obstacle: ground
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.5
end
)";
      for (const std::string theta : {"0.5", "1"}) {
        SCOPED_TRACE(theta);
        Scene<2> scene(section("0, 0", "1, 1", "5, 5", 1) + body +
                       in_time("0.3 courant", theta));
        const double start = scene.energy();
        double worst = 0.;
        for (unsigned int step = 0; step < 80; ++step) {
          scene.advance_bisecting();
          const EnergyLines &e = scene.state.energy;
          const double kinetic = integral(
              scene, scene.state.velocity, [](const Place &, const double *v) {
                return (v[0] * v[0] + v[1] * v[1]) / 2.;
              });
          EXPECT_NEAR(e.kinetic, kinetic, 1e-12 * start);
          worst = std::max(worst,
                           std::abs(scene.energy() + e.damage + e.friction +
                                    e.impact + e.numerical - e.work - start));
        }
        EXPECT_LT(worst, 1e-9 * start);
        EXPECT_GT(scene.state.energy.damage, 1e-4 * start);
        EXPECT_GT(scene.state.energy.friction, 1e-4 * start);
        unsigned int broken = 0;
        for (std::size_t i = 0; i < scene.state.beta.size(); ++i)
          broken += scene.discretization->origins()[i].kind ==
                        PointOrigin::Kind::interface &&
                    scene.state.beta[i] == 0.;
        EXPECT_GT(broken, 0u);
      }
    }

    // A penny-shaped crack of radius a in a large cylinder, opened by the
    // pressure p (Sneddon 1946): its width is w = 8 (1 - nu^2) p a / (pi E)
    // sqrt(1 - r^2 / a^2), its volume 16 (1 - nu^2) p a^3 / (3 E), and with
    // p dV / 2 = G dA, K_I = 2 p sqrt(a / pi). The cylinder of radius and half
    // height 10 a changes V by the order of (a / R)^3 = 0.1 %.
    TEST(Axisymmetric, PennyShapedCrack)
    {
      const double pi = std::acos(-1.), step = 0.05;
      const auto volume = [&](const double a, double &width) {
        Scene<2> scene(fmt::format(R"(set dimension = 2
set plane = axisymmetric
subsection Mesh
  set type         = isotropic
  set lower corner = 0, -10
  set upper corner = 10, 10
  set lines        = inner: [0, 0], [{0}, 0]; outer: [{0}, 0], [{1}, 0]
  set size         = max(0.008, 0.12 * (sqrt((x - 1)^2 + y^2) - 0.05))
  set split        = none
end
subsection Discretization
  set degree = 2
end
subsection Interface: crack
  set where          = abs(y) < 1e-6 && x < {2}
  set law            = contact
  set crack pressure = 1
end
)",
                                   1. - step, 1. + step, a) +
                       material() + faces("joined") +
                       side("bottom", "displacement y = 0") + slowly);
        const State state = equilibrium(scene);
        const auto &points = scene.discretization->points();
        double sum = 0., smallest = 10.;
        for (std::size_t i = 0; i < points.n_points; ++i)
          if (state.kind[i] == PointKind::free) {
            sum += points.weight[i] * std::abs(state.jump[2 * i]);
            if (points.position[2 * i] < smallest) {
              smallest = points.position[2 * i];
              width = std::abs(state.jump[2 * i]) /
                      std::sqrt(1. - smallest * smallest / (a * a));
            }
          }
        return 2. * pi * sum;
      };
      double width_1, width_2;
      const double V_1 = volume(1. - step, width_1),
                   V_2 = volume(1. + step, width_2);
      const double stiff = E / (1. - nu * nu);
      const auto exact = [&](const double a) {
        return 16. * a * a * a / (3. * stiff);
      };
      EXPECT_NEAR(V_1 / exact(1. - step), 1., 0.005);
      EXPECT_NEAR(V_2 / exact(1. + step), 1., 0.005);
      EXPECT_NEAR(width_1 / (8. * (1. - step) / (pi * stiff)), 1., 0.005);
      const double G = (V_2 - V_1) / 2. / (4. * pi * step);
      EXPECT_NEAR(std::sqrt(stiff * G) / (2. / std::sqrt(pi)), 1., 0.005);
    }

    struct Refused {
      std::string rest; ///< of the scene
      std::string sentence;
    };

    // What cannot be is said at once, and all of it.
    TEST(Axisymmetric, Refusals)
    {
      const std::string mesh = "set dimension = 2\nset plane = axisymmetric\n"
                               "subsection Mesh\n  set upper corner = 1, 1\n"
                               "  set cells = 2, 2\nend\n",
                        rest = faces("joined") + in_time("0.5 courant", "0.5");
      const std::vector<Refused> cases = {
          {"set motion = large\n" + material(),
           "motion = large has explicit steps alone"},
          {material() + "subsection Loads\n  set gravity = 9.81, 0\nend\n",
           "has a part across the axis"},
          {"subsection Material: body\n  set model = rigid\n"
           "  set density = 1\nend\n",
           "no rigid bodies"},
          {"subsection Material: body\n  set model = j2 plastic\n"
           "  set Young modulus = 1\n  set Poisson ratio = 0\n"
           "  set yield stress = 1\n  set density = 1\nend\n",
           "do not know the strain along the hoops"},
          {material() + "subsection Discretization\n"
                        "  set interface quadrature = gauss lobatto\nend\n",
           "would have no area"},
          {material() + "subsection Discretization\n  set degree = 2\n"
                        "  set mass = lumped\nend\n",
           "would have no mass"},
          {material() + "subsection Observable: G\n"
                        "  set type = energy release rate\n  set at = 0.5, 0\n"
                        "  set radii = 0.2, 0.3\nend\n",
           "its integrals are those of the plane"},
      };
      for (const Refused &one : cases) {
        const std::string text = mesh + one.rest + rest;
        InputErrors errors;
        EXPECT_FALSE(read_scene_text(text, "test.prm", {}, errors));
        EXPECT_NE(errors.report().find(one.sentence), std::string::npos)
            << errors.report();
      }
      try {
        const Scene<2> scene(section("-0.5, 0", "0.5, 1", "2, 2", 1) +
                             material() + rest);
        ADD_FAILURE() << "cells behind the axis were taken";
      } catch (const std::invalid_argument &error) {
        EXPECT_NE(std::string(error.what()).find("reaches to (-0.5, "),
                  std::string::npos)
            << error.what();
      }
    }
  } // namespace
} // namespace nsfd::test_axisymmetric
