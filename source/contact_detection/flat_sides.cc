#include "flat_sides.h"

#include "facet_geometry.h"

#include "core/disjoint_sets.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

namespace nsfd
{
  template <int dim>
  void set_flat_sides(Surfaces<dim> &surfaces, const double *x,
                      const std::function<bool(unsigned int)> &keeps_shape)
  {
    constexpr double parallel = 1. - 1e-9;
    auto &facets = surfaces.facets;
    std::vector<Plane<dim>> planes;
    set_planes<dim>(surfaces, x, planes);
    DisjointSets sides(facets.size());
    // facets at an edge, in the plane at a vertex
    std::map<std::pair<unsigned int, unsigned int>, std::vector<unsigned int>>
        at;
    for (unsigned int f = 0; f < facets.size(); ++f) {
      facets[f].side = facets[f].key;
      if (!keeps_shape(facets[f].body))
        continue;
      const unsigned int n = facets[f].n_vertices;
      for (unsigned int v = 0; v < n; ++v) {
        const unsigned int a = facets[f].vertex[v],
                           b = dim == 2 ? a : facets[f].vertex[(v + 1) % n];
        auto &others = at[std::minmax(a, b)];
        for (const unsigned int g : others)
          if (facets[g].body == facets[f].body &&
              dot(planes[g].normal, planes[f].normal) > parallel)
            sides.join(f, g);
        others.push_back(f);
      }
    }
    // by the least key, which does not depend on the order of facets
    std::vector<std::uint64_t> least(facets.size(),
                                     std::numeric_limits<std::uint64_t>::max());
    for (unsigned int f = 0; f < facets.size(); ++f) {
      auto &key = least[sides.first(f)];
      key = std::min(key, facets[f].key);
    }
    for (unsigned int f = 0; f < facets.size(); ++f)
      facets[f].side = least[sides.first(f)];
  }

  template <int dim>
  bool is_below(const typename Surfaces<dim>::Facet &facet, const double *x,
                const std::array<double, dim> &y)
  {
    const Plane<dim> plane = plane_of<dim>(facet, x);
    const double height = dot(plane.normal, difference(y, plane.centre));
    return height < -same_length * plane.size && height > -plane.size &&
           projects_into<dim>(facet, plane, x, y);
  }

  template bool is_below<2>(const Surfaces<2>::Facet &, const double *,
                            const std::array<double, 2> &);
  template bool is_below<3>(const Surfaces<3>::Facet &, const double *,
                            const std::array<double, 3> &);
  template void set_flat_sides<2>(Surfaces<2> &, const double *,
                                  const std::function<bool(unsigned int)> &);
  template void set_flat_sides<3>(Surfaces<3> &, const double *,
                                  const std::function<bool(unsigned int)> &);
} // namespace nsfd
