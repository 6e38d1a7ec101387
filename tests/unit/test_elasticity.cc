#include "materials/elasticity.h"

#include "make_scene.h"

#include "nsfd/scene/material_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

// Linear elastic materials at one place, against their compliance, other
// coordinates, and the dimensions among each other.

using namespace nsfd;
using namespace nsfd::test;

namespace test_elasticity
{
  using Stress = std::array<double, 6>;
  using Gradient3 = std::array<double, 9>;
  using Rotation = std::array<std::array<double, 3>, 3>;

  constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

  MaterialInput isotropic(const double young, const double poisson)
  {
    MaterialInput material;
    material.young = young;
    material.poisson = poisson;
    material.density = 2.;
    return material;
  }

  MaterialInput laminate(const std::array<double, 3> &axis)
  {
    MaterialInput material;
    material.density = 2.;
    auto &constants = material.transverse.emplace();
    constants.axis = axis;
    constants.axial_young = 14.;
    constants.transverse_young = 1.;
    constants.axial_poisson = 0.3;
    constants.transverse_poisson = 0.45;
    constants.axial_shear = 0.5;
    return material;
  }

  /** The same constants as an isotropic material. */
  MaterialInput like_isotropic(const double young, const double poisson,
                               const std::array<double, 3> &axis)
  {
    MaterialInput material = laminate(axis);
    auto &constants = *material.transverse;
    constants.axial_young = constants.transverse_young = young;
    constants.axial_poisson = constants.transverse_poisson = poisson;
    constants.axial_shear = young / (2. * (1. + poisson));
    return material;
  }

  class Random
  {
  public:
    double operator()() { return uniform_(engine_); }

    Gradient3 gradient()
    {
      Gradient3 result;
      for (double &value : result)
        value = (*this)();
      return result;
    }

    /** From a quaternion. */
    Rotation rotation()
    {
      std::array<double, 4> q;
      double size = 0.;
      for (double &value : q) {
        value = (*this)();
        size += value * value;
      }
      for (double &value : q)
        value /= std::sqrt(size);
      const auto [w, x, y, z] = q;
      return {{{1. - 2. * (y * y + z * z), 2. * (x * y - w * z),
                2. * (x * z + w * y)},
               {2. * (x * y + w * z), 1. - 2. * (x * x + z * z),
                2. * (y * z - w * x)},
               {2. * (x * z - w * y), 2. * (y * z + w * x),
                1. - 2. * (x * x + y * y)}}};
    }

  private:
    std::mt19937 engine_{4711};
    std::uniform_real_distribution<double> uniform_{-1., 1.};
  };

  /** Q A Q^T. */
  Gradient3 turned(const Rotation &Q, const Gradient3 &A)
  {
    Gradient3 result{};
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = 0; l < 3; ++l)
            result[i * 3 + j] += Q[i][k] * A[k * 3 + l] * Q[j][l];
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

  double energy(const Stress &s, const Gradient3 &gradient)
  {
    double result = 0.;
    for (unsigned int i = 0; i < 9; ++i)
      result += as_matrix(s)[i] * gradient[i] / 2.;
    return result;
  }

  LinearElasticity<3> in_space(const MaterialInput &material)
  {
    return LinearElasticity<3>(material, false);
  }

  // A stress in one direction makes the strains that the constants say.
  TEST(Elasticity, ComplianceOfTheConstants)
  {
    const MaterialInput material = laminate({{1., 0., 0.}});
    const auto &c = *material.transverse;
    const double G_T = c.transverse_young / (2. * (1. + c.transverse_poisson));
    struct Case {
      Stress stress;
      Gradient3 gradient;
    };
    const double a = 1. / c.axial_young, t = 1. / c.transverse_young;
    const Case cases[] = {
        {{{1., 0., 0., 0., 0., 0.}},
         {{a, 0., 0., 0., -c.axial_poisson * a, 0., 0., 0.,
           -c.axial_poisson * a}}},
        {{{0., 1., 0., 0., 0., 0.}},
         {{-c.axial_poisson * a, 0., 0., 0., t, 0., 0., 0.,
           -c.transverse_poisson * t}}},
        {{{0., 0., 0., 1., 0., 0.}},
         {{0., 1. / c.axial_shear, 0., 0., 0., 0., 0., 0., 0.}}},
        {{{0., 0., 0., 0., 1., 0.}},
         {{0., 0., 0.5 / c.axial_shear, 0., 0., 0., 0.5 / c.axial_shear, 0.,
           0.}}},
        {{{0., 0., 0., 0., 0., 1.}},
         {{0., 0., 0., 0., 0., 1. / G_T, 0., 0., 0.}}}};
    for (const Case &one : cases) {
      const Stress s = in_space(material).stress(one.gradient.data());
      for (unsigned int k = 0; k < 6; ++k)
        EXPECT_NEAR(s[k], one.stress[k], 1e-14) << k;
    }
  }

  // A body turned with its axis answers a turned strain by the turned stress.
  TEST(Elasticity, TurnsWithTheAxis)
  {
    Random random;
    for (unsigned int n = 0; n < 100; ++n) {
      const Rotation Q = random.rotation();
      const Gradient3 gradient = random.gradient();
      const auto straight = in_space(laminate({{1., 0., 0.}}));
      const auto oblique = in_space(laminate({{Q[0][0], Q[1][0], Q[2][0]}}));
      const Gradient3 expected =
          turned(Q, as_matrix(straight.stress(gradient.data())));
      const Gradient3 found =
          as_matrix(oblique.stress(turned(Q, gradient).data()));
      for (unsigned int k = 0; k < 9; ++k)
        EXPECT_NEAR(found[k], expected[k], 1e-12);
      EXPECT_DOUBLE_EQ(oblique.pressure_wave_speed(),
                       straight.pressure_wave_speed());
    }
  }

  TEST(Elasticity, IsotropicConstantsAreLinearElastic)
  {
    Random random;
    for (const double nu : {-0.5, 0., 0.3, 0.49}) {
      const Rotation Q = random.rotation();
      const auto transverse =
          in_space(like_isotropic(3., nu, {{Q[0][0], Q[1][0], Q[2][0]}}));
      const auto plain = in_space(isotropic(3., nu));
      const double size = plain.lambda + 2. * plain.mu;
      const Gradient3 gradient = random.gradient();
      const Stress a = transverse.stress(gradient.data()),
                   b = plain.stress(gradient.data());
      for (unsigned int k = 0; k < 6; ++k)
        EXPECT_NEAR(a[k], b[k], 1e-14 * 10. * size);
      EXPECT_NEAR(transverse.pressure_wave_speed(), plain.pressure_wave_speed(),
                  1e-13 * plain.pressure_wave_speed());
      EXPECT_NEAR(transverse.shear_wave_speed(), plain.shear_wave_speed(),
                  1e-13 * plain.pressure_wave_speed());
    }
  }

  // The planes are what space makes of strains or stresses in the plane.
  TEST(Elasticity, PlaneProblemsAgreeWithSpace)
  {
    Random random;
    const std::array<double, 3> axes[] = {
        {{1., 0., 0.}}, {{0.6, -0.8, 0.}}, {{0., 0., 1.}}};
    for (const auto &axis : axes)
      for (unsigned int n = 0; n < 20; ++n) {
        const MaterialInput material = laminate(axis);
        const Gradient3 g = random.gradient();
        const std::array<double, 4> flat = {{g[0], g[1], g[3], g[4]}};
        Gradient3 gradient = {{g[0], g[1], 0., g[3], g[4], 0., 0., 0., 0.}};
        const Stress strain =
            LinearElasticity<2>(material, false).stress(flat.data());
        const Stress space = in_space(material).stress(gradient.data());
        for (unsigned int k = 0; k < 4; ++k)
          EXPECT_NEAR(strain[k], space[k], 1e-14 * 20.);

        // the strain across that leaves no stress there
        const Gradient3 across = {{0., 0., 0., 0., 0., 0., 0., 0., 1.}};
        gradient[8] = -space[2] / in_space(material).stress(across.data())[2];
        const Stress free = in_space(material).stress(gradient.data());
        const Stress plane =
            LinearElasticity<2>(material, true).stress(flat.data());
        EXPECT_NEAR(free[2], 0., 1e-14 * 20.);
        for (unsigned int k = 0; k < 4; ++k)
          EXPECT_NEAR(plane[k], free[k], 1e-14 * 20.);
      }
  }

  // What the blocks of a cell are made of is the stress.
  TEST(Elasticity, CouplingIsTheStressOfGradients)
  {
    Random random;
    for (unsigned int n = 0; n < 20; ++n) {
      const Rotation Q = random.rotation();
      const auto law = in_space(laminate({{Q[0][0], Q[1][0], Q[2][0]}}));
      dealii::Tensor<1, 3> g, h;
      for (unsigned int c = 0; c < 3; ++c) {
        g[c] = random();
        h[c] = random();
      }
      for (unsigned int d = 0; d < 3; ++d) {
        Gradient3 gradient{}; // of a displacement along d that grows along h
        for (unsigned int l = 0; l < 3; ++l)
          gradient[d * 3 + l] = h[l];
        const Gradient3 s = as_matrix(law.stress(gradient.data()));
        for (unsigned int c = 0; c < 3; ++c) {
          const double expected =
              s[c * 3] * g[0] + s[c * 3 + 1] * g[1] + s[c * 3 + 2] * g[2];
          EXPECT_NEAR(law.coupling(c, d, g, h), expected, 1e-14 * 50.);
          EXPECT_NEAR(law.coupling(d, c, h, g), expected, 1e-14 * 50.);
        }
      }
    }
  }

  // Close to the bounds of the constants the energy is still positive, and
  // beyond them there is a strain without any.
  TEST(Elasticity, PositiveDefiniteWithinTheBounds)
  {
    Random random;
    for (const double nu_T : {-0.9, 0., 0.45, 0.9}) {
      MaterialInput material = laminate({{0., 1., 0.}});
      auto &c = *material.transverse;
      c.transverse_poisson = nu_T;
      const double bound =
          std::sqrt((1. - nu_T) * c.axial_young / c.transverse_young / 2.);
      for (const double share : {-0.999, 0.5, 0.999}) {
        c.axial_poisson = share * bound;
        for (unsigned int n = 0; n < 200; ++n) {
          Gradient3 strain = random.gradient();
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < i; ++j)
              strain[i * 3 + j] = strain[j * 3 + i];
          EXPECT_GT(energy(in_space(material).stress(strain.data()), strain),
                    0.);
        }
      }
      c.axial_poisson = 1.001 * bound;
      // the strain of the stress (1, t, t) that is softest
      double smallest = 1.;
      for (double ratio = -20.; ratio < 20.; ratio += 0.01) {
        const Gradient3 strain = {{ratio, 0., 0., 0., 1., 0., 0., 0., ratio}};
        smallest = std::min(
            smallest, energy(in_space(material).stress(strain.data()), strain));
      }
      EXPECT_LT(smallest, 0.);
    }
  }

  // The fastest wave of all directions, by a scan of Christoffel's matrix.
  TEST(Elasticity, WaveSpeeds)
  {
    const double pi = std::acos(-1.);
    for (const double shear : {0.5, 5.}) { // 5: fastest at an oblique angle
      MaterialInput material = laminate({{1., 0., 0.}});
      material.transverse->axial_shear = shear;
      material.transverse->axial_young = shear > 1. ? 6. : 14.;
      const auto law = in_space(material);
      double fastest = 0., slowest = 1e9;
      for (unsigned int n = 0; n <= 2000; ++n) {
        const double phi = n * pi / 4000.;
        dealii::Tensor<1, 3> direction;
        direction[0] = std::cos(phi);
        direction[1] = std::sin(phi);
        const auto entry = [&](const unsigned int c, const unsigned int d) {
          return law.coupling(c, d, direction, direction);
        };
        const double mean = (entry(0, 0) + entry(1, 1)) / 2.,
                     radius = std::hypot((entry(0, 0) - entry(1, 1)) / 2.,
                                         entry(0, 1));
        fastest = std::max(fastest, mean + radius);
        slowest = std::min({slowest, mean - radius, entry(2, 2)});
      }
      fastest = std::sqrt(fastest / material.density);
      slowest = std::sqrt(slowest / material.density);
      EXPECT_NEAR(law.pressure_wave_speed(), fastest, 1e-6 * fastest);
      EXPECT_GE(law.pressure_wave_speed(), fastest * (1. - 1e-14));
      EXPECT_NEAR(law.shear_wave_speed(), slowest, 1e-6 * slowest);
      EXPECT_LE(law.shear_wave_speed(), slowest * (1. + 1e-14));
      if (shear < 1.) { // along the axis
        dealii::Tensor<1, 3> axis;
        axis[0] = 1.;
        EXPECT_DOUBLE_EQ(law.pressure_wave_speed(),
                         std::sqrt(law.coupling(0, 0, axis, axis) / 2.));
      }
    }
  }

  TEST(Elasticity, ViscousStress)
  {
    MaterialInput material = isotropic(1., 0.3);
    material.shear_viscosity = 3.;
    material.bulk_viscosity = 5.;
    const Gradient3 rate = {{1., 2., 0., 0., -2., 0., 4., 0., 5.}};
    const Stress s = LinearElasticity<3>::viscous(material).stress(rate.data());
    const double volume = 4., third = volume / 3.; // zeta tr + 2 eta dev
    const Stress expected = {{5. * volume + 6. * (1. - third),
                              5. * volume + 6. * (-2. - third),
                              5. * volume + 6. * (5. - third), 6., 12., 0.}};
    for (unsigned int k = 0; k < 6; ++k)
      EXPECT_NEAR(s[k], expected[k], 1e-13);
  }
} // namespace test_elasticity
