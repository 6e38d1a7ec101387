#include "history_cell.h"

#include "materials/strain.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace nsfd
{
  template <int dim>
  HistoryCell<dim>::HistoryCell(
      std::shared_ptr<const HistoryMaterial<dim>> material, const bool finite,
      std::vector<double> JxW, std::vector<double> gradients)
      : DeformableCell<dim>(std::move(JxW), std::move(gradients),
                            material->modulus()),
        material_(std::move(material)), finite_(finite)
  {
  }

  template <int dim>
  void HistoryCell<dim>::begin_history(double *history) const
  {
    for (std::size_t q = 0; q < this->JxW_.size(); ++q)
      material_->begin(history + q * material_->n_history());
  }

  template <int dim>
  bool HistoryCell<dim>::strain(const unsigned int q, const double *u,
                                double *F, Voigt<dim> &C) const
  {
    this->gradient(q, u, F, finite_ ? 1. : 0.);
    if (finite_) {
      C = symmetric_product<dim>(F, F);
      return jacobian<dim>(F) > 0.;
    }
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = a; b < dim; ++b)
        C[voigt_place<dim>(a, b)] = F[a * dim + b] + F[b * dim + a];
    return true;
  }

  template <int dim>
  double HistoryCell<dim>::energy(const double *u, const double *history) const
  {
    double F[dim * dim], sum = 0.;
    Voigt<dim> C;
    for (unsigned int q = 0; q < this->JxW_.size(); ++q) {
      if (!strain(q, u, F, C))
        return std::numeric_limits<double>::infinity();
      sum += this->JxW_[q] *
             material_->energy(C, history + q * material_->n_history());
    }
    return sum;
  }

  template <int dim>
  bool HistoryCell<dim>::set_way(const unsigned int q, const CellMotion &motion,
                                 double *F0, double *F1, Way &way) const
  {
    way.history = motion.history + q * material_->n_history();
    way.time_step = motion.time_step;
    way.theta = motion.theta;
    return strain(q, motion.start, F0, way.C0) &&
           strain(q, motion.end, F1, way.C1);
  }

  template <int dim>
  CellLosses HistoryCell<dim>::account(const CellMotion &motion,
                                       double *history) const
  {
    CellLosses losses;
    double F0[dim * dim], F1[dim * dim];
    Way way;
    Step step;
    for (unsigned int q = 0; q < this->JxW_.size(); ++q) {
      if (!set_way(q, motion, F0, F1, way) ||
          !material_->step(way, false, step,
                           history ? history + q * material_->n_history()
                                   : nullptr)) {
        losses.numerical = std::numeric_limits<double>::quiet_NaN();
        return losses;
      }
      losses.numerical += this->JxW_[q] * step.numerical;
      losses.plastic += this->JxW_[q] * step.plastic;
      losses.viscous += this->JxW_[q] * step.viscous;
    }
    return losses;
  }

  template <int dim>
  bool HistoryCell<dim>::set_point(const unsigned int q,
                                   const CellMotion &motion,
                                   const bool with_tangent, Point &point) const
  {
    double F0[dim * dim];
    Way way;
    Step step;
    if (!set_way(q, motion, F0, point.F_end, way) ||
        !material_->step(way, with_tangent, step, nullptr))
      return false;
    point.S = step.S;
    point.turning = finite_ ? step.S : Voigt<dim>{};
    for (unsigned int i = 0; i < dim * dim; ++i)
      if (finite_)
        point.F[i] = (F0[i] + point.F_end[i]) / 2.;
      else
        point.F[i] = point.F_end[i] = i % (dim + 1) == 0 ? 1. : 0.;
    if (with_tangent)
      point.tangent = step.tangent;
    return true;
  }

  template class HistoryCell<2>;
  template class HistoryCell<3>;
} // namespace nsfd
