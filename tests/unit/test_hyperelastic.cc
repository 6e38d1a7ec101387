// Energies of finite strain and cells that store them.
#include "bodies/finite_cell.h"
#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace test_hyperelastic
{
  using namespace nsfd;

  constexpr double young = 3., poisson = 0.3;

  template <int dim>
  constexpr unsigned int n_entries = dim *(dim + 1) / 2;

  template <int dim>
  struct Law {
    const char *name;
    std::shared_ptr<const Hyperelastic<dim>> material;
    double lambda, mu;
  };

  template <int dim>
  std::vector<Law<dim>> laws()
  {
    const double mu = young / (2. * (1. + poisson)),
                 lambda =
                     young * poisson / ((1. + poisson) * (1. - 2. * poisson));
    const auto saint_venant = BulkModel::saint_venant_kirchhoff;
    std::vector<Law<dim>> all = {
        {"Saint-Venant Kirchhoff",
         make_hyperelastic<dim>(saint_venant, young, poisson, false), lambda,
         mu},
        {"neo-Hooke",
         make_hyperelastic<dim>(BulkModel::neo_hookean, young, poisson, false),
         lambda, mu}};
    if (dim == 2)
      all.push_back({"Saint-Venant Kirchhoff in plane stress",
                     make_hyperelastic<dim>(saint_venant, young, poisson, true),
                     2. * lambda * mu / (lambda + 2. * mu), mu});
    return all;
  }

  template <int dim>
  Voigt<dim> identity()
  {
    Voigt<dim> I{};
    std::fill_n(I.begin(), dim, 1.);
    return I;
  }

  template <int dim>
  Voigt<dim> sum(const double a, const Voigt<dim> &A, const double b,
                 const Voigt<dim> &B)
  {
    Voigt<dim> C;
    for (unsigned int i = 0; i < n_entries<dim>; ++i)
      C[i] = a * A[i] + b * B[i];
    return C;
  }

  template <int dim>
  double size(const Voigt<dim> &A)
  {
    return std::sqrt(contract<dim>(A, A));
  }

  struct Random {
    std::mt19937 generator{11};

    double number(const double size)
    {
      return std::uniform_real_distribution<double>(-size, size)(generator);
    }
    std::vector<double> numbers(const unsigned int n, const double size)
    {
      std::vector<double> x(n);
      for (double &c : x)
        c = number(size);
      return x;
    }
    template <int dim>
    Voigt<dim> symmetric(const double size)
    {
      Voigt<dim> A;
      for (double &a : A)
        a = number(size);
      return A;
    }
    /** A right Cauchy-Green tensor some way from 1. */
    template <int dim>
    Voigt<dim> stretch(const double size)
    {
      return sum<dim>(1., identity<dim>(), 1., symmetric<dim>(size));
    }
  };

  /** @p check once per dimension and material. */
  template <int dim, typename Check>
  void for_each_law(Check check)
  {
    for (const Law<dim> &law : laws<dim>()) {
      SCOPED_TRACE(law.name);
      SCOPED_TRACE(dim);
      check(law);
    }
  }

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
    EXPECT_THROW(make_hyperelastic<2>(BulkModel::rigid, 1., 0.3, false),
                 std::invalid_argument);
    EXPECT_THROW(make_hyperelastic<2>(BulkModel::neo_hookean, 1., 0.3, true),
                 std::invalid_argument);
    EXPECT_THROW(
        make_hyperelastic<3>(BulkModel::saint_venant_kirchhoff, 1., 0.3, true),
        std::invalid_argument);
  }

  /** A cube, or a square, of the size @p edge with nodes at equal distances. */
  template <int dim>
  struct Cell {
    std::vector<double> nodes; ///< positions before deformation
    std::vector<double> mass;  ///< of the density 1, consistent
    std::vector<double> JxW, gradients;
    std::unique_ptr<FiniteCell<dim>> finite;
    unsigned int n = 0; ///< unknowns

    Cell(std::shared_ptr<const Hyperelastic<dim>> material,
         const unsigned int degree, const double edge = 1.);

    std::vector<double> positions(const std::vector<double> &u) const
    {
      std::vector<double> x(nodes);
      for (unsigned int i = 0; i < n; ++i)
        x[i] += u[i];
      return x;
    }
  };

  /** Value and slope of the polynomial of node @p i. */
  std::pair<double, double> shape(const unsigned int i,
                                  const unsigned int degree, const double x)
  {
    double value = 1., slope = 0.;
    for (unsigned int k = 0; k <= degree; ++k)
      if (k != i) {
        const double over = double(degree) / (double(i) - double(k));
        const double factor = (x - double(k) / degree) * over;
        slope = slope * factor + value * over;
        value *= factor;
      }
    return {value, slope};
  }

  template <int dim>
  Cell<dim>::Cell(std::shared_ptr<const Hyperelastic<dim>> material,
                  const unsigned int degree, const double edge)
  {
    // Gauss' rule of three points, enough for the mass of degree 2
    const double g = std::sqrt(0.6) / 2.;
    const double x[] = {0.5 - g, 0.5, 0.5 + g};
    const double w[] = {5. / 18., 8. / 18., 5. / 18.};
    const unsigned int m = degree + 1;
    const unsigned int n_nodes = dim == 2 ? m * m : m * m * m;
    const unsigned int n_points = dim == 2 ? 9 : 27;
    n = n_nodes * dim;
    mass.assign(n * n, 0.);
    for (unsigned int i = 0; i < n_nodes; ++i)
      for (unsigned int c = 0, rest = i; c < dim; ++c, rest /= m)
        nodes.push_back(edge * (rest % m) / degree);
    for (unsigned int q = 0; q < n_points; ++q) {
      double weight = 1.;
      for (unsigned int c = 0, rest = q; c < dim; ++c, rest /= 3)
        weight *= edge * w[rest % 3];
      JxW.push_back(weight);
      std::vector<double> values;
      for (unsigned int i = 0; i < n_nodes; ++i) {
        double value = 1., gradient[dim];
        std::fill_n(gradient, dim, 1. / edge);
        for (unsigned int c = 0, a = i, b = q; c < dim; ++c, a /= m, b /= 3) {
          const auto s = shape(a % m, degree, x[b % 3]);
          value *= s.first;
          for (unsigned int d = 0; d < dim; ++d)
            gradient[d] *= c == d ? s.second : s.first;
        }
        values.push_back(value);
        gradients.insert(gradients.end(), gradient, gradient + dim);
      }
      for (unsigned int i = 0; i < n_nodes; ++i)
        for (unsigned int j = 0; j < n_nodes; ++j)
          for (unsigned int c = 0; c < dim; ++c)
            mass[(j * dim + c) * n + i * dim + c] +=
                weight * values[i] * values[j];
    }
    finite = std::make_unique<FiniteCell<dim>>(material, JxW, gradients);
  }

  /** Turned by @p angle, in space about (1, 1, 1), stretched by @p stretch
   *  along x before, and displaced by @p away. */
  template <int dim>
  std::vector<double> turned(const Cell<dim> &cell, const double angle,
                             const double stretch = 1., const double away = 0.)
  {
    const double c = std::cos(angle), s = std::sin(angle),
                 third = (1. - c) / 3., r = s / std::sqrt(3.);
    double R[3][3] = {{c, -s, 0.}, {s, c, 0.}, {0., 0., 1.}};
    if (dim == 3)
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int b = 0; b < 3; ++b)
          R[a][b] = third + (a == b ? c : (b + 1) % 3 == a ? r : -r);
    std::vector<double> u(cell.n);
    for (unsigned int i = 0; i < cell.n; i += dim)
      for (unsigned int a = 0; a < dim; ++a) {
        double x = away;
        for (unsigned int b = 0; b < dim; ++b)
          x += R[a][b] * cell.nodes[i + b] * (b == 0 ? stretch : 1.);
        u[i + a] = x - cell.nodes[i + a];
      }
    return u;
  }

  double scalar(const std::vector<double> &a, const std::vector<double> &b)
  {
    double total = 0.;
    for (std::size_t i = 0; i < a.size(); ++i)
      total += a[i] * b[i];
    return total;
  }

  std::vector<double> applied(const std::vector<double> &M,
                              const std::vector<double> &v)
  {
    std::vector<double> Mv(v.size(), 0.);
    for (std::size_t j = 0; j < v.size(); ++j)
      for (std::size_t i = 0; i < v.size(); ++i)
        Mv[i] += M[j * v.size() + i] * v[j];
    return Mv;
  }

  template <int dim>
  std::array<double, dim> resultant(const std::vector<double> &f)
  {
    std::array<double, dim> total{};
    for (std::size_t i = 0; i < f.size(); ++i)
      total[i % dim] += f[i];
    return total;
  }

  /** sum_i x_i x f_i; of the plane the last one. */
  template <int dim>
  std::array<double, 3> moment(const std::vector<double> &x,
                               const std::vector<double> &f)
  {
    std::array<double, 3> total{};
    for (std::size_t i = 0; i < f.size(); i += dim) {
      total[2] += x[i] * f[i + 1] - x[i + 1] * f[i];
      if (dim == 3) {
        total[0] += x[i + 1] * f[i + 2] - x[i + 2] * f[i + 1];
        total[1] += x[i + 2] * f[i] - x[i] * f[i + 2];
      }
    }
    return total;
  }

  double norm(const std::vector<double> &x) { return std::sqrt(scalar(x, x)); }

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
              cell.finite->book({u0.data(), u1.data(), theta}).numerical;
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
      EXPECT_TRUE(std::isnan(cell.finite->book({u, bad, 0.5}).numerical));
    });
  }

  /** A cell in motion, with what stays of it. */
  template <int dim>
  struct Flight {
    const Cell<dim> &cell;
    std::vector<double> u, v;
    FiniteScratch scratch;
    const std::vector<double> none;
    double dissipated = 0.;

    /** Stretched along x and spinning at @p spin, in space about (1, 1, 1). */
    Flight(const Cell<dim> &body, const double stretch, const double spin,
           const double drift)
        : cell(body), u(turned(body, 0., stretch)), v(body.n, 0.),
          none(body.n, 0.)
    {
      const std::vector<double> x = cell.positions(u);
      for (unsigned int i = 0; i < cell.n; i += dim)
        for (unsigned int c = 0; c < dim; ++c) {
          const unsigned int next = (c + 1) % dim, last = (c + dim - 1) % dim;
          v[i + c] = drift + (dim == 3 ? spin * (x[i + last] - x[i + next])
                              : c == 0 ? -spin * x[i + 1]
                                       : spin * x[i]);
        }
    }

    bool advance(const double h, const double theta = 0.5)
    {
      FiniteStep step;
      step.time_step = h;
      step.theta = theta;
      step.mass = cell.mass.data();
      step.displacement = u.data();
      step.velocity = v.data();
      step.load = none.data();
      std::vector<double> next = v, end = u, change(cell.n);
      if (!cell.finite->solve(step, next.data(), scratch))
        return false;
      for (unsigned int i = 0; i < cell.n; ++i) {
        end[i] += h * (theta * next[i] + (1. - theta) * v[i]);
        change[i] = next[i] - v[i];
      }
      dissipated += cell.finite->book({u.data(), end.data(), theta}).numerical +
                    (theta - 0.5) * scalar(change, applied(cell.mass, change));
      u = end;
      v = next;
      return true;
    }

    double energy() const
    {
      return scalar(v, applied(cell.mass, v)) / 2. +
             cell.finite->energy(u.data());
    }
    std::array<double, 3> spin() const
    {
      return moment<dim>(cell.positions(u), applied(cell.mass, v));
    }
  };

  template <int dim>
  void free_flight_conserves(const unsigned int degree, const unsigned int n)
  {
    for_each_law<dim>([&](const Law<dim> &law) {
      const Cell<dim> cell(law.material, degree);
      Flight<dim> flight(cell, 1.2, 0.5, 0.1);
      const double energy = flight.energy();
      const auto spin = flight.spin();
      const auto momentum = resultant<dim>(applied(cell.mass, flight.v));
      double size = 0., softest = energy, most = 0.;
      for (const double s : spin)
        size = std::max(size, std::abs(s));
      for (unsigned int i = 0; i < n; ++i) {
        ASSERT_TRUE(flight.advance(0.1)) << i;
        ASSERT_NEAR(flight.energy(), energy, 1e-12 * energy) << i;
        for (unsigned int c = 0; c < 3; ++c)
          ASSERT_NEAR(flight.spin()[c], spin[c], 1e-12 * size) << i;
        const auto now = resultant<dim>(applied(cell.mass, flight.v));
        for (unsigned int c = 0; c < dim; ++c)
          ASSERT_NEAR(now[c], momentum[c], 1e-12 * std::abs(momentum[c])) << i;
        const double stored = cell.finite->energy(flight.u.data());
        softest = std::min(softest, stored);
        most = std::max(most, stored);
      }
      // it has oscillated
      EXPECT_LT(softest, 0.5 * most);
    });
  }

  TEST(FiniteCell, FreeFlightConserves)
  {
    free_flight_conserves<2>(1, 1000);
    free_flight_conserves<3>(1, 1000);
  }

  TEST(FiniteCell, FreeFlightOfSecondDegreeConserves)
  {
    free_flight_conserves<2>(2, 200);
    free_flight_conserves<3>(2, 20);
  }

  TEST(FiniteCell, WhatThetaTakesIsCounted)
  {
    for_each_law<3>([](const Law<3> &law) {
      const Cell<3> cell(law.material, 1);
      Flight<3> flight(cell, 1.2, 0.5, 0.1);
      const double energy = flight.energy();
      for (unsigned int i = 0; i < 100; ++i)
        ASSERT_TRUE(flight.advance(0.1, 1.));
      EXPECT_GT(flight.dissipated, 1e-2 * energy);
      EXPECT_NEAR(flight.energy() + flight.dissipated, energy, 1e-12 * energy);
    });
  }

  /** Stiff cells of micrometres, at rest and loaded: all sizes are relative. */
  TEST(FiniteCell, SmallStiffCellsMoveUnderTheirLoad)
  {
    const std::shared_ptr<const Hyperelastic<2>> steel = make_hyperelastic<2>(
        BulkModel::saint_venant_kirchhoff, 2e11, 0.3, false);
    const double edge = 1e-6;
    const Cell<2> cell(steel, 1, edge); // of the density 1
    std::vector<double> u(cell.n, 0.), v0(cell.n, 0.), v(cell.n, 0.),
        load(cell.n), impulse(cell.n, 0.);
    const double mass = edge * edge, h = 1e-12;
    for (unsigned int i = 0; i < cell.n; ++i)
      load[i] = i % 2 == 0 ? mass / 4. * 9.81 : 0.;
    impulse[1] = impulse[3] = impulse[5] = impulse[7] = mass / 4. * 1e-3;
    FiniteStep step;
    step.time_step = h;
    step.mass = cell.mass.data();
    step.displacement = u.data();
    step.velocity = v0.data();
    step.load = load.data();
    FiniteScratch scratch;
    ASSERT_TRUE(cell.finite->solve(step, v.data(), scratch));
    for (unsigned int i = 0; i < cell.n; i += 2)
      EXPECT_NEAR(v[i], 9.81 * h, 1e-10 * 9.81 * h);
    step.impulse = impulse.data();
    ASSERT_TRUE(cell.finite->solve(step, v.data(), scratch));
    for (unsigned int i = 1; i < cell.n; i += 2)
      EXPECT_NEAR(v[i], 1e-3, 1e-13);
  }

  TEST(FiniteCell, WhatCannotBeSolvedIsRefused)
  {
    for_each_law<2>([](const Law<2> &law) {
      const Cell<2> cell(law.material, 1);
      Flight<2> flight(cell, 1.2, 0.5, 0.1);
      const double nan = std::numeric_limits<double>::quiet_NaN();
      std::vector<double> load(cell.n, 0.), v = flight.v;
      load[0] = nan;
      FiniteStep step;
      step.time_step = 0.1;
      step.mass = cell.mass.data();
      step.displacement = flight.u.data();
      step.velocity = flight.v.data();
      step.load = load.data();
      EXPECT_FALSE(cell.finite->solve(step, v.data(), flight.scratch));
      EXPECT_EQ(v, flight.v);
      const auto mirrored = turned(cell, 0., -1.);
      load[0] = 0.;
      step.displacement = mirrored.data();
      EXPECT_FALSE(cell.finite->solve(step, v.data(), flight.scratch));
      EXPECT_EQ(v, flight.v);
    });
  }
} // namespace test_hyperelastic
