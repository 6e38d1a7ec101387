#include "face_release.h"

#include "discretization/cells.h"
#include "discretization/loads.h"
#include "discretization/point_factors.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nsfd
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    /// of the strength: a face is released early that would be further in the
    /// next step
    constexpr double too_far = 1.03;
  } // namespace

  template <int dim>
  FaceRelease<dim>::FaceRelease(const Discretization<dim> &discretization,
                                const OneStepProblem<dim> &all,
                                const HangingNodes<dim> &hanging)
      : discretization_(discretization), all_(all),
        sites_(discretization.points())
  {
    const auto &points = discretization.points();
    const auto &input = discretization.input();
    const Cells<dim> &cells = discretization.cells();
    first_site_.assign(points.faces.size(), -1);
    if (input.discretization.degree == 1) { // a site per face
      sites_.reserve(points.faces.size());
      factors_.reserve(points.faces.size());
    }
    bool any_share = false;
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const auto &face = points.faces[f];
      const PointOrigin &origin = discretization.origins()[face.first];
      if (origin.kind != PointOrigin::Kind::interface || face.boundary ||
          !input.interfaces[origin.block].law)
        continue; // an obstacle holds nodes by rows of their own
      const auto &block = input.interfaces[origin.block];
      // rigid cells have no stress: the mean is half of what the other one has
      double sides = 2.;
      for (const int b : face.bodies)
        sides -= cells.body_class(std::size_t(b)).undeformed;
      const double share = sides > 0. ? 2. / sides : 1.;
      if (share != 1. && !any_share) {
        any_share = true;
        share_.assign(sites_.size(), 1.);
      }
      const bool whole = cells.class_shape(std::size_t(face.bodies[0]))
                             .reference.is_simplex() ||
                         input.discretization.degree == 1;
      first_site_[f] = int(sites_.size());
      typename StrengthSites<dim>::Site site;
      site.n_points = whole ? face.count : 1;
      site.cells = {{unsigned(face.bodies[0]), unsigned(face.bodies[1])}};
      double least = infinity;
      std::vector<typename StrengthSites<dim>::Site> of_face;
      for (unsigned int i = face.first; i < face.first + face.count;
           i += site.n_points) {
        site.first_point = i;
        typename LeapfrogPoints<dim>::Factors of_law = {all.strength_factor[i],
                                                        all.opening_factor[i]};
        if (whole) {
          const auto factors = point_factors<dim>(block, face.centre.data(),
                                                  discretization.extent());
          of_law = {factors.strength, factors.strength / factors.toughness};
        }
        factors_.push_back(of_law);
        const LawPoint here(*block.law, of_law.strength, of_law.opening,
                            block.plateau);
        const double shear[2] = {1., 0.};
        const double of_shear =
            here.template effective_traction<dim>(0., shear);
        site.shear_weight = of_shear * of_shear;
        // the surface of two scalars is within the norm of its two ends only
        // between two of them points are held by their law from the start
        if (any_share)
          share_.push_back(share);
        const double strength = here.strength() / share;
        site.limit = (block.law->mixed() ? 0.5 : 1.) * strength * strength;
        least = std::min(least, site.limit / std::max(1., site.shear_weight));
        of_face.push_back(site);
      }
      if (!hanging.held().empty()) {
        held_.resize(sites_.size() + of_face.size(),
                     hanging.held()[face.first]);
        // tractions between the nodes of a cell are beyond those at them
        least /= hanging.spread() * hanging.spread();
      }
      for (auto &one : of_face) {
        one.least = least;
        sites_.add(one);
      }
    }
    sites_.finish(cells.bodies.size());
    if (has_warm_faces(input))
      for (std::size_t k = 0; k < sites_.size(); ++k)
        cold_.push_back({factors_[k], {sites_[k].limit, sites_[k].least}});
  }

  template <int dim>
  LawPoint FaceRelease<dim>::law(const std::size_t site) const
  {
    const auto &block = block_of(site);
    return LawPoint(*block.law, factors_[site].strength, factors_[site].opening,
                    block.plateau);
  }

  /** What holds intact faces as well, mu. */
  template <int dim>
  double FaceRelease<dim>::friction_of(const std::size_t site) const
  {
    const auto &block = block_of(site);
    if (block.friction_exponent != 0.)
      return 0.;
    return temperature_.empty()
               ? block.friction
               : block.friction * block.heat.friction.at(temperature(site));
  }

  template <int dim>
  const InterfaceInput &FaceRelease<dim>::block_of(const std::size_t site) const
  {
    return discretization_.input()
        .interfaces[discretization_.origins()[sites_[site].first_point].block];
  }

  template <int dim>
  typename LeapfrogPoints<dim>::Factors
  FaceRelease<dim>::factors(const unsigned int point) const
  {
    const auto &points = discretization_.points();
    const int first = first_site_[points.face_of[point]];
    if (first < 0) {
      typename LeapfrogPoints<dim>::Factors of_point = {
          all_.strength_factor[point], all_.opening_factor[point]};
      const PointOrigin &origin = discretization_.origins()[point];
      if (!temperature_.empty() &&
          origin.kind == PointOrigin::Kind::interface) {
        const PointFactors warm =
            warm_factors(discretization_.input().interfaces[origin.block],
                         temperature_[point]);
        of_point.strength *= warm.strength;
        of_point.opening *= warm.strength / warm.toughness;
      }
      return of_point;
    }
    const unsigned int within =
        point - points.faces[points.face_of[point]].first;
    return factors_[std::size_t(first) +
                    within / sites_[std::size_t(first)].n_points];
  }

  /** The mean of its points, K. */
  template <int dim>
  double FaceRelease<dim>::temperature(const std::size_t site) const
  {
    const auto first = temperature_.begin() + long(sites_[site].first_point);
    const unsigned int n = sites_[site].n_points;
    return std::accumulate(first, first + long(n), 0.) / n;
  }

  template <int dim>
  void FaceRelease<dim>::warm(const std::vector<double> &temperatures)
  {
    temperature_ = temperatures;
    std::vector<typename StrengthSites<dim>::Limits> limits(cold_.size());
    const auto &points = discretization_.points();
    for (std::size_t k = 0; k < cold_.size(); ++k) {
      const PointFactors warm = warm_factors(block_of(k), temperature(k));
      factors_[k].strength = cold_[k].factors.strength * warm.strength;
      factors_[k].opening =
          cold_[k].factors.opening * (warm.strength / warm.toughness);
      limits[k].limit = cold_[k].limits.limit * warm.strength * warm.strength;
    }
    // `least` is of all sites of a face
    for (std::size_t k = 0; k < cold_.size();) {
      const unsigned int face = points.face_of[sites_[k].first_point];
      double ratio = infinity;
      std::size_t end = k;
      for (; end < cold_.size() &&
             points.face_of[sites_[end].first_point] == face;
           ++end)
        ratio = std::min(ratio,
                         factors_[end].strength / cold_[end].factors.strength);
      for (; k < end; ++k)
        limits[k].least = cold_[k].limits.least * ratio * ratio;
    }
    sites_.set_limits(limits);
  }

  template <int dim>
  void FaceRelease<dim>::start(std::vector<std::uint8_t> intact)
  {
    intact_ = std::move(intact);
    // `broken` is of points: a face may be broken at one of its ends
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      const auto first = intact_.begin() + long(sites_[k].first_point);
      if (std::find(first, first + long(sites_[k].n_points), 1) ==
          first + long(sites_[k].n_points))
        sites_.release(k);
    }
  }

  template <int dim>
  void FaceRelease<dim>::let_go(const std::size_t site,
                                std::vector<unsigned int> &released)
  {
    sites_.release(site);
    const unsigned int first = sites_[site].first_point;
    for (unsigned int i = first; i < first + sites_[site].n_points; ++i) {
      if (!intact_[i])
        continue; // it was broken before, and stays so
      intact_[i] = 0;
      released.push_back(i);
    }
  }

  template <int dim>
  std::array<double, dim>
  FaceRelease<dim>::in_frame(const std::size_t point,
                             const std::array<double, dim> &t) const
  {
    const double *frame = discretization_.points().axes(point);
    std::array<double, dim> local{};
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c)
        local[r] += frame[r * dim + c] * t[c];
    return local;
  }

  /** With what viscous materials and an initial stress add. */
  template <int dim>
  std::array<double, dim>
  FaceRelease<dim>::traction(const CellForces<dim> &forces,
                             const std::size_t site) const
  {
    auto t = forces.traction(sites_, site);
    const auto *viscous = forces.viscous();
    const auto *initial = discretization_.loads().initial_stress();
    if (!viscous && !initial)
      return t;
    const auto &weight = discretization_.points().weight;
    const unsigned int first = sites_[site].first_point,
                       last = first + sites_[site].n_points;
    double length = 0.;
    for (unsigned int i = first; i < last; ++i)
      length += weight[i];
    for (unsigned int i = first; i < last; ++i) {
      for (unsigned int c = 0; viscous && c < dim; ++c)
        t[c] += weight[i] / length * viscous->traction(i)[c];
      for (unsigned int c = 0; initial && c < dim; ++c)
        t[c] += weight[i] / length * initial->traction(i)[c] / share_of(site);
    }
    return t;
  }

  /** Something else than strains gives a traction at a site. */
  template <int dim>
  bool FaceRelease<dim>::has_more(const CellForces<dim> &forces,
                                  const std::size_t site) const
  {
    const auto &one = sites_[site];
    if (const auto *viscous = forces.viscous())
      for (const unsigned int cell : one.cells)
        if (viscous->acts_in(cell))
          return true;
    if (const auto *initial = discretization_.loads().initial_stress())
      for (unsigned int i = one.first_point; i < one.first_point + one.n_points;
           ++i)
        for (unsigned int c = 0; c < dim; ++c)
          if (initial->traction(i)[c] != 0.)
            return true;
    return false;
  }

  /** Where more than strains adds to tractions, these are at hand nowhere. */
  template <int dim>
  void FaceRelease<dim>::add_more(const CellForces<dim> &forces)
  {
    typename StrengthSites<dim>::Near all;
    auto square = near_.square.begin();
    auto site = near_.site.begin();
    for (unsigned int k = 0; k < sites_.size(); ++k) {
      const bool is_near = site != near_.site.end() && *site == k;
      if (!sites_.is_released(k) && has_more(forces, k)) {
        all.site.push_back(k);
        all.square.push_back(sites_.square(k, traction(forces, k)));
      } else if (is_near) {
        all.site.push_back(k);
        all.square.push_back(*square);
      }
      if (is_near) {
        ++site;
        ++square;
      }
    }
    near_ = std::move(all);
  }

  template <int dim>
  auto FaceRelease<dim>::reached(const CellForces<dim> &forces, double &excess)
      -> std::vector<unsigned int>
  {
    std::vector<unsigned int> released;
    std::swap(near_, last_near_);
    forces.squared_tractions(sites_, near_);
    if (forces.viscous() || discretization_.loads().initial_stress())
      add_more(forces);
    constexpr double seen = StrengthSites<dim>::looked_at,
                     least = (too_far + seen) / 2.;
    std::size_t last = 0;
    for (std::size_t n = 0; n < near_.site.size(); ++n) {
      const std::size_t k = near_.site[n];
      const double square = near_.square[n];
      if (!(square >= least * least * sites_[k].limit))
        continue;
      const LawPoint here = law(k);
      double share = share_of(k) * std::sqrt(square) / here.strength();
      const double friction = friction_of(k);
      if (here.law().mixed() || friction > 0.) {
        const auto t = in_frame(sites_[k].first_point, traction(forces, k));
        share = share_of(k) *
                here.template effective_traction<dim>(t[0], &t[1], friction) /
                here.strength();
      }
      if (!held_.empty() && held_[k]) {
        if (share > worst_held_.share) {
          const unsigned int first = sites_[k].first_point;
          const auto &points = discretization_.points();
          worst_held_ = {share, points.faces[points.face_of[first]].centre,
                         discretization_.origins()[first].block};
        }
        continue;
      }
      while (last < last_near_.site.size() && last_near_.site[last] < k)
        ++last;
      double old_square = 0.;
      if (!has_looked_)
        old_square = infinity; // nothing has grown
      else if (last < last_near_.site.size() && last_near_.site[last] == k)
        old_square = last_near_.square[last];
      // what it was below that has not been looked at
      const double before =
          std::max(seen, share * std::sqrt(old_square / square));
      if (share < 1. && 2. * share - before < too_far)
        continue;
      excess = std::max(excess, share - 1.);
      let_go(k, released);
    }
    has_looked_ = true;
    return released;
  }

  template <int dim>
  void FaceRelease<dim>::visit_near(
      const std::function<void(unsigned int, double)> &visit) const
  {
    for (std::size_t n = 0; n < near_.site.size(); ++n) {
      const std::size_t k = near_.site[n];
      if (sites_.is_released(k))
        continue;
      const double share =
          share_of(k) * std::sqrt(near_.square[n]) / law(k).strength();
      if (share >= StrengthSites<dim>::looked_at)
        visit(sites_[k].first_point, share);
    }
  }

  template <int dim>
  auto FaceRelease<dim>::worst_held(const Communicator &communicator) const
      -> Held
  {
    // the first one by its coordinates, if several are
    constexpr double none = std::numeric_limits<double>::max();
    Held worst = worst_held_;
    worst.share = communicator.max(worst.share);
    bool here = worst.share > 0. && worst_held_.share == worst.share;
    for (double &x : worst.centre) {
      const double mine = x;
      x = communicator.min(here ? mine : none);
      here = here && mine == x;
    }
    worst.block = unsigned(communicator.min(here ? worst.block : none));
    if (!(worst.share > 0.))
      return {};
    return worst;
  }

  template <int dim>
  void FaceRelease<dim>::serialize(const Communicator &communicator,
                                   Archive &archive)
  {
    if (communicator.any(!held_.empty())) {
      worst_held_ = worst_held(communicator);
      std::vector<double> values(worst_held_.centre.begin(),
                                 worst_held_.centre.end());
      values.push_back(worst_held_.share);
      values.push_back(worst_held_.block);
      archive.common("held", values);
      std::copy_n(values.begin(), dim, worst_held_.centre.begin());
      worst_held_.share = values[dim];
      worst_held_.block = unsigned(values[dim + 1]);
    }
    // 0 where it was not looked at, infinite everywhere if never
    std::vector<double> all(discretization_.points().n_points,
                            has_looked_ ? 0. : infinity);
    if (!archive.reads())
      for (std::size_t n = 0; n < near_.site.size(); ++n)
        all[sites_[near_.site[n]].first_point] = near_.square[n];
    archive.points("squared_tractions", all);
    if (!archive.reads())
      return;
    near_ = {};
    for (unsigned int k = 0; k < sites_.size(); ++k) {
      const double square = all[sites_[k].first_point];
      has_looked_ = square != infinity;
      if (!has_looked_)
        break;
      if (square != 0.) {
        near_.site.push_back(k);
        near_.square.push_back(square);
      }
    }
  }

  template <int dim>
  void FaceRelease<dim>::show(const CellForces<dim> &forces,
                              std::vector<double> &tractions) const
  {
    std::fill(tractions.begin(), tractions.end(), 0.);
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      const unsigned int first = sites_[k].first_point;
      if (sites_.is_released(k))
        continue;
      auto t = traction(forces, k);
      for (double &of_t : t)
        of_t *= share_of(k);
      for (unsigned int i = first; i < first + sites_[k].n_points; ++i) {
        if (!intact_[i])
          continue;
        const auto local = in_frame(i, t);
        std::copy(local.begin(), local.end(), &tractions[std::size_t(i) * dim]);
      }
    }
  }

  template class FaceRelease<2>;
  template class FaceRelease<3>;
} // namespace nsfd
