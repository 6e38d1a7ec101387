#pragma once

#include "discretization/bodies.h"
#include "state/state.h"

#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class FiniteElement;
} // namespace dealii

namespace nsfd
{
  /** The children of a cell, in their order, with their motion. */
  struct Family {
    std::vector<const BodyClass *> classes;
    std::vector<std::vector<double>> displacement;
    std::vector<const double *> velocity;

    /** A child without the @p translation (per component) that it has. */
    void add(const Bodies &bodies, const State &state, unsigned int body,
             const double *translation, unsigned int dim);
  };

  /** What their parent takes over from them, per unknown of a cell. */
  struct ParentMotion {
    std::vector<double> displacement; ///< interpolated, mean where they meet
    std::vector<double> momentum;     ///< sum over children of P^T M v
  };

  /** x.A x / 2. */
  double half_product(const Block &A, const double *x);

  /** The polynomials @p x of a parent in its child @p child; n unknowns. */
  template <int dim>
  std::vector<double> in_child(const dealii::FiniteElement<dim, dim> &element,
                               unsigned int child, const double *x,
                               std::size_t n);

  template <int dim>
  ParentMotion motion_of_parent(const dealii::FiniteElement<dim, dim> &element,
                                const Family &family);

  /** Kinetic and elastic energy of a family, J (J/m in two dimensions). */
  struct FamilyEnergy {
    double now = 0.;
    double change = 0.; ///< in becoming their parent, sizes of both kinds
  };

  template <int dim>
  FamilyEnergy energy_of_family(const dealii::FiniteElement<dim, dim> &element,
                                const Family &family);
} // namespace nsfd
