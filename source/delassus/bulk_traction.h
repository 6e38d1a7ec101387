#pragma once

#include "delassus_operator.h"

#include <array>
#include <vector>

namespace nsfd
{
  template <int dim>
  class InitialStress;

  /**
   * The mean traction of the bulk on both sides of a point,
   *
   *     t = omega_1 sigma_1 n + omega_2 sigma_2 n,
   *     omega_1 = Lambda_2 / (Lambda_1 + Lambda_2),  omega_2 = 1 - omega_1,
   *
   * Lambda_b the traction bound of a body (BodyClass). A rigid body has no
   * traction: the other one gives all of it. With that of an initial stress. In
   * scenes with bonded faces.
   */
  template <int dim>
  class BulkTraction
  {
  public:
    enum class Where {
      everywhere,
      marked ///< at the faces of mark()
    };

    /** No face is marked; @p initial null: there is no such stress.
        Collective. */
    explicit BulkTraction(const DelassusOperator<dim> &delassus,
                          const InitialStress<dim> *initial = nullptr);

    /** By face: what a step asks for. A face of two ranks is marked on both. */
    void mark(const std::vector<char> &faces);

    const DelassusOperator<dim> &delassus() const { return delassus_; }

    /**
     * t at the points, in the local frames, in Pa, from the displacement of the
     * bodies; other points keep what they have. Collective.
     */
    void evaluate(const double *displacement, Where where,
                  double *traction) const;

    /** Viscous stress in the same mean, from velocities. Collective. */
    void evaluate_viscous(const double *velocity, Where where,
                          double *traction) const;

  private:
    void set_shares();
    void mean(const Block BodyClass::*traction, const double *motion,
              Where where, double *result) const;

    const DelassusOperator<dim> &delassus_;
    const InitialStress<dim> *initial_;
    std::vector<std::array<double, 2>> share_; ///< omega, per point
    BodyOrder marked_;                         ///< bodies at marked faces
    std::vector<unsigned int> marked_points_;
    mutable std::vector<double> side_1_, side_2_;
  };
} // namespace nsfd
