#include "merged_groups.h"

#include "linear_algebra/small_inverse.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  void MergedGroups<dim>::reinit(const NodeProblem<dim> &node,
                                 const std::vector<std::uint8_t> &holds)
  {
    const std::size_t n = node.inverse_mass.size();
    groups_.resize(n);
    for (std::size_t g = 0; g < n; ++g)
      groups_[g] = {int(g), false, {}, {}};
    const auto first_of = [&](const int g) {
      return groups_[std::size_t(g)].of;
    };
    std::vector<std::uint8_t> on_ground(n, 0); // by the first of those merged
    for (std::size_t k = 0; k < node.points.size(); ++k) {
      if (!holds[k])
        continue;
      const auto [one, two] = node.points[k].groups;
      for (const int g : {one, two})
        if (g >= 0)
          groups_[std::size_t(g)].held = true;
      if (one < 0 || two < 0) {
        on_ground[std::size_t(first_of(std::max(one, two)))] = 1;
        continue;
      }
      const int first = std::min(first_of(one), first_of(two)),
                last = std::max(first_of(one), first_of(two));
      if (first == last)
        continue;
      for (Group &group : groups_)
        if (group.of == last)
          group.of = first;
      on_ground[std::size_t(first)] |= on_ground[std::size_t(last)];
    }
    merge_masses(node, on_ground);
    set_carried(node, holds);
  }

  /** And the numbers of those merged, which are those of their firsts so far.
   */
  template <int dim>
  void
  MergedGroups<dim>::merge_masses(const NodeProblem<dim> &node,
                                  const std::vector<std::uint8_t> &on_ground)
  {
    const std::size_t n = groups_.size();
    std::vector<int> number(n, -1);
    std::vector<Vector> sum;
    std::vector<std::array<int, dim>> given; // a group with a given motion
    inverse_mass_.clear();
    may_differ_ = false;
    for (std::size_t g = 0; g < n; ++g) {
      int &at = number[std::size_t(groups_[g].of)];
      const bool rests = on_ground[std::size_t(groups_[g].of)] != 0;
      if (at < 0) {
        at = int(sum.size());
        sum.emplace_back();
        given.emplace_back().fill(rests ? int(n) : -1);
      }
      groups_[g].of = at;
      for (unsigned int c = 0; c < dim; ++c)
        if (const double inverse = node.inverse_mass[g][c]; inverse > 0.) {
          groups_[g].mass[c] = 1. / inverse;
          sum[std::size_t(at)][c] += groups_[g].mass[c];
        } else if (given[std::size_t(at)][c] < 0)
          given[std::size_t(at)][c] = int(g);
        else
          may_differ_ = true;
    }
    inverse_mass_.resize(sum.size());
    for (std::size_t g = 0; g < n; ++g) {
      const auto at = std::size_t(groups_[g].of);
      for (unsigned int c = 0; c < dim; ++c) {
        const bool moves = given[at][c] < 0;
        // alone, a group keeps its numbers to the last bit
        const double whole = sum[at][c] == groups_[g].mass[c] ? 1. : 0.;
        inverse_mass_[at][c] = !moves        ? 0.
                               : whole == 1. ? node.inverse_mass[g][c]
                                             : 1. / sum[at][c];
        groups_[g].share[c] = !moves        ? double(given[at][c] == int(g))
                              : whole == 1. ? 1.
                                            : groups_[g].mass[c] / sum[at][c];
      }
    }
  }

  /**
   * L phi = change of momentum, L the sum of w (e_2 - e_1)(e_2 - e_1)^T over
   * the holding points, without the groups whose motion is given; where all
   * move, the sum of phi is 0.
   */
  template <int dim>
  void MergedGroups<dim>::set_carried(const NodeProblem<dim> &node,
                                      const std::vector<std::uint8_t> &holds)
  {
    const std::size_t n = groups_.size();
    std::vector<double> weight;
    std::vector<std::array<int, 2>> links;
    for (std::size_t k = 0; k < node.points.size(); ++k)
      if (holds[k]) {
        Vector sum{};
        for (const int g : node.points[k].groups)
          for (unsigned int c = 0; g >= 0 && c < dim; ++c)
            sum[c] += node.inverse_mass[std::size_t(g)][c];
        const double inverse = *std::max_element(sum.begin(), sum.end());
        weight.push_back(inverse > 0. ? 1. / inverse : 1.);
        links.push_back(node.points[k].groups);
      }
    carried_.assign(links.size() * n, Vector{});
    if (links.empty())
      return;
    bool alike = true; // all axes
    for (const Vector &inverse : node.inverse_mass)
      for (unsigned int c = 1; c < dim; ++c)
        alike = alike && inverse[c] == inverse[0];
    std::vector<double> L;
    for (unsigned int c = 0; c < (alike ? 1 : dim); ++c) {
      L.assign(n * n, 0.);
      const auto moves = [&](const int g) {
        return g >= 0 && node.inverse_mass[std::size_t(g)][c] > 0.;
      };
      double largest = 0.;
      for (std::size_t e = 0; e < links.size(); ++e) {
        const auto [a, b] = links[e];
        for (const int g : {a, b})
          if (moves(g))
            L[std::size_t(g) * (n + 1)] += weight[e];
        if (moves(a) && moves(b)) {
          L[std::size_t(a) * n + std::size_t(b)] -= weight[e];
          L[std::size_t(b) * n + std::size_t(a)] -= weight[e];
        }
        largest = std::max(largest, weight[e]);
      }
      for (std::size_t g = 0; g < n; ++g) {
        if (L[g * (n + 1)] == 0.)
          L[g * (n + 1)] = 1.; // not held, or not moved by it
        else if (inverse_mass_[std::size_t(groups_[g].of)][c] > 0.)
          for (std::size_t f = 0; f < n; ++f)
            if (groups_[f].of == groups_[g].of)
              L[g * n + f] += largest;
      }
      invert_in_place<most>(L.data(), n, n, 0., [](std::size_t) {});
      for (std::size_t e = 0; e < links.size(); ++e)
        for (std::size_t g = 0; g < n; ++g) {
          const auto [a, b] = links[e];
          if (!moves(int(g)) || !groups_[g].held)
            continue;
          const auto phi = [&](const int at) {
            return moves(at) ? L[std::size_t(at) * n + g] : 0.;
          };
          const double value = weight[e] * (phi(b) - phi(a));
          for (unsigned int d = c; d < (alike ? dim : c + 1); ++d)
            carried_[e * n + g][d] = value;
        }
    }
  }

  template <int dim>
  bool MergedGroups<dim>::merge(const std::vector<Vector> &velocity,
                                Vector *merged) const
  {
    std::fill_n(merged, size(), Vector{});
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (unsigned int c = 0; c < dim; ++c)
        merged[groups_[g].of][c] += groups_[g].share[c] * velocity[g][c];
    if (may_differ_)
      for (std::size_t g = 0; g < groups_.size(); ++g)
        for (unsigned int c = 0; c < dim; ++c)
          if (groups_[g].mass[c] == 0. &&
              velocity[g][c] != merged[groups_[g].of][c])
            return false;
    return true;
  }

  template <int dim>
  auto MergedGroups<dim>::carried(const std::size_t held,
                                  const Vector *change) const -> Vector
  {
    const std::size_t n = groups_.size();
    Vector P{};
    for (std::size_t g = 0; g < n; ++g)
      for (unsigned int c = 0; c < dim; ++c)
        P[c] += carried_[held * n + g][c] * change[g][c];
    return P;
  }

  template class MergedGroups<2>;
  template class MergedGroups<3>;
} // namespace nsfd
