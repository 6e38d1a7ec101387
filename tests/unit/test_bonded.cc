#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

// Faces joined through the bulk: the stiffness is symmetric, exact on linear
// fields, hardly less than that of the bodies alone; W is what its definition
// says; a bond that breaks gives its energy to the energy balance.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_bonded
{
  using Vector = std::vector<double>;

  const std::string solid = R"(
subsection Material: solid
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
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

  /**
   * The smallest u.K u / u.K_bodies u that the descent u <- u - a (K u -
   * ratio K_bodies u) finds from a random start, 300 steps with the length of
   * an exact line search.
   */
  template <int dim>
  double smallest_ratio(const Scene<dim> &scene, std::mt19937 &random)
  {
    using Operator = typename DelassusOperator<dim>::Operator;
    const std::size_t n = scene.state.displacement.size();
    const auto &bodies = scene.discretization->bodies();
    const auto apply = [&](const Vector &x, Vector &K, Vector &alone) {
      K.assign(n, 0.);
      alone.assign(n, 0.);
      scene.bonded->BondedDelassus<dim>::apply(Operator::stiffness, x.data(),
                                               K.data());
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto &block = bodies.classes[bodies.class_of[b]].stiffness;
        for (unsigned int i = 0; i < block.rows; ++i)
          for (unsigned int j = 0; j < block.cols; ++j)
            alone[bodies.first_dof[b] + i] +=
                block(i, j) * x[bodies.first_dof[b] + j];
      }
    };
    Vector x = random_vector(n, random), Kx, Bx, g(n), Kg, Bg;
    double best = 0.;
    for (unsigned int k = 0; k < 300; ++k) {
      apply(x, Kx, Bx);
      const double a = dot(x, Kx), b = dot(x, Bx), ratio = a / b;
      best = ratio;
      for (std::size_t i = 0; i < n; ++i)
        g[i] = Kx[i] - ratio * Bx[i];
      apply(g, Kg, Bg);
      // minimise (a + 2 s c + s^2 d) / (b + 2 s e + s^2 f) over s
      const double c = dot(x, Kg), d = dot(g, Kg), e = dot(x, Bg),
                   f = dot(g, Bg);
      const double A = d * e - c * f, B = d * b - a * f, C = c * b - a * e;
      const double root = std::sqrt(std::max(0., B * B - 4. * A * C));
      double s = 0., value = ratio;
      for (const double sign : {-1., 1.}) {
        const double trial =
            A != 0. ? (-B + sign * root) / (2. * A) : (B != 0. ? -C / B : 0.);
        const double at = (a + 2. * trial * c + trial * trial * d) /
                          (b + 2. * trial * e + trial * trial * f);
        if (std::isfinite(at) && at < value) {
          value = at;
          s = trial;
        }
      }
      for (std::size_t i = 0; i < n; ++i)
        x[i] += s * g[i];
    }
    return best;
  }

  template <int dim>
  void expect_coercive(const Case &one)
  {
    SCOPED_TRACE(one.name);
    Scene<dim> scene(one.text);
    bond(scene);
    std::mt19937 random(7);
    double least = 1e300;
    for (unsigned int trial = 0; trial < 5; ++trial)
      least = std::min(least, smallest_ratio(scene, random));
    EXPECT_GE(least, (1. - 1. / 32.) * (1. - 1e-10));
    EXPECT_LE(least, 1.); // conforming fields have 1: the search is one
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
    const Vector x = random_vector(n, random), y = random_vector(n, random);
    Vector Kx(n), Ky(n);
    const BondedDelassus<dim> &bonded = *scene.bonded;
    bonded.BondedDelassus<dim>::apply(Operator::stiffness, x.data(), Kx.data());
    bonded.BondedDelassus<dim>::apply(Operator::stiffness, y.data(), Ky.data());
    EXPECT_NEAR(dot(y, Kx), dot(x, Ky),
                1e-13 * std::sqrt(dot(Kx, Kx) * dot(y, y)));
    // M_hat^{-1} undoes M + h^2 theta^2 K of motions with common nodes
    Vector Mx(n), back(n), joined = x;
    EXPECT_TRUE(scene.bonded->join_motion(joined));
    EXPECT_FALSE(scene.bonded->join_motion(joined));
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
    BulkTraction<dim>(*scene.delassus).evaluate(u.data(), traction.data());
    const double lambda = 0.3 / (1.3 * 0.4), mu = 1. / 2.6;
    const auto &points = scene.discretization->points();
    for (std::size_t i = 0; i < points.n_points; ++i) {
      if (scene.state.kind[i] != PointKind::bonded)
        continue;
      const double *Q = &points.frame[i * dim * dim];
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

  TEST(Bonded, StiffnessIsSymmetricAndMHatItsInverse)
  {
    for (const auto &one : plane_cases)
      expect_symmetric<2>(one);
    for (const auto &one : space_cases)
      expect_symmetric<3>(one);
  }

  TEST(Bonded, HardlyLessThanTheBodiesAlone)
  {
    for (const auto &one : plane_cases)
      expect_coercive<2>(one);
    for (const auto &one : space_cases)
      expect_coercive<3>(one);
  }

  TEST(Bonded, ExactOnLinearFields)
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
  TEST(Bonded, DelassusIsWhatItsDefinitionSays)
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
        EXPECT_LE(U[row], scene.delassus->face_block(f)[k * size + k]);
        EXPECT_GT(U[row], 0.);
      }
    }
  }

  TEST(Bonded, RigidBodyLeavesTheTractionToItsNeighbour)
  {
    Scene<2> scene(mesh("rectangle", "2, 1", "2, 1", 1) + rigid_half + solid);
    bond(scene);
    const auto u = scene.discretization->interpolate(
        [](const dealii::Point<2> &x, unsigned int, double *value) {
          value[0] = std::max(0., x[0] - 1.);
          value[1] = 0.;
        });
    Vector traction(scene.state.jump.size());
    BulkTraction<2>(*scene.delassus).evaluate(u.data(), traction.data());
    const double expected = 0.3 / (1.3 * 0.4) + 2. / 2.6; // lambda + 2 mu
    bool any = false;
    for (std::size_t i = 0; i < scene.state.kind.size(); ++i)
      if (scene.state.kind[i] == PointKind::bonded) {
        any = true;
        EXPECT_NEAR(traction[i * 2], expected, 1e-12);
      }
    EXPECT_TRUE(any);
    EXPECT_THROW(
        bond(*std::make_unique<Scene<2>>(
            mesh("rectangle", "3, 1", "3, 1", 1) +
            "subsection Material: stone\n  set model = rigid\n  set "
            "density = 1\nend\nsubsection Interface: all\n  set law = "
            "bonded\nend\nsubsection Time\n  set end = 1\n  set step = "
            "0.1\nend\n")),
        std::invalid_argument); // by the reader
  }

  /** Halves that are apart at the start: the bond stores it, and knows it. */
  TEST(Bonded, JumpsAtTheStartAreInTheBalance)
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
  TEST(Bonded, BreaksWithClosedBalance)
  {
    const std::string brick = "set dimension = 2\nsubsection Mesh\n"
                              "  set type = rectangle\n"
                              "  set upper corner = 2, 1\n"
                              "  set cells = 4, 2\nend\n";
    const std::string breakable = R"(
subsection Material: solid
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
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
    // what bonds had stored is little against what breaking takes
    EXPECT_LE(std::abs(e.numerical), 0.05 * e.damage);
  }
} // namespace test_bonded
