#include "make_scene.h"

#include "delassus/sparse_assembly.h"
#include "discretization/cells.h"
#include "discretization/node_coordinates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

// The sparse matrix of all bodies against its factors M, K and H, the numbers
// of the joined space against places in space, and both solvers against the
// matrix.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_spd_solver
{
  using Vector = std::vector<double>;

  std::string text(const std::string &type, const std::string &upper,
                   const std::string &cells, const unsigned int degree)
  {
    const auto dim = std::count(cells.begin(), cells.end(), ',') + 1;
    return "set dimension = " + std::to_string(dim) +
           "\nsubsection Mesh\n  set type = " + type +
           "\n  set upper corner = " + upper + "\n  set cells = " + cells +
           "\n  set distortion = 0.1\nend\n"
           "subsection Discretization\n  set degree = " +
           std::to_string(degree) + R"(
end
subsection Material: solid
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: springs
  set law                  = elastic
  set normal stiffness     = 20
  set tangential stiffness = 7
end
subsection Boundary: bottom
  set velocity y = 0
end
subsection Time
  set end  = 1000
  set step = 2 courant
end
)";
  }

  const std::string quads = text("rectangle", "4, 3", "4, 3", 2),
                    triangles = text("crossed triangles", "4, 2", "4, 2", 2),
                    hexes = text("brick", "4, 2, 2", "4, 2, 2", 1),
                    tets = text("tetrahedra", "4, 1, 1", "4, 1, 1", 1);

  Vector random_vector(const std::size_t n, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1., 1.);
    Vector x(n);
    for (double &value : x)
      value = number(random);
    return x;
  }

  Vector product(const SparseRows &A, const Vector &x)
  {
    Vector y(x.size(), 0.);
    for (int i = 0; i < A.n_rows(); ++i)
      for (int k = A.start[i]; k < A.start[i + 1]; ++k)
        y[i] += A.value[k] * x[A.column[k]];
    return y;
  }

  /** Springs a decade apart from face to face; those of faces across x = 2 are
   * broken. */
  template <int dim>
  Vector springs(const Scene<dim> &scene, const bool broken)
  {
    const auto &points = scene.discretization->points();
    Vector k(points.n_points * dim);
    const Vector exponent = random_vector(points.faces.size(), 3);
    for (std::size_t i = 0; i < k.size(); ++i) {
      const auto &face = points.faces[points.face_of[i / dim]];
      k[i] = 1e4 * std::pow(10., 0.5 * exponent[points.face_of[i / dim]]) *
             (i % dim == 0 ? 2. : 1.);
      if (broken && std::abs(face.centre[0] - 2.) < 0.3 &&
          std::abs(points.axes(i / dim)[0]) > 0.85)
        k[i] = 0.;
    }
    return k;
  }

  template <int dim>
  struct Parts {
    explicit Parts(const std::string &input, const bool broken = false)
        : scene(input), coordinates(node_coordinates(*scene.discretization)),
          assembly(scene.communicator, scene.discretization->bodies(),
                   scene.discretization->points(), coordinates),
          k(springs(scene, broken))
    {
      s = std::pow(scene.time_step * scene.input->time.theta, 2);
      assembly.assemble(s, k);
    }
    Scene<dim> scene;
    Vector coordinates;
    SparseAssembly<dim> assembly;
    Vector k;
    double s;
  };

  template <int dim>
  void check_matrix(const std::string &input)
  {
    Parts<dim> parts(input);
    const auto &delassus = *parts.scene.delassus;
    const std::size_t n = delassus.bodies().n_dofs();
    const Vector x = random_vector(n, 5);
    Vector expected(n), y(n), jump(parts.k.size());
    delassus.relative_velocity(x.data(), jump.data());
    for (std::size_t i = 0; i < jump.size(); ++i)
      jump[i] *= parts.k[i];
    delassus.generalised_impulse(jump.data(), expected.data());
    delassus.apply(DelassusOperator<dim>::Operator::mass, x.data(), y.data());
    for (std::size_t i = 0; i < n; ++i)
      expected[i] += y[i];
    delassus.apply(DelassusOperator<dim>::Operator::stiffness, x.data(),
                   y.data());
    double size = 0.;
    for (std::size_t i = 0; i < n; ++i) {
      expected[i] += parts.s * y[i];
      size = std::max(size, std::abs(expected[i]));
    }
    const Vector found = product(parts.assembly.matrix(), x);
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_NEAR(found[i], expected[i], 1e-12 * size) << i;
  }

  TEST(SpdSolver, MatrixIsMassStiffnessAndSprings)
  {
    check_matrix<2>(quads);
    check_matrix<2>(triangles);
    check_matrix<3>(hexes);
    check_matrix<3>(tets);
  }

  /** Nodes at different places; apart on both sides of x = 2 if asked. */
  template <int dim>
  std::size_t count_nodes(const Parts<dim> &parts, const bool broken)
  {
    const auto &bodies = parts.scene.discretization->bodies();
    std::set<std::vector<long long>> places;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const bool right = parts.scene.discretization->cells().centre(b)[0] > 2.;
      for (std::size_t i = bodies.first_dof[b]; i < bodies.first_dof[b + 1];
           i += dim) {
        std::vector<long long> place{broken && right};
        for (unsigned int c = 0; c < dim; ++c)
          place.push_back(std::llround(1e8 * parts.coordinates[i + c]));
        places.insert(place);
      }
    }
    return places.size();
  }

  template <int dim>
  void check_joined(const std::string &input)
  {
    for (const bool broken : {false, true}) {
      const Parts<dim> parts(input, broken);
      ConformingSpace joined(parts.scene.communicator, dim,
                             parts.assembly.unknowns(),
                             parts.assembly.node_pairs());
      const auto carrying = parts.assembly.carrying(parts.s, parts.k);
      joined.conform(carrying);
      const CoarseSpace &space = joined.space();
      EXPECT_EQ(std::size_t(space.n_global), dim * count_nodes(parts, broken));
      // one unknown has one place, and the modes are rigid motions of it
      std::vector<Vector> at(space.n_global);
      for (std::size_t i = 0; i < parts.coordinates.size(); ++i)
        at[space.number[i]].push_back(parts.coordinates[i]);
      for (const Vector &x : at)
        EXPECT_NEAR(*std::min_element(x.begin(), x.end()),
                    *std::max_element(x.begin(), x.end()), 1e-9);
      EXPECT_EQ(space.modes.size(), dim == 2 ? 3u : 6u);
      const auto version = space.version;
      joined.conform(carrying);
      EXPECT_EQ(space.version, version) << "nothing has changed";
      joined.conform(std::vector<char>(carrying.size(), 0));
      EXPECT_EQ(space.n_global,
                static_cast<long long>(parts.coordinates.size()));
      EXPECT_GT(space.version, version);
    }
  }

  TEST(SpdSolver, JoinedNodesAreOneWhereFacesCarry)
  {
    check_joined<2>(quads);
    check_joined<2>(triangles);
    check_joined<3>(hexes);
    check_joined<3>(tets);
  }

  template <int dim>
  void check_solvers(const std::string &input)
  {
    for (const bool broken : {false, true}) {
      const Parts<dim> parts(input, broken);
      const auto &A = parts.assembly.matrix();
      const auto &communicator = parts.scene.communicator;
      ConformingSpace joined(communicator, dim, parts.assembly.unknowns(),
                             parts.assembly.node_pairs());
      joined.conform(parts.assembly.carrying(parts.s, parts.k));
      const auto &first = parts.scene.discretization->bodies().first_dof;
      const Vector x = random_vector(first.back(), 7), b = product(A, x);
      const auto check = [&](SpdSolver &solver, const char *name,
                             const unsigned int most) {
        solver.prepare(A, joined.space(), true);
        Vector y(x.size(), 0.);
        EXPECT_LE(solver.solve(b.data(), y.data(), 1e-12), most) << name;
        EXPECT_TRUE(solver.converged()) << name;
        const Vector Ay = product(A, y);
        double size = 0.;
        for (const double value : b)
          size = std::max(size, std::abs(value));
        for (std::size_t i = 0; i < y.size(); ++i) {
          ASSERT_NEAR(Ay[i], b[i], 1e-10 * size) << name;
          ASSERT_NEAR(y[i], x[i], 1e-8) << name; // condition below 1e4 / 1e-8
        }
        // a solution to start from leaves nothing to do
        const Vector again = y;
        solver.solve(b.data(), y.data(), 0.5);
        for (std::size_t i = 0; i < y.size(); ++i)
          ASSERT_NEAR(y[i], again[i], 1e-8) << name;
        solver.prepare(A, joined.space(), false);
        EXPECT_LE(solver.counters().coarse_spaces, 1u) << "kept";
        EXPECT_EQ(solver.counters().factorisations, 2u);
      };
      check(*make_cholesky_solver(communicator), "factor", 0);
      // a good preconditioner: half a digit per iteration, whatever the mesh
      check(*make_two_level_cg(communicator, first, 1000000),
            "joined space, exact", 70);
      check(*make_two_level_cg(communicator, first, 0),
            "joined space, multigrid", 90);
    }
  }

  TEST(SpdSolver, SolversInvertTheMatrix)
  {
    check_solvers<2>(quads);
    check_solvers<2>(triangles);
    check_solvers<3>(hexes);
    check_solvers<3>(tets);
  }

  /**
   * Springs of 1e16 the inertia of a body leave nothing of the mass in a sum
   * with them: a free translation t, A t = M t, comes back only from who keeps
   * the joined space apart.
   */
  template <int dim>
  void check_stiff(const std::string &input)
  {
    Parts<dim> parts(input);
    const auto &points = parts.scene.discretization->points();
    for (std::size_t i = 0; i < parts.k.size(); ++i) {
      const auto &face = points.faces[points.face_of[i / dim]];
      parts.k[i] = face.boundary ? 0. : 1e12 * parts.k[i];
    }
    const auto &communicator = parts.scene.communicator;
    const auto &delassus = *parts.scene.delassus;
    auto &assembly = parts.assembly;
    ConformingSpace joined(communicator, dim, assembly.unknowns(),
                           assembly.node_pairs());
    joined.conform(assembly.carrying(parts.s, parts.k));
    const auto &first = parts.scene.discretization->bodies().first_dof;
    const std::size_t n = first.back();
    const auto add_bodies = [&](const double *x, double *y) {
      Vector z(n);
      delassus.apply(DelassusOperator<dim>::Operator::mass, x, z.data());
      for (std::size_t i = 0; i < n; ++i)
        y[i] += z[i];
      delassus.apply(DelassusOperator<dim>::Operator::stiffness, x, z.data());
      for (std::size_t i = 0; i < n; ++i)
        y[i] += parts.s * z[i];
    };
    const auto solver = make_two_level_cg(communicator, first, 1000000);
    const auto faces = joined.without_jump();
    assembly.assemble(parts.s, parts.k, faces);
    solver->prepare_coarse(assembly.matrix(), joined.space(), add_bodies);
    assembly.add_springs(parts.k, faces);
    solver->prepare(assembly.matrix(), joined.space(), true);
    Vector t(n, 0.), b(n), rest(n), coarse(n);
    for (std::size_t i = 0; i < n; i += dim)
      t[i] = 1.;
    delassus.apply(DelassusOperator<dim>::Operator::mass, t.data(), b.data());
    EXPECT_LE(
        solver->solve_parts(b.data(), n, rest.data(), coarse.data(), 1e-10),
        70);
    EXPECT_TRUE(solver->converged());
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_NEAR(rest[i] + coarse[i], t[i], 1e-8);
    // what pulls at the springs is known apart from the translation
    Vector jump(parts.k.size());
    delassus.relative_velocity(rest.data(), jump.data());
    for (std::size_t i = 0; i < jump.size(); ++i)
      if (parts.k[i] > 0.) {
        ASSERT_NEAR(jump[i], 0., 1e-15);
      }
  }

  TEST(SpdSolver, SpringsBeyondTheDigitsOfTheMass)
  {
    check_stiff<2>(quads);
    check_stiff<2>(triangles);
    check_stiff<3>(hexes);
    check_stiff<3>(tets);
  }

  TEST(SpdSolver, RefusesWhatIsNotPositiveDefinite)
  {
    Communicator communicator(MPI_COMM_SELF);
    SparseRows A;
    A.start = {0, 2, 4};
    A.column = {0, 1, 0, 1};
    A.value = {1., 2., 2., 1.}; // eigenvalues 3 and -1
    EXPECT_THROW(
        make_cholesky_solver(communicator)->prepare(A, CoarseSpace(), true),
        std::runtime_error);
  }
} // namespace test_spd_solver
