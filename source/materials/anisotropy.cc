#include "anisotropy.h"

#include "core/mix_bits.h"

#include <deal.II/base/symmetric_tensor.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace nsfd
{
  namespace
  {
    using dealii::SymmetricTensor;
    using dealii::Tensor;
    using Axes = std::array<std::array<double, 3>, 3>;

    constexpr unsigned int first_of[6] = {0, 1, 2, 0, 0, 1};
    constexpr unsigned int second_of[6] = {0, 1, 2, 1, 2, 2};

    /** Mandel's matrix: an orthonormal basis, the same eigenvalues. */
    SymmetricTensor<4, 3> as_tensor(const HookeMatrix &C)
    {
      SymmetricTensor<4, 3> result;
      for (unsigned int i = 0; i < 6; ++i)
        for (unsigned int j = 0; j < 6; ++j)
          result[first_of[i]][second_of[i]][first_of[j]][second_of[j]] =
              C[i][j];
      return result;
    }

    /** Christoffel's matrix n_j C_ijkl n_l. */
    SymmetricTensor<2, 3> acoustic_tensor(const HookeMatrix &C,
                                          const Tensor<1, 3> &n)
    {
      SymmetricTensor<2, 3> result;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int k = i; k < 3; ++k)
          for (unsigned int j = 0; j < 3; ++j)
            for (unsigned int l = 0; l < 3; ++l)
              result[i][k] +=
                  n[j] * C[stress_place(i, j)][stress_place(k, l)] * n[l];
      return result;
    }

    /** Of half of the sphere, even, and those of high symmetry. */
    std::vector<Tensor<1, 3>> directions()
    {
      std::vector<Tensor<1, 3>> result;
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z)
            if (9 * x + 3 * y + z > 0) {
              Tensor<1, 3> n;
              n[0] = x;
              n[1] = y;
              n[2] = z;
              result.push_back(n / n.norm());
            }
      constexpr unsigned int n_more = 500; // golden spiral: 5 degrees apart
      const double turn = std::acos(-1.) * (std::sqrt(5.) - 1.);
      for (unsigned int k = 0; k < n_more; ++k) {
        const double z = (k + 0.5) / n_more, r = std::sqrt(1. - z * z);
        Tensor<1, 3> n;
        n[0] = r * std::cos(k * turn);
        n[1] = r * std::sin(k * turn);
        n[2] = z;
        result.push_back(n);
      }
      return result;
    }

    /**
     * The extreme of C_ijkl p_i n_j p_k n_l over directions n and
     * polarisations p, in which it is symmetric: each in turn takes its best
     * value, from the best direction of @p starts on. @p which: 0 for the
     * largest, 2 for the smallest eigenvalue.
     */
    double extreme_wave(const HookeMatrix &C, const unsigned int which,
                        const std::vector<Tensor<1, 3>> &starts)
    {
      const auto better = [&](const double a, const double b) {
        return which == 0 ? a > b : a < b;
      };
      std::vector<std::pair<double, unsigned int>> order;
      for (unsigned int s = 0; s < starts.size(); ++s) {
        const double value =
            dealii::eigenvalues(acoustic_tensor(C, starts[s]))[which];
        order.emplace_back(which == 0 ? -value : value, s);
      }
      std::sort(order.begin(), order.end());
      double best = std::abs(order[0].first);
      constexpr unsigned int n_tried = 8, n_steps = 200;
      for (unsigned int k = 0; k < n_tried; ++k) {
        Tensor<1, 3> n = starts[order[k].second];
        double value = 0.;
        for (unsigned int step = 0; step < n_steps; ++step) {
          const auto pair = dealii::eigenvectors(acoustic_tensor(C, n))[which];
          n = pair.second;
          if (step > 0 && !better(pair.first, value))
            break;
          value = pair.first;
        }
        best = better(value, best) ? value : best;
      }
      return best;
    }

    /** Of a bar along @p n: 1/E = S_nnnn, and minus the mean contraction. */
    std::array<double, 2> bar_along(const HookeMatrix &S, const Tensor<1, 3> &n)
    {
      double along = 0., trace = 0.;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          for (unsigned int k = 0; k < 3; ++k) {
            for (unsigned int l = 0; l < 3; ++l)
              along += n[i] * n[j] * n[k] * n[l] *
                       S[stress_place(i, j)][stress_place(k, l)];
            trace += n[i] * n[j] * S[stress_place(i, j)][k];
          }
      return {{1. / along, (along - trace) / (2. * along)}};
    }

    double degrees(const double radians)
    {
      return radians * 180. / std::acos(-1.);
    }
  } // namespace

  std::array<std::array<double, 3>, 3> crystal_axes(const EulerAngles &angles)
  {
    const auto radians = [&](const unsigned int k) {
      return angles[k] * std::acos(-1.) / 180.;
    };
    const double c1 = std::cos(radians(0)), s1 = std::sin(radians(0)),
                 C = std::cos(radians(1)), S = std::sin(radians(1)),
                 c2 = std::cos(radians(2)), s2 = std::sin(radians(2));
    return {{{{c1 * c2 - s1 * s2 * C, s1 * c2 + c1 * s2 * C, s2 * S}},
             {{-c1 * s2 - s1 * c2 * C, -s1 * s2 + c1 * c2 * C, c2 * S}},
             {{s1 * S, -c1 * S, C}}}};
  }

  EulerAngles euler_angles(const std::array<std::array<double, 3>, 3> &axes)
  {
    const double S = std::hypot(axes[2][0], axes[2][1]);
    if (S == 0.) // turned about axis 3 alone
      return {{degrees(std::atan2(axes[0][1], axes[0][0])),
               axes[2][2] > 0. ? 0. : 180., 0.}};
    return {{degrees(std::atan2(axes[2][0], -axes[2][1])),
             degrees(std::atan2(S, axes[2][2])),
             degrees(std::atan2(axes[0][2], axes[1][2]))}};
  }

  HookeMatrix turned(const HookeMatrix &stiffness, const EulerAngles &angles)
  {
    const Axes g = crystal_axes(angles);
    // sigma in the scene from sigma in the crystal: Bond's matrix
    HookeMatrix M, product{}, result{};
    for (unsigned int I = 0; I < 6; ++I)
      for (unsigned int A = 0; A < 6; ++A) {
        const unsigned int i = first_of[I], j = second_of[I], a = first_of[A],
                           b = second_of[A];
        M[I][A] = g[a][i] * g[b][j] + (a == b ? 0. : g[b][i] * g[a][j]);
      }
    for (unsigned int I = 0; I < 6; ++I)
      for (unsigned int A = 0; A < 6; ++A)
        for (unsigned int B = 0; B < 6; ++B)
          product[I][A] += M[I][B] * stiffness[B][A];
    for (unsigned int I = 0; I < 6; ++I)
      for (unsigned int J = 0; J <= I; ++J) {
        for (unsigned int A = 0; A < 6; ++A)
          result[I][J] += product[I][A] * M[J][A];
        result[J][I] = result[I][J];
      }
    return result;
  }

  HookeMatrix compliance_of(const HookeMatrix &stiffness)
  {
    const auto S = dealii::invert(as_tensor(stiffness));
    HookeMatrix result;
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        result[i][j] = S[first_of[i]][second_of[i]][first_of[j]][second_of[j]];
    return result;
  }

  bool is_stable(const HookeMatrix &stiffness)
  {
    // pivots of L D L^T in Mandel's basis
    HookeMatrix A = stiffness;
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        A[i][j] *= (i < 3 ? 1. : std::sqrt(2.)) * (j < 3 ? 1. : std::sqrt(2.));
    double largest = 0.;
    for (unsigned int i = 0; i < 6; ++i)
      largest = std::max(largest, std::abs(A[i][i]));
    for (unsigned int k = 0; k < 6; ++k) {
      // what elimination leaves of zero is below the bits of the entries
      if (!(A[k][k] > 32. * std::numeric_limits<double>::epsilon() * largest))
        return false;
      for (unsigned int i = k + 1; i < 6; ++i)
        for (unsigned int j = k + 1; j < 6; ++j)
          A[i][j] -= A[i][k] * A[k][j] / A[k][k];
    }
    return true;
  }

  AnisotropicInput anisotropic_of(const HookeMatrix &stiffness)
  {
    AnisotropicInput result;
    result.stiffness = stiffness;
    const auto all = directions();
    result.fastest = extreme_wave(stiffness, 0, all);
    result.slowest = extreme_wave(stiffness, 2, all);
    const HookeMatrix S = compliance_of(stiffness);
    for (const auto &n : all) {
      const auto [young, poisson] = bar_along(S, n);
      if (young > result.stiffest_young) {
        result.stiffest_young = young;
        result.stiffest_poisson = poisson;
      }
      if (result.softest_young == 0. || young < result.softest_young) {
        result.softest_young = young;
        result.softest_poisson = poisson;
      }
    }
    return result;
  }

  unsigned int grain_number(const OrientationInput &orientation,
                            const unsigned int id)
  {
    return id < orientation.numbers.size() ? orientation.numbers[id] : id;
  }

  std::string orientation_text(const OrientationInput &orientation)
  {
    using Kind = OrientationInput::Kind;
    switch (orientation.kind) {
    case Kind::angles:
      return orientation.varies() ? ", turned by a formula" : "";
    case Kind::random:
      return ", grains at random";
    case Kind::in_plane:
      return ", grains at random in the plane";
    case Kind::table:
      return fmt::format(", {} grains of a file", orientation.of_grain.size());
    case Kind::cell_data:
      return ", turned by data of cells";
    }
    return "";
  }

  EulerAngles orientation_at(const OrientationInput &orientation,
                             const std::array<double, 3> &x,
                             const unsigned int id)
  {
    using Kind = OrientationInput::Kind;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const auto drawn = [&](const unsigned int k) {
      const std::uint64_t grain = grain_number(orientation, id);
      return uniform(orientation.seed, 3 * grain + k);
    };
    switch (orientation.kind) {
    case Kind::angles:
      return {{orientation.angles[0](x[0], x[1], x[2]),
               orientation.angles[1](x[0], x[1], x[2]),
               orientation.angles[2](x[0], x[1], x[2])}};
    case Kind::random:
      // Haar's measure is sin(Phi) dphi_1 dPhi dphi_2
      return {{360. * drawn(0), degrees(std::acos(1. - 2. * drawn(1))),
               360. * drawn(2)}};
    case Kind::in_plane:
      return {{360. * drawn(0), 0., 0.}};
    case Kind::table: {
      const auto found =
          orientation.of_grain.find(grain_number(orientation, id));
      return found == orientation.of_grain.end()
                 ? EulerAngles{{none, none, none}}
                 : found->second;
    }
    case Kind::cell_data:
      return id < orientation.of_id.size() ? orientation.of_id[id]
                                           : EulerAngles{{none, none, none}};
    }
    return {{none, none, none}};
  }
} // namespace nsfd
