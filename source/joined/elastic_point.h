#pragma once

#include "nonsmooth/point_law.h"

namespace nsfd
{
  /**
   * A point that is a spring as long as it is not open beyond its history: with
   * P = -kappa (y_0 + s U) in each direction and, where the spring is
   * one-sided, contact. Or one that is broken, with contact alone; or one that
   * never was open, as long as it holds: U = 0.
   */
  template <int dim>
  struct ElasticPoint {
    Secant secant; ///< Pa/m
    double beta = 1.;
    double largest = 0.;    ///< of the square of the effective opening
    bool one_sided = false; ///< contact ends the spring
    bool rubs = false;      ///< once it is closed
    bool broken = false, holds = false;
    double surely_held = 0.; ///< square of an impulse below the strength, N s

    /** False if the point is anything else. @p beta: what it has. */
    bool reinit(const OneStepProblem<dim> &problem, std::size_t i, double beta);

    /** Of a point that holds: @p impulse (dim) is not above its strength. */
    bool can_hold(const OneStepProblem<dim> &problem, const std::size_t i,
                  const double *impulse) const
    {
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        square += impulse[c] * impulse[c];
      return square <= surely_held || is_below_strength(problem, i, impulse);
    }

    struct Energies {
      double stored, stored_old;        ///< J/m^2
      std::array<double, dim> traction; ///< of the spring, Pa
    };
    /** Of a step with @p velocity (dim) that was solved. */
    Energies energies(const OneStepProblem<dim> &problem, std::size_t i,
                      const double *velocity) const;

  private:
    bool is_below_strength(const OneStepProblem<dim> &problem, std::size_t i,
                           const double *impulse) const;
  };
} // namespace nsfd
