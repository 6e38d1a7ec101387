#include "finite_forces.h"

#include <algorithm>

// Forces of cells that other ranks compute.

namespace nsfd
{
  /** What set_cell() leaves of each cell, from its rank. Collective. */
  template <int dim, int sdim>
  void FiniteForces<dim, sdim>::share_cells()
  {
    const std::size_t n_cells = stored_.size();
    const auto &first = discretization_.bodies().first_dof;
    FrontViscosity &front = this->front_;
    const bool flows = !taken_.empty();
    const auto visit = [&](const std::size_t cell, const auto &move) {
      const std::size_t n = first[cell + 1] - first[cell];
      move(&stored_[cell], 1);
      move(&peaks_[cell], 1);
      move(volumes_[cell].data(), 2);
      move(&forces_[first[cell]], n);
      if (front.acts())
        move(&front_forces_[first[cell]], n);
      if (!flows)
        return;
      for (double *value :
           {&dilatations_[cell], &taken_[cell], &taken_[n_cells + cell]})
        move(value, 1);
    };
    std::size_t width = 0;
    for (std::size_t cell = 0; cell < n_cells; ++cell) {
      std::size_t n = 1 + (flows ? histories_.n_numbers(cell) : 0);
      visit(cell, [&n](const double *, const std::size_t m) { n += m; });
      width = std::max(width, n);
    }
    const auto &others = divided_->all();
    others.start(unsigned(width), [&](const std::size_t cell, double *values) {
      *values++ = inverted_ == int(cell) ? 1. : 0.;
      visit(cell, [&values](const double *from, const std::size_t n) {
        values = std::copy_n(from, n, values);
      });
      if (flows)
        histories_.pack(cell, values);
    });
    others.finish(
        unsigned(width), [&](const std::size_t cell, const double *values) {
          const bool is_inverted = *values++ != 0.;
          visit(cell, [&values](double *to, const std::size_t n) {
            std::copy_n(values, n, to);
            values += n;
          });
          if (flows)
            histories_.unpack(cell, values);
          if (is_inverted)
            inverted_ = std::max(inverted_, int(cell));
          else if (front.acts() &&
                   !discretization_.cells().body_class(cell).undeformed)
            front.update(cell, volumes_[cell][1] / volumes_[cell][0] - 1.,
                         volumes_[cell][0]);
        });
  }

  template void FiniteForces<2>::share_cells();
  template void FiniteForces<2, 3>::share_cells();
  template void FiniteForces<3>::share_cells();
} // namespace nsfd
