#include "make_scene.h"

#include "delassus/bulk_traction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

// Bodies that share the nodes of their faces: the stiffness is symmetric and
// exact on linear fields; W is what its definition says; where there are no
// common nodes there are rows; the energy balance closes when faces let go.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_joined_delassus
{
  using Vector = std::vector<double>;

  const std::string material = R"(
subsection Material: solid
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
)";

  const std::string solid = material + R"(
subsection Interface: all
  set law = bonded
end
subsection Time
  set end   = 1000
  set step  = 2 courant
  set theta = 0.6
end
)";

  const std::string soft_half = R"(
subsection Material: soft
  set where         = x < 1.5
  set model         = linear elastic
  set Young modulus = 1e-6
  set Poisson ratio = 0.49
  set density       = 1
end
)";

  const std::string rigid_half = R"(
subsection Material: stone
  set where   = x < 1
  set model   = rigid
  set density = 3
end
)";

  std::string mesh(const std::string &type, const std::string &upper,
                   const std::string &cells, const unsigned int degree)
  {
    const unsigned int dim = std::count(cells.begin(), cells.end(), ',') + 1;
    return "set dimension = " + std::to_string(dim) +
           "\nsubsection Mesh\n  set type = " + type +
           "\n  set upper corner = " + upper + "\n  set cells = " + cells +
           "\n  set distortion = 0.25\nend\n" +
           "subsection Discretization\n  set degree = " +
           std::to_string(degree) + "\nend\n";
  }

  struct Case {
    std::string name, text;
  };

  const std::vector<Case> plane_cases = {
      {"quads", mesh("rectangle", "3, 2", "3, 2", 1) + solid},
      {"cubic quads", mesh("rectangle", "3, 2", "2, 2", 3) + solid},
      {"thin quads", mesh("rectangle", "3, 0.003", "3, 2", 2) + solid},
      {"triangles", mesh("crossed triangles", "3, 2", "2, 1", 2) + solid},
      {"contrast", mesh("rectangle", "3, 2", "3, 2", 2) + soft_half + solid},
  };

  const std::vector<Case> space_cases = {
      {"hexes", mesh("brick", "3, 2, 1", "2, 2, 1", 1) + solid},
      {"tets", mesh("tetrahedra", "3, 2, 1", "1, 1, 1", 1) + solid},
  };

  /** Stick all points together and prepare a step. */
  template <int dim>
  void bond(Scene<dim> &scene)
  {
    std::vector<std::uint8_t> bonded(scene.state.kind.size());
    for (std::size_t i = 0; i < bonded.size(); ++i)
      bonded[i] = scene.state.kind[i] == PointKind::bonded;
    scene.bonded->set_bonds(bonded);
    scene.delassus->reinit(scene.time_step, scene.input->time.theta);
  }

  double dot(const Vector &a, const Vector &b)
  {
    double sum = 0.;
    for (std::size_t k = 0; k < a.size(); ++k)
      sum += a[k] * b[k];
    return sum;
  }

  Vector random_vector(const std::size_t n, std::mt19937 &random)
  {
    std::uniform_real_distribution<double> number(-1., 1.);
    Vector x(n);
    for (double &value : x)
      value = number(random);
    return x;
  }

  /** u.K_bodies u. */
  template <int dim>
  double bodies_alone(const Scene<dim> &scene, const Vector &u)
  {
    const auto &bodies = scene.discretization->bodies();
    double sum = 0.;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto &K = bodies.classes[bodies.class_of[b]].stiffness;
      const double *x = &u[bodies.first_dof[b]];
      for (unsigned int i = 0; i < K.rows; ++i)
        for (unsigned int j = 0; j < K.cols; ++j)
          sum += x[i] * K(i, j) * x[j];
    }
    return sum;
  }

  template <int dim>
  void expect_symmetric(const Case &one)
  {
    SCOPED_TRACE(one.name);
    using Operator = typename DelassusOperator<dim>::Operator;
    Scene<dim> scene(one.text);
    bond(scene);
    std::mt19937 random(3);
    const std::size_t n = scene.state.displacement.size();
    Vector joined = random_vector(n, random), y = random_vector(n, random);
    for (Vector *motion : {&joined, &y}) {
      EXPECT_TRUE(scene.bonded->join_motion(*motion));
      EXPECT_FALSE(scene.bonded->join_motion(*motion));
    }
    Vector Kx(n), Ky(n);
    scene.delassus->apply(Operator::stiffness, joined.data(), Kx.data());
    scene.delassus->apply(Operator::stiffness, y.data(), Ky.data());
    EXPECT_NEAR(dot(y, Kx), dot(joined, Ky),
                1e-13 * std::sqrt(dot(Kx, Kx) * dot(y, y)));
    // M_hat^{-1} undoes M + h^2 theta^2 K of motions with common nodes
    Vector Mx(n), back(n);
    scene.delassus->apply(Operator::stiffness, joined.data(), Kx.data());
    scene.delassus->apply(Operator::mass, joined.data(), Mx.data());
    const double f = std::pow(scene.time_step * scene.input->time.theta, 2);
    for (std::size_t k = 0; k < n; ++k)
      Mx[k] += f * Kx[k];
    scene.delassus->apply(Operator::inverse, Mx.data(), back.data());
    for (std::size_t k = 0; k < n; ++k)
      back[k] -= joined[k];
    EXPECT_LE(std::sqrt(dot(back, back) / dot(joined, joined)), 1e-7)
        << "the contrast of 1e6 leaves less";
  }

  /** A linear field: no jump, the exact traction, the exact energy. */
  template <int dim>
  void expect_exact_on_linear_fields(const Case &one)
  {
    SCOPED_TRACE(one.name);
    using Operator = typename DelassusOperator<dim>::Operator;
    Scene<dim> scene(one.text);
    bond(scene);
    const auto u = scene.discretization->interpolate(
        [](const dealii::Point<dim> &x, unsigned int, double *value) {
          for (unsigned int c = 0; c < dim; ++c)
            value[c] = 0.;
          value[0] = 0.3 * x[0] + 0.2 * x[1];
        });
    const std::size_t n = u.size();
    Vector Ku(n);
    scene.delassus->apply(Operator::stiffness, u.data(), Ku.data());
    const double alone = bodies_alone(scene, u);
    // a traction is a gradient: cells 1e3 times as long as high lose digits
    EXPECT_NEAR(dot(u, Ku), alone, 1e-9 * alone);

    Vector traction(scene.state.jump.size());
    BulkTraction<dim>(*scene.delassus)
        .evaluate(u.data(), BulkTraction<dim>::Where::everywhere,
                  traction.data());
    const double lambda = 0.3 / (1.3 * 0.4), mu = 1. / 2.6;
    const auto &points = scene.discretization->points();
    for (std::size_t i = 0; i < points.n_points; ++i) {
      if (scene.state.kind[i] != PointKind::bonded)
        continue;
      const double *Q = points.axes(i);
      // sigma = lambda tr(e) 1 + 2 mu e, e_xx = 0.3, e_xy = 0.1
      double sigma_n[3] = {lambda * 0.3 * Q[0], lambda * 0.3 * Q[1],
                           dim == 3 ? lambda * 0.3 * Q[dim - 1] : 0.};
      sigma_n[0] += 2. * mu * (0.3 * Q[0] + 0.1 * Q[1]);
      sigma_n[1] += 2. * mu * 0.1 * Q[0];
      for (unsigned int k = 0; k < dim; ++k) {
        double expected = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          expected += Q[k * dim + c] * sigma_n[c];
        EXPECT_NEAR(traction[i * dim + k], expected, 1e-10);
      }
    }
  }

  TEST(JoinedDelassus, StiffnessIsSymmetricAndMHatItsInverse)
  {
    for (const auto &one : plane_cases)
      expect_symmetric<2>(one);
    for (const auto &one : space_cases)
      expect_symmetric<3>(one);
  }

  TEST(JoinedDelassus, ExactOnLinearFields)
  {
    for (const auto &one : plane_cases)
      if (one.name != "contrast")
        expect_exact_on_linear_fields<2>(one);
    for (const auto &one : space_cases)
      expect_exact_on_linear_fields<3>(one);
  }

  /** A line that may break in a bonded body, and a driven side. */
  const std::string line = R"(
subsection Interface: line
  set where        = abs(x - 1) < 0.01
  set law          = camacho-ortiz
  set strength     = 1e-3
  set toughness    = 1e-4
  set intact faces = rigid
end
)";
  const std::string driven = R"(
subsection Boundary: left
  set velocity x = -1e-3
end
subsection Boundary: right
  set velocity x = 1e-3
end
)";

  /** Of the line and the driven sides: from its definition, and bounded. */
  TEST(JoinedDelassus, DelassusIsWhatItsDefinitionSays)
  {
    const std::string plain = "set dimension = 2\nsubsection Mesh\n"
                              "  set type = rectangle\n"
                              "  set upper corner = 2, 1\n"
                              "  set cells = 4, 2\nend\n";
    Scene<2> scene(plain + line + solid + driven);
    bond(scene);
    const std::size_t n = scene.state.jump.size(),
                      m = scene.state.displacement.size();
    std::mt19937 random(5);
    Vector P(n, 0.);
    for (std::size_t k = 0; k < n; ++k)
      if (scene.state.kind[k / 2] != PointKind::bonded)
        P[k] = random_vector(1, random)[0];
    Vector r(m), v(m), expected(n), U(n);
    scene.delassus->generalised_impulse(P.data(), r.data());
    scene.delassus->apply(DelassusOperator<2>::Operator::inverse, r.data(),
                          v.data());
    scene.delassus->relative_velocity(v.data(), expected.data());
    // sparse at first, condensed after a while
    for (unsigned int round = 0; round < 40; ++round) {
      scene.delassus->apply_delassus(P.data(), U.data());
      for (std::size_t k = 0; k < n; ++k)
        if (scene.state.kind[k / 2] != PointKind::bonded) {
          EXPECT_NEAR(U[k], expected[k], 1e-12) << k << " " << round;
        }
    }
    // the blocks that majorants come from bound it
    for (std::size_t f = 0; f < scene.delassus->points().faces.size(); ++f) {
      const auto &face = scene.delassus->points().faces[f];
      const unsigned int size = face.count * 2;
      for (unsigned int k = 0; k < size; ++k) {
        const std::size_t row = std::size_t(face.first) * 2 + k;
        if (scene.state.kind[row / 2] == PointKind::bonded)
          continue;
        Vector unit(n, 0.);
        unit[row] = 1.;
        scene.delassus->apply_delassus(unit.data(), U.data());
        EXPECT_LE(U[row], scene.delassus->point_block(row / 2)[row % 2 * 3]);
        EXPECT_GT(U[row], 0.);
      }
    }
  }

  unsigned int count(const State &state, const PointKind kind)
  {
    return unsigned(std::count(state.kind.begin(), state.kind.end(), kind));
  }

  TEST(JoinedDelassus, RigidBodyLeavesTheTractionToItsNeighbour)
  {
    Scene<2> scene(mesh("rectangle", "2, 1", "2, 1", 1) + rigid_half + solid);
    bond(scene);
    const auto u = scene.discretization->interpolate(
        [](const dealii::Point<2> &x, unsigned int, double *value) {
          value[0] = std::max(0., x[0] - 1.);
          value[1] = 0.;
        });
    Vector traction(scene.state.jump.size());
    BulkTraction<2>(*scene.delassus)
        .evaluate(u.data(), BulkTraction<2>::Where::everywhere,
                  traction.data());
    // at the faces that are marked it is the same, others keep what they have
    BulkTraction<2> bulk(*scene.delassus);
    const auto &faces = scene.discretization->points().faces;
    std::vector<char> marked(faces.size(), 0);
    for (std::size_t f = 0; f < faces.size(); f += 3)
      marked[f] = 1;
    bulk.mark(marked);
    Vector some(traction.size(), -7.);
    bulk.evaluate(u.data(), BulkTraction<2>::Where::marked, some.data());
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (unsigned int k = 2 * faces[f].first;
           k < 2 * (faces[f].first + faces[f].count); ++k)
        EXPECT_EQ(some[k], marked[f] ? traction[k] : -7.);
    const double expected = 0.3 / (1.3 * 0.4) + 2. / 2.6; // lambda + 2 mu
    bool any = false;
    for (std::size_t i = 0; i < scene.state.kind.size(); ++i)
      if (scene.state.kind[i] == PointKind::bonded) {
        any = true;
        EXPECT_NEAR(traction[i * 2], expected, 1e-12);
      }
    EXPECT_TRUE(any);
  }

  /** Nodes follow a rigid cell, and a rigid cell another one. */
  TEST(JoinedDelassus, RigidBodiesMoveWithTheOthers)
  {
    std::string rigid = rigid_half;
    rigid.replace(rigid.find("x < 1"), 5, "x < 2");
    Scene<2> scene(mesh("rectangle", "4, 1", "4, 1", 1) + rigid + solid +
                   driven);
    EXPECT_EQ(count(scene.state, PointKind::bonded), 3u * 2u);
    EXPECT_EQ(count(scene.state, PointKind::prescribed), 2u * 2u); // driven
    for (unsigned int k = 0; k < 20; ++k)
      EXPECT_LE(scene.advance().balance_residual, 1e-12);
    double largest = 0.;
    for (const double u :
         scene.discretization->to_nodal(scene.state.displacement))
      largest = std::max(largest, std::abs(u));
    EXPECT_GT(largest, 0.);
    std::vector<double> jump(scene.state.jump.size());
    scene.delassus->relative_velocity(scene.state.displacement.data(),
                                      jump.data());
    for (const auto &face : scene.discretization->points().faces)
      for (unsigned int k = face.first * 2;
           !face.boundary && k < (face.first + face.count) * 2; ++k)
        EXPECT_LE(std::abs(jump[k]), 1e-9 * largest);
  }

  /** What is left of a face of which a part is open: rows, until it breaks. */
  TEST(JoinedDelassus, RowsHoldFacesWithAnOpenPart)
  {
    const std::string notched = R"(
subsection Interface: line
  set where        = abs(x - 1) < 0.01
  set law          = camacho-ortiz
  set strength     = 1e-3
  set toughness    = 1e-7
  set intact faces = bonded
  set broken       = y < 0.25
end
)";
    Scene<2> scene("set dimension = 2\nsubsection Mesh\n"
                   "  set type = rectangle\n  set upper corner = 2, 1\n"
                   "  set cells = 4, 2\nend\n" +
                   notched + solid + driven);
    EXPECT_EQ(count(scene.state, PointKind::free), 1u);
    EXPECT_EQ(count(scene.state, PointKind::rigid), 1u);
    while (scene.state.time < 20. && scene.state.energy.damage == 0.)
      EXPECT_GT(scene.advance_bisecting(), 0.);
    EXPECT_GT(scene.state.energy.damage, 0.);
    EXPECT_EQ(count(scene.state, PointKind::rigid), 0u);
    const auto &e = scene.state.energy;
    const double defect = e.kinetic + e.elastic + e.cohesive + e.damage +
                          e.friction + e.impact + e.numerical - e.work;
    EXPECT_LE(std::abs(defect), 1e-10 * scene.state.largest_energy);
  }

  /** Halves that are apart at the start are joined in the nearest motion. */
  TEST(JoinedDelassus, ClosesJumpsOfTheStart)
  {
    const std::string right = R"(
subsection Material: right
  set where                  = x > 1
  set model                  = linear elastic
  set Young modulus          = 1
  set Poisson ratio          = 0.3
  set density                = 1
  set initial displacement x = 1e-3
end
)";
    Scene<2> scene("set dimension = 2\nsubsection Mesh\n"
                   "  set type = rectangle\n  set upper corner = 2, 1\n"
                   "  set cells = 4, 2\nend\n" +
                   right + solid);
    EXPECT_GT(scene.state.energy.elastic, 0.);
    for (unsigned int k = 0; k < 20; ++k)
      EXPECT_LE(scene.advance().balance_residual, 1e-12);
  }

  /** Pulled until all bonds are gone: the energy balance closes at every step.
   */
  TEST(JoinedDelassus, BreaksWithClosedBalance)
  {
    const std::string brick = "set dimension = 2\nsubsection Mesh\n"
                              "  set type = rectangle\n"
                              "  set upper corner = 2, 1\n"
                              "  set cells = 4, 2\nend\n";
    const std::string breakable = material + R"(
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1e-3
  set toughness = 1e-7
  set friction  = 0.3
end
subsection Time
  set end  = 40
  set step = 0.25 courant
end
)";
    Scene<2> scene(brick + breakable + driven);
    ASSERT_NE(scene.bonded, nullptr);
    unsigned int released = 0;
    while (scene.state.time < 10.) {
      const double h = scene.advance_bisecting();
      EXPECT_GT(h, 0.);
    }
    for (const PointKind kind : scene.state.kind)
      released += kind == PointKind::free || kind == PointKind::cohesive;
    EXPECT_GT(released, 0u);
    const auto &e = scene.state.energy;
    const double defect = e.kinetic + e.elastic + e.cohesive + e.damage +
                          e.friction + e.impact + e.numerical - e.work;
    EXPECT_LE(std::abs(defect), 1e-10 * scene.state.largest_energy);
    EXPECT_GT(e.damage, 0.);
    EXPECT_LE(std::abs(e.numerical), 0.05 * e.damage);
  }
} // namespace test_joined_delassus
