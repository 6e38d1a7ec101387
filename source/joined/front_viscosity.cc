#include "front_viscosity.h"

#include "core/instruction_sets.h"
#include "discretization/body_frequency.h"
#include "discretization/cells.h"
#include "discretization/point_places.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// jump of the rate from which a front is sharp: that of waves of 8 cells
    constexpr double sharp = 0.15;

    /** By face: body 2 is larger than body 1; empty: nowhere. */
    template <int dim>
    std::vector<char> larger_cells(const Discretization<dim> &discretization)
    {
      const auto &points = discretization.points();
      std::vector<char> result;
      for_all_places(discretization.bodies(), points.n_points,
                     [&](const std::size_t body, const unsigned int slot,
                         const std::size_t point, unsigned int) {
                       const auto &shape =
                           discretization.cells().class_shape(body);
                       if (!(shape.divided >> shape.slot_faces[slot] & 1u))
                         return;
                       result.resize(points.faces.size(), 0);
                       result[points.face_of[point]] = 1;
                     });
      return result;
    }

    /** psi eta of a cell from sums over its neighbours, of jumps of the rate
        and of sizes. */
    NSFD_INLINE double viscosity_of(const double jump, const double size,
                                    const double eta)
    {
      const double ratio = jump / (size > 0. ? size : 1.),
                   of_sharp = std::abs(size > 0. ? ratio : 0.) / sharp,
                   share = of_sharp < 1. ? of_sharp : 1.;
      return eta * share * share * share;
    }

    /** Of cells that have all @p n_slots neighbours; numbers for others. */
    NSFD_CLONES
    void set_viscosities(const std::size_t n, const unsigned int n_slots,
                         const unsigned int *neighbor, const double *rate,
                         const double *eta, double *viscosity)
    {
      for (std::size_t first = 0; first + lanes <= n;
           first += lanes, neighbor += n_slots * lanes) {
        const auto vector = [](const double *x)
                                NSFD_INLINED -> const Vector8u & {
          return *reinterpret_cast<const Vector8u *>(x);
        };
        const Vector8 mine = vector(rate + first), zero = {}, one = zero + 1.;
        const Vector8 my_size = mine < 0. ? -mine : mine;
        Vector8 jump = {}, size = {};
        for (unsigned int k = 0; k < n_slots; ++k) {
          const unsigned int *of = neighbor + k * lanes;
          const Vector8 other = {rate[of[0]], rate[of[1]], rate[of[2]],
                                 rate[of[3]], rate[of[4]], rate[of[5]],
                                 rate[of[6]], rate[of[7]]};
          jump += other - mine;
          size += (other < 0. ? -other : other) + my_size;
        }
        const Vector8 ratio =
            size > 0. ? jump / (size > 0. ? size : one) : zero;
        const Vector8 of_sharp = (ratio < 0. ? -ratio : ratio) / sharp;
        const Vector8 share = of_sharp < 1. ? of_sharp : one;
        *reinterpret_cast<Vector8u *>(viscosity + first) =
            vector(eta + first) * share * share * share;
      }
    }
  } // namespace

  template <int dim>
  FrontViscosity::FrontViscosity(const Discretization<dim> &discretization,
                                 const double share, const GhostCells *ghosts)
      : acts_(share != 0.), ghosts_(ghosts)
  {
    if (!acts_)
      return;
    const Cells<dim> &cells = discretization.cells();
    const std::size_t n = cells.bodies.size();
    const auto frequency = frequencies_of_bodies(cells);
    const double n_strained = discretization.input().axisymmetric ? 3 : dim;
    for (std::size_t b = 0; b < n; ++b) {
      double bulk = 0.;
      for (const auto &local : cells.class_shape(b).elasticity)
        bulk = std::max(bulk, local.lambda + 2. * local.mu / n_strained);
      eta_.push_back(frequency[b] > 0. ? 2. * share * bulk / frequency[b] : 0.);
    }
    tension.assign(n, 0.);
    dilatation = rate = viscosity = present_viscosity = tension;
    terms_.assign(4 * n, 0.);

    const auto &faces = discretization.points().faces;
    const auto deforms = [&](const int b) {
      return b >= 0 && !cells.body_class(std::size_t(b)).undeformed;
    };
    std::vector<std::size_t> pairs;
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (!faces[f].boundary && deforms(faces[f].bodies[0]) &&
          deforms(faces[f].bodies[1]))
        pairs.push_back(f);
    std::vector<double> n_neighbors(n, 0.);
    for (const std::size_t f : pairs)
      for (const int b : faces[f].bodies)
        ++n_neighbors[std::size_t(b)];
    for (const double here : n_neighbors)
      n_slots_ = std::max(n_slots_, unsigned(here));
    neighbor_.resize((n + lanes - 1) / lanes * lanes * n_slots_);
    for (std::size_t b = 0; b < n; ++b)
      for (unsigned int k = 0; k < n_slots_; ++k)
        neighbor_[slot(b, k)] = unsigned(b);
    const auto larger = larger_cells(discretization);
    if (!larger.empty())
      weight_.assign(neighbor_.size(), 1.);
    std::vector<std::uint8_t> next(n, 0);
    for (const std::size_t f : pairs)
      for (unsigned int side = 0; side < 2; ++side) {
        const auto &pair = faces[f].bodies;
        const std::size_t b = std::size_t(pair[side]), k = slot(b, next[b]++);
        neighbor_[k] = unsigned(pair[1 - side]);
        // a rate that is linear in space has no second difference: centres
        // are 3/2 of the smaller cell apart, 3/4 of the larger one
        if (!larger.empty() && larger[f])
          weight_[k] = side == 0 ? 2. / 3. : 4. / 3. / (1u << (dim - 1));
      }
    for (std::size_t b = 0; b < n; ++b)
      if (n_neighbors[b] < n_slots_ || b >= n / lanes * lanes ||
          !weight_.empty())
        others_.push_back(unsigned(b));
    // ghosts have neighbours that are not here
    if (ghosts_)
      ghosts_->fetch(n_neighbors);
    for (std::size_t b = 0; b < n; ++b)
      if (n_neighbors[b] == 1. && next[b] > 0)
        ends_.push_back(unsigned(b));
  }

  /** At the boundary, and beside cells of other sizes. */
  void FrontViscosity::set_viscosity(const std::size_t cell)
  {
    double jump = 0., size = 0.;
    for (unsigned int i = 0; i < n_slots_; ++i) {
      const std::size_t k = slot(cell, i);
      if (neighbor_[k] == cell)
        break; // there are no more
      const double other = rate[neighbor_[k]],
                   weight = weight_.empty() ? 1. : weight_[k];
      jump += weight * (other - rate[cell]);
      size += weight * (std::abs(other) + std::abs(rate[cell]));
    }
    viscosity[cell] = viscosity_of(jump, size, eta_[cell]);
  }

  FrontViscosity::Powers
  FrontViscosity::finish(const Communicator &communicator)
  {
    const std::size_t n = eta_.size();
    if (weight_.empty())
      set_viscosities(n, n_slots_, neighbor_.data(), rate.data(), eta_.data(),
                      viscosity.data());
    for (const unsigned int b : others_)
      set_viscosity(b);
    if (ghosts_ && acts_) {
      ghosts_->fetch(viscosity);
      for (std::size_t b = 0; b < n; ++b)
        for (unsigned int row = 0; row < 4 && ghosts_->is_ghost(b); ++row)
          terms_[row * n + b] = 0.;
    }
    // at an end there is no second difference
    for (const unsigned int b : ends_) {
      const unsigned int other = neighbor_[slot(b, 0)];
      viscosity[b] =
          eta_[other] > 0. ? viscosity[other] / eta_[other] * eta_[b] : 0.;
    }
    const auto sums = communicator.sums(terms_.data(), 4, n);
    return {sums[0], sums[1], sums[2], sums[3]};
  }

  void FrontViscosity::serialize(Archive &archive,
                                 const std::vector<std::size_t> &first_dof)
  {
    if (!acts())
      return;
    std::vector<double> all(first_dof.back(), 0.);
    const auto copy = [&](const bool reads) {
      for (std::size_t b = 0; b < eta_.size(); ++b) {
        double *mine = all.data() + first_dof[b];
        double *const values[4] = {&tension[b], &rate[b], &viscosity[b],
                                   &present_viscosity[b]};
        for (unsigned int k = 0; k < 4; ++k)
          (reads ? *values[k] : mine[k]) = reads ? mine[k] : *values[k];
      }
    };
    copy(false);
    archive.bodies("front_viscosity", all);
    if (archive.reads())
      copy(true);
  }

  template FrontViscosity::FrontViscosity(const Discretization<2> &, double,
                                          const GhostCells *);
  template FrontViscosity::FrontViscosity(const Discretization<3> &, double,
                                          const GhostCells *);
} // namespace nsfd
