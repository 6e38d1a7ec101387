#include "face_release.h"

#include "discretization/cells.h"
#include "discretization/point_factors.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
  } // namespace

  template <int dim>
  FaceRelease<dim>::FaceRelease(const Discretization<dim> &discretization,
                                const JoinedMesh<dim> &mesh,
                                const OneStepProblem<dim> &all)
      : discretization_(discretization), mesh_(mesh)
  {
    const auto &points = discretization.points();
    const auto &input = discretization.input();
    const Cells<dim> &cells = discretization.cells();
    site_of_.assign(points.n_points, -1);
    for (const auto &face : points.faces) {
      const PointOrigin &origin = discretization.origins()[face.first];
      if (origin.kind != PointOrigin::Kind::interface ||
          !input.interfaces[origin.block].law)
        continue;
      const auto &block = input.interfaces[origin.block];
      const bool whole =
          cells.shape(std::size_t(face.bodies[0])).reference.is_simplex() ||
          input.discretization.degree == 1;
      sites_.first_of_face.push_back(sites_.size());
      double least = infinity;
      for (unsigned int k = 0; k < (whole ? 1 : face.count); ++k) {
        const unsigned int i = face.first + k;
        double strength = all.strength_factor[i],
               opening = all.opening_factor[i];
        if (whole) {
          const auto factors = point_factors<dim>(block, face.centre.data(),
                                                  discretization.extent());
          strength = factors.strength;
          opening = factors.strength / factors.toughness;
        }
        for (unsigned int j = i; j < i + (whole ? face.count : 1); ++j)
          site_of_[j] = int(sites_.size());
        sites_.first_point.push_back(i);
        sites_.n_points.push_back(whole ? face.count : 1);
        sites_.cells.push_back(
            {{unsigned(face.bodies[0]), unsigned(face.bodies[1])}});
        const double *normal = &points.frame[std::size_t(i) * dim * dim];
        sites_.normal.insert(sites_.normal.end(), normal, normal + dim);
        strength_factor_.push_back(strength);
        opening_factor_.push_back(opening);
        const LawPoint here = law(sites_.size() - 1);
        const double shear[2] = {1., 0.};
        const double of_shear =
            here.template effective_traction<dim>(0., shear);
        sites_.shear_weight.push_back(of_shear * of_shear);
        // the surface of two scalars is within the norm of its two ends only
        sites_.limit.push_back((block.law->mixed() ? 0.5 : 1.) *
                               here.strength() * here.strength());
        weakest_.push_back(here.strength() / std::max(1., of_shear) *
                           (block.law->mixed() ? std::sqrt(0.5) : 1.));
        least = std::min(least, sites_.limit.back() /
                                    std::max(1., sites_.shear_weight.back()));
      }
      sites_.least.push_back(least);
    }
    sites_.first_of_face.push_back(sites_.size());
  }

  template <int dim>
  LawPoint FaceRelease<dim>::law(const std::size_t site) const
  {
    const auto &block =
        discretization_.input().interfaces
            [discretization_.origins()[sites_.first_point[site]].block];
    return LawPoint(*block.law, strength_factor_[site], opening_factor_[site],
                    block.plateau);
  }

  template <int dim>
  typename LeapfrogPoints<dim>::Factors
  FaceRelease<dim>::factors(const unsigned int point) const
  {
    if (site_of_[point] < 0)
      return {};
    const auto site = std::size_t(site_of_[point]);
    return {strength_factor_[site], opening_factor_[site]};
  }

  template <int dim>
  void FaceRelease<dim>::start(std::vector<std::uint8_t> intact)
  {
    intact_ = std::move(intact);
    is_end_.assign(mesh_.n_nodes(), 0);
    ends_.clear();
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      const unsigned int first = sites_.first_point[k];
      if (intact_[first])
        continue;
      sites_.limit[k] = infinity;
      for (unsigned int i = first; i < first + sites_.n_points[k]; ++i)
        add_end(mesh_.node_of_point(i));
    }
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
      add_end(mesh_.node_of_point(i));
    }
  }

  template <int dim>
  void FaceRelease<dim>::add_end(const std::size_t node)
  {
    if (is_end_[node])
      return;
    is_end_[node] = 1;
    End end;
    end.node = unsigned(node);
    const auto corners = mesh_.corners_of_node(node);
    const auto place = [&](const unsigned int corner) {
      return static_cast<unsigned short>(
          std::lower_bound(corners.begin(), corners.end(), corner) -
          corners.begin());
    };
    for (const unsigned int i : mesh_.links_of_node(node)) {
      const auto &sides = mesh_.corners(i);
      end.links.push_back({i, {{place(sides[0]), place(sides[1])}}});
    }
    ends_.push_back(std::move(end));
  }

  template <int dim>
  bool FaceRelease<dim>::is_finished(const End &end) const
  {
    return std::none_of(
        end.links.begin(), end.links.end(), [this](const auto &link) {
          return site_of_[link.point] >= 0 && intact_[link.point];
        });
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

  template <int dim>
  auto FaceRelease<dim>::reached(const CellForces<dim> &forces, double &excess)
      -> std::vector<unsigned int>
  {
    std::vector<unsigned int> released;
    forces.squared_tractions(sites_, squares_);
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      if (!(squares_[k] >= sites_.limit[k]))
        continue;
      const LawPoint here = law(k);
      double square = squares_[k] / (here.strength() * here.strength());
      if (here.law().mixed()) {
        const auto t =
            in_frame(sites_.first_point[k], forces.traction(sites_, k));
        const double share =
            here.template effective_traction<dim>(t[0], &t[1]) /
            here.strength();
        square = share * share;
        if (square < 1.)
          continue;
      }
      excess = std::max(excess, std::sqrt(square) - 1.);
      let_go(k, released);
    }
    return released;
  }

  /**
   * The weakest face of a node that can still let go: half of the sum of the
   * sizes of all pulls bounds what holds any part of it.
   */
  template <int dim>
  bool FaceRelease<dim>::may_let_go(const End &end) const
  {
    double weakest = infinity;
    for (const auto &link : end.links)
      if (site_of_[link.point] >= 0 && intact_[link.point])
        weakest =
            std::min(weakest, discretization_.points().weight[link.point] *
                                  weakest_[std::size_t(site_of_[link.point])]);
    double pulls = 0.;
    for (const auto &pull : pulls_) {
      double square = 0.;
      for (const double x : pull)
        square += x * x;
      pulls += std::sqrt(square);
    }
    return pulls / 2. >= weakest;
  }

  /** What pulls the corners of a node away from its groups. */
  template <int dim>
  void FaceRelease<dim>::set_pulls(const End &end,
                                   const CellForces<dim> &forces,
                                   const CornerGroups<dim> &groups,
                                   const LeapfrogPoints<dim> &points,
                                   const std::vector<double> &corner_loads,
                                   const std::vector<std::uint8_t> &prescribed)
  {
    const auto corners = mesh_.corners_of_node(end.node);
    pulls_.resize(corners.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      pulls_[k] = forces.corner_force(corners.first[k], groups);
      for (unsigned int c = 0; c < dim && !corner_loads.empty(); ++c)
        pulls_[k][c] += corner_loads[corners.first[k] * dim + c];
    }
    points.add_forces(end.node, groups, pulls_);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const unsigned int group = groups.of(corners.first[k]);
      std::array<double, dim> sum{};
      bool is_first = true;
      for (std::size_t j = 0; j < corners.size(); ++j)
        if (groups.of(corners.first[j]) == group) {
          is_first &= j >= k;
          for (unsigned int c = 0; c < dim; ++c)
            sum[c] += pulls_[j][c];
        }
      if (!is_first)
        continue;
      for (std::size_t j = k; j < corners.size(); ++j)
        if (groups.of(corners.first[j]) == group)
          for (unsigned int c = 0; c < dim; ++c)
            pulls_[j][c] = prescribed[group] & (1u << c)
                               ? 0. // corners are held one by one
                               : pulls_[j][c] - mesh_.mass(corners.first[j]) /
                                                    groups.mass[group] * sum[c];
    }
  }

  /**
   * Without the link its group falls apart: `side_` is 1 for the corners that
   * stay with that of body 1.
   */
  template <int dim>
  bool FaceRelease<dim>::cuts(const End &end, const std::size_t link,
                              const CornerGroups<dim> &groups)
  {
    const auto &points = mesh_.corners(end.links[link].point);
    if (groups.of(points[0]) != groups.of(points[1]))
      return false;
    const auto &ends = end.links[link].corners;
    side_.assign(pulls_.size(), 0);
    side_[ends[0]] = 1;
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t k = 0; k < end.links.size(); ++k) {
        const auto &one = end.links[k];
        char &a = side_[one.corners[0]], &b = side_[one.corners[1]];
        if (a == b || k == link || !intact_[one.point])
          continue;
        a = b = 1;
        grows = true;
        if (side_[ends[1]])
          return false;
      }
    }
    return true;
  }

  /** Of the worst face of the cut that has been found, over its strength. */
  template <int dim>
  double
  FaceRelease<dim>::share_of_strength(const End &end,
                                      const typename End::Link &link,
                                      const CornerGroups<dim> &groups) const
  {
    const auto &weight = discretization_.points().weight;
    const unsigned int group = groups.of(mesh_.corners(link.point)[0]);
    std::array<double, dim> holding{}; // on body 1
    for (std::size_t k = 0; k < pulls_.size(); ++k)
      if (side_[k])
        for (unsigned int c = 0; c < dim; ++c)
          holding[c] -= pulls_[k][c];
    const auto crosses = [&](const typename End::Link &one) {
      const auto &sides = mesh_.corners(one.point);
      return side_[one.corners[0]] != side_[one.corners[1]] &&
             groups.of(sides[0]) == group && groups.of(sides[1]) == group;
    };
    double area = 0.;
    for (const auto &one : end.links)
      if (crosses(one))
        area += weight[one.point];
    double share = 0.;
    for (const auto &one : end.links) {
      if (site_of_[one.point] < 0 || !crosses(one))
        continue;
      auto t = holding;
      for (double &value : t)
        value *= (side_[one.corners[0]] ? 1. : -1.) / area;
      const auto local = in_frame(one.point, t);
      const LawPoint here = law(std::size_t(site_of_[one.point]));
      share = std::max(
          share, here.template effective_traction<dim>(local[0], &local[1]) /
                     here.strength());
    }
    return share;
  }

  template <int dim>
  auto
  FaceRelease<dim>::reached_at_ends(const CellForces<dim> &forces,
                                    const CornerGroups<dim> &groups,
                                    const LeapfrogPoints<dim> &points,
                                    const std::vector<double> &corner_loads,
                                    const std::vector<std::uint8_t> &prescribed,
                                    double &excess) -> std::vector<unsigned int>
  {
    std::vector<unsigned int> released;
    ends_.erase(
        std::remove_if(ends_.begin(), ends_.end(),
                       [this](const End &end) { return is_finished(end); }),
        ends_.end());
    std::sort(ends_.begin(), ends_.end(), [](const End &one, const End &two) {
      return one.node < two.node;
    });
    const std::size_t n = ends_.size(); // new ones: in the next step
    for (std::size_t e = 0; e < n; ++e) {
      set_pulls(ends_[e], forces, groups, points, corner_loads, prescribed);
      if (!may_let_go(ends_[e]))
        continue;
      for (std::size_t k = 0; k < ends_[e].links.size(); ++k) {
        const auto link = ends_[e].links[k];
        if (!intact_[link.point] || site_of_[link.point] < 0 ||
            !cuts(ends_[e], k, groups))
          continue;
        const double share = share_of_strength(ends_[e], link, groups);
        if (share < 1.)
          continue;
        excess = std::max(excess, share - 1.);
        let_go(std::size_t(site_of_[link.point]), released);
      }
    }
    return released;
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
      const auto t = forces.traction(sites_, k);
      for (unsigned int i = first; i < first + sites_.n_points[k]; ++i) {
        const auto local = in_frame(i, t);
        std::copy(local.begin(), local.end(), &tractions[std::size_t(i) * dim]);
      }
    }
  }

  template class FaceRelease<2>;
  template class FaceRelease<3>;
} // namespace nsfd
