#include "materials/matrix_log.h"

#include "bodies/history_cell.h"
#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

// Materials with history in their strains, small and finite, and cells of them.

using namespace nsfd;

namespace test_history_material
{
  constexpr double young = 70e9, poisson = 0.3, yield = 300e6;

  PlasticInput flow(const double isotropic = 2e9, const double kinematic = 3e9,
                    const double viscosity = 0.)
  {
    PlasticInput plastic;
    plastic.yield_stress = yield;
    plastic.isotropic = isotropic;
    plastic.kinematic = kinematic;
    plastic.viscosity = viscosity;
    return plastic;
  }

  class Random
  {
  public:
    double number(const double scale = 1.) { return scale * normal_(engine_); }

  private:
    std::mt19937 engine_{99};
    std::normal_distribution<double> normal_;
  };

  Voigt<3> symmetric(Random &random, const double scale)
  {
    Voigt<3> A;
    for (double &a : A)
      a = random.number(scale);
    return A;
  }

  Voigt<3> plus(const Voigt<3> &A, const double s, const Voigt<3> &B)
  {
    Voigt<3> result;
    for (unsigned int i = 0; i < 6; ++i)
      result[i] = A[i] + s * B[i];
    return result;
  }

  double size(const Voigt<3> &A) { return std::sqrt(contract<3>(A, A)); }

  // --------------------------------------------------------------- logarithm

  const Voigt<3> one = {1., 1., 1., 0., 0., 0.};

  /** Eigenvalues are known to round-off of the largest one. */
  double condition(const Spectrum &C)
  {
    const Vec3 &c = C.values();
    return *std::max_element(c.begin(), c.end()) /
           *std::min_element(c.begin(), c.end());
  }

  TEST(MatrixLog, OfItsExponential)
  {
    Random random;
    for (const double scale : {1e-12, 1e-6, 1e-3, 0.3, 2.})
      for (unsigned int k = 0; k < 50; ++k) {
        const Voigt<3> E = symmetric(random, scale);
        const Spectrum C(Spectrum(E).function(
            [](const double e) { return std::exp(2. * e); }));
        ASSERT_TRUE(C.positive());
        EXPECT_LT(size(plus(C.half_log(), -1., E)), 1e-14 * condition(C));
      }
    EXPECT_EQ(size(Spectrum(one).half_log()), 0.);
  }

  TEST(MatrixLog, SecantIsExact)
  {
    Random random;
    for (const double start : {0., 1e-3, 0.5})
      for (const double way : {1e-14, 1e-8, 1e-3, 0.3}) {
        const auto positive = [](const Voigt<3> &E) {
          return Spectrum(E).function(
              [](const double e) { return std::exp(2. * e); });
        };
        for (unsigned int k = 0; k < 20; ++k) {
          const Voigt<3> E0 = symmetric(random, start), C0 = positive(E0),
                         C1 = positive(plus(E0, 1., symmetric(random, way)));
          const Voigt<3> T = symmetric(random, 1.);
          const Spectrum a(C0), b(C1);
          const double work =
              contract<3>(T, plus(b.half_log(), -1., a.half_log()));
          EXPECT_NEAR(
              contract<3>(LogSecant(a, b).pulled_back(T), plus(C1, -1., C0)) /
                  2.,
              work, 1e-14 * (condition(a) + condition(b)));
        }
      }
  }

  TEST(MatrixLog, ChangesAreThoseOfTheSecant)
  {
    Random random;
    for (const double scale : {0., 1e-9, 0.01, 0.1, 0.8})
      for (unsigned int k = 0; k < 20; ++k) {
        const auto exponential = [&](const double s) {
          return Spectrum(symmetric(random, s)).function([](const double e) {
            return std::exp(e);
          });
        };
        const Voigt<3> C0 = exponential(scale), C1 = exponential(scale),
                       T = symmetric(random, 1.), H = symmetric(random, 1.);
        const double d = 1e-6;
        const auto at = [&](const double s) {
          return LogSecant(Spectrum(C0), Spectrum(plus(C1, s * d, H)))
              .pulled_back(T);
        };
        const Voigt<3> difference = plus(at(1.), -1., at(-1.));
        const Voigt<3> change =
            LogSecant(Spectrum(C0), Spectrum(C1)).change_at_end(T, H);
        EXPECT_LT(size(plus(plus({}, 0.5 / d, difference), -1., change)),
                  1e-6 * (1. + size(change)));
        const auto log_at = [&](const double s) {
          return Spectrum(plus(C1, s * d, H)).half_log();
        };
        EXPECT_LT(
            size(plus(plus({}, 0.5 / d, plus(log_at(1.), -1., log_at(-1.))),
                      -1., half_log_change(Spectrum(C1), H))),
            1e-6);
      }
  }

  // ------------------------------------------------------------ finite strain

  /** A point of finite strain and its books. */
  struct Point {
    explicit Point(const PlasticInput &plastic)
        : law(make_history_material<3>(young, poisson, plastic, true, false)),
          history(law->n_history())
    {
      law->begin(history.data());
    }

    void go(const Voigt<3> &to, const double h = 1., const double theta = 0.5)
    {
      HistoryMaterial<3>::Way way;
      way.C0 = C;
      way.C1 = to;
      way.history = history.data();
      way.time_step = h;
      way.theta = theta;
      std::vector<double> next(history.size());
      const double before = law->energy(C, history.data());
      ASSERT_TRUE(law->step(way, false, step, next.data()));
      const double work = contract<3>(step.S, plus(to, -1., C)) / 2.;
      const double after = law->energy(to, next.data());
      plastic += step.plastic;
      largest = std::max({largest, after, std::abs(work)});
      defect =
          std::max(defect, std::abs(work - (after - before) - step.plastic -
                                    step.viscous - step.numerical) /
                               largest);
      C = to;
      history = next;
    }

    std::unique_ptr<const HistoryMaterial<3>> law;
    std::vector<double> history;
    Voigt<3> C = one;
    HistoryMaterial<3>::Step step;
    double plastic = 0., defect = 0., largest = 0.;
  };

  double determinant_of_flow(const Point &point)
  {
    const double *G = point.history.data();
    return G[0] * (G[4] * G[8] - G[5] * G[7]) -
           G[1] * (G[3] * G[8] - G[5] * G[6]) +
           G[2] * (G[3] * G[7] - G[4] * G[6]);
  }

  // ln of the stretches: elastic ones of Hencky's law and the flow. The stress
  // of Hencky is Kirchhoff's, sigma det F.
  TEST(FiniteFlow, BarInLogarithmicStrain)
  {
    const double H = 2e9, K = 3e9;
    for (const unsigned int n : {1u, 4u, 60u}) {
      Point bar(flow(H, K));
      double p = 0.;
      for (unsigned int k = 1; k <= n; ++k) {
        p = 0.8 * k / n;
        const double tau = yield + (H + K) * p;
        const double axial = tau / young + p,
                     lateral = -poisson * tau / young - p / 2.;
        bar.go({std::exp(2. * axial), std::exp(2. * lateral),
                std::exp(2. * lateral), 0., 0., 0.});
        const double gradient[9] = {std::exp(axial) - 1.,   0., 0., 0.,
                                    std::exp(lateral) - 1., 0., 0., 0.,
                                    std::exp(lateral) - 1.};
        const auto sigma = bar.law->stress(gradient, bar.history.data());
        const double J = std::exp(axial + 2. * lateral);
        EXPECT_NEAR(sigma[0], tau / J, 1e-10 * yield);
        EXPECT_NEAR(sigma[1], 0., 1e-10 * yield);
        EXPECT_NEAR(bar.law->equivalent_strain(bar.history.data()), p, 1e-12);
      }
      EXPECT_NEAR(bar.plastic, yield * p, 1e-10 * yield);
      EXPECT_LT(bar.defect, 1e-12);
      EXPECT_NEAR(determinant_of_flow(bar), 1., 1e-14);
    }
  }

  // Flow without hardening: the shear stress of simple shear stays, up to the
  // elastic strain, which also lets volume and normal stresses change.
  TEST(FiniteFlow, SimpleShearStaysOnTheSurface)
  {
    Point point(flow(0., 0.));
    for (unsigned int k = 1; k <= 400; ++k) {
      const double g = 4. * k / 400.;
      point.go({1., 1. + g * g, 1., g, 0., 0.});
    }
    const double gradient[9] = {0., 4., 0., 0., 0., 0., 0., 0., 0.};
    const auto sigma = point.law->stress(gradient, point.history.data());
    EXPECT_NEAR(sigma[3], yield / std::sqrt(3.), 0.02 * yield);
    const double J2 =
        (std::pow(sigma[0] - sigma[1], 2) + std::pow(sigma[1] - sigma[2], 2) +
         std::pow(sigma[2] - sigma[0], 2)) /
            6. +
        sigma[3] * sigma[3];
    EXPECT_NEAR(std::sqrt(3. * J2), yield, 1e-10 * yield);
    EXPECT_LT(point.defect, 1e-12);
  }

  TEST(FiniteFlow, PressureDoesNotFlow)
  {
    Point point(flow());
    for (const double stretch : {0.5, 1.7}) {
      const double c = stretch * stretch;
      point.go({c, c, c, 0., 0., 0.});
      EXPECT_EQ(point.law->equivalent_strain(point.history.data()), 0.);
    }
  }

  TEST(FiniteFlow, BooksOfAnyWayCloseAndNothingIsGained)
  {
    for (const double viscosity : {0., 1e8})
      for (const double theta : {0.5, 0.7}) {
        Random random;
        Point point(flow(2e9, 3e9, viscosity));
        std::vector<double> F = {1., 0., 0., 0., 1., 0., 0., 0., 1.};
        for (unsigned int k = 0; k < 2000; ++k) {
          const double scale =
              std::pow(10., -1.5 - std::abs(random.number(2.)));
          std::vector<double> next = F;
          for (unsigned int i = 0; i < 9; ++i)
            next[i] += random.number(scale) +
                       (k % 100 ? 0. : 1. * (i % 4 == 0) - F[i]);
          Voigt<3> C;
          const unsigned int at[6][2] = {{0, 0}, {1, 1}, {2, 2},
                                         {0, 1}, {0, 2}, {1, 2}};
          for (unsigned int i = 0; i < 6; ++i) {
            C[i] = 0.;
            for (unsigned int c = 0; c < 3; ++c)
              C[i] += next[c * 3 + at[i][0]] * next[c * 3 + at[i][1]];
          }
          if (!(determinant(C) > 0.05) || !(C[0] + C[1] + C[2] < 9.))
            continue;
          F = next;
          point.go(C, std::pow(10., random.number(2.)), theta);
          ASSERT_GE(point.step.plastic, 0.);
          ASSERT_GE(point.step.viscous, 0.);
          ASSERT_NEAR(determinant_of_flow(point), 1., 1e-13);
        }
        EXPECT_GT(point.plastic, 0.);
        EXPECT_LT(point.defect, 1e-11);
      }
  }

  TEST(FiniteFlow, TangentIsThatOfTheStress)
  {
    Random random;
    unsigned int flowing = 0;
    Point point(flow(2e9, 3e9));
    for (unsigned int k = 0; k < 200; ++k) {
      const Voigt<3> to =
          Spectrum(symmetric(random, 0.1)).function([](const double e) {
            return std::exp(2. * e);
          });
      HistoryMaterial<3>::Way way;
      way.C0 = point.C;
      way.C1 = to;
      const std::vector<double> history = point.history;
      way.history = history.data();
      way.theta = 0.6;
      point.go(to, 1., 0.6);
      HistoryMaterial<3>::Step here, up, down;
      ASSERT_TRUE(point.law->step(way, true, here, nullptr));
      const Voigt<3> along = symmetric(random, 1.);
      const double d = 1e-7;
      way.C1 = plus(to, d, along);
      point.law->step(way, false, up, nullptr);
      way.C1 = plus(to, -d, along);
      point.law->step(way, false, down, nullptr);
      if ((up.plastic > 0.) != (down.plastic > 0.))
        continue;
      flowing += here.plastic > 0.;
      Voigt<3> error = plus({}, 0.5 / d, plus(up.S, -1., down.S));
      double scale = size(error);
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j < 6; ++j)
          error[i] -= here.tangent[i * 6 + j] * voigt_weight<3>(j) * along[j];
      EXPECT_LT(size(error), 1e-5 * (scale + young)) << k;
    }
    EXPECT_GT(flowing, 100u);
  }

  // ------------------------------------------------------------------- cells

  /** A bilinear square with 2 x 2 Gauss points. */
  std::unique_ptr<HistoryCell<2>> make_cell(const PlasticInput &plastic,
                                            const bool finite)
  {
    std::vector<double> JxW, gradients;
    const double g = 0.5 / std::sqrt(3.);
    for (const double y : {0.5 - g, 0.5 + g})
      for (const double x : {0.5 - g, 0.5 + g}) {
        JxW.push_back(0.25);
        for (unsigned int i = 0; i < 4; ++i) {
          const double a = i % 2 ? x : 1. - x, b = i / 2 ? y : 1. - y;
          gradients.push_back((i % 2 ? 1. : -1.) * b);
          gradients.push_back((i / 2 ? 1. : -1.) * a);
        }
      }
    return std::make_unique<HistoryCell<2>>(
        make_history_material<2>(young, poisson, plastic, finite, false),
        finite, JxW, gradients);
  }

  constexpr unsigned int n_dofs = 8;
  using Dofs = std::vector<double>;

  Dofs by_chance(Random &random, const double scale)
  {
    Dofs u(n_dofs);
    for (double &x : u)
      x = random.number(scale);
    return u;
  }

  double length(const Dofs &x)
  {
    double sum = 0.;
    for (const double a : x)
      sum += a * a;
    return std::sqrt(sum);
  }

  /** A point in the middle of its way: cell, its memory, where it is. */
  struct UsedCell {
    std::unique_ptr<HistoryCell<2>> cell;
    Dofs history, u0, u1;

    UsedCell(const PlasticInput &plastic, const bool finite, Random &random,
             const double scale)
        : cell(make_cell(plastic, finite)), history(cell->n_history()),
          u0(by_chance(random, scale)), u1(by_chance(random, scale))
    {
      cell->begin_history(history.data());
      const Dofs fresh = history, rest(n_dofs, 0.);
      cell->book({rest.data(), u0.data(), 0.5, 1., fresh.data()},
                 history.data());
    }

    CellMotion motion(const double theta) const
    {
      return {u0.data(), u1.data(), theta, 1., history.data()};
    }
  };

  TEST(HistoryCell, WorkAndResultantsAreExact)
  {
    Random random;
    for (const bool finite : {false, true})
      for (const double theta : {0.5, 0.8})
        for (unsigned int k = 0; k < 20; ++k) {
          const UsedCell used(flow(), finite, random, 0.05);
          Dofs f(n_dofs), after(used.history.size());
          ASSERT_TRUE(used.cell->force(used.motion(theta), f.data()));
          const CellLosses losses =
              used.cell->book(used.motion(theta), after.data());
          EXPECT_GT(losses.plastic, 0.);
          double work = 0., moment = 0.;
          std::array<double, 2> total{};
          for (unsigned int i = 0; i < n_dofs; ++i) {
            work += f[i] * (used.u1[i] - used.u0[i]);
            total[i % 2] += f[i];
          }
          for (unsigned int i = 0; i < 4; ++i) {
            const auto place = [&](const unsigned int c) {
              return (c == 0 ? i % 2 : i / 2) +
                     (finite ? (used.u0[2 * i + c] + used.u1[2 * i + c]) / 2.
                             : 0.);
            };
            moment += place(0) * f[2 * i + 1] - place(1) * f[2 * i];
          }
          const double stored =
              used.cell->energy(used.u1.data(), after.data()) -
              used.cell->energy(used.u0.data(), used.history.data());
          EXPECT_NEAR(work, stored + losses.plastic + losses.numerical,
                      1e-13 * (std::abs(work) + losses.plastic +
                               length(f) * length(used.u1)));
          EXPECT_LT(std::abs(total[0]) + std::abs(total[1]) + std::abs(moment),
                    1e-13 * length(f));
        }
  }

  TEST(HistoryCell, TangentIsTheDerivativeOfForce)
  {
    Random random;
    for (const bool finite : {false, true})
      for (unsigned int k = 0; k < 20; ++k) {
        UsedCell used(flow(), finite, random, 0.05);
        Dofs K(n_dofs * n_dofs), plus(n_dofs), minus(n_dofs);
        ASSERT_TRUE(used.cell->tangent(used.motion(0.6), K.data()));
        const double d = 1e-8;
        for (unsigned int j = 0; j < n_dofs; ++j) {
          const double u = used.u1[j];
          used.u1[j] = u + d;
          used.cell->force(used.motion(0.6), plus.data());
          used.u1[j] = u - d;
          used.cell->force(used.motion(0.6), minus.data());
          used.u1[j] = u;
          for (unsigned int i = 0; i < n_dofs; ++i)
            EXPECT_NEAR(K[j * n_dofs + i], (plus[i] - minus[i]) / (2. * d),
                        1e-5 * young);
        }
      }
  }

  Dofs solve(Dofs A, Dofs b)
  {
    for (unsigned int k = 0; k < n_dofs; ++k) {
      unsigned int p = k;
      for (unsigned int i = k; i < n_dofs; ++i)
        if (std::abs(A[k * n_dofs + i]) > std::abs(A[k * n_dofs + p]))
          p = i;
      std::swap(b[k], b[p]);
      for (unsigned int j = 0; j < n_dofs; ++j)
        std::swap(A[j * n_dofs + k], A[j * n_dofs + p]);
      for (unsigned int i = k + 1; i < n_dofs; ++i) {
        const double factor = A[k * n_dofs + i] / A[k * n_dofs + k];
        b[i] -= factor * b[k];
        for (unsigned int j = k; j < n_dofs; ++j)
          A[j * n_dofs + i] -= factor * A[j * n_dofs + k];
      }
    }
    for (unsigned int k = n_dofs; k-- > 0;) {
      for (unsigned int j = k + 1; j < n_dofs; ++j)
        b[k] -= A[j * n_dofs + k] * b[j];
      b[k] /= A[k * n_dofs + k];
    }
    return b;
  }

  // The residual, as a strain, is at most that of the step before squared, over
  // the strain on which the tangent changes: the flow of the step, some 1e-2.
  TEST(HistoryCell, NewtonConvergesQuadratically)
  {
    constexpr double bound = 1e3, round_off = 3e-16;
    Random random;
    for (const bool finite : {false, true}) {
      unsigned int seen = 0;
      for (unsigned int k = 0; k < 20; ++k) {
        UsedCell used(flow(), finite, random, 0.03);
        const Dofs target = used.u1;
        Dofs wanted(n_dofs), f(n_dofs), K(n_dofs * n_dofs);
        used.cell->force(used.motion(0.5), wanted.data());
        for (double &u : used.u1)
          u += random.number(1e-4);
        const double inertia = 0.1 * young;
        std::vector<double> sizes;
        for (unsigned int step = 0; step < 8; ++step) {
          used.cell->force(used.motion(0.5), f.data());
          used.cell->tangent(used.motion(0.5), K.data());
          Dofs r(n_dofs);
          for (unsigned int i = 0; i < n_dofs; ++i) {
            r[i] = f[i] - wanted[i] + inertia * (used.u1[i] - target[i]);
            K[i * n_dofs + i] += inertia;
          }
          sizes.push_back(length(r) / young);
          const Dofs change = solve(K, r);
          for (unsigned int i = 0; i < n_dofs; ++i)
            used.u1[i] -= change[i];
        }
        EXPECT_LT(sizes.back(), round_off);
        for (std::size_t i = 1; i < sizes.size(); ++i)
          if (sizes[i - 1] < 1e-4 && sizes[i - 1] > 1e-8) {
            ++seen;
            EXPECT_LT(sizes[i], bound * sizes[i - 1] * sizes[i - 1] + round_off)
                << i;
          }
      }
      EXPECT_GT(seen, 5u);
    }
  }
} // namespace test_history_material
