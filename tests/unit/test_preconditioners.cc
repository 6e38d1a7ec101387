#include "small_meshes.h"

namespace small_meshes::test_preconditioners
{
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
  Vector delassus_diagonal(const DelassusOperator<dim> &delassus)
  {
    Vector result(delassus.points().n_points * dim);
    for (std::size_t k = 0; k < result.size(); ++k)
      result[k] = delassus.point_block(k / dim)[k % dim * (dim + 1)];
    return result;
  }

  template <int dim>
  void check_sparse(const std::string &text, const std::string &solver)
  {
    Scene<dim> scene(
        text, {"Solver/path=assembled", "Solver/linear solver=" + solver});
    auto &delassus = *scene.delassus;
    const Vector diagonal = delassus_diagonal(delassus);
    const std::size_t n = diagonal.size();
    for (const bool all : {true, false}) {
      const Vector D = compliance(diagonal, all, 1e-2, 1e2);
      delassus.prepare_preconditioner(D);
      for (unsigned int seed = 0; seed < 3; ++seed) {
        const Vector r = random_vector(n, 30 + seed);
        Vector z(n), Wz(n);
        delassus.precondition(r.data(), z.data());
        for (std::size_t k = 0; k < n; ++k)
          if (D[k] < 0.) {
            EXPECT_EQ(z[k], 0.) << "does not take part";
          }
        delassus.apply_delassus(z.data(), Wz.data());
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
    Scene<2> scene(quads, {"Solver/path=assembled"});
    auto &delassus = *scene.delassus;
    Vector D = delassus_diagonal(delassus);
    delassus.prepare_preconditioner(D);
    const auto count = delassus.counters().global_factorisations;
    delassus.prepare_preconditioner(D);
    EXPECT_EQ(delassus.counters().global_factorisations, count);
    D[3] *= 2.;
    delassus.prepare_preconditioner(D);
    EXPECT_EQ(delassus.counters().global_factorisations, count + 1);
    delassus.reinit(scene.time_step / 2., 0.6);
    delassus.prepare_preconditioner(D);
    EXPECT_EQ(delassus.counters().global_factorisations, count + 2);
  }

  template <int dim>
  void check_elementwise(const std::string &text)
  {
    Scene<dim> scene(text);
    auto &delassus = *scene.delassus;
    const Vector diagonal = delassus_diagonal(delassus);
    const std::size_t n = diagonal.size();
    for (const bool all : {true, false}) {
      const Vector D = compliance(diagonal, all, 1e-2, 1e2);
      delassus.prepare_preconditioner(D);
      const Vector r = random_vector(n, 40);
      Vector z(n, 5.);
      delassus.precondition(r.data(), z.data());
      // (W_ff + D_f) z_f = r_f on the components that take part
      const auto &faces = delassus.points().faces;
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
            value += delassus.face_block(f)[i * count + j] * z[first + j];
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
    auto &delassus = *scene.delassus;
    auto *inner = dynamic_cast<InnerSolver *>(scene.delassus.get());
    ASSERT_NE(inner, nullptr);
    const Vector diagonal = delassus_diagonal(delassus);
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
      Vector residual = product_with_W(delassus, x);
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
      Vector Wy = product_with_W(delassus, y), result(y), inverse(n);
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
    auto *inner = dynamic_cast<InnerSolver *>(scene.delassus.get());
    const Vector D = delassus_diagonal(*scene.delassus);
    Vector x(D.size(), 3.);
    EXPECT_EQ(inner->solve_inner({D, 1e-6, 100, nullptr, nullptr, 0.},
                                 Vector(D.size(), 0.), x),
              0u);
    EXPECT_EQ(largest(x), 0.);
  }

  TEST(Preconditioner, RigidRowsStayPositive)
  {
    // D = 0 with more points than a rigid face has modes: W_ff is singular,
    // the preconditioner must stay symmetric, positive and finite
    Scene<2> scene(mixed);
    auto &delassus = *scene.delassus;
    const std::size_t n = delassus.points().n_points * 2;
    delassus.prepare_preconditioner(Vector(n, 0.));
    for (unsigned int seed = 0; seed < 10; ++seed) {
      const Vector r = random_vector(n, seed), s = random_vector(n, 50 + seed);
      Vector z(n), y(n);
      delassus.precondition(r.data(), z.data());
      delassus.precondition(s.data(), y.data());
      EXPECT_GT(dot(r, z), 0.);
      EXPECT_NEAR(dot(s, z), dot(r, y),
                  1e-12 * std::sqrt(dot(r, z) * dot(s, y)));
    }
  }
} // namespace small_meshes::test_preconditioners
