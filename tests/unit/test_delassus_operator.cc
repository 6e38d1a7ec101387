#include "small_meshes.h"

namespace small_meshes::test_delassus_operator
{
  template <int dim>
  void check_operator(const std::string &text)
  {
    Scene<dim> scene(text);
    if (scene.communicator.size() > 1)
      GTEST_SKIP() << "compares columns of one rank";
    const auto &delassus = *scene.delassus;
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
      const Vector P = random_vector(n, seed), U = product_with_W(delassus, P);

      // the operator is linear in its columns
      Vector columns(n, 0.);
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = 0; i < n; ++i)
          columns[i] += P[k] * W[k][i];
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_NEAR(U[i], columns[i], 1e-13 * largest(U));

      // and the product of its three factors
      Vector r(m), v(m), product(n);
      delassus.generalised_impulse(P.data(), r.data());
      delassus.apply(DelassusOperator<dim>::Operator::inverse, r.data(),
                     v.data());
      delassus.relative_velocity(v.data(), product.data());
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_NEAR(U[i], product[i], 1e-13 * largest(U));
      Vector change(m, 0.);
      delassus.add_velocity_change(P.data(), change.data());
      for (std::size_t i = 0; i < m; ++i)
        ASSERT_NEAR(change[i], v[i], 1e-13 * largest(v));

      // energy of the impulses: r . M_hat^{-1} r >= 0
      EXPECT_GE(dot(P, U), 0.);
      EXPECT_NEAR(dot(P, U), dot(r, v), 1e-13 * dot(r, v));

      // H^T is the transpose of H
      const Vector velocity = random_vector(m, 100 + seed);
      Vector jump(n);
      delassus.relative_velocity(velocity.data(), jump.data());
      double terms = 0.;
      for (std::size_t i = 0; i < m; ++i)
        terms += std::abs(velocity[i] * r[i]);
      EXPECT_NEAR(dot(P, jump), dot(velocity, r), 1e-13 * terms);

      // M_hat M_hat^{-1} = 1, M_hat = M + h^2 theta^2 K
      const double factor = std::pow(scene.time_step * 0.6, 2);
      Vector Mv(m), Kv(m);
      delassus.apply(DelassusOperator<dim>::Operator::mass, v.data(),
                     Mv.data());
      delassus.apply(DelassusOperator<dim>::Operator::stiffness, v.data(),
                     Kv.data());
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
      const Vector U = product_with_W(delassus, P);
      for (std::size_t i = 0; i < n; ++i)
        P[i] -= U[i] / norm;
      const double length = std::sqrt(dot(P, P));
      for (double &value : P)
        value /= length;
    }
    EXPECT_GE(dot(P, product_with_W(delassus, P)), -1e-14 * norm);

    // diagonal blocks of the faces
    const auto &faces = scene.discretization->points().faces;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const unsigned int count = faces[f].count * dim;
      const std::size_t first = std::size_t(faces[f].first) * dim;
      for (unsigned int i = 0; i < count; ++i)
        for (unsigned int j = 0; j < count; ++j)
          ASSERT_NEAR(delassus.face_block(f)[i * count + j],
                      W[first + j][first + i], 1e-13 * size);
    }
  }

  TEST(DelassusOperator, Quads) { check_operator<2>(quads); }
  TEST(DelassusOperator, Triangles) { check_operator<2>(triangles); }
  TEST(DelassusOperator, Hexes) { check_operator<3>(hexes); }
  TEST(DelassusOperator, Tetrahedra) { check_operator<3>(tets); }
  TEST(DelassusOperator, RigidAndDeformable)
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
    scene.delassus->relative_velocity(v.data(), U.data());
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

  TEST(DelassusOperator, TranslationOpensNothing)
  {
    check_translation<2>(quads);
    check_translation<2>(triangles);
    check_translation<3>(hexes);
    check_translation<3>(tets);
    check_translation<2>(mixed);
  }

  TEST(DelassusOperator, ReinitFollowsTheStep)
  {
    Scene<2> scene(quads);
    const std::size_t n = scene.discretization->points().n_points * 2;
    const Vector P = random_vector(n, 1);
    const Vector at_step = product_with_W(*scene.delassus, P);
    const auto count = scene.delassus->counters().factorisations;
    scene.delassus->reinit(scene.time_step, 0.6);
    EXPECT_EQ(scene.delassus->counters().factorisations, count)
        << "nothing has changed";
    scene.delassus->reinit(scene.time_step / 2., 0.6);
    EXPECT_GT(scene.delassus->counters().factorisations, count);
    const Vector half = product_with_W(*scene.delassus, P);
    EXPECT_GT(dot(P, half), dot(P, at_step) * (1. + 1e-6))
        << "a shorter step leaves less stiffness in M_hat";
    scene.delassus->reinit(scene.time_step, 0.6);
    EXPECT_EQ(product_with_W(*scene.delassus, P), at_step);
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
} // namespace small_meshes::test_delassus_operator
