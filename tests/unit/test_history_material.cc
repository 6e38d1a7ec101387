#include "plastic_flow.h"

namespace plastic_flow::test_history_material
{
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
      cell->account({rest.data(), u0.data(), 0.5, 1., fresh.data()},
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
              used.cell->account(used.motion(theta), after.data());
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
} // namespace plastic_flow::test_history_material
