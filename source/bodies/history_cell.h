#pragma once

#include "deformable_cell.h"
#include "nsfd/materials/history_material.h"

#include <memory>

namespace nsfd
{
  /**
   * A cell of a history-dependent material. Of finite strain its forces are
   * those of FiniteCell with another stress; of small strain F is 1 and C is 2
   * eps, so that the work of a step is sum_q JxW_q S:d eps. The history of the
   * points stands one behind the other.
   */
  template <int dim>
  class HistoryCell final : public DeformableCell<dim>
  {
  public:
    HistoryCell(std::shared_ptr<const HistoryMaterial<dim>> material,
                bool finite, std::vector<double> JxW,
                std::vector<double> gradients);

    std::size_t n_history() const override
    {
      return material_->n_history() * this->JxW_.size();
    }
    void begin_history(double *history) const override;
    double energy(const double *u, const double *history) const override;
    CellLosses account(const CellMotion &motion,
                       double *history) const override;

  private:
    using typename DeformableCell<dim>::Point;
    using Way = typename HistoryMaterial<dim>::Way;
    using Step = typename HistoryMaterial<dim>::Step;

    bool strain(unsigned int q, const double *u, double *F,
                Voigt<dim> &C) const;
    bool set_way(unsigned int q, const CellMotion &motion, double *F0,
                 double *F1, Way &way) const;
    bool set_point(unsigned int q, const CellMotion &motion, bool with_tangent,
                   Point &point) const override;
    VoigtBlock<dim> tangent_at_rest(double theta) const override
    {
      return material_->tangent_at_rest(theta);
    }
    // flow without hardening is not definite, and far from the one at rest
    double least_share() const override { return 1e-6; }

    std::shared_ptr<const HistoryMaterial<dim>> material_;
    bool finite_;
  };
} // namespace nsfd
