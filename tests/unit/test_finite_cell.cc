#include "finite_strain.h"

namespace finite_strain::test_finite_cell
{
  template <int dim>
  void rigid_motion_is_free_of_force()
  {
    for_each_law<dim>([](const Law<dim> &law) {
      for (const unsigned int degree : {1u, 2u}) {
        const Cell<dim> cell(law.material, degree);
        const double angle = 170. * std::acos(-1.) / 180.;
        const std::vector<double> u = turned(cell, angle, 1., 3.);
        std::vector<double> f(cell.n);
        ASSERT_TRUE(cell.finite->force({u.data(), u.data(), 0.5}, f.data()));
        EXPECT_LT(norm(f), 1e-13 * young);
        EXPECT_LT(cell.finite->energy(u.data()), 1e-26 * young);
        // not so for the linear strain
        EXPECT_GT(norm(u), 1.);
      }
    });
  }

  TEST(FiniteCell, RigidMotionIsFreeOfForce)
  {
    rigid_motion_is_free_of_force<2>();
    rigid_motion_is_free_of_force<3>();
  }

  /** Far from each other, with a rotation and large strains between them. */
  template <int dim>
  struct TwoStates {
    std::vector<double> u0, u1;

    TwoStates(const Cell<dim> &cell, Random &random)
        : u0(turned(cell, 0.4, 1.1)), u1(turned(cell, 1.3, 0.9, 0.5))
    {
      for (double &u : u0)
        u += random.number(0.03);
      for (double &u : u1)
        u += random.number(0.03);
    }
  };

  template <int dim>
  void forces_keep_their_identities()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      for (const unsigned int degree : {1u, 2u})
        for (const double theta : {0.5, 0.8}) {
          const Cell<dim> cell(law.material, degree);
          const TwoStates<dim> states(cell, random);
          const auto &u0 = states.u0, &u1 = states.u1;
          std::vector<double> f(cell.n), way(cell.n), middle(cell.n);
          ASSERT_TRUE(
              cell.finite->force({u0.data(), u1.data(), theta}, f.data()));
          for (unsigned int i = 0; i < cell.n; ++i) {
            way[i] = u1[i] - u0[i];
            middle[i] = (u0[i] + u1[i]) / 2.;
          }
          const double dissipated =
              cell.finite->account({u0.data(), u1.data(), theta}).numerical;
          if (theta > 0.5)
            EXPECT_GT(dissipated, 1e-3);
          else
            EXPECT_EQ(dissipated, 0.);
          EXPECT_NEAR(scalar(f, way),
                      cell.finite->energy(u1.data()) -
                          cell.finite->energy(u0.data()) + dissipated,
                      1e-14 * norm(f) * norm(way));
          for (const double total : resultant<dim>(f))
            EXPECT_NEAR(total, 0., 1e-14 * norm(f));
          for (const double total : moment<dim>(cell.positions(middle), f))
            EXPECT_NEAR(total, 0., 1e-14 * norm(f) * std::sqrt(cell.n));
          EXPECT_GT(norm(f), 1e-2);
        }
    });
  }

  TEST(FiniteCell, WorkMomentaAndMomentsAreExact)
  {
    forces_keep_their_identities<2>();
    forces_keep_their_identities<3>();
  }

  template <int dim>
  void tangent_is_the_derivative_of_force()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      for (const double theta : {0.5, 1.}) {
        const Cell<dim> cell(law.material, 1);
        const TwoStates<dim> states(cell, random);
        const unsigned int n = cell.n;
        std::vector<double> K(n * n), plus(n), minus(n);
        const double *u0 = states.u0.data();
        std::vector<double> u1 = states.u1;
        ASSERT_TRUE(cell.finite->tangent({u0, u1.data(), theta}, K.data()));
        const double d = 1e-5;
        for (unsigned int j = 0; j < n; ++j) {
          const double u = u1[j];
          u1[j] = u + d;
          ASSERT_TRUE(cell.finite->force({u0, u1.data(), theta}, plus.data()));
          u1[j] = u - d;
          ASSERT_TRUE(cell.finite->force({u0, u1.data(), theta}, minus.data()));
          u1[j] = u;
          for (unsigned int i = 0; i < n; ++i)
            EXPECT_NEAR(K[j * n + i], (plus[i] - minus[i]) / (2. * d), 1e-7);
        }
      }
    });
  }

  TEST(FiniteCell, TangentIsTheDerivativeOfForce)
  {
    tangent_is_the_derivative_of_force<2>();
    tangent_is_the_derivative_of_force<3>();
  }

  /** Cholesky's factorization of K + @p shift exists. */
  bool definite(std::vector<double> K, const unsigned int n, const double shift)
  {
    for (unsigned int j = 0; j < n; ++j) {
      K[j * n + j] += shift;
      for (unsigned int k = 0; k < j; ++k)
        for (unsigned int i = j; i < n; ++i)
          K[j * n + i] -= K[k * n + i] * K[k * n + j];
      const double pivot = K[j * n + j];
      if (!(pivot > 0.))
        return false;
      for (unsigned int i = j; i < n; ++i)
        K[j * n + i] /= std::sqrt(pivot);
    }
    return true;
  }

  template <int dim>
  void symmetric_tangent_is_semidefinite()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      const Cell<dim> cell(law.material, 1);
      const unsigned int n = cell.n;
      std::vector<double> K(n * n), exact(n * n);
      // strongly compressed, where the exact one is not
      const auto crushed = turned(cell, 0.5, 0.4), whole = turned(cell, 0.4),
                 longer = turned(cell, 0.5, 3.);
      for (const auto &u : {crushed, whole, longer}) {
        ASSERT_TRUE(cell.finite->symmetric_tangent(
            {whole.data(), u.data(), 0.5}, K.data()));
        EXPECT_TRUE(definite(K, n, 1e-13 * young));
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < i; ++j)
            EXPECT_EQ(K[i * n + j], K[j * n + i]);
      }
      ASSERT_TRUE(cell.finite->tangent({crushed.data(), crushed.data(), 0.5},
                                       exact.data()));
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < i; ++j)
          exact[i * n + j] = exact[j * n + i] =
              (exact[i * n + j] + exact[j * n + i]) / 2.;
      EXPECT_FALSE(definite(exact, n, 1e-13 * young));
      // at rest both are the same: half of the stiffness of small strain
      ASSERT_TRUE(cell.finite->symmetric_tangent(
          {whole.data(), whole.data(), 0.5}, K.data()));
      ASSERT_TRUE(cell.finite->tangent({whole.data(), whole.data(), 0.5},
                                       exact.data()));
      for (unsigned int i = 0; i < n * n; ++i)
        EXPECT_NEAR(K[i], exact[i], 1e-13 * young);
    });
  }

  TEST(FiniteCell, SymmetricTangentIsSemidefinite)
  {
    symmetric_tangent_is_semidefinite<2>();
    symmetric_tangent_is_semidefinite<3>();
  }

  /**
   * Between states that differ by a small strain it is the symmetric part of
   * the derivative, compressed or not, as long as the mass carries this; beside
   * a small mass it is the one that is definite by itself.
   */
  template <int dim>
  void step_tangent_knows_the_mass()
  {
    for_each_law<dim>([&](const Law<dim> &law) {
      const Cell<dim> cell(law.material, 1);
      const unsigned int n = cell.n;
      std::vector<double> K(n * n), exact(n * n), definite_one(n * n),
          mass(n * n, 0.);
      const auto crushed = turned(cell, 0.5, 0.4);
      const CellMotion motion{crushed.data(), crushed.data(), 0.5, 1.};
      ASSERT_TRUE(cell.finite->tangent(motion, exact.data()));
      ASSERT_TRUE(cell.finite->symmetric_tangent(motion, definite_one.data()));
      for (const double m : {1e3 * young, 1e-9 * young}) {
        for (unsigned int i = 0; i < n; ++i)
          mass[i * n + i] = m;
        ASSERT_TRUE(cell.finite->step_tangent(motion, mass.data(), K.data()));
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            EXPECT_NEAR(K[i * n + j],
                        m > young ? (exact[i * n + j] + exact[j * n + i]) / 2.
                                  : definite_one[i * n + j],
                        1e-12 * young);
      }
    });
  }

  TEST(FiniteCell, StepTangentKnowsTheMass)
  {
    step_tangent_knows_the_mass<2>();
    step_tangent_knows_the_mass<3>();
  }

  TEST(FiniteCell, CellsInsideOutAreRefused)
  {
    for_each_law<2>([](const Law<2> &law) {
      const Cell<2> cell(law.material, 1);
      const auto whole = turned(cell, 0.), mirrored = turned(cell, 0., -1.);
      std::vector<double> f(cell.n), K(cell.n * cell.n);
      const double *u = whole.data(), *bad = mirrored.data();
      EXPECT_FALSE(cell.finite->force({u, bad, 0.5}, f.data()));
      EXPECT_FALSE(cell.finite->force({bad, u, 0.5}, f.data()));
      EXPECT_FALSE(cell.finite->tangent({u, bad, 0.5}, K.data()));
      EXPECT_FALSE(cell.finite->symmetric_tangent({u, bad, 0.5}, K.data()));
      EXPECT_TRUE(std::isinf(cell.finite->energy(bad)));
      EXPECT_TRUE(std::isnan(cell.finite->account({u, bad, 0.5}).numerical));
    });
  }

  /** A cell in motion, with what stays of it. */
} // namespace finite_strain::test_finite_cell
