#include "finite_strain.h"

#include "nsfd/materials/material_model.h"

namespace finite_strain::test_hyperelastic
{
  template <int dim>
  void energies_are_their_formulas()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      for (unsigned int i = 0; i < 20; ++i) {
        const Voigt<dim> C = random.stretch<dim>(0.3);
        const Voigt<dim> E = sum<dim>(0.5, C, -0.5, identity<dim>());
        double tr = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          tr += E[c];
        const double log_det = std::log(determinant(C));
        const double expected =
            law.name == std::string("neo-Hooke")
                ? law.mu / 2. * (2. * tr - log_det) +
                      law.lambda / 8. * log_det * log_det
                : law.lambda / 2. * tr * tr + law.mu * contract<dim>(E, E);
        EXPECT_NEAR(law.material->energy(C), expected, 1e-14 * young);
      }
    });
  }

  TEST(Hyperelastic, EnergiesAreTheirFormulas)
  {
    energies_are_their_formulas<2>();
    energies_are_their_formulas<3>();
  }

  /** In space, with a third stretch of 1, is the plane. */
  TEST(Hyperelastic, PlaneStrainIsSpaceWithoutStrainAcross)
  {
    Random random;
    for (unsigned int l = 0; l < 2; ++l) {
      const auto plane = laws<2>()[l].material;
      const auto space = laws<3>()[l].material;
      const Voigt<2> C = random.stretch<2>(0.3);
      const Voigt<3> D{C[0], C[1], 1., C[2], 0., 0.};
      Voigt<2> S;
      Voigt<3> T;
      ASSERT_TRUE(plane->stress(C, S) && space->stress(D, T));
      EXPECT_NEAR(plane->energy(C), space->energy(D), 1e-15 * young);
      EXPECT_NEAR(S[0], T[0], 1e-15 * young);
      EXPECT_NEAR(S[1], T[1], 1e-15 * young);
      EXPECT_NEAR(S[2], T[3], 1e-15 * young);
    }
  }

  template <int dim>
  void small_strain_is_hookes_law()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      const double small = 1e-7;
      const Voigt<dim> e = random.symmetric<dim>(1.);
      const Voigt<dim> C = sum<dim>(1., identity<dim>(), 2. * small, e);
      Voigt<dim> S;
      VoigtBlock<dim> T;
      ASSERT_TRUE(law.material->stress(C, S, &T));
      double tr = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        tr += e[c];
      const Voigt<dim> hooke =
          sum<dim>(law.lambda * tr, identity<dim>(), 2. * law.mu, e);
      EXPECT_LT(size<dim>(sum<dim>(1. / small, S, -1., hooke)), 1e-5);
      EXPECT_NEAR(law.material->energy(C) / (small * small),
                  contract<dim>(hooke, e) / 2., 1e-5);
      for (unsigned int i = 0; i < n_entries<dim>; ++i) {
        double product = 0.;
        for (unsigned int j = 0; j < n_entries<dim>; ++j)
          product +=
              T[i * n_entries<dim> + j] * voigt_weight<dim>(j) * 2. * e[j];
        EXPECT_NEAR(product, hooke[i], 1e-5);
      }
      EXPECT_NEAR(law.material->modulus(), law.lambda + 2. * law.mu, 1e-14);
    });
  }

  TEST(Hyperelastic, SmallStrainIsHookesLaw)
  {
    small_strain_is_hookes_law<2>();
    small_strain_is_hookes_law<3>();
  }

  /** Also where the strain is as small as that of stiff solids. */
  TEST(Hyperelastic, SmallEnergiesAreAccurate)
  {
    for_each_law<3>([&](const Law<3> &law) {
      const double x = 1e-12;
      const Voigt<3> C{1. + 1.1 * x, 1. + 0.7 * x, 1. - 0.3 * x,
                       0.6 * x,      0.,           0.};
      // as far as C can tell, and exactly
      const Voigt<3> E = sum<3>(0.5, C, -0.5, identity<3>());
      const double tr = E[0] + E[1] + E[2];
      const double expected =
          law.lambda / 2. * tr * tr + law.mu * contract<3>(E, E);
      EXPECT_NEAR(law.material->energy(C), expected, 1e-10 * expected);
    });
  }

  template <int dim>
  void stress_is_the_derivative_of_energy()
  {
    Random random;
    const double d = 1e-5;
    for_each_law<dim>([&](const Law<dim> &law) {
      const Voigt<dim> C = random.stretch<dim>(0.25),
                       A = random.symmetric<dim>(1.);
      Voigt<dim> S, S_plus, S_minus;
      VoigtBlock<dim> T;
      ASSERT_TRUE(law.material->stress(C, S, &T));
      const Voigt<dim> plus = sum<dim>(1., C, d, A),
                       minus = sum<dim>(1., C, -d, A);
      EXPECT_NEAR(contract<dim>(S, A) / 2.,
                  (law.material->energy(plus) - law.material->energy(minus)) /
                      (2. * d),
                  1e-8);
      ASSERT_TRUE(law.material->stress(plus, S_plus) &&
                  law.material->stress(minus, S_minus));
      for (unsigned int i = 0; i < n_entries<dim>; ++i) {
        double change = 0.;
        for (unsigned int j = 0; j < n_entries<dim>; ++j) {
          change += T[i * n_entries<dim> + j] * voigt_weight<dim>(j) * A[j];
          EXPECT_NEAR(T[i * n_entries<dim> + j], T[j * n_entries<dim> + i],
                      1e-14);
        }
        EXPECT_NEAR(change, (S_plus[i] - S_minus[i]) / (2. * d), 1e-7);
      }
    });
  }

  TEST(Hyperelastic, StressIsTheDerivativeOfEnergy)
  {
    stress_is_the_derivative_of_energy<2>();
    stress_is_the_derivative_of_energy<3>();
  }

  /** W(C1) - W(C0) = int S:dC / 2 on the straight way, where the difference of
   *  the energies would cancel. By Gauss' rule of five points. */
  template <int dim>
  double gained(const Hyperelastic<dim> &material, const Voigt<dim> &C0,
                const Voigt<dim> &dC)
  {
    const double x[] = {0., 0.538469310105683091, 0.906179845938663993};
    const double w[] = {0.568888888888888889, 0.478628670499366468,
                        0.236926885056189088};
    double total = 0.;
    for (const int k : {-2, -1, 0, 1, 2}) {
      const double t = (1. + (k < 0 ? -1. : 1.) * x[std::abs(k)]) / 2.;
      Voigt<dim> S;
      EXPECT_TRUE(material.stress(sum<dim>(1., C0, t, dC), S));
      total += w[std::abs(k)] / 2. * contract<dim>(S, dC) / 2.;
    }
    return total;
  }

  template <int dim>
  void average_stress_gives_the_change_of_energy()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      for (const double step : {0.2, 1e-2, 1e-4, 1e-8, 1e-12, 0.})
        for (unsigned int i = 0; i < 20; ++i) {
          const Voigt<dim> C0 = random.stretch<dim>(0.2),
                           C1 = sum<dim>(1., C0, step,
                                         random.symmetric<dim>(1.));
          const Voigt<dim> dC = sum<dim>(1., C1, -1., C0);
          Voigt<dim> S, back;
          ASSERT_TRUE(law.material->average_stress(C0, C1, S));
          ASSERT_TRUE(law.material->average_stress(C1, C0, back));
          const double work = contract<dim>(S, dC) / 2.;
          const double most = law.material->modulus() * size<dim>(dC);
          EXPECT_LT(size<dim>(sum<dim>(1., S, -1., back)),
                    1e-14 * law.material->modulus());
          if (step > 1e-3)
            EXPECT_NEAR(work,
                        law.material->energy(C1) - law.material->energy(C0),
                        1e-14 * law.material->modulus());
          else
            EXPECT_NEAR(work, gained<dim>(*law.material, C0, dC), 1e-15 * most);
        }
    });
  }

  TEST(Hyperelastic, AverageStressGivesTheChangeOfEnergy)
  {
    average_stress_gives_the_change_of_energy<2>();
    average_stress_gives_the_change_of_energy<3>();
  }

  template <int dim>
  void tangent_of_a_step_is_the_derivative()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      for (const double theta : {0.5, 0.75, 1.})
        // below and above where series are summed
        for (const double step : {1e-9, 0.02, 0.4}) {
          const Voigt<dim> C0 = random.stretch<dim>(0.1),
                           C1 = sum<dim>(1., C0, step,
                                         random.symmetric<dim>(0.5));
          StepStress<dim> at, plus, minus;
          ASSERT_TRUE(step_stress<dim>(*law.material, C0, C1, theta, true, at));
          const double d = 1e-5;
          for (unsigned int j = 0; j < n_entries<dim>; ++j) {
            Voigt<dim> A{};
            A[j] = d;
            ASSERT_TRUE(step_stress<dim>(*law.material, C0,
                                         sum<dim>(1., C1, 1., A), theta, false,
                                         plus));
            ASSERT_TRUE(step_stress<dim>(*law.material, C0,
                                         sum<dim>(1., C1, -1., A), theta, false,
                                         minus));
            for (unsigned int i = 0; i < n_entries<dim>; ++i)
              EXPECT_NEAR(at.tangent[i * n_entries<dim> + j] *
                              voigt_weight<dim>(j),
                          (plus.S[i] - minus.S[i]) / (2. * d), 1e-7)
                  << theta << " " << step;
          }
        }
    });
  }

  TEST(Hyperelastic, TangentOfAStepIsTheDerivative)
  {
    tangent_of_a_step_is_the_derivative<2>();
    tangent_of_a_step_is_the_derivative<3>();
  }

  template <int dim>
  void work_is_stored_or_dissipated()
  {
    Random random;
    for_each_law<dim>([&](const Law<dim> &law) {
      const Voigt<dim> C0 = random.stretch<dim>(0.2),
                       C1 = random.stretch<dim>(0.2);
      StepStress<dim> step;
      ASSERT_TRUE(step_stress<dim>(*law.material, C0, C1, 0.8, false, step));
      EXPECT_GT(step.dissipated, 0.);
      EXPECT_NEAR(contract<dim>(step.S, sum<dim>(0.5, C1, -0.5, C0)),
                  law.material->energy(C1) - law.material->energy(C0) +
                      step.dissipated,
                  1e-14 * young);
    });
  }

  TEST(Hyperelastic, WorkIsStoredOrDissipated)
  {
    work_is_stored_or_dissipated<2>();
    work_is_stored_or_dissipated<3>();
  }

  TEST(Hyperelastic, FlatStatesAreRefused)
  {
    for_each_law<3>([](const Law<3> &law) {
      const Voigt<3> flat{1., 1., 0., 0., 0., 0.}, I = identity<3>();
      Voigt<3> S;
      EXPECT_FALSE(law.material->stress(flat, S));
      EXPECT_FALSE(law.material->average_stress(I, flat, S));
      EXPECT_FALSE(law.material->average_stress(flat, I, S));
      EXPECT_TRUE(std::isinf(law.material->energy(flat)));
      EXPECT_TRUE(law.material->average_stress(I, I, S));
    });
  }

  TEST(Hyperelastic, OtherEnergiesAreRefused)
  {
    EXPECT_THROW(make_saint_venant_kirchhoff<3>(1., 0.3, true),
                 std::invalid_argument);
    MaterialInput material;
    for (const std::string &name : material_model_names()) {
      const auto model = MaterialRegistry::instance().create(name);
      if (model->kind() != MaterialKind::finite_strain) {
        EXPECT_THROW(model->hyperelastic<2>(material, false), std::logic_error)
            << name;
      }
      if (model->kind() != MaterialKind::history_dependent) {
        EXPECT_THROW(model->history_dependent<3>(material, false, false),
                     std::logic_error)
            << name;
      }
    }
  }

  /** A cube, or a square, of the size @p edge with nodes at equal distances. */
} // namespace finite_strain::test_hyperelastic
