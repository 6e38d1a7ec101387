// Cells whose joints make their nodes one: what they move, what they carry.
#include "make_scene.h"

#include "nonsmooth/solvers/tied_nodes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace nsfd::test_tied_nodes
{
  using Vector = std::vector<double>;

  std::string scene(const std::string &mesh)
  {
    return mesh + R"(
subsection Material: rubber
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1
  set tangential stiffness = 1
end
subsection Time
  set end  = 1
  set step = 0.1
end
)";
  }

  Vector random(const std::size_t n, const unsigned int seed)
  {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> number(-1., 1.);
    Vector x(n);
    for (double &value : x)
      value = number(generator);
    return x;
  }

  /** All faces but those of every @p open th point are held. */
  template <int dim>
  void expect_nodes(const std::string &mesh, const std::size_t n_nodes,
                    const std::size_t open)
  {
    test::Scene<dim> scene(test_tied_nodes::scene(mesh));
    const auto &delassus = *scene.delassus;
    const auto &points = delassus.points();
    std::vector<char> held(points.n_points, 1);
    for (std::size_t f = 0; f < points.faces.size(); ++f)
      if (open > 0 && f % open == 0)
        held[points.faces[f].first] = 0;
    const TiedNodes<dim> ties(delassus, held);
    ASSERT_TRUE(ties.any());
    if (n_nodes > 0) {
      EXPECT_EQ(ties.n_unknowns(), n_nodes * dim);
    }

    const std::size_t n = delassus.bodies().n_dofs(),
                      n_rows = points.n_points * dim;
    const auto tied = [&](const std::size_t k) {
      return ties.points()[k / dim] != 0;
    };
    std::size_t n_tied = 0;
    for (std::size_t i = 0; i < points.n_points; ++i)
      n_tied += tied(i * dim);
    EXPECT_GT(n_tied, 0u);

    // what moves as one has no jump
    Vector v, U(n_rows);
    ties.spread(random(ties.n_unknowns(), 1), v);
    delassus.relative_velocity(v.data(), U.data());
    for (std::size_t k = 0; k < n_rows; ++k)
      if (tied(k)) {
        EXPECT_NEAR(U[k], 0., 1e-13);
      }

    // jumps of a motion are those of another one
    delassus.relative_velocity(random(n, 2).data(), U.data());
    Vector V(n_rows);
    delassus.relative_velocity(ties.motion_of(U).data(), V.data());
    for (std::size_t k = 0; k < n_rows; ++k)
      if (tied(k)) {
        EXPECT_NEAR(U[k], V[k], 1e-12);
      }

    // impulses of the joints act as others do, and sum to nothing at a node
    Vector P = random(n_rows, 3), r(n), s(n), sums;
    for (std::size_t k = 0; k < n_rows; ++k)
      if (!tied(k))
        P[k] = 0.;
    delassus.generalised_impulse(P.data(), r.data());
    ties.fold(r, sums);
    for (const double sum : sums)
      EXPECT_NEAR(sum, 0., 1e-13);
    const Vector Q = ties.impulses_of(r);
    delassus.generalised_impulse(Q.data(), s.data());
    for (std::size_t k = 0; k < n_rows; ++k) {
      if (!tied(k)) {
        EXPECT_EQ(Q[k], 0.);
      }
    }
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(r[i], s[i], 1e-12);
  }

  TEST(TiedNodes, AreThoseOfAMesh)
  {
    const std::string plane = "set dimension = 2\nsubsection Mesh\n"
                              "  set type = rectangle\n"
                              "  set upper corner = 2, 1\n"
                              "  set cells = 4, 3\n"
                              "  set distortion = 0.2\nend\n",
                      space = "set dimension = 3\nsubsection Mesh\n"
                              "  set type = brick\n"
                              "  set upper corner = 2, 1, 1\n"
                              "  set cells = 3, 2, 2\n"
                              "  set distortion = 0.2\nend\n";
    const std::string quadratic =
        "subsection Discretization\n  set degree = 2\nend\n";
    expect_nodes<2>(plane, 5 * 4, 0);
    expect_nodes<2>(plane + quadratic, 9 * 7, 0);
    expect_nodes<3>(space, 4 * 3 * 3, 0);
    expect_nodes<2>("set dimension = 2\nsubsection Mesh\n"
                    "  set type = crossed triangles\n"
                    "  set upper corner = 2, 1\n"
                    "  set cells = 3, 2\nend\n",
                    4 * 3 + 6, 0);
    expect_nodes<3>("set dimension = 3\nsubsection Mesh\n"
                    "  set type = tetrahedra\n"
                    "  set upper corner = 2, 1, 1\n"
                    "  set cells = 2, 2, 1\nend\n",
                    0, 0);
  }

  TEST(TiedNodes, LeaveOpenFacesAlone)
  {
    for (const std::size_t open : {2, 3, 5}) {
      SCOPED_TRACE(open);
      expect_nodes<2>("set dimension = 2\nsubsection Mesh\n"
                      "  set type = rectangle\n"
                      "  set upper corner = 2, 1\n"
                      "  set cells = 4, 3\nend\n",
                      0, open);
      expect_nodes<3>("set dimension = 3\nsubsection Mesh\n"
                      "  set type = tetrahedra\n"
                      "  set upper corner = 2, 1, 1\n"
                      "  set cells = 2, 2, 2\nend\n",
                      0, open);
    }
  }
} // namespace nsfd::test_tied_nodes
