#include "ghost_states.h"

#include "state/point_fields.h"

namespace nsfd
{
  template <int dim>
  void spread_state(const GhostLayer<dim> &layer, State &state)
  {
    state.displacement = layer.spread_unknowns(state.displacement);
    state.velocity = layer.spread_unknowns(state.velocity);
    state.material_history = layer.spread_histories(state.material_history);
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          state.*member = layer.spread_points(state.*member, field.width(dim));
        });
  }

  template <int dim>
  void fetch_state(const GhostLayer<dim> &layer, State &all)
  {
    layer.fetch_unknowns(all.displacement);
    layer.fetch_unknowns(all.velocity);
    layer.fetch_histories(all.material_history);
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          layer.fetch_points(field.width(dim), all.*member);
        });
  }

  template <int dim>
  void take_own(const GhostLayer<dim> &layer, State &state)
  {
    state.displacement = layer.own_unknowns(state.displacement);
    state.velocity = layer.own_unknowns(state.velocity);
    state.material_history = layer.own_histories(state.material_history);
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          state.*member = layer.own_points(state.*member, field.width(dim));
        });
  }

  template <int dim>
  void GhostArchive<dim>::bodies(const std::string &name,
                                 std::vector<double> &values)
  {
    auto own = layer_.own_unknowns(values);
    archive_.bodies(path(name), own);
    if (!reads())
      return;
    values = layer_.spread_unknowns(own);
    layer_.fetch_unknowns(values);
  }

  template <int dim>
  template <typename T>
  void GhostArchive<dim>::store_points(const std::string &name,
                                       std::vector<T> &values)
  {
    const unsigned int width = layer_.width(values);
    auto own = layer_.own_points(values, width);
    archive_.points(path(name), own);
    if (!reads())
      return;
    values = layer_.spread_points(own, width);
    layer_.fetch_points(width, values);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template void spread_state(const GhostLayer<dim> &, State &);                \
  template void fetch_state(const GhostLayer<dim> &, State &);                 \
  template void take_own(const GhostLayer<dim> &, State &);                    \
  template class GhostArchive<dim>
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
