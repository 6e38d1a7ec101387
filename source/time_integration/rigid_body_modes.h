#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct State;

  /**
   * The rigid motion that @p residual, the forces without balance, does most
   * work on, of those that supports leave free: of which fragment of @p state,
   * in words. Empty if those forces are mostly balanced
   * by themselves, or by supports. Collective.
   */
  template <int dim>
  std::string rigid_body_modes(const Discretization<dim> &discretization,
                               const DelassusOperator<dim> &delassus,
                               const State &state,
                               const std::vector<double> &residual);
} // namespace nsfd
