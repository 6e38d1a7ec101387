#pragma once

#include <memory>
#include <vector>

namespace nsfd
{
  class Indicator; // see adaptivity/indicator.h

  /** Section `Adaptivity` with the blocks `Indicator: name`. */
  struct AdaptivityInput {
    unsigned int levels = 2; ///< the smallest cell: that of the mesh / 2^levels
    unsigned int coarsen_every = 10; ///< steps; 0: cells stay small
    /// springs of intrinsic laws on smaller cells: the modulus of the body or
    /// the stiffness of every face stays
    bool constant_modulus = true;
    /// triangles on joined nodes, see adaptivity/bisection.h
    bool bisects = false;
    /// of them: further than the indicators ask for, in cohesive zones
    double ahead = 1.;
    std::vector<std::shared_ptr<const Indicator>> indicators;
  };
} // namespace nsfd
