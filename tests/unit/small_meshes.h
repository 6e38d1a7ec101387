#pragma once

#include "delassus/block_inverse.h"
#include "make_scene.h"

#include "delassus/inner_solver.h"
#include "linear_algebra/block_kernels.h"

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

namespace small_meshes
{
  using namespace nsfd;
  using nsfd::test::Scene;

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

  inline std::string time(const std::string &step)
  {
    return "subsection Time\n  set end = 1000\n  set step = " + step +
           "\n  set theta = 0.6\nend\n";
  }

  inline std::string mesh(const std::string &type, const std::string &upper,
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
                            springs + supports_2d + time("2 courant");
  const std::string triangles = mesh("crossed triangles", "3, 2", "2, 1", 2) +
                                solid + springs + supports_2d +
                                time("2 courant");
  const std::string hexes = mesh("brick", "3, 2, 1", "2, 2, 1", 2) + solid +
                            springs + supports_3d + time("2 courant");
  const std::string tets = mesh("tetrahedra", "3, 2, 1", "2, 1, 1", 1) + solid +
                           springs + supports_3d + time("2 courant");
  const std::string mixed = mesh("rectangle", "3, 2", "4, 3", 2) + half_rigid +
                            solid + springs + supports_2d + time("2 courant");

  inline Vector random_vector(const std::size_t n, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1., 1.);
    Vector x(n);
    for (double &value : x)
      value = number(random);
    return x;
  }

  inline double largest(const Vector &x)
  {
    double result = 0.;
    for (const double value : x)
      result = std::max(result, std::abs(value));
    return result;
  }

  inline double dot(const Vector &a, const Vector &b)
  {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
  }

  template <int dim>
  Vector product_with_W(const DelassusOperator<dim> &delassus, const Vector &P)
  {
    Vector U(P.size());
    delassus.apply_delassus(P.data(), U.data());
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
      W.push_back(product_with_W(*scene.delassus, P));
    }
    return W;
  }
} // namespace small_meshes
