#include "point_memory.h"

namespace nsfd
{
  template <int dim>
  template <typename StateOrConst, typename Visit>
  void PointMemory<dim>::for_numbers(StateOrConst &state, Visit &&visit) const
  {
    visit(state.beta); // the first one, see the enumeration of columns
    visit(state.opening_max);
    visit(state.slip);
    visit(state.released_overlap);
    visit(state.approach);
    if (slip_max_)
      visit(state.slip_max);
    if (lift_) {
      visit(state.dilated);
      visit(state.worn);
      visit(state.dilation_speed);
      visit(state.wear_speed);
    }
    if (pressure_)
      visit(state.pressure);
  }

  template <int dim>
  PointMemory<dim>::PointMemory(const State &state)
      : slip_max_(!state.slip_max.empty()), lift_(!state.dilated.empty()),
        pressure_(!state.pressure.empty()), size_(history + 3)
  {
    for_numbers(state, [&](const std::vector<double> &) { ++size_; });
  }

  template <int dim>
  void PointMemory<dim>::store(const Discretization<dim> &discretization,
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
    for_numbers(
        state, [&](const std::vector<double> &values) { *next++ = values[i]; });
    *next++ = double(state.kind[i]);
    *next++ = state.two_sided[i];
    *next++ = state.contact[i];
  }

  template <int dim>
  void PointMemory<dim>::restore(const double *row, const double weight,
                                 const std::size_t i, State &state) const
  {
    for (unsigned int c = 0; c < dim; ++c)
      state.impulse[i * dim + c] = row[impulse + c] * weight;
    const double *next = row + history;
    for_numbers(state,
                [&](std::vector<double> &values) { values[i] = *next++; });
    state.kind[i] = PointKind(int(*next++));
    state.two_sided[i] = std::uint8_t(*next++);
    state.contact[i] = std::uint8_t(*next++);
  }

  template <int dim>
  void PointMemory<dim>::resize(const std::size_t n, State &state) const
  {
    for_numbers(state, [&](std::vector<double> &values) { values.resize(n); });
  }

  template class PointMemory<2>;
  template class PointMemory<3>;
} // namespace nsfd
