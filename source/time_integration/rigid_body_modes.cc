#include "rigid_body_modes.h"

#include "bodies/fragments.h"
#include "discretization/cells.h"
#include "linear_algebra/small_inverse.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    template <int dim>
    struct RigidMotion {
      std::string name;
      std::vector<double> unknowns;
      double free = 1.; ///< the share of it that supports leave
    };

    /** Translations, and rotations about @p centre; of axisymmetric scenes the
        translation along the axis. */
    template <int dim>
    std::vector<RigidMotion<dim>>
    rigid_motions(const Discretization<dim> &discretization,
                  const dealii::Point<dim> &centre)
    {
      const double L = discretization.extent(); // displacements of size 1
      std::vector<RigidMotion<dim>> motions;
      const bool rings = discretization.input().axisymmetric;
      for (unsigned int c = rings ? 1 : 0; c < dim; ++c)
        motions.push_back(
            {fmt::format("the translation in {}", "xyz"[c]),
             discretization.interpolate(
                 [c](const dealii::Point<dim> &, unsigned int, double *value) {
                   for (unsigned int d = 0; d < dim; ++d)
                     value[d] = d == c;
                 })});
      if (rings)
        return motions;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = a + 1; b < dim; ++b)
          motions.push_back(
              {fmt::format("the rotation about {}", "xyz"[3 - a - b]),
               discretization.interpolate([&](const dealii::Point<dim> &x,
                                              unsigned int, double *value) {
                 std::fill_n(value, dim, 0.);
                 value[a] = -(x[b] - centre[b]) / L;
                 value[b] = (x[a] - centre[a]) / L;
               })});
      return motions;
    }

    /**
     * To each motion the part of it that no support takes part in: a hinge
     * holds translations and rotations about the centre, and leaves a rotation
     * about itself. With G_ab = sum (H m_a)(H m_b) over the components that are
     * prescribed, that is (I + G/e)^-1 m_a for small e. Collective.
     */
    template <int dim>
    void take_what_is_free(const DelassusOperator<dim> &delassus,
                           const Discretization<dim> &discretization,
                           std::vector<RigidMotion<dim>> &motions)
    {
      constexpr std::size_t most = 6;
      constexpr double little = 1e-10; // of the motions of all supports
      const std::size_t n = motions.size(),
                        n_owned = discretization.points().n_owned;
      std::vector<std::vector<double>> jumps(
          n, std::vector<double>(discretization.points().n_points * dim));
      for (std::size_t a = 0; a < n; ++a)
        delassus.relative_velocity(motions[a].unknowns.data(), jumps[a].data());
      std::vector<double> terms(n * n * n_owned, 0.);
      for (std::size_t i = 0; i < n_owned; ++i) {
        const PointOrigin origin = discretization.origins()[i];
        if (origin.kind != PointOrigin::Kind::motion)
          continue;
        const auto &boundary = discretization.input().boundaries[origin.block];
        for (unsigned int c = 0; c < dim; ++c)
          if (boundary.displacement[c] || boundary.velocity[c])
            for (std::size_t a = 0; a < n; ++a)
              for (std::size_t b = 0; b < n; ++b)
                terms[(a * n + b) * n_owned + i] +=
                    jumps[a][i * dim + c] * jumps[b][i * dim + c];
      }
      auto G =
          delassus.communicator().sums(terms.data(), unsigned(n * n), n_owned);
      double size = 0.;
      for (std::size_t a = 0; a < n; ++a)
        size += G[a * n + a];
      if (size == 0.)
        return;
      for (std::size_t k = 0; k < n * n; ++k)
        G[k] = G[k] / (little * size) + (k % (n + 1) == 0 ? 1. : 0.);
      invert_in_place<most>(G.data(), n, n, 0., [](std::size_t) {});
      std::vector<std::vector<double>> free(
          n, std::vector<double>(motions[0].unknowns.size(), 0.));
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b)
          for (std::size_t k = 0; k < free[a].size(); ++k)
            free[a][k] += G[a * n + b] * motions[b].unknowns[k];
      for (std::size_t a = 0; a < n; ++a) {
        motions[a].unknowns = std::move(free[a]);
        motions[a].free = G[a * n + a];
      }
    }
  } // namespace

  template <int dim>
  std::string rigid_body_modes(const Discretization<dim> &discretization,
                               const DelassusOperator<dim> &delassus,
                               const State &state,
                               const std::vector<double> &residual)
  {
    const Communicator &communicator = delassus.communicator();
    Fragments<dim> fragments(discretization, communicator);
    fragments.update(state);
    const std::vector<unsigned int> fragment_of = fragments.number_bodies();
    const auto &bodies = discretization.bodies();
    const unsigned int n_bodies = unsigned(bodies.size());
    std::string name;
    constexpr double moves = 0.5; // of the unbalanced forces
    double largest = 0.;
    std::vector<double> size(residual.size());
    for (std::size_t k = 0; k < residual.size(); ++k)
      size[k] = std::abs(residual[k]);
    const double all = communicator.sum(size);
    for (unsigned int f = 0; f < fragments.count() && all > 0.; ++f) {
      const auto ours = [&](const unsigned int b) {
        return fragment_of[b] == f;
      };
      std::vector<double> moments((dim + 1) * n_bodies, 0.);
      for (unsigned int b = 0; b < n_bodies; ++b)
        if (ours(b)) {
          moments[b] = discretization.cells().volume(b);
          for (unsigned int c = 0; c < dim; ++c)
            moments[(c + 1) * n_bodies + b] =
                discretization.cells().volume(b) *
                discretization.cells().centre(b)[c];
        }
      const auto sums = communicator.sums(moments.data(), dim + 1, n_bodies);
      if (sums[0] == 0.)
        continue;
      dealii::Point<dim> centre;
      std::string place;
      for (unsigned int c = 0; c < dim; ++c) {
        centre[c] = sums[c + 1] / sums[0];
        place += fmt::format("{}{:.4g}", c ? ", " : "", centre[c]);
      }
      auto motions = rigid_motions(discretization, centre);
      for (auto &motion : motions) {
        for (unsigned int b = 0; b < n_bodies; ++b)
          if (!ours(b))
            std::fill(motion.unknowns.begin() + long(bodies.first_dof[b]),
                      motion.unknowns.begin() + long(bodies.first_dof[b + 1]),
                      0.);
      }
      take_what_is_free(delassus, discretization, motions);
      for (const auto &motion : motions) {
        std::vector<double> terms(2 * residual.size(), 0.);
        for (std::size_t k = 0; k < residual.size(); ++k) {
          terms[k] = residual[k] * motion.unknowns[k];
          terms[residual.size() + k] = std::abs(terms[k]);
        }
        const auto work = communicator.sums(terms.data(), 2, residual.size());
        // all of one sign: the forces of a free acceleration
        const double share = work[1] > 0. ? std::abs(work[0]) / work[1] : 0.;
        if (share > moves && share * motion.free > largest &&
            std::abs(work[0]) > 0.01 * all) {
          largest = share * motion.free;
          name = motion.name +
                 (fragments.count() > 1
                      ? fmt::format(" of the fragment around ({})", place)
                      : "");
        }
      }
    }
    return name;
  }

#define INSTANTIATE(dim)                                                       \
  template std::string rigid_body_modes<dim>(                                  \
      const Discretization<dim> &, const DelassusOperator<dim> &,              \
      const State &, const std::vector<double> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
