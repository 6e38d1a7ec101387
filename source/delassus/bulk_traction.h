#pragma once

#include "delassus_operator.h"

#include <vector>

namespace nsfd
{
  /**
   * The mean traction of the bulk on both sides of a point,
   *
   *     t = omega_1 sigma_1 n + omega_2 sigma_2 n,
   *     omega_1 = Lambda_2 / (Lambda_1 + Lambda_2),  omega_2 = 1 - omega_1,
   *
   * Lambda_b the traction bound of a body (BodyClass). A rigid body has no
   * traction: the other one gives all of it. In scenes with bonded faces.
   */
  template <int dim>
  class BulkTraction
  {
  public:
    /** Collective. */
    explicit BulkTraction(const DelassusOperator<dim> &delassus);

    /**
     * Of the penalty over Lambda_1 Lambda_2 / (Lambda_1 + Lambda_2). Above 1
     * the interior penalty stiffness is at least 1 - 1/factor of that of the
     * bodies alone. What a bond holds when it breaks falls like 1/factor: 12,
     * 6, 1 % of the dissipated energy at 2, 8, 32, on coarse linear quads.
     */
    static constexpr double penalty_factor = 32.;

    struct Bond {
      double weight_1 = 0., weight_2 = 0.; ///< omega
      /// eta = factor Lambda_1 Lambda_2 / (Lambda_1 + Lambda_2) in Pa/m; 0 at
      /// the boundary and between rigid bodies
      double penalty = 0.;
      /// of rates, with the same weights: factor times the sum of omega^2
      /// Lambda of the viscous tractions, in Pa s/m
      double viscous_penalty = 0.;
    };
    const std::vector<Bond> &bonds() const { return bonds_; }
    const DelassusOperator<dim> &delassus() const { return delassus_; }

    /**
     * t at every point, in the local frames, in Pa, from the displacement of
     * the bodies. Collective.
     */
    void evaluate(const double *displacement, double *traction) const;

    /** Viscous stress in the same mean, from velocities. Collective. */
    void evaluate_viscous(const double *velocity, double *traction) const;

    /** w (t.u + eta u.u / 2): share of an interior penalty bond in the energy.
     */
    double bond_energy(const std::size_t point, const double *jump,
                       const double *traction) const
    {
      double energy = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        energy +=
            jump[c] * (traction[c] + bonds_[point].penalty / 2. * jump[c]);
      return delassus_.points().weight[point] * energy;
    }

  private:
    void set_bonds();
    void mean(const Block BodyClass::*traction, const double *motion,
              double *result) const;

    const DelassusOperator<dim> &delassus_;
    std::vector<Bond> bonds_; ///< per point
    mutable std::vector<double> side_1_, side_2_;
  };
} // namespace nsfd
