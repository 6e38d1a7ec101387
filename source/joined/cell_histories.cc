#include "cell_histories.h"

#include "discretization/body_shape.h"
#include "discretization/cells.h"
#include "discretization/material_histories.h"
#include "nsfd/materials/material_model.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  template <int dim, int sdim>
  CellHistories<dim, sdim>::CellHistories(
      const Discretization<dim> &discretization)
      : discretization_(discretization), first_(first_histories(discretization))
  {
    const SceneInput &input = discretization.input();
    for (const MaterialInput &m : input.materials)
      materials_.push_back(m.kind == MaterialKind::history_dependent
                               ? m.model->template history_dependent<sdim>(
                                     m, input.large_motion, input.plane_stress)
                               : nullptr);
    std::size_t n = 0;
    for (std::size_t cell = 0; any() && cell + 1 < first_.size(); ++cell) {
      first_point_.push_back(n);
      if (of(cell))
        n += n_points(cell);
    }
    strains_.resize(n);
    now_ = at_rest();
  }

  template <int dim, int sdim>
  CellHistories<dim, sdim>::~CellHistories() = default;

  template <int dim, int sdim>
  const HistoryMaterial<sdim> *
  CellHistories<dim, sdim>::of(const std::size_t cell) const
  {
    return materials_[discretization_.cells().body_class(cell).material].get();
  }

  template <int dim, int sdim>
  std::size_t CellHistories<dim, sdim>::place(const std::size_t cell,
                                              const unsigned int q) const
  {
    return first_[cell] + q * of(cell)->n_history();
  }

  template <int dim, int sdim>
  std::vector<double> CellHistories<dim, sdim>::at_rest() const
  {
    std::vector<double> values(first_.back());
    for (std::size_t cell = 0; cell + 1 < first_.size(); ++cell)
      for (std::size_t k = first_[cell]; k < first_[cell + 1];
           k += of(cell)->n_history())
        of(cell)->begin(&values[k]);
    return values;
  }

  void KeptHistories::begin_step(const double time_step)
  {
    time_step_before_ = time_step_;
    time_step_ = time_step;
    before_ = now_;
    moves_ = true;
  }

  void KeptHistories::go_back()
  {
    now_ = before_;
    time_step_ = time_step_before_;
    moves_ = false;
  }

  template <int dim, int sdim>
  bool CellHistories<dim, sdim>::set_point(const std::size_t cell,
                                           const unsigned int q,
                                           const unsigned int n_same,
                                           const Voigt<sdim> &C, Stress &result)
  {
    const HistoryMaterial<sdim> &material = *of(cell);
    const unsigned int n = material.n_history();
    const std::size_t at = place(cell, q);
    Voigt<sdim> &strain = strains_[first_point_[cell] + q];
    result.plastic = result.viscous = 0.;
    if (moves_) {
      typename HistoryMaterial<sdim>::Way way;
      way.C0 = strain;
      way.C1 = C;
      way.history = &before_[at];
      way.time_step = time_step_;
      typename HistoryMaterial<sdim>::Step step;
      if (!material.step(way, false, step, &now_[at]))
        return false;
      // forces of both ends act along the way, and nothing beside them
      result.plastic = std::max(0., step.plastic - step.added);
      result.viscous = step.viscous;
      for (unsigned int k = 1; k <= n_same; ++k)
        std::copy_n(&now_[at], n, &now_[at + k * n]);
    }
    strain = C;
    return material.state(C, &now_[at], result.S, result.energy);
  }

  template <int dim, int sdim>
  bool
  CellHistories<dim, sdim>::beside(const std::size_t cell, const unsigned int q,
                                   const Voigt<sdim> &C, Voigt<sdim> &S) const
  {
    const HistoryMaterial<sdim> &material = *of(cell);
    const std::size_t at = place(cell, q);
    typename HistoryMaterial<sdim>::Way way;
    way.C0 = strains_[first_point_[cell] + q];
    way.C1 = C;
    way.history = &now_[at];
    way.time_step = time_step_;
    typename HistoryMaterial<sdim>::Step step;
    std::vector<double> history(material.n_history());
    double energy = 0.;
    // at the point itself nothing flows: a step of no way is round-off alone
    if (C == way.C0)
      return material.state(C, &now_[at], S, energy);
    return material.step(way, false, step, history.data()) &&
           material.state(C, history.data(), S, energy);
  }

  template <int dim, int sdim>
  void CellHistories<dim, sdim>::pack(const std::size_t cell,
                                      double *values) const
  {
    if (!of(cell))
      return;
    values = std::copy(now_.begin() + long(first_[cell]),
                       now_.begin() + long(first_[cell + 1]), values);
    for (std::size_t q = 0; q < n_points(cell); ++q) {
      const Voigt<sdim> &strain = strains_[first_point_[cell] + q];
      values = std::copy(strain.begin(), strain.end(), values);
    }
  }

  template <int dim, int sdim>
  void CellHistories<dim, sdim>::unpack(const std::size_t cell,
                                        const double *values)
  {
    if (!of(cell))
      return;
    const std::size_t n = first_[cell + 1] - first_[cell];
    std::copy_n(values, n, now_.begin() + long(first_[cell]));
    values += n;
    for (std::size_t q = 0; q < n_points(cell); ++q) {
      Voigt<sdim> &strain = strains_[first_point_[cell] + q];
      std::copy_n(values, strain.size(), strain.begin());
      values += strain.size();
    }
  }

  template class CellHistories<2>;
  template class CellHistories<2, 3>;
  template class CellHistories<3>;
} // namespace nsfd
