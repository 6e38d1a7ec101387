#include "face_release.h"

#include "discretization/cells.h"
#include "discretization/point_factors.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
      : discretization_(discretization)
  {
    const auto &points = discretization.points();
    const auto &input = discretization.input();
    const Cells<dim> &cells = discretization.cells();
    site_of_.assign(points.n_points, -1);
    if (input.discretization.degree == 1)
      reserve(points.faces.size()); // a site per face
    for (const auto &face : points.faces) {
      const PointOrigin &origin = discretization.origins()[face.first];
      if (origin.kind != PointOrigin::Kind::interface ||
          !input.interfaces[origin.block].law)
        continue;
      const auto &block = input.interfaces[origin.block];
      // rigid cells have no stress: the mean is half of what the other one has
      double sides = 2.;
      for (const int b : face.bodies)
        sides -= cells.body_class(std::size_t(b)).undeformed;
      const bool whole = cells.class_shape(std::size_t(face.bodies[0]))
                             .reference.is_simplex() ||
                         input.discretization.degree == 1;
      sites_.first_of_face.push_back(sites_.size());
      double least = infinity;
      for (unsigned int k = 0; k < (whole ? 1 : face.count); ++k) {
        const unsigned int i = face.first + k;
        typename LeapfrogPoints<dim>::Factors of_law = {all.strength_factor[i],
                                                        all.opening_factor[i]};
        if (whole) {
          const auto factors = point_factors<dim>(block, face.centre.data(),
                                                  discretization.extent());
          of_law = {factors.strength, factors.strength / factors.toughness};
        }
        for (unsigned int j = i; j < i + (whole ? face.count : 1); ++j)
          site_of_[j] = int(sites_.size());
        sites_.first_point.push_back(i);
        sites_.n_points.push_back(whole ? face.count : 1);
        sites_.cells.push_back(
            {{unsigned(face.bodies[0]), unsigned(face.bodies[1])}});
        const double *normal = &points.frame[std::size_t(i) * dim * dim];
        sites_.normal.insert(sites_.normal.end(), normal, normal + dim);
        factors_.push_back(of_law);
        const LawPoint here = law(sites_.size() - 1);
        const double shear[2] = {1., 0.};
        const double of_shear =
            here.template effective_traction<dim>(0., shear);
        sites_.shear_weight.push_back(of_shear * of_shear);
        // the surface of two scalars is within the norm of its two ends only
        // between two of them points are held by their law from the start
        share_.push_back(sides > 0. ? 2. / sides : 1.);
        const double strength = here.strength() / share_.back();
        sites_.limit.push_back((block.law->mixed() ? 0.5 : 1.) * strength *
                               strength);
        least = std::min(least, sites_.limit.back() /
                                    std::max(1., sites_.shear_weight.back()));
      }
      if (!hanging.held().empty()) {
        held_.resize(sites_.size(), hanging.held()[face.first]);
        // tractions between the nodes of a cell are beyond those at them
        least /= hanging.spread() * hanging.spread();
      }
      sites_.least.push_back(least);
    }
    sites_.first_of_face.push_back(sites_.size());
  }

  template <int dim>
  void FaceRelease<dim>::reserve(const std::size_t n)
  {
    sites_.first_point.reserve(n);
    sites_.n_points.reserve(n);
    sites_.cells.reserve(n);
    sites_.normal.reserve(n * dim);
    sites_.first_of_face.reserve(n + 1);
    factors_.reserve(n);
    for (auto *list :
         {&sites_.shear_weight, &sites_.limit, &sites_.least, &share_})
      list->reserve(n);
  }

  template <int dim>
  LawPoint FaceRelease<dim>::law(const std::size_t site) const
  {
    const auto &block =
        discretization_.input().interfaces
            [discretization_.origins()[sites_.first_point[site]].block];
    return LawPoint(*block.law, factors_[site].strength, factors_[site].opening,
                    block.plateau);
  }

  template <int dim>
  typename LeapfrogPoints<dim>::Factors
  FaceRelease<dim>::factors(const unsigned int point) const
  {
    const int site = site_of_[point];
    if (site < 0)
      return {};
    return factors_[std::size_t(site)];
  }

  template <int dim>
  void FaceRelease<dim>::start(std::vector<std::uint8_t> intact)
  {
    intact_ = std::move(intact);
    for (std::size_t k = 0; k < sites_.size(); ++k)
      if (!intact_[sites_.first_point[k]])
        sites_.limit[k] = infinity;
  }

  template <int dim>
  void FaceRelease<dim>::let_go(const std::size_t site,
                                std::vector<unsigned int> &released)
  {
    const unsigned int first = sites_.first_point[site];
    sites_.limit[site] = infinity;
    for (unsigned int i = first; i < first + sites_.n_points[site]; ++i) {
      intact_[i] = 0;
      released.push_back(i);
    }
  }

  template <int dim>
  std::array<double, dim>
  FaceRelease<dim>::in_frame(const std::size_t point,
                             const std::array<double, dim> &t) const
  {
    const double *frame = &discretization_.points().frame[point * dim * dim];
    std::array<double, dim> local{};
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c)
        local[r] += frame[r * dim + c] * t[c];
    return local;
  }

  /** With what viscous materials add. */
  template <int dim>
  std::array<double, dim>
  FaceRelease<dim>::traction(const CellForces<dim> &forces,
                             const std::size_t site) const
  {
    auto t = forces.traction(sites_, site);
    const auto *viscous = forces.viscous();
    if (!viscous)
      return t;
    const auto &weight = discretization_.points().weight;
    const unsigned int first = sites_.first_point[site],
                       last = first + sites_.n_points[site];
    double length = 0.;
    for (unsigned int i = first; i < last; ++i)
      length += weight[i];
    for (unsigned int i = first; i < last; ++i) {
      const auto more = viscous->traction(i);
      for (unsigned int c = 0; c < dim; ++c)
        t[c] += weight[i] / length * more[c];
    }
    return t;
  }

  template <int dim>
  auto FaceRelease<dim>::reached(const CellForces<dim> &forces, double &excess)
      -> std::vector<unsigned int>
  {
    std::vector<unsigned int> released;
    old_squares_.swap(squares_);
    forces.squared_tractions(sites_, squares_);
    if (const auto *viscous = forces.viscous())
      for (std::size_t k = 0; k < sites_.size(); ++k)
        if (std::isfinite(sites_.limit[k]) &&
            (viscous->acts_in(sites_.cells[k][0]) ||
             viscous->acts_in(sites_.cells[k][1])))
          squares_[k] = sites_.square(k, traction(forces, k));
    old_squares_.resize(squares_.size(), infinity); // nothing has grown
    constexpr double seen = StrengthSites::looked_at,
                     least = (too_far + seen) / 2.;
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      if (!(squares_[k] >= least * least * sites_.limit[k]))
        continue;
      const LawPoint here = law(k);
      double share = share_[k] * std::sqrt(squares_[k]) / here.strength();
      if (here.law().mixed()) {
        const auto t = in_frame(sites_.first_point[k], traction(forces, k));
        share = share_[k] * here.template effective_traction<dim>(t[0], &t[1]) /
                here.strength();
      }
      if (!held_.empty() && held_[k]) {
        if (share > worst_held_.share) {
          const unsigned int first = sites_.first_point[k];
          const auto &points = discretization_.points();
          worst_held_ = {share, points.faces[points.face_of[first]].centre,
                         discretization_.origins()[first].block};
        }
        continue;
      }
      // what it was below that has not been looked at
      const double before =
          std::max(seen, share * std::sqrt(old_squares_[k] / squares_[k]));
      if (share < 1. && 2. * share - before < too_far)
        continue;
      excess = std::max(excess, share - 1.);
      let_go(k, released);
    }
    return released;
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
    std::vector<double> all(discretization_.points().n_points, infinity);
    if (!archive.reads())
      for (std::size_t k = 0; k < squares_.size(); ++k)
        all[sites_.first_point[k]] = squares_[k];
    archive.points("squared_tractions", all);
    if (!archive.reads())
      return;
    squares_.resize(sites_.size());
    for (std::size_t k = 0; k < sites_.size(); ++k)
      squares_[k] = all[sites_.first_point[k]];
  }

  template <int dim>
  void FaceRelease<dim>::show(const CellForces<dim> &forces,
                              std::vector<double> &tractions) const
  {
    std::fill(tractions.begin(), tractions.end(), 0.);
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      const unsigned int first = sites_.first_point[k];
      if (!intact_[first])
        continue;
      auto t = traction(forces, k);
      for (double &of_t : t)
        of_t *= share_[k];
      for (unsigned int i = first; i < first + sites_.n_points[k]; ++i) {
        const auto local = in_frame(i, t);
        std::copy(local.begin(), local.end(), &tractions[std::size_t(i) * dim]);
      }
    }
  }

  template class FaceRelease<2>;
  template class FaceRelease<3>;
} // namespace nsfd
