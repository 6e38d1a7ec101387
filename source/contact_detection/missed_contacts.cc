#include "swept_surfaces.h"

#include <tuple>

namespace nsfd
{
  template <int dim>
  void take_first(std::optional<MissedContact<dim>> &first,
                  const MissedContact<dim> &other)
  {
    const auto order = [](const MissedContact<dim> &missed) {
      return std::tie(missed.share, missed.body_1, missed.body_2, missed.place);
    };
    if (!first || order(other) < order(*first))
      first = other;
  }

  template <int dim>
  std::optional<MissedContact<dim>>
  first_missed(const Surfaces<dim> &surfaces, const StepPath &path,
               const std::vector<double> &thickness,
               const std::function<bool(unsigned int)> &is_own,
               const AreJoined &joined)
  {
    std::optional<MissedContact<dim>> first;
    const SweptSurfaces<dim> swept(surfaces, path, thickness);
    if (swept.all_slow())
      return first;
    std::vector<typename BoxTree<dim>::Entry> entries;
    entries.reserve(surfaces.facets.size());
    for (unsigned int f = 0; f < surfaces.facets.size(); ++f) {
      const auto &facet = surfaces.facets[f];
      if (!facet.touches)
        continue;
      entries.emplace_back(swept.swept(facet.vertex.begin(),
                                       facet.vertex.begin() + facet.n_vertices,
                                       0.),
                           f);
    }
    const BoxTree<dim> tree(entries);
    const PassingBodies bodies{is_own, joined};
    find_missed_points<dim>(surfaces, swept, tree, bodies, first);
    find_missed_balls<dim>(surfaces, swept, tree, bodies, first);
    find_missed_edges<dim>(surfaces, swept, bodies, first);
    return first;
  }

#define INSTANTIATE(dim)                                                       \
  template void take_first<dim>(std::optional<MissedContact<dim>> &,           \
                                const MissedContact<dim> &);                   \
  template std::optional<MissedContact<dim>> first_missed<dim>(                \
      const Surfaces<dim> &, const StepPath &, const std::vector<double> &,    \
      const std::function<bool(unsigned int)> &, const AreJoined &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
