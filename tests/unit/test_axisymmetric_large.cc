#include "leapfrog_steps.h"

#include "joined/finite_forces.h"
#include "nsfd/materials/hyperelastic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

// Explicit steps of axisymmetric bodies that are no linear function of their
// motion: large ones, and small ones with plastic flow.

namespace nsfd::test_axisymmetric_large
{
  namespace
  {
    using test::Steps;

    /** A full cylinder of radius 1 and height 1. */
    std::string scene(const std::string &type, const std::string &model,
                      const std::string &rest = "")
    {
      return fmt::format(R"(set dimension = 2
set plane = axisymmetric
set motion = large
subsection Mesh
  set type         = {}
  set upper corner = 1, 1
  set cells        = 4, 4
  set distortion   = 0.2
end
subsection Material: body
  set model         = {}
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: all
  set law = joined
end
subsection Time
  set end    = 1000
  set step   = auto
  set scheme = explicit
end
{})",
                         type, model, rest);
    }

    const std::vector<std::string> mesh_types = {"rectangle",
                                                 "crossed triangles"};
    const std::string elastic = "neo-hookean",
                      flowing = "j2 plastic\n  set yield stress = 0.004\n"
                                "  set isotropic hardening modulus = 0.01";

    /** Cells with groups of their corners, all joined. */
    struct JoinedRings {
      explicit JoinedRings(const std::string &text)
          : scene(text), mesh(*scene.discretization),
            groups(mesh, std::vector<std::uint8_t>(
                             scene.discretization->points().n_points, 1)),
            forces(*scene.discretization, mesh, FrontViscosity()),
            on_axis(groups.size(), 0), at_rim(groups.size(), 0),
            place(groups.size())
      {
        const auto &cells = scene.discretization->cells();
        for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
          const auto &shape = cells.class_shape(b);
          for (unsigned int i = 0; i < shape.n_nodes; ++i) {
            const unsigned int g = groups.of(cells.first_node[b] + i);
            const auto x = place[g] = cells.place(b, shape.nodes[i]);
            on_axis[g] = shape.on_axis[i];
            at_rim[g] = x[0] > 1. - 1e-9 || x[1] < 1e-9 || x[1] > 1. - 1e-9;
          }
        }
      }

      double energy()
      {
        forces.set_forces(groups);
        EXPECT_LT(forces.inverted(), 0);
        return std::accumulate(forces.stored().begin(), forces.stored().end(),
                               0.);
      }

      test::Scene<2> scene;
      JoinedMesh<2> mesh;
      CornerGroups<2> groups;
      FiniteForces<2, 3> forces;
      std::vector<char> on_axis, at_rim; ///< by group
      std::vector<dealii::Point<2>> place;
    };

    // f = -dU/dq, also after some of the cells have flown; nothing along z in
    // all, and nothing along r on the axis.
    TEST(AxisymmetricLarge, ForcesAreThoseOfAnEnergy)
    {
      for (const std::string &type : mesh_types)
        for (const std::string &model : {elastic, flowing}) {
          SCOPED_TRACE(type + " " + model);
          JoinedRings rings(scene(type, model));
          auto &q = rings.groups.displacement;
          std::mt19937 engine(7);
          std::uniform_real_distribution<double> random(-1., 1.);
          const auto move = [&](const double way) {
            for (std::size_t k = 0; k < q.size(); ++k)
              q[k] += k % 2 == 0 && rings.on_axis[k / 2] ? 0.
                                                         : way * random(engine);
          };
          rings.energy();
          move(0.02);
          rings.forces.histories().begin_step(1e-6);
          rings.energy();
          double taken = 0.;
          for (const double x : rings.forces.taken())
            taken += x;
          EXPECT_EQ(taken > 0., model == flowing);
          move(1e-4);
          rings.energy();
          const std::vector<double> force = rings.groups.force, place = q;
          double largest = 0., along = 0.;
          for (std::size_t k = 0; k < force.size(); ++k) {
            largest = std::max(largest, std::abs(force[k]));
            along += k % 2 == 1 ? force[k] : 0.;
          }
          EXPECT_LT(std::abs(along), 1e-13 * largest * double(force.size()));
          for (std::size_t k = 0; k < force.size(); ++k) {
            if (k % 2 == 0 && rings.on_axis[k / 2]) {
              EXPECT_EQ(force[k], 0.);
              continue;
            }
            constexpr double way = 1e-5; // of the third order in it
            double ends[2];
            for (const int side : {0, 1}) {
              q = place;
              q[k] += way * (2 * side - 1);
              ends[side] = rings.energy();
            }
            EXPECT_NEAR(force[k], -(ends[1] - ends[0]) / (2. * way),
                        1e-6 * largest);
          }
        }
    }

    // F = diag(1 + a, 1 + b, 1 + a) everywhere: the energy of neo-Hooke times
    // R^2 H / 2 per radian, and no force but at the surface.
    TEST(AxisymmetricLarge, UniformStretch)
    {
      const double a = 0.3, b = -0.4;
      for (const std::string &type : mesh_types) {
        SCOPED_TRACE(type);
        JoinedRings rings(scene(type, elastic));
        for (std::size_t g = 0; g < rings.place.size(); ++g) {
          rings.groups.displacement[2 * g] = a * rings.place[g][0];
          rings.groups.displacement[2 * g + 1] = b * rings.place[g][1];
        }
        const double r = (1. + a) * (1. + a), z = (1. + b) * (1. + b);
        const double W =
            make_neo_hooke<3>(1., 0.3)->energy({{r, z, r, 0., 0., 0.}});
        EXPECT_NEAR(rings.energy(), W / 2., 1e-12 * W);
        const auto &f = rings.groups.force;
        double largest = 0., inside = 0.;
        for (std::size_t k = 0; k < f.size(); ++k)
          (rings.at_rim[k / 2] ? largest : inside) =
              std::max(rings.at_rim[k / 2] ? largest : inside, std::abs(f[k]));
        EXPECT_GT(largest, 1e-3);
        EXPECT_LT(inside, 1e-13);
      }
    }

    // What flies, strains and flows keeps its momentum along z; the axis stays
    // where it is.
    TEST(AxisymmetricLarge, KeepsMomentumAlongTheAxis)
    {
      for (const std::string &type : mesh_types)
        for (const std::string &model : {elastic, flowing}) {
          SCOPED_TRACE(type + " " + model);
          Steps<2> run(scene(type, model),
                       {"Material: body/initial velocity x=0.1 * x * cos(3*y)",
                        "Material: body/initial velocity y=0.3 + 0.1 * y*y"});
          const double before = run.momentum()[1];
          double residual = 0., plastic = 0.;
          for (unsigned int step = 0; step < 100; ++step) {
            const double h = run.time_step * run.leapfrog->stable_share();
            residual = std::max(residual,
                                run.step(h / run.time_step).balance_residual);
          }
          plastic = run.state.energy.plastic;
          EXPECT_NEAR(run.momentum()[1], before, 1e-12 * before);
          EXPECT_LT(residual, 1e-12);
          EXPECT_EQ(plastic > 1e-3 * run.state.initial_energy,
                    model == flowing);
          const auto &cells = run.discretization->cells();
          for (std::size_t b = 0; b < cells.bodies.size(); ++b)
            for (unsigned int i = 0; i < cells.class_shape(b).n_nodes; ++i)
              if (cells.class_shape(b).on_axis[i]) {
                ASSERT_EQ(
                    run.state.displacement[cells.bodies.first_dof[b] + 2 * i],
                    0.);
              }
        }
    }

    /** After some steps of one length; velocities of @p size. */
    std::vector<double> places(const std::string &type,
                               const std::string &model,
                               const std::string &motion, const double size)
    {
      Steps<2> run(
          scene(type, model),
          {"motion=" + motion, "Time/step=0.02 s",
           fmt::format("Material: body/initial velocity x={} * x*cos(3*y)",
                       size),
           fmt::format("Material: body/initial velocity y={} * y*y", size)});
      for (unsigned int step = 0; step < 40; ++step)
        run.step();
      run.show();
      return run.state.displacement;
    }

    double difference(const std::vector<double> &one,
                      const std::vector<double> &other)
    {
      double apart = 0., size = 0.;
      for (std::size_t i = 0; i < one.size(); ++i) {
        apart = std::max(apart, std::abs(one[i] - other[i]));
        size = std::max(size, std::abs(one[i]));
      }
      return apart / size;
    }

    // Motions of 1e-6 are small ones, up to their square: in blocks of cells
    // and in points of their quadrature (on triangles one, which has less
    // of the hoops: of the order of the size of cells).
    TEST(AxisymmetricLarge, SmallMotionsAreLinear)
    {
      const auto linear = places("rectangle", "linear elastic", "small", 1e-6);
      EXPECT_LT(difference(places("rectangle", elastic, "large", 1e-6), linear),
                1e-5);
      // flow that never begins: cells have one dilatation in both
      const std::string strong = "j2 plastic\n  set yield stress = 1";
      EXPECT_LT(difference(places("rectangle", strong, "large", 1e-6),
                           places("rectangle", strong, "small", 1e-6)),
                1e-5);
      const std::string triangles = "crossed triangles";
      EXPECT_LT(difference(places(triangles, elastic, "large", 1e-6),
                           places(triangles, "linear elastic", "small", 1e-6)),
                0.05);
    }

    // Small motions with plastic flow: what flows is taken, nothing is given.
    TEST(AxisymmetricLarge, SmallFlowKeepsTheBalance)
    {
      Steps<2> run(scene("rectangle", flowing),
                   {"motion=small",
                    "Material: body/initial velocity x=0.05 * x * cos(3*y)",
                    "Material: body/initial velocity y=0.05 * y*y"});
      double residual = 0., last = 0.;
      for (unsigned int step = 0; step < 100; ++step) {
        residual = std::max(residual, run.step().balance_residual);
        EXPECT_GE(run.state.energy.plastic, last);
        last = run.state.energy.plastic;
      }
      EXPECT_LT(residual, 1e-12);
      EXPECT_GT(last, 0.05 * run.state.initial_energy);
    }

    struct Refused {
      std::vector<std::string> overrides;
      std::string rest, sentence;
    };

    TEST(AxisymmetricLarge, Refusals)
    {
      const std::vector<Refused> cases = {
          {{"Time/scheme=moreau-jean"},
           "",
           "motion = large has explicit steps"},
          {{},
           "subsection Contact: all\n  set friction = 0.1\nend\n",
           "surfaces of bodies do not meet each other with plane = "},
          {{"Discretization/degree=2"},
           "",
           "nodes on the axis of plane = axisymmetric would have no lumped"},
      };
      for (const Refused &one : cases) {
        InputErrors errors;
        EXPECT_FALSE(read_scene_text(scene("rectangle", elastic, one.rest),
                                     "test.prm", one.overrides, errors));
        EXPECT_NE(errors.report().find(one.sentence), std::string::npos)
            << errors.report();
      }
      // where either scheme may be taken, nothing is said of the implicit one
      InputErrors errors;
      EXPECT_FALSE(read_scene_text(
          scene("rectangle", elastic,
                "subsection Contact: all\n  set friction = 0.1\nend\n"),
          "test.prm", {"Time/scheme=auto"}, errors));
      EXPECT_EQ(errors.diagnostics().size(), 1u) << errors.report();
    }
  } // namespace
} // namespace nsfd::test_axisymmetric_large
