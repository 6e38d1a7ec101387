#pragma once

#include "discretization/discretization.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** For messages: where point @p i of @p origins is, at @p positions with dim
      components each, and to which block it belongs. */
  template <int dim>
  std::string name_of_point(const SceneInput &input,
                            const std::vector<PointOrigin> &origins,
                            const std::vector<double> &positions,
                            std::size_t i);
} // namespace nsfd
