#pragma once

#include "deformable_cell.h"

#include <memory>

namespace nsfd
{
  /**
   * Forces in a cell of finite strain between two displacements u0 and u1,
   *
   *   f_ic = sum_q JxW_q (F_mid S)_cd grad_i,d,   F_mid = (F0 + F1) / 2,
   *
   * with the stress S of step_stress(). As F_mid^T (F1 - F0) has the symmetric
   * part (C1 - C0) / 2, the work f.(u1 - u0) is the change of energy and what
   * theta > 1/2 dissipates, exactly. F_mid S F_mid^T is symmetric, so that f
   * has no moment about the mean positions, and sums to zero over the nodes as
   * the gradients do. Fails where det F0 <= 0 or det F1 <= 0 at a quadrature
   * point.
   */
  template <int dim>
  class FiniteCell final : public DeformableCell<dim>
  {
  public:
    FiniteCell(std::shared_ptr<const Hyperelastic<dim>> material,
               std::vector<double> JxW, std::vector<double> gradients);

    double energy(const double *u,
                  const double *history = nullptr) const override;
    /** The part (theta - 1/2) dS:dE of the work is numerical. */
    CellLosses account(const CellMotion &motion,
                       double *history = nullptr) const override;

  private:
    using typename DeformableCell<dim>::Point;

    bool set_point(unsigned int q, const CellMotion &motion, bool with_tangent,
                   Point &point) const override;
    VoigtBlock<dim> tangent_at_rest(double theta) const override;

    std::shared_ptr<const Hyperelastic<dim>> material_;
  };
} // namespace nsfd
