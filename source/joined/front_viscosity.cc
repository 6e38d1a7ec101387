#include "front_viscosity.h"

#include "core/instruction_sets.h"
#include "discretization/body_frequency.h"
#include "discretization/cells.h"
#include "discretization/point_places.h"
#include "nsfd/core/archive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

    /** Sums over the neighbours of a cell, and psi eta of cells from them. */
    NSFD_CLONES
    void set_viscosities(const std::size_t n, const std::size_t *first_neighbor,
                         const unsigned int *neighbor, const double *rate,
                         const double *eta, double *viscosity)
    {
      constexpr std::size_t width = 64;
      double jump[width], size[width];
      for (std::size_t first = 0; first < n; first += width) {
        const std::size_t count = std::min(width, n - first);
        for (std::size_t l = 0; l < count; ++l) {
          const double mine = rate[first + l], my_size = std::abs(mine);
          double of_jump = 0., of_size = 0.;
          for (std::size_t k = first_neighbor[first + l];
               k < first_neighbor[first + l + 1]; ++k) {
            const double other = rate[neighbor[k]];
            of_jump += other - mine;
            of_size += std::abs(other) + my_size;
          }
          jump[l] = of_jump;
          size[l] = of_size;
        }
        for (std::size_t l = 0; l < count; ++l) {
          const double ratio = jump[l] / (size[l] > 0. ? size[l] : 1.),
                       of_sharp = std::abs(size[l] > 0. ? ratio : 0.) / sharp,
                       share = of_sharp < 1. ? of_sharp : 1.;
          viscosity[first + l] = eta[first + l] * share * share * share;
        }
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
    for (std::size_t b = 0; b < n; ++b) {
      double bulk = 0.;
      for (const auto &local : cells.class_shape(b).elasticity)
        bulk = std::max(bulk, local.lambda + 2. * local.mu / dim);
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
    first_neighbor_.assign(n + 1, 0);
    for (const std::size_t f : pairs)
      for (const int b : faces[f].bodies)
        ++first_neighbor_[std::size_t(b) + 1];
    std::partial_sum(first_neighbor_.begin(), first_neighbor_.end(),
                     first_neighbor_.begin());
    neighbor_.resize(first_neighbor_.back());
    const auto larger = larger_cells(discretization);
    if (!larger.empty())
      weight_.assign(neighbor_.size(), 1.);
    auto next = first_neighbor_;
    for (const std::size_t f : pairs)
      for (unsigned int side = 0; side < 2; ++side) {
        const auto &pair = faces[f].bodies;
        const std::size_t k = next[std::size_t(pair[side])]++;
        neighbor_[k] = unsigned(pair[1 - side]);
        // a rate that is linear in space has no second difference: centres
        // are 3/2 of the smaller cell apart, 3/4 of the larger one
        if (!larger.empty() && larger[f])
          weight_[k] = side == 0 ? 2. / 3. : 4. / 3. / (1u << (dim - 1));
      }
    // ghosts have neighbours that are not here
    std::vector<double> n_neighbors;
    for (std::size_t b = 0; b < n; ++b)
      n_neighbors.push_back(
          double(first_neighbor_[b + 1] - first_neighbor_[b]));
    if (ghosts_)
      ghosts_->fetch(n_neighbors);
    for (std::size_t b = 0; b < n; ++b)
      if (n_neighbors[b] == 1. && first_neighbor_[b + 1] > first_neighbor_[b])
        ends_.push_back(unsigned(b));
  }

  /** Beside cells of other sizes. */
  void FrontViscosity::set_viscosity(const std::size_t cell)
  {
    double jump = 0., size = 0.;
    for (std::size_t k = first_neighbor_[cell]; k < first_neighbor_[cell + 1];
         ++k) {
      const double other = rate[neighbor_[k]];
      jump += weight_[k] * (other - rate[cell]);
      size += weight_[k] * (std::abs(other) + std::abs(rate[cell]));
    }
    const double ratio = size > 0. ? jump / size : 0.;
    const double share = std::min(1., std::abs(ratio) / sharp);
    viscosity[cell] = eta_[cell] * share * share * share;
  }

  FrontViscosity::Powers
  FrontViscosity::finish(const Communicator &communicator)
  {
    const std::size_t n = eta_.size();
    if (weight_.empty() && n > 0)
      set_viscosities(n, first_neighbor_.data(), neighbor_.data(), rate.data(),
                      eta_.data(), viscosity.data());
    else
      for (std::size_t b = 0; b < n; ++b)
        set_viscosity(b);
    if (ghosts_ && acts_) {
      ghosts_->fetch(viscosity);
      for (std::size_t b = 0; b < n; ++b)
        for (unsigned int row = 0; row < 4 && ghosts_->is_ghost(b); ++row)
          terms_[row * n + b] = 0.;
    }
    // at an end there is no second difference
    for (const unsigned int b : ends_) {
      const unsigned int other = neighbor_[first_neighbor_[b]];
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
