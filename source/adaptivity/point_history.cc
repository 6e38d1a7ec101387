#include "point_history.h"

#include "state/point_fields.h"

#include <type_traits>

namespace nsfd
{
  template <int dim>
  template <typename Visit>
  void PointHistory<dim>::for_fields(Visit &&visit) const
  {
    std::size_t k = 0;
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          if (used_.at(k++))
            visit(field, member);
        });
  }

  template <int dim>
  PointHistory<dim>::PointHistory(const SceneInput &input) : size_(history)
  {
    for_point_fields([&](const PointField &field, const auto &...) {
      used_.push_back(field.life != PointField::Life::step &&
                      has_field(input, field));
      size_ += used_.back();
    });
  }

  template <int dim>
  void PointHistory<dim>::store(const Discretization<dim> &discretization,
                                const State &state, const std::size_t i,
                                const double *jump_offset, double *row) const
  {
    const auto &points = discretization.points();
    const PointOrigin origin = discretization.origins()[i];
    row[origin_kind] = double(origin.kind);
    row[origin_block] = origin.block;
    for (unsigned int c = 0; c < dim; ++c) {
      row[position + c] = points.position[i * dim + c];
      row[offset + c] = jump_offset[c];
      row[impulse + c] = state.impulse[i * dim + c] / points.weight[i];
      row[jump + c] = state.jump[i * dim + c];
    }
    row[compliance] = origin.compliance;
    double *next = row + history;
    for_fields([&](const PointField &, const auto member) {
      *next++ = double((state.*member)[i]);
    });
  }

  template <int dim>
  void PointHistory<dim>::restore(const double *row, const double weight,
                                  const std::size_t i, State &state) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      state.impulse[i * dim + c] = row[impulse + c] * weight;
    const double *next = row + history;
    for_fields([&](const PointField &, const auto member) {
      using Value = typename std::decay_t<decltype(state.*member)>::value_type;
      (state.*member)[i] = Value(*next++);
    });
  }

  template <int dim>
  void PointHistory<dim>::resize(const std::size_t n, State &state) const
  {
    for_fields([&](const PointField &, const auto member) {
      (state.*member).resize(n);
    });
  }

  template class PointHistory<2>;
  template class PointHistory<3>;
} // namespace nsfd
