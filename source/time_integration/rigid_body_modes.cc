#include "rigid_body_modes.h"

#include "bodies/fragments.h"
#include "discretization/cells.h"
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
    };

    /** Translations, and rotations about @p centre. */
    template <int dim>
    std::vector<RigidMotion<dim>>
    rigid_motions(const Discretization<dim> &discretization,
                  const dealii::Point<dim> &centre)
    {
      const double L = discretization.extent(); // displacements of size 1
      std::vector<RigidMotion<dim>> motions;
      for (unsigned int c = 0; c < dim; ++c)
        motions.push_back(
            {fmt::format("the translation in {}", "xyz"[c]),
             discretization.interpolate(
                 [c](const dealii::Point<dim> &, unsigned int, double *value) {
                   for (unsigned int d = 0; d < dim; ++d)
                     value[d] = d == c;
                 })});
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
  } // namespace

  template <int dim>
  std::string rigid_body_modes(const Discretization<dim> &discretization,
                               const Communicator &communicator,
                               const State &state,
                               const std::vector<double> &residual)
  {
    Fragments<dim> fragments(discretization, communicator);
    fragments.update(state);
    const std::vector<unsigned int> fragment_of = fragments.number_bodies();
    const auto &bodies = discretization.bodies();
    const unsigned int n_bodies = unsigned(bodies.size());
    std::string name;
    double largest = 0.5; // of the unbalanced forces, above which it moves
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
      for (const auto &motion : rigid_motions(discretization, centre)) {
        std::vector<double> terms(2 * residual.size(), 0.);
        for (unsigned int b = 0; b < n_bodies; ++b)
          if (ours(b))
            for (std::size_t k = bodies.first_dof[b];
                 k < bodies.first_dof[b + 1]; ++k) {
              terms[k] = residual[k] * motion.unknowns[k];
              terms[residual.size() + k] = std::abs(terms[k]);
            }
        const auto work = communicator.sums(terms.data(), 2, residual.size());
        // all of one sign: the forces of a free acceleration
        const double share = work[1] > 0. ? std::abs(work[0]) / work[1] : 0.;
        if (share > largest && std::abs(work[0]) > 0.01 * all) {
          largest = share;
          name = motion.name +
                 (fragments.count() > 1
                      ? fmt::format(" of the fragment around ({})", place)
                      : "");
        }
      }
    }
    return name;
  }

  template std::string rigid_body_modes(const Discretization<2> &,
                                        const Communicator &, const State &,
                                        const std::vector<double> &);
  template std::string rigid_body_modes(const Discretization<3> &,
                                        const Communicator &, const State &,
                                        const std::vector<double> &);
} // namespace nsfd
