#pragma once

#include "delassus_operator.h"

namespace nsfd
{
  /** What one application of W takes on this rank, counted. */
  struct DelassusCost {
    double flops = 0.; ///< additions and multiplications that are needed
    /// read or written once: vectors, frames, lists, and blocks once per class
    double bytes = 0.;
    unsigned int rows = 0; ///< of the block that does most of the work
  };

  template <int dim>
  DelassusCost count_delassus(const DelassusOperator<dim> &delassus);

  /**
   * What the machine does in this moment, on arrays as large as those of one
   * application of W: bytes read and written per second by a copy, and
   * operations per second of the product of a block with several columns, all
   * of it in the nearest cache. Takes some milliseconds.
   */
  struct MachineLimits {
    double copy_bytes_per_second = 0., product_flops_per_second = 0.;
  };
  MachineLimits measure_machine(const DelassusCost &cost);
} // namespace nsfd
