#include "materials/anisotropy.h"

#include "materials/elasticity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// Cubic and orthotropic elasticity at any orientation, at one place: against
// turned strains, compliances, an isotropic body and Christoffel's closed
// forms.

using namespace nsfd;

namespace test_anisotropy
{
  using Gradient3 = std::array<double, 9>;
  using Stress = std::array<double, 6>;

  constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

  HookeMatrix cubic(const double C11, const double C12, const double C44)
  {
    HookeMatrix C{};
    for (unsigned int i = 0; i < 3; ++i) {
      for (unsigned int j = 0; j < 3; ++j)
        C[i][j] = i == j ? C11 : C12;
      C[i + 3][i + 3] = C44;
    }
    return C;
  }

  MaterialInput crystal(const HookeMatrix &C, const EulerAngles &angles)
  {
    MaterialInput material;
    material.density = 8960.;
    AnisotropicInput input = anisotropic_of(C);
    for (unsigned int k = 0; k < 3; ++k)
      input.orientation.angles[k] = Expression(angles[k]);
    material.anisotropic = std::make_shared<const AnisotropicInput>(input);
    return material;
  }

  class Random
  {
  public:
    double operator()() { return uniform_(engine_); }
    EulerAngles angles()
    {
      return {{180. * (*this)(), 90. + 90. * (*this)(), 180. * (*this)()}};
    }
    template <std::size_t n>
    std::array<double, n> numbers()
    {
      std::array<double, n> result;
      for (double &value : result)
        value = (*this)();
      return result;
    }

  private:
    std::mt19937 engine_{4711};
    std::uniform_real_distribution<double> uniform_{-1., 1.};
  };

  /** A in the axes of the scene, of one in those of the crystal. */
  Gradient3 to_scene(const EulerAngles &angles, const Gradient3 &A)
  {
    const auto g = crystal_axes(angles);
    Gradient3 result{};
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int b = 0; b < 3; ++b)
            result[i * 3 + j] += g[a][i] * A[a * 3 + b] * g[b][j];
    return result;
  }

  Gradient3 as_matrix(const Stress &s)
  {
    Gradient3 result;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        result[i * 3 + j] = s[at[i][j]];
    return result;
  }

  template <std::size_t n>
  void expect_near(const std::array<double, n> &a,
                   const std::array<double, n> &b, const double tolerance)
  {
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(a[i], b[i], tolerance) << i;
  }

  const HookeMatrix copper = cubic(168.4e9, 121.4e9, 75.4e9);

  // Bunge's angles: about z, the new x, the new z.
  TEST(Anisotropy, EulerAngles)
  {
    // x' is the first axis of the crystal after 90 degrees about z
    expect_near(crystal_axes({{90., 0., 0.}})[0], {{0., 1., 0.}}, 1e-15);
    expect_near(crystal_axes({{0., 90., 0.}})[2], {{0., -1., 0.}}, 1e-15);
    // z of the scene is axis 2 of the crystal after 90 degrees about x', and
    // axis 1 of it after 90 more about the new z
    expect_near(crystal_axes({{0., 90., 0.}})[1], {{0., 0., 1.}}, 1e-15);
    expect_near(crystal_axes({{0., 90., 90.}})[0], {{0., 0., 1.}}, 1e-15);
    Random random;
    for (unsigned int k = 0; k < 20; ++k) {
      const auto axes = crystal_axes(random.angles());
      const auto again = crystal_axes(euler_angles(axes));
      for (unsigned int a = 0; a < 3; ++a)
        expect_near(axes[a], again[a], 1e-14);
    }
    for (const EulerAngles &angles :
         {EulerAngles{{30., 0., 20.}}, EulerAngles{{30., 180., 20.}}}) {
      auto axes = crystal_axes(angles);
      axes[2][0] = axes[2][1] = 0.;
      const auto again = crystal_axes(euler_angles(axes));
      for (unsigned int a = 0; a < 3; ++a)
        expect_near(axes[a], again[a], 1e-14);
    }
  }

  TEST(Anisotropy, TurnedCrystalMovesTurned)
  {
    Random random;
    for (unsigned int k = 0; k < 10; ++k) {
      HookeMatrix C{}; // any symmetric matrix is one
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          C[i][j] = C[j][i] = random() + (i == j ? 5. : 0.);
      const EulerAngles angles = random.angles();
      const auto strain = random.numbers<9>();
      const LinearElasticity<3> straight(crystal(C, {{0., 0., 0.}}), false),
          turned_law(crystal(C, angles), false);
      const auto expected =
          to_scene(angles, as_matrix(straight.stress(strain.data())));
      const auto found =
          as_matrix(turned_law.stress(to_scene(angles, strain).data()));
      expect_near(found, expected, 1e-13);
    }
  }

  // Stress, traction and blocks speak of one law, in all dimensions.
  TEST(Anisotropy, CouplingIsTheTraction)
  {
    Random random;
    const auto test = [&](auto dimension, const bool plane_stress) {
      constexpr int dim = decltype(dimension)::value;
      const LinearElasticity<dim> law(crystal(copper, random.angles()),
                                      plane_stress);
      dealii::Tensor<1, dim> g, h;
      for (unsigned int d = 0; d < dim; ++d) {
        g[d] = random();
        h[d] = random();
      }
      for (unsigned int d = 0; d < dim; ++d) {
        double gradient[dim * dim] = {}; // of a displacement h.x e_d
        for (unsigned int l = 0; l < dim; ++l)
          gradient[d * dim + l] = h[l];
        const auto t = traction_on<dim>(law.stress(gradient), &g[0]);
        for (unsigned int c = 0; c < dim; ++c)
          EXPECT_NEAR(law.coupling(c, d, g, h), t[c], 1e-14 * 2e11);
      }
    };
    test(std::integral_constant<int, 2>(), false);
    test(std::integral_constant<int, 2>(), true);
    test(std::integral_constant<int, 3>(), false);
  }

  TEST(Anisotropy, PlaneProblemsAgainstSpace)
  {
    Random random;
    for (unsigned int k = 0; k < 10; ++k) {
      const EulerAngles angles = random.angles();
      const MaterialInput material = crystal(copper, angles);
      const auto flat = random.numbers<4>();
      // strain: what space gives without strain across the plane
      const Gradient3 in_space = {
          {flat[0], flat[1], 0., flat[2], flat[3], 0., 0., 0., 0.}};
      const Stress s =
          LinearElasticity<3>(material, false).stress(in_space.data());
      const Stress strain =
          LinearElasticity<2>(material, false).stress(flat.data());
      expect_near(strain, {{s[0], s[1], s[2], s[3], 0., 0.}}, 1e-13 * 2e11);
      // stress: no stress across the plane, the strains of the compliance
      const Stress stress =
          LinearElasticity<2>(material, true).stress(flat.data());
      const HookeMatrix S = compliance_of(turned(copper, angles));
      const unsigned int kept[3] = {0, 1, 3};
      const double strains[3] = {flat[0], flat[3], (flat[1] + flat[2]) / 2.};
      for (unsigned int i = 0; i < 3; ++i) {
        double sum = 0.;
        for (const unsigned int j : kept)
          sum += S[kept[i]][j] * stress[j] * (j < 3 ? 1. : 2.);
        EXPECT_NEAR(sum, strains[i], 1e-12);
      }
      EXPECT_EQ(stress[2], 0.);
    }
  }

  // A rotated cube couples extension and shear in the plane.
  TEST(Anisotropy, RotatedCubeInPlaneStrain)
  {
    const double degrees = 22.5, H = 168.4e9 - 121.4e9 - 2. * 75.4e9;
    const LinearElasticity<2> law(crystal(copper, {{degrees, 0., 0.}}), false);
    const double extension[4] = {1., 0., 0., 0.};
    const Stress s = law.stress(extension);
    // C_16 = H sin 4 phi / 4, C_11 = C11 - H sin^2 2 phi / 2
    EXPECT_NEAR(s[3], H / 4., 1e-3);
    EXPECT_NEAR(s[0], 168.4e9 - H / 4., 1e-3);
  }

  TEST(Anisotropy, IsotropicConstantsInAnyDirection)
  {
    MaterialInput isotropic;
    isotropic.young = 2.;
    isotropic.poisson = 0.3;
    isotropic.density = 8960.;
    const double mu = 1. / 1.3, lambda = 0.6 / (1.3 * 0.4);
    const HookeMatrix C = cubic(lambda + 2. * mu, lambda, mu);
    Random random;
    for (unsigned int k = 0; k < 5; ++k) {
      const MaterialInput turned_body = crystal(C, random.angles());
      const auto gradient = random.numbers<9>();
      const auto flat = random.numbers<4>();
      expect_near(LinearElasticity<3>(turned_body, false).stress(&gradient[0]),
                  LinearElasticity<3>(isotropic, false).stress(&gradient[0]),
                  1e-14);
      for (const bool plane_stress : {false, true}) {
        const LinearElasticity<2> one(turned_body, plane_stress),
            other(isotropic, plane_stress);
        expect_near(one.stress(&flat[0]), other.stress(&flat[0]), 1e-14);
        EXPECT_NEAR(one.lambda, other.lambda, 1e-14);
        EXPECT_NEAR(one.mu, other.mu, 1e-14);
        EXPECT_NEAR(one.pressure_wave_speed(), other.pressure_wave_speed(),
                    1e-14);
        EXPECT_NEAR(one.shear_wave_speed(), other.shear_wave_speed(), 1e-14);
      }
      const auto extremes = LinearElasticity<3>(turned_body, false).extremes();
      EXPECT_NEAR(extremes.stiffest.young, 2., 1e-13);
      EXPECT_NEAR(extremes.softest.poisson, 0.3, 1e-13);
    }
  }

  // Copper by Christoffel's equation: fastest along [111], slowest along [110].
  TEST(Anisotropy, WaveSpeedsOfCopper)
  {
    const double fastest =
                     std::sqrt((168.4e9 + 242.8e9 + 301.6e9) / 3. / 8960.),
                 slowest = std::sqrt(23.5e9 / 8960.),
                 along_face = std::sqrt(220.3e9 / 8960.);
    Random random;
    for (unsigned int k = 0; k < 5; ++k) {
      const LinearElasticity<3> law(crystal(copper, random.angles()), false);
      EXPECT_NEAR(law.pressure_wave_speed(), fastest, 1e-12 * fastest);
      EXPECT_NEAR(law.shear_wave_speed(), slowest, 1e-12 * slowest);
    }
    // in a plane of the cube the fastest runs along [110]
    const LinearElasticity<2> flat(crystal(copper, {{17., 0., 0.}}), false);
    EXPECT_NEAR(flat.pressure_wave_speed(), along_face, 1e-10 * along_face);
    EXPECT_NEAR(flat.shear_wave_speed(), slowest, 1e-10 * slowest);
    const auto extremes = flat.extremes(); // E along [111] and [100]
    EXPECT_NEAR(extremes.stiffest.young, 191.1e9, 0.1e9);
    EXPECT_NEAR(extremes.softest.young, 66.7e9, 0.1e9);
  }

  // Of any symmetry, no direction has a faster wave than the one found.
  TEST(Anisotropy, NoDirectionIsFaster)
  {
    Random random;
    HookeMatrix C{};
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j <= i; ++j)
        C[i][j] = C[j][i] = random() + (i == j ? 4. : 0.);
    ASSERT_TRUE(is_stable(C));
    const AnisotropicInput input = anisotropic_of(C);
    const LinearElasticity<3> law(crystal(C, {{0., 0., 0.}}), false);
    for (unsigned int k = 0; k < 20000; ++k) {
      dealii::Tensor<1, 3> n, p;
      for (unsigned int d = 0; d < 3; ++d) {
        n[d] = random();
        p[d] = random();
      }
      n /= n.norm();
      p /= p.norm();
      double value = 0.;
      for (unsigned int c = 0; c < 3; ++c)
        for (unsigned int d = 0; d < 3; ++d)
          value += p[c] * p[d] * law.coupling(c, d, n, n);
      EXPECT_LE(value, input.fastest * (1. + 1e-14));
      EXPECT_GE(value, input.slowest * (1. - 1e-14));
    }
  }
} // namespace test_anisotropy
