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

    /// share of the strength below which no face of a node can be held by more
    /// than its strength: a node takes from few faces only
    constexpr double quiet = 0.2;
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
      }
    }
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
        if (const std::size_t node = mesh_.node_of_point(i); !is_end_[node]) {
          is_end_[node] = 1;
          ends_.push_back(unsigned(node));
        }
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
      const std::size_t node = mesh_.node_of_point(i);
      if (is_end_[node])
        continue;
      is_end_[node] = 1;
      ends_.push_back(unsigned(node));
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

  /** Some face of the node that can still let go carries something. */
  template <int dim>
  bool FaceRelease<dim>::is_loaded(const std::size_t node) const
  {
    for (const unsigned int i : mesh_.links_of_node(node))
      if (const int k = site_of_[i];
          k >= 0 && intact_[i] &&
          squares_[std::size_t(k)] >=
              quiet * quiet * sites_.limit[std::size_t(k)])
        return true;
    return false;
  }

  /** What pulls the corners of a node away from its groups. */
  template <int dim>
  void FaceRelease<dim>::set_pulls(const std::size_t node,
                                   const CellForces<dim> &forces,
                                   const CornerGroups<dim> &groups,
                                   const LeapfrogPoints<dim> &points,
                                   const std::vector<double> &corner_loads,
                                   const std::vector<std::uint8_t> &prescribed)
  {
    const auto corners = mesh_.corners_of_node(node);
    pulls_.resize(corners.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      pulls_[k] = forces.corner_force(corners.first[k], groups);
      for (unsigned int c = 0; c < dim && !corner_loads.empty(); ++c)
        pulls_[k][c] += corner_loads[corners.first[k] * dim + c];
    }
    points.add_forces(node, groups, pulls_);
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
   * Without @p link its group falls apart: `side_` is 1 for the corners that
   * stay with that of body 1.
   */
  template <int dim>
  bool FaceRelease<dim>::cuts(const std::size_t node, const unsigned int link,
                              const CornerGroups<dim> &groups)
  {
    const auto corners = mesh_.corners_of_node(node);
    const auto place = [&](const unsigned int corner) {
      return std::size_t(
          std::lower_bound(corners.begin(), corners.end(), corner) -
          corners.begin());
    };
    const auto &ends = mesh_.corners(link);
    if (groups.of(ends[0]) != groups.of(ends[1]))
      return false;
    side_.assign(corners.size(), 0);
    side_[place(ends[0])] = 1;
    for (bool grows = true; grows;) {
      grows = false;
      for (const unsigned int i : mesh_.links_of_node(node)) {
        if (!intact_[i] || i == link)
          continue;
        const auto &sides = mesh_.corners(i);
        char &a = side_[place(sides[0])], &b = side_[place(sides[1])];
        if (a == b)
          continue;
        a = b = 1;
        grows = true;
      }
    }
    return side_[place(ends[1])] == 0;
  }

  template <int dim>
  void FaceRelease<dim>::look_at(const std::size_t node,
                                 const CornerGroups<dim> &groups,
                                 double &excess,
                                 std::vector<unsigned int> &released)
  {
    const auto corners = mesh_.corners_of_node(node);
    const auto &weight = discretization_.points().weight;
    const auto side_of = [&](const unsigned int corner) {
      return side_[std::size_t(
          std::lower_bound(corners.begin(), corners.end(), corner) -
          corners.begin())];
    };
    for (const unsigned int link : mesh_.links_of_node(node)) {
      if (!intact_[link] || site_of_[link] < 0 || !cuts(node, link, groups))
        continue;
      const unsigned int group = groups.of(mesh_.corners(link)[0]);
      std::array<double, dim> holding{}; // on body 1
      for (std::size_t k = 0; k < corners.size(); ++k)
        if (side_[k])
          for (unsigned int c = 0; c < dim; ++c)
            holding[c] -= pulls_[k][c];
      const auto crosses = [&](const unsigned int i) {
        const auto &sides = mesh_.corners(i);
        return groups.of(sides[0]) == group && groups.of(sides[1]) == group &&
               side_of(sides[0]) != side_of(sides[1]);
      };
      double area = 0.;
      for (const unsigned int i : mesh_.links_of_node(node))
        if (crosses(i))
          area += weight[i];
      double share = 0.;
      for (const unsigned int i : mesh_.links_of_node(node)) {
        if (!crosses(i) || site_of_[i] < 0)
          continue;
        auto t = holding;
        for (double &value : t)
          value *= (side_of(mesh_.corners(i)[0]) ? 1. : -1.) / area;
        const auto local = in_frame(i, t);
        const LawPoint here = law(std::size_t(site_of_[i]));
        share = std::max(
            share, here.template effective_traction<dim>(local[0], &local[1]) /
                       here.strength());
      }
      if (share < 1.)
        continue;
      excess = std::max(excess, share - 1.);
      let_go(std::size_t(site_of_[link]), released);
    }
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
    const std::size_t n = ends_.size(); // new ones: in the next step
    for (std::size_t k = 0; k < n; ++k)
      if (is_loaded(ends_[k])) {
        set_pulls(ends_[k], forces, groups, points, corner_loads, prescribed);
        look_at(ends_[k], groups, excess, released);
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
