#pragma once

#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** What a run cost, on rank 0, and why. */
  struct CostRecord
  {
    /// CPU seconds by what they were spent on, every moment once, and calls
    struct Part
    {
      std::string name;
      double seconds = 0.;
      unsigned long long calls = 0;
    };
    std::vector<Part> parts;

    /// iterations of the accepted steps
    struct Spread
    {
      std::string name;
      double median = 0., worst = 0.;
    };
    std::vector<Spread> per_step;

    /// bytes of the heap by owner
    std::vector<std::pair<std::string, double>> memory;

    /// one application of W, and the limits of the machine; rates are 0 where
    /// the run was too short to measure them
    double applications = 0., seconds = 0.; ///< of one, mean CPU time
    double flops = 0., bytes = 0.;
    double copy_bytes_per_second = 0., product_flops_per_second = 0.;

    bool has_limits() const
    {
      return applications > 0. && seconds > 0. && copy_bytes_per_second > 0.;
    }
    /** Time that the nearer of both limits allows, over that of one. */
    double share_of_limit() const;
    bool limited_by_copy() const;
  };

  /** The last lines of a run. */
  std::string cost_text(const CostRecord &cost, double peak_memory_mb);
} // namespace nsfd
