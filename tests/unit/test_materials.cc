#include "make_scene.h"

#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

// Graded, transversely isotropic and viscous materials in whole scenes: which
// cells share their blocks, what a step does with them on every path, and
// their energy balance.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_materials
{
  using Vector = std::vector<double>;
  using Operator = DelassusOperator<2>::Operator;

  /** A plate that is thrown at a wall; MATERIAL and FACES are filled in. */
  const std::string plate = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 8, 4
  set cells        = 8, 4
end
subsection Material: plate
MATERIAL
  set initial velocity x = exp(-((x - 2)^2 + (y - 1.5)^2))
  set initial velocity y = 0.5 * exp(-((x - 5)^2 + (y - 2)^2))
end
subsection Interface: all
FACES
end
subsection Obstacle: wall
  set normal = 1, 0
  set point  = 0, 0
end
subsection Time
  set end  = 1000
  set step = 0.5 courant
end
subsection Solver
  set tolerance = 1e-10
end
)";

  const std::string plain = "  set Young modulus = 1\n"
                            "  set Poisson ratio = 0.3\n"
                            "  set density       = 1\n";
  const std::string viscous = "  set shear viscosity = 0.3\n"
                              "  set bulk viscosity  = 0.2\n";
  const std::string fibres = "  set model = transversely isotropic\n"
                             "  set axis  = 2, 1, 0\n"
                             "  set axial Young modulus      = 3\n"
                             "  set transverse Young modulus = 1\n"
                             "  set axial Poisson ratio      = 0.3\n"
                             "  set transverse Poisson ratio = 0.4\n"
                             "  set axial shear modulus      = 0.4\n"
                             "  set density                  = 1\n";
  const std::string rigid = "  set law = rigid";

  std::string text(const std::string &material, const std::string &faces)
  {
    std::string result = plate;
    for (const auto &[what, by] :
         {std::pair("MATERIAL\n", &material), std::pair("FACES", &faces)})
      result.replace(result.find(what), std::string(what).size(), *by);
    return result;
  }

  double largest(const Vector &v)
  {
    double result = 0.;
    for (const double value : v)
      result = std::max(result, std::abs(value));
    return result;
  }

  double difference(const Vector &a, const Vector &b)
  {
    EXPECT_EQ(a.size(), b.size());
    double result = 0.;
    for (std::size_t i = 0; i < a.size(); ++i)
      result = std::max(result, std::abs(a[i] - b[i]));
    return result / largest(b);
  }

  /** How far the energies are from adding up, over the largest of them. */
  template <int dim>
  double defect(const Scene<dim> &scene)
  {
    const EnergyLines &e = scene.state.energy;
    return std::abs(e.kinetic + e.elastic + e.cohesive + e.damage + e.friction +
                    e.viscous + e.impact + e.numerical - e.work -
                    scene.state.initial_energy) /
           scene.state.largest_energy;
  }

  // --- graded

  TEST(GradedMaterial, CellsShareBlocksWhereTheyAreAlike)
  {
    const auto n_classes = [](const std::string &young,
                              const std::string &density = "1",
                              const std::string &faces = rigid) {
      return Scene<2>(text("  set Young modulus = " + young +
                               "\n  set Poisson ratio = 0.3\n"
                               "  set density = " +
                               density + "\n",
                           faces))
          .discretization->bodies()
          .classes.size();
    };
    EXPECT_EQ(n_classes("1"), 1u);
    EXPECT_EQ(n_classes("1 + 0 * x"), 1u);
    EXPECT_EQ(n_classes("exp(x / 8)"), 8u);
    EXPECT_EQ(n_classes("exp(x / 8 + y)"), 32u);
    EXPECT_EQ(n_classes("1", "1 + y"), 4u);
    EXPECT_EQ(n_classes("if(x < 3, 1, 2)"), 2u);
    EXPECT_EQ(n_classes("if(x < 3, 1, 2)", "1", "  set law = bonded"), 2u);
    EXPECT_EQ(n_classes("1 + random(1, floor(x), floor(y))"), 32u);
  }

  TEST(GradedMaterial, MassAndStiffnessByQuadrature)
  {
    // of one cell from 0 to 1: mass 3/2, and a strain of 1 along x stores
    // lambda + 2 mu over 2, E = 1 + x in the mean 3/2
    const Scene<2> scene(
        text("  set Young modulus = 1 + x\n  set Poisson ratio = 0\n"
             "  set density = 1 + x\n",
             rigid),
        {"Mesh/upper corner=1, 1", "Mesh/cells=1, 1"});
    const Vector move = scene.discretization->interpolate(
        [](const auto &, unsigned int, double *v) { v[0] = 1., v[1] = 0.; });
    const Vector strain = scene.discretization->interpolate(
        [](const auto &x, unsigned int, double *v) { v[0] = x[0], v[1] = 0.; });
    Vector product(move.size());
    const auto form = [&](const Operator op, const Vector &v) {
      scene.delassus->apply(op, v.data(), product.data());
      double sum = 0.;
      for (std::size_t i = 0; i < v.size(); ++i)
        sum += v[i] * product[i];
      return sum;
    };
    EXPECT_NEAR(form(Operator::mass, move), 1.5, 1e-14);
    EXPECT_NEAR(form(Operator::stiffness, strain), 1.5, 1e-14);
    EXPECT_NEAR(form(Operator::stiffness, move), 0., 1e-14);
    const double value[2] = {0., 0.}, gradient[4] = {1., 0., 0., 0.};
    const auto stress = scene.discretization->stress(
        0, dealii::Point<2>(0.25, 0.5), value, gradient);
    EXPECT_NEAR(stress[0], 1.25, 1e-8); // a billionth of the way inwards
    EXPECT_NEAR(scene.discretization->extremes(0).fastest, 1., 1e-14);
    EXPECT_GT(scene.discretization->extremes(0).stiffest.young, 1.5);
    EXPECT_LT(scene.discretization->extremes(0).softest.young, 1.5);
  }

  // One material with a condition and two materials are the same body.
  TEST(GradedMaterial, TwoLayersByExpressionOrByBlocks)
  {
    const std::string one = "  set Young modulus = if(x < 3, 1, 4)\n"
                            "  set Poisson ratio = if(x < 3, 0.3, 0.2)\n"
                            "  set density       = if(x < 3, 1, 2)\n";
    const std::string motion =
        "  set initial velocity x = exp(-((x - 2)^2 + (y - 1.5)^2))\n"
        "  set initial velocity y = 0.5 * exp(-((x - 5)^2 + (y - 2)^2))\n";
    const std::string two =
        "  set where = x < 3\n" + plain + motion +
        "end\nsubsection Material: other\n"
        "  set Young modulus = 4\n  set Poisson ratio = 0.2\n"
        "  set density = 2\n";
    for (const std::string law : {"rigid", "bonded"}) {
      SCOPED_TRACE(law);
      Scene<2> graded(text(one, "  set law = " + law)),
          blocks(text(two, "  set law = " + law));
      EXPECT_EQ(graded.discretization->crossing_time(),
                blocks.discretization->crossing_time());
      for (unsigned int k = 0; k < 20; ++k) {
        graded.advance();
        blocks.advance();
      }
      EXPECT_LT(difference(graded.state.velocity, blocks.state.velocity),
                1e-12);
      EXPECT_LT(
          difference(graded.state.displacement, blocks.state.displacement),
          1e-12);
    }
  }

  // --- all of them, on all paths

  TEST(LinearMaterials, PathsAgreeAndBalancesClose)
  {
    const std::string graded =
        "  set Young modulus = exp(x / 8)\n  set Poisson ratio = 0.2 + y / 40\n"
        "  set density = 1 + x / 8\n";
    for (const std::string &material :
         {fibres, graded, plain + viscous, fibres + viscous})
      for (const std::string theta : {"0.5", "0.7"}) {
        SCOPED_TRACE(material + "theta " + theta);
        Scene<2> cells(text(material, rigid),
                       {"Solver/path=local", "Time/theta=" + theta}),
            assembled(text(material, rigid),
                      {"Solver/path=assembled", "Time/theta=" + theta}),
            bonded(text(material, "  set law = bonded"),
                   {"Time/theta=" + theta});
        for (Scene<2> *scene : {&cells, &assembled, &bonded}) {
          double dissipated = 0., worst = 0.;
          for (unsigned int k = 0; k < 20; ++k) {
            scene->advance();
            worst = std::max(worst, defect(*scene));
            EXPECT_GE(scene->state.energy.viscous, dissipated);
            dissipated = scene->state.energy.viscous;
          }
          EXPECT_LT(worst, 1e-9);
          if (scene->input->materials[0].is_viscous())
            EXPECT_GT(dissipated, 0.1 * scene->state.initial_energy);
          else
            EXPECT_EQ(dissipated, 0.);
        }
        EXPECT_LT(difference(assembled.state.velocity, cells.state.velocity),
                  1e-7);
      }
  }

  // Rigid motions are not damped, and M_hat is what the step says.
  TEST(ViscousMaterial, Blocks)
  {
    for (const std::string law : {"rigid", "bonded"}) {
      Scene<2> scene(text(plain + viscous, "  set law = " + law),
                     {"Mesh/distortion=0.2"});
      const Vector rigid_motion = scene.discretization->interpolate(
          [](const auto &x, unsigned int, double *v) {
            v[0] = 1. - 0.3 * x[1];
            v[1] = 0.5 + 0.3 * x[0];
          });
      Vector C(rigid_motion.size()), work(C.size());
      const auto damp = [&](const Vector &motion) {
        scene.delassus->apply(Operator::damping, motion.data(), C.data());
      };
      damp(rigid_motion);
      const double of_rigid_motion = largest(C);
      Vector v(C.size()), sum(C.size());
      for (std::size_t i = 0; i < v.size(); ++i)
        v[i] = std::sin(1. + 12.9898 * double(i));
      if (scene.bonded)
        scene.bonded->join_motion(v);
      const double h = scene.time_step, theta = 0.5;
      scene.delassus->apply(Operator::mass, v.data(), sum.data());
      scene.delassus->apply(Operator::stiffness, v.data(), work.data());
      damp(v);
      EXPECT_LT(of_rigid_motion, 1e-13 * largest(C)); // of a motion of size 1
      double power = 0.;
      for (std::size_t i = 0; i < v.size(); ++i) {
        sum[i] += h * h * theta * theta * work[i] + h * theta * C[i];
        power += v[i] * C[i];
      }
      EXPECT_GT(power, 0.);
      scene.delassus->apply(Operator::inverse, sum.data(), work.data());
      EXPECT_LT(difference(work, v), 1e-11);
    }
  }

  TEST(ViscousMaterial, InverseWithBonds)
  {
    for (const std::string solver : {"direct", "cg"}) {
      Scene<2> scene(text(fibres + viscous, "  set law = bonded"),
                     {"Mesh/distortion=0.2", "Solver/linear solver=" + solver});
      const std::size_t n = scene.discretization->bodies().n_dofs();
      Vector v(n), sum(n), work(n);
      for (std::size_t i = 0; i < n; ++i)
        v[i] = std::sin(1. + 12.9898 * double(i));
      EXPECT_TRUE(scene.bonded->join_motion(v)); // common nodes
      const double h = scene.time_step, theta = 0.5;
      scene.delassus->apply(Operator::mass, v.data(), sum.data());
      for (const auto &[op, share] :
           {std::pair(Operator::stiffness, h * h * theta * theta),
            std::pair(Operator::damping, h * theta)}) {
        scene.delassus->apply(op, v.data(), work.data());
        for (std::size_t i = 0; i < n; ++i)
          sum[i] += share * work[i];
      }
      scene.delassus->apply(Operator::inverse, sum.data(), work.data());
      EXPECT_LT(difference(work, v), 1e-10) << solver;
    }
  }

  // A plate of uniform strain rate between its bonds: the viscous stress goes
  // through faces whole, whatever the size of the cells.
  TEST(ViscousMaterial, BondsAreConsistent)
  {
    Scene<2> scene(text(plain + viscous, "  set law = bonded"),
                   {"Mesh/distortion=0.2"});
    const Vector v = scene.discretization->interpolate(
        [](const auto &x, unsigned int, double *out) {
          out[0] = x[0] + 0.4 * x[1];
          out[1] = -0.3 * x[1];
        });
    Vector C(v.size());
    scene.delassus->apply(Operator::damping, v.data(), C.data());
    // eta, zeta = 0.3, 0.2: xx 0.6 (1 - 0.7/3) + 0.14, yy, xy; over 32
    const double trace = 0.7, xx = 0.6 * (1. - trace / 3.) + 0.2 * trace,
                 yy = 0.6 * (-0.3 - trace / 3.) + 0.2 * trace, xy = 0.3 * 0.4;
    double power = 0.;
    for (std::size_t i = 0; i < v.size(); ++i)
      power += v[i] * C[i];
    EXPECT_NEAR(power, 32. * (xx * 1. + xy * 0.4 + yy * -0.3), 1e-11);
  }

  TEST(ViscousMaterial, SymplecticStepsAndFractureCloseTheBalance)
  {
    const std::string law = "  set law = michel-suquet\n  set stiffness = 21\n"
                            "  set strength = 0.1\n  set friction = 0.3";
    for (const std::vector<std::string> &more :
         {std::vector<std::string>{},
          std::vector<std::string>{"Time/scheme=symplectic",
                                   "Time/step=0.1 courant"},
          std::vector<std::string>{"Solver/path=assembled"},
          std::vector<std::string>{"Solver/method=interior point"}}) {
      SCOPED_TRACE(more.empty() ? "plain" : more.front());
      Scene<2> scene(text(plain + viscous, law), more);
      double viscous_energy = 0., worst = 0.;
      for (unsigned int k = 0; k < 40; ++k) {
        scene.advance_bisecting();
        worst = std::max(worst, defect(scene));
        EXPECT_GE(scene.state.energy.viscous, viscous_energy);
        viscous_energy = scene.state.energy.viscous;
      }
      EXPECT_LT(worst, 1e-9);
      EXPECT_GT(viscous_energy, 0.);
      EXPECT_GT(scene.state.energy.damage, 0.);
    }
  }

  TEST(ViscousMaterial, SymplecticStepsOnCommonNodesCloseTheBalance)
  {
    for (const std::string mass : {"consistent", "lumped"}) {
      Scene<2> scene(text(plain + viscous, "  set law = bonded"),
                     {"Time/scheme=symplectic", "Time/step=0.1 courant",
                      "Discretization/mass=" + mass});
      for (unsigned int k = 0; k < 40; ++k) {
        scene.advance();
        EXPECT_LT(defect(scene), 1e-9);
      }
      EXPECT_GT(scene.state.energy.viscous, 0.);
    }
  }

  // A body of fibres turned with its motion moves the same: by 90 degrees on
  // the same mesh, to round-off.
  TEST(TransverseMaterial, TurnedBodyMovesTurned)
  {
    const auto run = [](const bool turned) {
      std::string material = fibres;
      if (turned)
        material.replace(material.find("2, 1, 0"), 7, "-1, 2, 0");
      std::string all = text(material, "  set law = rigid");
      const auto drop = [&all](const std::string &from, const std::string &to) {
        const std::size_t begin = all.find(from);
        all.erase(begin, all.find(to, begin) - begin);
      };
      drop("subsection Obstacle", "subsection Time");
      drop("  set initial velocity x", "end");
      const std::string pulse = turned ? "set initial velocity y = exp(-((y - "
                                         "2)^2 + (-x - 1)^2))\n"
                                       : "set initial velocity x = exp(-((x - "
                                         "2)^2 + (y - 1)^2))\n";
      const std::size_t at = all.find("end\nsubsection Interface");
      all.insert(at, pulse);
      Scene<2> scene(
          all, turned ? std::vector<std::string>{"Mesh/lower corner=-4, 0",
                                                 "Mesh/upper corner=0, 8",
                                                 "Mesh/cells=4, 8"}
                      : std::vector<std::string>{"Mesh/lower corner=0, 0",
                                                 "Mesh/upper corner=8, 4",
                                                 "Mesh/cells=8, 4"});
      for (unsigned int k = 0; k < 20; ++k)
        scene.advance();
      return std::array<double, 2>{
          {scene.state.energy.kinetic, scene.state.energy.elastic}};
    };
    const auto straight = run(false), turned = run(true);
    EXPECT_GT(straight[1], 1e-3 * straight[0]);
    for (unsigned int k = 0; k < 2; ++k)
      EXPECT_NEAR(turned[k], straight[k], 1e-9 * straight[k]);
  }

  TEST(LinearMaterials, InSpace)
  {
    const std::string block = R"(
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 2, 2, 1
  set cells        = 2, 2, 1
end
subsection Material: block
  set model = transversely isotropic
  set axis  = 1, 2, -2
  set axial Young modulus      = 3
  set transverse Young modulus = 1
  set axial Poisson ratio      = 0.3
  set transverse Poisson ratio = 0.4
  set axial shear modulus      = 0.4
  set density                  = 1 + x / 4
  set VISCOSITY viscosity      = 0.1
  set initial velocity x       = y * z
end
subsection Interface: all
  set law = LAW
end
subsection Time
  set end  = 1000
  set step = 0.5 courant
end
)";
    for (const auto &[law, viscosity] :
         {std::pair("rigid", "shear"), std::pair("bonded", "shear"),
          std::pair("bonded", "bulk")}) {
      std::string all = block;
      all.replace(all.find("LAW"), 3, law);
      all.replace(all.find("VISCOSITY"), 9, viscosity);
      Scene<3> scene(all);
      for (unsigned int k = 0; k < 10; ++k)
        scene.advance();
      EXPECT_LT(defect(scene), 1e-9);
      EXPECT_GT(scene.state.energy.viscous, 1e-4 * scene.state.initial_energy);
      EXPECT_GT(scene.state.energy.elastic, 0.);
    }
  }
} // namespace test_materials
