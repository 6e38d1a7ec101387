#include "corner_groups.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  CornerGroups<dim>::CornerGroups(const JoinedMesh<dim> &mesh,
                                  const std::vector<std::uint8_t> &intact)
      : mesh_(mesh), of_(mesh.n_corners())
  {
    for (std::size_t i = 0; i < of_.size(); ++i)
      of_[i] = mesh.node(i);
    mass.assign(mesh.n_nodes(), 0.);
    for (std::size_t i = 0; i < of_.size(); ++i)
      mass[of_[i]] += mesh.mass(i);
    displacement.assign(mesh.n_nodes() * dim, 0.);
    velocity = force = displacement;
    for (unsigned int node = 0; node < mesh.n_nodes(); ++node)
      if (!mesh.counts(node))
        not_counted_.push_back(node);
    for (std::size_t node = 0; node < mesh.n_nodes(); ++node)
      split(node, intact);
  }

  /** Of every corner of a node the first one that it hangs together with. */
  template <int dim>
  const std::vector<unsigned int> &
  CornerGroups<dim>::components(const std::size_t node,
                                const std::vector<std::uint8_t> &intact)
  {
    const auto corners = mesh_.corners_of_node(node);
    component_.resize(corners.size());
    for (unsigned int k = 0; k < component_.size(); ++k)
      component_[k] = k;
    const auto place = [&](const unsigned int corner) {
      return std::size_t(
          std::lower_bound(corners.begin(), corners.end(), corner) -
          corners.begin());
    };
    for (const unsigned int point : mesh_.links_of_node(node)) {
      if (!intact[point])
        continue;
      const auto &sides = mesh_.corners(point);
      const unsigned int a = component_[place(sides[0])],
                         b = component_[place(sides[1])];
      if (a != b)
        std::replace(component_.begin(), component_.end(), std::max(a, b),
                     std::min(a, b));
    }
    return component_;
  }

  template <int dim>
  bool CornerGroups<dim>::split(const std::size_t node,
                                const std::vector<std::uint8_t> &intact)
  {
    const auto corners = mesh_.corners_of_node(node);
    const auto &component = components(node, intact);
    bool cut = false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      // the component of the first corner of the present group stays in it
      const unsigned int group = of_[corners.first[k]];
      std::size_t first = 0;
      while (of_[corners.first[first]] != group)
        ++first;
      if (component[first] == component[k])
        continue;
      cut = true;
      const auto fresh = unsigned(mass.size());
      mass.push_back(0.);
      if (!mesh_.counts(node))
        not_counted_.push_back(fresh);
      for (auto *values : {&displacement, &velocity, &force})
        for (unsigned int c = 0; c < dim; ++c)
          values->push_back((*values)[group * dim + c]);
      for (std::size_t j = k; j < corners.size(); ++j)
        if (of_[corners.first[j]] == group && component[j] == component[k])
          of_[corners.first[j]] = fresh;
    }
    if (!cut)
      return false;
    // sums in the order of the corners, whatever has been cut before
    for (const unsigned int corner : corners)
      mass[of_[corner]] = 0.;
    for (const unsigned int corner : corners)
      mass[of_[corner]] += mass_of(corner);
    return true;
  }

  template <int dim>
  void CornerGroups<dim>::set_masses(std::vector<double> of_corners)
  {
    masses_ = std::move(of_corners);
    std::fill(mass.begin(), mass.end(), 0.);
    for (std::size_t i = 0; i < of_.size(); ++i)
      mass[of_[i]] += masses_[i];
  }

  template <int dim>
  void CornerGroups<dim>::gather(const std::vector<double> &of_corners,
                                 std::vector<double> &of_groups) const
  {
    of_groups.assign(size() * dim, 0.);
    std::vector<char> state(size(), 0); // 1: has a value, 2: has several
    for (std::size_t i = 0; i < of_.size(); ++i) {
      const double *value = &of_corners[i * dim];
      double *mine = &of_groups[of_[i] * dim];
      char &known = state[of_[i]];
      if (known == 0)
        std::copy_n(value, dim, mine);
      if (known < 2)
        known = std::equal(value, value + dim, mine) ? 1 : 2;
    }
    // where corners say the same, that to the last bit
    for (std::size_t i = 0; i < of_.size(); ++i)
      if (state[of_[i]] == 2)
        std::fill_n(&of_groups[of_[i] * dim], dim, 0.);
    for (std::size_t i = 0; i < of_.size(); ++i)
      if (state[of_[i]] == 2)
        for (unsigned int c = 0; c < dim; ++c)
          of_groups[of_[i] * dim + c] +=
              mesh_.mass(i) / mass[of_[i]] * of_corners[i * dim + c];
  }

  template <int dim>
  void CornerGroups<dim>::scatter(const std::vector<double> &of_groups,
                                  std::vector<double> &of_corners) const
  {
    of_corners.resize(of_.size() * dim);
    for (std::size_t i = 0; i < of_.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        of_corners[i * dim + c] = of_groups[of_[i] * dim + c];
  }

  template class CornerGroups<2>;
  template class CornerGroups<3>;
} // namespace nsfd
