#include "finite_cell.h"

#include "materials/strain.h"

#include <limits>
#include <utility>

namespace nsfd
{
  template <int dim>
  FiniteCell<dim>::FiniteCell(std::shared_ptr<const Hyperelastic<dim>> material,
                              std::vector<double> JxW,
                              std::vector<double> gradients)
      : DeformableCell<dim>(std::move(JxW), std::move(gradients),
                            material->modulus()),
        material_(std::move(material))
  {
  }

  template <int dim>
  double FiniteCell<dim>::energy(const double *u, const double *) const
  {
    double F[dim * dim], sum = 0.;
    for (unsigned int q = 0; q < this->JxW_.size(); ++q) {
      this->gradient(q, u, F);
      if (!(jacobian<dim>(F) > 0.))
        return std::numeric_limits<double>::infinity();
      sum += this->JxW_[q] * material_->energy(symmetric_product<dim>(F, F));
    }
    return sum;
  }

  namespace
  {
    /** The ends of a step; false where one is turned inside out, which det C
        does not see. */
    template <int dim>
    struct Ends {
      double F0[dim * dim], F1[dim * dim];
      Voigt<dim> C0, C1;

      bool set()
      {
        C0 = symmetric_product<dim>(F0, F0);
        C1 = symmetric_product<dim>(F1, F1);
        return jacobian<dim>(F0) > 0. && jacobian<dim>(F1) > 0.;
      }
    };
  } // namespace

  template <int dim>
  CellLosses FiniteCell<dim>::account(const CellMotion &motion, double *) const
  {
    CellLosses losses;
    Ends<dim> ends;
    StepStress<dim> stress;
    for (unsigned int q = 0; q < this->JxW_.size(); ++q) {
      this->gradient(q, motion.start, ends.F0);
      this->gradient(q, motion.end, ends.F1);
      if (!ends.set() || !step_stress<dim>(*material_, ends.C0, ends.C1,
                                           motion.theta, false, stress)) {
        losses.numerical = std::numeric_limits<double>::quiet_NaN();
        return losses;
      }
      losses.numerical += this->JxW_[q] * stress.dissipated;
    }
    return losses;
  }

  template <int dim>
  bool FiniteCell<dim>::set_point(const unsigned int q,
                                  const CellMotion &motion,
                                  const bool with_tangent, Point &point) const
  {
    Ends<dim> ends;
    StepStress<dim> stress;
    this->gradient(q, motion.start, ends.F0);
    this->gradient(q, motion.end, ends.F1);
    if (!ends.set() || !step_stress<dim>(*material_, ends.C0, ends.C1,
                                         motion.theta, with_tangent, stress))
      return false;
    for (unsigned int i = 0; i < dim * dim; ++i) {
      point.F[i] = (ends.F0[i] + ends.F1[i]) / 2.;
      point.F_end[i] = ends.F1[i];
    }
    point.S = point.turning = stress.S;
    if (with_tangent)
      point.tangent = stress.tangent;
    return true;
  }

  template <int dim>
  VoigtBlock<dim> FiniteCell<dim>::tangent_at_rest(const double theta) const
  {
    Voigt<dim> C{};
    for (unsigned int c = 0; c < dim; ++c)
      C[c] = 1.;
    StepStress<dim> at_rest;
    step_stress<dim>(*material_, C, C, theta, true, at_rest);
    return at_rest.tangent;
  }

  template class FiniteCell<2>;
  template class FiniteCell<3>;
} // namespace nsfd
