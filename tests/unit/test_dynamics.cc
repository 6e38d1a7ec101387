#include "delassus/block_inverse.h"
#include "make_scene.h"

#include "delassus/inner_solver.h"
#include "nsfd/linear_algebra/block_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

// H, M_hat^{-1}, W = H M_hat^{-1} H^T and its preconditioners on small meshes,
// and the sums that do not depend on the ranks. The operators are compared
// entry by entry on one rank; sums and kernels are right on any number.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_dynamics
{
  using Vector = std::vector<double>;

  const std::string springs = R"(
subsection Interface: springs
  set law                  = elastic
  set normal stiffness     = 20
  set tangential stiffness = 7
end
)";

  const std::string solid = R"(
subsection Material: solid
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
)";

  std::string time(const std::string &step)
  {
    return "subsection Time\n  set end = 1000\n  set step = " + step +
           "\n  set theta = 0.6\nend\n";
  }

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

  /** A driven side and an obstacle on the same faces: two points per slot. */
  const std::string supports_2d = R"(
subsection Boundary: bottom
  set velocity x = 0
end
subsection Obstacle: floor
  set where  = bottom
  set point  = 0, 0
  set normal = 0.2, 1
end
)";

  const std::string supports_3d = R"(
subsection Boundary: bottom
  set velocity x = 0
end
subsection Obstacle: floor
  set where  = bottom
  set point  = 0, 0, 0
  set normal = 0.2, -0.1, 1
end
)";

  /** Half of the cells are rigid. */
  const std::string half_rigid = R"(
subsection Material: stone
  set where   = x < 1.5
  set model   = rigid
  set density = 3
end
)";

  const std::string quads = mesh("rectangle", "3, 2", "3, 2", 3) + solid +
                            springs + supports_2d + time("2 crossings");
  const std::string triangles = mesh("crossed triangles", "3, 2", "2, 1", 2) +
                                solid + springs + supports_2d +
                                time("2 crossings");
  const std::string hexes = mesh("brick", "3, 2, 1", "2, 2, 1", 2) + solid +
                            springs + supports_3d + time("2 crossings");
  const std::string tets = mesh("tetrahedra", "3, 2, 1", "2, 1, 1", 1) + solid +
                           springs + supports_3d + time("2 crossings");
  const std::string mixed = mesh("rectangle", "3, 2", "4, 3", 2) + half_rigid +
                            solid + springs + supports_2d + time("2 crossings");

  Vector random_vector(const std::size_t n, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1., 1.);
    Vector x(n);
    for (double &value : x)
      value = number(random);
    return x;
  }

  double largest(const Vector &x)
  {
    double result = 0.;
    for (const double value : x)
      result = std::max(result, std::abs(value));
    return result;
  }

  double dot(const Vector &a, const Vector &b)
  {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
  }

  template <int dim>
  Vector delassus(const Dynamics<dim> &dynamics, const Vector &P)
  {
    Vector U(P.size());
    dynamics.apply_delassus(P.data(), U.data());
    return U;
  }

  /** W by columns. */
  template <int dim>
  std::vector<Vector> dense_delassus(const Scene<dim> &scene)
  {
    const std::size_t n = scene.discretization->points().n_points * dim;
    std::vector<Vector> W;
    for (std::size_t k = 0; k < n; ++k) {
      Vector P(n, 0.);
      P[k] = 1.;
      W.push_back(delassus(*scene.dynamics, P));
    }
    return W;
  }

  template <int dim>
  void check_operator(const std::string &text)
  {
    Scene<dim> scene(text);
    if (scene.communicator.size() > 1)
      GTEST_SKIP() << "compares columns of one rank";
    const auto &dynamics = *scene.dynamics;
    const std::size_t n = scene.discretization->points().n_points * dim,
                      m = scene.discretization->bodies().n_dofs();
    ASSERT_GT(n, 20u);
    ASSERT_FALSE(scene.discretization->bodies().extra_points.empty())
        << "the scene is meant to have two points per slot";
    const auto W = dense_delassus(scene);
    double size = 0.;
    for (const auto &column : W)
      size = std::max(size, largest(column));

    // Symmetric to the last bit body by body; the sum over two bodies and the
    // two rotations add a few round-offs.
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_NEAR(W[i][j], W[j][i], 1e-14 * size) << i << ", " << j;

    for (unsigned int seed = 0; seed < 20; ++seed) {
      const Vector P = random_vector(n, seed), U = delassus(dynamics, P);

      // the operator is linear in its columns
      Vector columns(n, 0.);
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = 0; i < n; ++i)
          columns[i] += P[k] * W[k][i];
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_NEAR(U[i], columns[i], 1e-13 * largest(U));

      // and the product of its three factors
      Vector r(m), v(m), product(n);
      dynamics.generalised_impulse(P.data(), r.data());
      dynamics.apply(Dynamics<dim>::Operator::inverse, r.data(), v.data());
      dynamics.relative_velocity(v.data(), product.data());
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_NEAR(U[i], product[i], 1e-13 * largest(U));
      Vector change(m, 0.);
      dynamics.add_velocity_change(P.data(), change.data());
      for (std::size_t i = 0; i < m; ++i)
        ASSERT_NEAR(change[i], v[i], 1e-13 * largest(v));

      // energy of the impulses: r . M_hat^{-1} r >= 0
      EXPECT_GE(dot(P, U), 0.);
      EXPECT_NEAR(dot(P, U), dot(r, v), 1e-13 * dot(r, v));

      // H^T is the transpose of H
      const Vector velocity = random_vector(m, 100 + seed);
      Vector jump(n);
      dynamics.relative_velocity(velocity.data(), jump.data());
      double terms = 0.;
      for (std::size_t i = 0; i < m; ++i)
        terms += std::abs(velocity[i] * r[i]);
      EXPECT_NEAR(dot(P, jump), dot(velocity, r), 1e-13 * terms);

      // M_hat M_hat^{-1} = 1, M_hat = M + h^2 theta^2 K
      const double factor = std::pow(scene.time_step * 0.6, 2);
      Vector Mv(m), Kv(m);
      dynamics.apply(Dynamics<dim>::Operator::mass, v.data(), Mv.data());
      dynamics.apply(Dynamics<dim>::Operator::stiffness, v.data(), Kv.data());
      for (std::size_t i = 0; i < m; ++i)
        ASSERT_NEAR(Mv[i] + factor * Kv[i], r[i], 1e-11 * largest(r))
            << "condition of a cell's block: a few hundred";
    }

    // The smallest eigenvalue: impulses with no effect are those of W P = 0.
    // Inverse iteration would need a factor; the worst of random vectors
    // pushed towards the kernel by (1 - W / |W|)^k is as good.
    double norm = 0.;
    for (const auto &column : W) {
      double sum = 0.;
      for (const double value : column)
        sum += std::abs(value);
      norm = std::max(norm, sum);
    }
    Vector P = random_vector(n, 77);
    for (unsigned int k = 0; k < 2000; ++k) {
      const Vector U = delassus(dynamics, P);
      for (std::size_t i = 0; i < n; ++i)
        P[i] -= U[i] / norm;
      const double length = std::sqrt(dot(P, P));
      for (double &value : P)
        value /= length;
    }
    EXPECT_GE(dot(P, delassus(dynamics, P)), -1e-14 * norm);

    // diagonal blocks of the faces
    const auto &faces = scene.discretization->points().faces;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const unsigned int count = faces[f].count * dim;
      const std::size_t first = std::size_t(faces[f].first) * dim;
      for (unsigned int i = 0; i < count; ++i)
        for (unsigned int j = 0; j < count; ++j)
          ASSERT_NEAR(dynamics.face_block(f)[i * count + j],
                      W[first + j][first + i], 1e-13 * size);
    }
  }

  TEST(Dynamics, Quads) { check_operator<2>(quads); }
  TEST(Dynamics, Triangles) { check_operator<2>(triangles); }
  TEST(Dynamics, Hexes) { check_operator<3>(hexes); }
  TEST(Dynamics, Tetrahedra) { check_operator<3>(tets); }
  TEST(Dynamics, RigidAndDeformable)
  {
    check_operator<2>(mixed);
    const Scene<2> scene(mixed);
    if (scene.communicator.size() > 1)
      return;
    const auto &classes = scene.discretization->bodies().classes;
    const auto rigid = std::count_if(classes.begin(), classes.end(),
                                     [](const auto &c) { return c.rigid; });
    EXPECT_GT(rigid, 0);
    EXPECT_LT(rigid, long(classes.size()));
  }

  template <int dim>
  void check_translation(const std::string &text)
  {
    // a common velocity opens no face, and only points on the boundary see it
    Scene<dim> scene(text);
    const auto &discretization = *scene.discretization;
    const auto &bodies = discretization.bodies();
    const auto v = discretization.interpolate(
        [](const dealii::Point<dim> &, const unsigned int, double *values) {
          for (unsigned int c = 0; c < dim; ++c)
            values[c] = 1. + c;
        });
    ASSERT_EQ(v.size(), bodies.n_dofs());
    const std::size_t n = discretization.points().n_points;
    Vector U(n * dim);
    scene.dynamics->relative_velocity(v.data(), U.data());
    for (std::size_t i = 0; i < n; ++i) {
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        size += U[i * dim + c] * U[i * dim + c];
      const bool inside =
          discretization.origins()[i].kind == PointOrigin::Kind::interface;
      // round-off of shape functions that add up to one
      EXPECT_NEAR(std::sqrt(size),
                  inside     ? 0.
                  : dim == 2 ? std::sqrt(5.)
                             : std::sqrt(14.),
                  1e-13);
    }
  }

  TEST(Dynamics, TranslationOpensNothing)
  {
    check_translation<2>(quads);
    check_translation<2>(triangles);
    check_translation<3>(hexes);
    check_translation<3>(tets);
    check_translation<2>(mixed);
  }

  TEST(Dynamics, ReinitFollowsTheStep)
  {
    Scene<2> scene(quads);
    const std::size_t n = scene.discretization->points().n_points * 2;
    const Vector P = random_vector(n, 1);
    const Vector at_step = delassus(*scene.dynamics, P);
    const auto count = scene.dynamics->counters().factorisations;
    scene.dynamics->reinit(scene.time_step, 0.6);
    EXPECT_EQ(scene.dynamics->counters().factorisations, count)
        << "nothing has changed";
    scene.dynamics->reinit(scene.time_step / 2., 0.6);
    EXPECT_GT(scene.dynamics->counters().factorisations, count);
    const Vector half = delassus(*scene.dynamics, P);
    EXPECT_GT(dot(P, half), dot(P, at_step) * (1. + 1e-6))
        << "a shorter step leaves less stiffness in M_hat";
    scene.dynamics->reinit(scene.time_step, 0.6);
    EXPECT_EQ(delassus(*scene.dynamics, P), at_step);
  }

  // --- kernels

  TEST(BlockKernels, OneColumnAndEightAreTheSameBits)
  {
    for (unsigned int rows = 1; rows <= 40; ++rows)
      for (const unsigned int cols : {1u, 2u, 7u, 8u, 13u, 32u}) {
        Block A(rows, cols);
        Vector numbers = random_vector(std::size_t(rows) * cols, rows * cols);
        for (unsigned int r = 0; r < rows; ++r)
          for (unsigned int c = 0; c < cols; ++c)
            A(r, c) = numbers[r * cols + c] * std::pow(10., int(r + c) % 9 - 4);
        const Vector X = random_vector(std::size_t(cols) * lanes, 3 * rows);
        Vector Y(std::size_t(padded(rows)) * lanes);
        multiply_lanes(A.values.data(), rows, cols, X.data(), Y.data());
        for (unsigned int l = 0; l < lanes; ++l) {
          Vector x(cols), y(padded(rows));
          for (unsigned int c = 0; c < cols; ++c)
            x[c] = X[c * lanes + l];
          multiply_one(A.values.data(), rows, cols, x.data(), y.data());
          for (unsigned int r = 0; r < rows; ++r) {
            ASSERT_EQ(y[r], Y[r * lanes + l]);
            double plain = 0., size = 0.;
            for (unsigned int c = 0; c < cols; ++c) {
              plain += A(r, c) * x[c];
              size += std::abs(A(r, c) * x[c]);
            }
            ASSERT_NEAR(y[r], plain, 1e-15 * cols * size);
          }
        }
      }
  }

  TEST(BlockKernels, FactorAndGram)
  {
    // A = B^T B + 1, then L L^T = A and gram(L^{-1}) = A^{-1}
    const unsigned int n = 19;
    Block B(n, n);
    const Vector numbers = random_vector(n * n, 4);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        B(i, j) = numbers[i * n + j];
    Block A = gram(B);
    for (unsigned int i = 0; i < n; ++i)
      A(i, i) += 1.;
    Block one(n, n);
    for (unsigned int i = 0; i < n; ++i)
      one(i, i) = 1.;
    const Block L = cholesky(A), inverse = gram(forward_solve(L, one)),
                LLt = product(L, L.transposed()), AA = product(A, inverse);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j) {
        EXPECT_EQ(inverse(i, j), inverse(j, i));
        EXPECT_NEAR(LLt(i, j), A(i, j), 1e-13 * n);
        EXPECT_NEAR(AA(i, j), one(i, j), 1e-12)
            << "condition below 1e3, entries of A below 20";
      }
    A(7, 7) = -1.;
    EXPECT_THROW(cholesky(A), std::runtime_error);
  }

  // --- sums

  /** Terms of very different sizes and both signs. */
  Vector wild_terms(const std::size_t n, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1., 1.), exponent(-12., 3.);
    Vector x(n);
    for (double &value : x)
      value = number(random) * std::pow(10., exponent(random));
    return x;
  }

  /** The part of the terms that this rank holds if dealt out one by one. */
  Vector dealt(const Communicator &communicator, const Vector &terms,
               const unsigned int offset = 0)
  {
    Vector mine;
    for (std::size_t i = 0; i < terms.size(); ++i)
      if (int((i + offset) % communicator.size()) == communicator.rank())
        mine.push_back(terms[i]);
    return mine;
  }

  TEST(Communicator, SumsDoNotDependOnTheOrder)
  {
    const Communicator alone(MPI_COMM_SELF), world(MPI_COMM_WORLD);
    std::mt19937 random(9);
    for (const std::size_t n : {1u, 7u, 8u, 9u, 1000u, 4321u}) {
      Vector terms = wild_terms(n, unsigned(n));
      const double sum = alone.sum(terms);
      // accurate: 2^-50 of n times the largest term is what may be dropped
      long double exact = 0.;
      for (const double term : terms)
        exact += term;
      EXPECT_NEAR(sum, double(exact), std::ldexp(n * largest(terms), -50));
      for (unsigned int k = 0; k < 20; ++k) {
        std::shuffle(terms.begin(), terms.end(), random);
        ASSERT_EQ(alone.sum(terms), sum) << "order, n = " << n;
        ASSERT_EQ(world.sum(dealt(world, terms, k)), sum) << "ranks";
      }
      // zeros are no terms
      terms.resize(n + 100, 0.);
      std::shuffle(terms.begin(), terms.end(), random);
      EXPECT_EQ(alone.sum(terms), sum);
      // neither is another row
      Vector rows(terms);
      const Vector other = wild_terms(terms.size(), 5);
      rows.insert(rows.end(), other.begin(), other.end());
      const Vector sums = alone.sums(rows.data(), 2, terms.size());
      EXPECT_EQ(sums[0], sum);
      EXPECT_EQ(sums[1], alone.sum(other));
    }
  }

  TEST(Communicator, DotIsASumOfProducts)
  {
    const Communicator alone(MPI_COMM_SELF);
    const Vector a = wild_terms(501, 1), b = wild_terms(501, 2);
    Vector products(500);
    for (std::size_t i = 0; i < products.size(); ++i)
      products[i] = a[i] * b[i];
    EXPECT_EQ(alone.dot(a.data(), b.data(), 500), alone.sum(products));
  }

  TEST(Communicator, CancellingSumsAreExact)
  {
    // pairs that cancel leave what lies within 2^-50 of the largest term
    const Communicator alone(MPI_COMM_SELF), world(MPI_COMM_WORLD);
    std::mt19937 random(10);
    for (const double rest : {0., 1., -std::ldexp(3., -10)}) {
      Vector terms;
      for (const double x : random_vector(3000, 6)) {
        const double large = std::ldexp(x, 40);
        terms.push_back(large);
        terms.push_back(-large);
      }
      terms.push_back(rest);
      for (unsigned int k = 0; k < 10; ++k) {
        std::shuffle(terms.begin(), terms.end(), random);
        EXPECT_EQ(alone.sum(terms), rest);
        EXPECT_EQ(world.sum(dealt(world, terms, k)), rest);
      }
      // a plain sum fails here, or this test would show nothing
      if (rest == 0.) {
        EXPECT_NE(std::accumulate(terms.begin(), terms.end(), 0.), rest);
      }
    }
  }

  TEST(Communicator, SumsOfNothingAndOfNonsense)
  {
    const Communicator alone(MPI_COMM_SELF);
    EXPECT_EQ(alone.sum(Vector()), 0.);
    EXPECT_EQ(alone.sum(Vector(10, 0.)), 0.);
    // an infinite or undefined term must not get lost
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()})
      for (const std::size_t place : {0u, 5u, 9u, 16u}) {
        Vector terms(17, 1.);
        terms[place] = bad;
        EXPECT_FALSE(std::isfinite(alone.sum(terms)));
      }
    // extreme but finite
    EXPECT_EQ(alone.sum(Vector{1e-300, 2e-300}), 3e-300);
  }

  // --- preconditioners

  /** D > 0 on all components, or on some: the others do not take part. */
  Vector compliance(const Vector &diagonal, const bool all, const double from,
                    const double to)
  {
    std::mt19937 random(12);
    std::uniform_real_distribution<double> unit(0., 1.);
    Vector D(diagonal.size());
    for (std::size_t k = 0; k < D.size(); ++k)
      D[k] = !all && unit(random) < 0.3
                 ? -1.
                 : diagonal[k] * from * std::pow(to / from, unit(random));
    return D;
  }

  template <int dim>
  Vector delassus_diagonal(const Dynamics<dim> &dynamics)
  {
    const auto &points = dynamics.points();
    Vector result(points.n_points * dim);
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const unsigned int n = points.faces[f].count * dim;
      for (unsigned int k = 0; k < n; ++k)
        result[std::size_t(points.faces[f].first) * dim + k] =
            dynamics.face_block(f)[k * n + k];
    }
    return result;
  }

  template <int dim>
  void check_sparse(const std::string &text, const std::string &solver)
  {
    Scene<dim> scene(text,
                     {"Solver/path=global", "Solver/linear solver=" + solver});
    auto &dynamics = *scene.dynamics;
    const Vector diagonal = delassus_diagonal(dynamics);
    const std::size_t n = diagonal.size();
    for (const bool all : {true, false}) {
      const Vector D = compliance(diagonal, all, 1e-2, 1e2);
      dynamics.prepare_preconditioner(D);
      for (unsigned int seed = 0; seed < 3; ++seed) {
        const Vector r = random_vector(n, 30 + seed);
        Vector z(n), Wz(n);
        dynamics.precondition(r.data(), z.data());
        for (std::size_t k = 0; k < n; ++k)
          if (D[k] < 0.) {
            EXPECT_EQ(z[k], 0.) << "does not take part";
          }
        dynamics.apply_delassus(z.data(), Wz.data());
        // Woodbury subtracts numbers that are 1 / D = 100 times larger, the
        // inner solve of `cg` stops at 1e-11
        for (std::size_t k = 0; k < n; ++k)
          if (D[k] >= 0.) {
            ASSERT_NEAR(Wz[k] + D[k] * z[k], r[k], 1e-9) << solver;
          }
      }
    }
  }

  TEST(Preconditioner, SparseIsTheInverse)
  {
    for (const std::string solver : {"direct", "cg"}) {
      check_sparse<2>(quads, solver);
      check_sparse<2>(triangles, solver);
      check_sparse<3>(hexes, solver);
      check_sparse<3>(tets, solver);
      check_sparse<2>(mixed, solver);
    }
  }

  TEST(Preconditioner, SparseReusesItsFactor)
  {
    Scene<2> scene(quads, {"Solver/path=global"});
    auto &dynamics = *scene.dynamics;
    Vector D = delassus_diagonal(dynamics);
    dynamics.prepare_preconditioner(D);
    const auto count = dynamics.counters().global_factorisations;
    dynamics.prepare_preconditioner(D);
    EXPECT_EQ(dynamics.counters().global_factorisations, count);
    D[3] *= 2.;
    dynamics.prepare_preconditioner(D);
    EXPECT_EQ(dynamics.counters().global_factorisations, count + 1);
    dynamics.reinit(scene.time_step / 2., 0.6);
    dynamics.prepare_preconditioner(D);
    EXPECT_EQ(dynamics.counters().global_factorisations, count + 2);
  }

  template <int dim>
  void check_elementwise(const std::string &text)
  {
    Scene<dim> scene(text);
    auto &dynamics = *scene.dynamics;
    const Vector diagonal = delassus_diagonal(dynamics);
    const std::size_t n = diagonal.size();
    for (const bool all : {true, false}) {
      const Vector D = compliance(diagonal, all, 1e-2, 1e2);
      dynamics.prepare_preconditioner(D);
      const Vector r = random_vector(n, 40);
      Vector z(n, 5.);
      dynamics.precondition(r.data(), z.data());
      // (W_ff + D_f) z_f = r_f on the components that take part
      const auto &faces = dynamics.points().faces;
      for (std::size_t f = 0; f < faces.size(); ++f) {
        const unsigned int count = faces[f].count * dim;
        const std::size_t first = std::size_t(faces[f].first) * dim;
        for (unsigned int i = 0; i < count; ++i) {
          if (D[first + i] < 0.) {
            EXPECT_EQ(z[first + i], 0.);
            continue;
          }
          double value = D[first + i] * z[first + i];
          for (unsigned int j = 0; j < count; ++j)
            value += dynamics.face_block(f)[i * count + j] * z[first + j];
          // condition below 1e4 / 1e-2
          ASSERT_NEAR(value, r[first + i], 1e-10);
        }
      }
    }
  }

  TEST(Preconditioner, ElementwiseInvertsTheFaces)
  {
    check_elementwise<2>(quads);
    check_elementwise<2>(triangles);
    check_elementwise<3>(hexes);
    check_elementwise<3>(tets);
    check_elementwise<2>(mixed);
  }

  // --- Newton systems in single precision

  /** Round-off of single precision times a condition number of some 1e3. */
  constexpr double single_tolerance = 1e-4;

  /** Largest |x_k - y_k| / s_k against the largest |y_k| / s_k. */
  double scaled_difference(const Vector &x, const Vector &y, const Vector &s)
  {
    double difference = 0., size = 0.;
    for (std::size_t k = 0; k < x.size(); ++k) {
      difference = std::max(difference, std::abs(x[k] - y[k]) / s[k]);
      size = std::max(size, std::abs(y[k]) / s[k]);
    }
    return difference / size;
  }

  template <int dim>
  void check_inner(const std::string &text)
  {
    Scene<dim> scene(text);
    auto &dynamics = *scene.dynamics;
    auto *inner = dynamic_cast<InnerSolver *>(scene.dynamics.get());
    ASSERT_NE(inner, nullptr);
    const Vector diagonal = delassus_diagonal(dynamics);
    const std::size_t n = diagonal.size();
    Vector root(n);
    for (std::size_t k = 0; k < n; ++k)
      root[k] = std::sqrt(diagonal[k]);
    for (const bool all : {true, false}) {
      const Vector D = compliance(diagonal, all, 1e-1, 1e2);
      Vector r = random_vector(n, 60), x(n, 3.);
      for (std::size_t k = 0; k < n; ++k)
        r[k] = D[k] >= 0. ? r[k] * root[k] : 0.;
      EXPECT_GT(inner->solve_inner({D, 1e-6, 1000, nullptr, nullptr, 0.}, r, x),
                0u);
      Vector residual = delassus(dynamics, x);
      for (std::size_t k = 0; k < n; ++k)
        if (D[k] < 0.) {
          EXPECT_EQ(x[k], 0.) << "does not take part";
          residual[k] = 0.;
        } else
          residual[k] += D[k] * x[k];
      EXPECT_LT(scaled_difference(residual, r, root), single_tolerance);

      // (I - J (W + shift R - R)) x = r, J unsymmetric, no slope where D < 0
      const double shift = 1e-3;
      const Vector noise = random_vector(n * dim, 70);
      Vector J(n * dim, 0.), R(diagonal), f = random_vector(n, 80), y(n, 3.);
      for (std::size_t k = 0; k < n; ++k) {
        R[k] *= 1.5;
        f[k] /= root[k];
        if (D[k] < 0.)
          continue;
        for (unsigned int c = 0; c < dim; ++c) {
          const std::size_t j = k - k % dim + c;
          J[k * dim + c] = c == k % dim ? -1. / (D[k] + R[k])
                           : D[j] < 0.
                               ? 0.
                               : 0.2 * noise[k * dim + c] /
                                     std::sqrt((D[k] + R[k]) * (D[j] + R[j]));
        }
      }
      EXPECT_GT(inner->solve_inner({D, 1e-6, 400, &J, &R, shift}, f, y), 0u);
      Vector Wy = delassus(dynamics, y), result(y), inverse(n);
      for (std::size_t k = 0; k < n; ++k) {
        inverse[k] = 1. / root[k];
        Wy[k] -= (1. - shift) * R[k] * y[k];
      }
      for (std::size_t k = 0; k < n; ++k)
        for (unsigned int c = 0; c < dim; ++c)
          result[k] -= J[k * dim + c] * Wy[k - k % dim + c];
      EXPECT_LT(scaled_difference(result, f, inverse), single_tolerance);
    }
  }

  TEST(InnerSolver, SolvesWhatItIsGiven)
  {
    check_inner<2>(quads);
    check_inner<2>(triangles);
    check_inner<3>(hexes);
    check_inner<3>(tets);
    check_inner<2>(mixed);
  }

  TEST(InnerSolver, LargeClassesAndSmallOnes)
  {
    // all bodies share one block, or each has its own
    std::string even = quads;
    const std::string word = "distortion = 0.25";
    even.replace(even.find(word), word.size(), "distortion = 0");
    even.replace(even.find("cells = 3, 2"), 12, "cells = 9, 6");
    check_inner<2>(even);
  }

  TEST(InnerSolver, NothingComesFromNothing)
  {
    Scene<2> scene(quads);
    auto *inner = dynamic_cast<InnerSolver *>(scene.dynamics.get());
    const Vector D = delassus_diagonal(*scene.dynamics);
    Vector x(D.size(), 3.);
    EXPECT_EQ(inner->solve_inner({D, 1e-6, 100, nullptr, nullptr, 0.},
                                 Vector(D.size(), 0.), x),
              0u);
    EXPECT_EQ(largest(x), 0.);
  }

  // A^{-1} M R = R for the rigid motions R, and A^{-1} K q -> q / f for the
  // strains, however little of the mass f K leaves in the entries of A.
  template <int dim>
  void check_inverse(const std::string &text)
  {
    Scene<dim> scene(text);
    const BodyClass &body = scene.discretization->bodies().classes.front();
    const unsigned int n = body.n_dofs;
    const Block &R = body.rigid_motions;
    ASSERT_EQ(R.cols, dim == 2 ? 3u : 6u);
    Block identity(n, n);
    double stiffness = 0., mass = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      identity(i, i) = 1.;
      stiffness += body.stiffness(i, i);
      mass += body.mass(i, i);
    }
    Block q(n, 1); // a strain: no part of it moves rigidly
    const Vector x = random_vector(n, 7);
    const Block momenta = product(body.mass, R);
    for (unsigned int i = 0; i < n; ++i)
      q(i, 0) = x[i];
    for (unsigned int k = 0; k < R.cols; ++k) {
      double share = 0.;
      for (unsigned int i = 0; i < n; ++i)
        share += momenta(i, k) * x[i];
      for (unsigned int i = 0; i < n; ++i)
        q(i, 0) -= share * R(i, k);
    }
    const Block force = product(body.stiffness, q);
    for (const double ratio : {1., 1e8, 1e16, 1e24, 1e32}) { // f K over M
      SCOPED_TRACE(ratio);
      const double f = ratio * mass / stiffness;
      const Block inverse = BlockInverse(body, f).form(identity);
      const Block motions = product(inverse, momenta);
      // less than four digits are left of M where A itself is factorised
      const double left = ratio < 1e12 ? 1e-14 * ratio : 0.;
      double size = 0.;
      for (unsigned int k = 0; k < R.cols; ++k)
        for (unsigned int i = 0; i < n; ++i)
          size = std::max(size, std::abs(R(i, k)));
      for (unsigned int k = 0; k < R.cols; ++k)
        for (unsigned int i = 0; i < n; ++i)
          ASSERT_NEAR(motions(i, k), R(i, k), (1e-12 + 10. * left) * size);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < i; ++j)
          ASSERT_EQ(inverse(i, j), inverse(j, i));
      if (ratio != 1e8)
        continue; // strains are seen where neither part hides the other
      const Block back = product(inverse, force);
      for (unsigned int i = 0; i < n; ++i)
        EXPECT_NEAR(f * back(i, 0), q(i, 0), 1e-4);
    }
  }

  TEST(Operators, LongStepsLeaveRigidMotionsAlone)
  {
    check_inverse<2>(quads);
    check_inverse<2>(triangles);
    check_inverse<3>(hexes);
    check_inverse<3>(tets);
  }

  TEST(Preconditioner, RigidRowsStayPositive)
  {
    // D = 0 with more points than a rigid face has modes: W_ff is singular,
    // the preconditioner must stay symmetric, positive and finite
    Scene<2> scene(mixed);
    auto &dynamics = *scene.dynamics;
    const std::size_t n = dynamics.points().n_points * 2;
    dynamics.prepare_preconditioner(Vector(n, 0.));
    for (unsigned int seed = 0; seed < 10; ++seed) {
      const Vector r = random_vector(n, seed), s = random_vector(n, 50 + seed);
      Vector z(n), y(n);
      dynamics.precondition(r.data(), z.data());
      dynamics.precondition(s.data(), y.data());
      EXPECT_GT(dot(r, z), 0.);
      EXPECT_NEAR(dot(s, z), dot(r, y),
                  1e-12 * std::sqrt(dot(r, z) * dot(s, y)));
    }
  }
} // namespace test_dynamics
