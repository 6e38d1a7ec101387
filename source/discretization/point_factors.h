#pragma once

#include "nsfd/discretization/point_origin.h"

#include <string>
#include <vector>

namespace nsfd
{
  class Communicator;
  struct InterfaceInput;
  struct SceneInput;
  template <int dim>
  class Discretization;

  /** Strength and toughness of a point over those of its law. */
  struct PointFactors {
    double strength = 1., toughness = 1.;
  };

  /**
   * Graded by the expressions of the block, scattered by the position alone.
   * @p extent is the size of the mesh.
   */
  template <int dim>
  PointFactors point_factors(const InterfaceInput &block,
                             const double *position, double extent);

  /** Of a point at the temperature @p T (K), times those. */
  PointFactors warm_factors(const InterfaceInput &block, double T);

  /** What mu of a point is times at the temperature @p T (K). */
  double friction_factor(const SceneInput &input, const PointOrigin &origin,
                         double T);

  /** A sentence for every expression that is not positive. Collective. */
  template <int dim>
  void check_point_factors(const SceneInput &input,
                           const Discretization<dim> &discretization,
                           const Communicator &communicator,
                           std::vector<std::string> &problems);
} // namespace nsfd
