#pragma once

#include "nsfd/core/message_counts.h"

#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** What a run cost, on rank 0, and why. */
  struct CostRecord {
    /// CPU seconds by what they were spent on, every moment once, and calls
    struct Part {
      std::string name;
      double seconds = 0.;
      unsigned long long calls = 0;
    };
    std::vector<Part> parts;

    /// iterations of the accepted steps
    struct Spread {
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

    /// what ranks have sent, the largest numbers of all of them; nothing on one
    unsigned int ranks = 1;
    MessageCounts sent;
    double steps = 0.; ///< in which they have sent it
    /// of all ranks at a time over that of one of them, alone: what the machine
    /// gives to any program at best; 0 where the run was too short
    double copy_gain = 0., product_gain = 0.;

    bool has_limits() const
    {
      return applications > 0. && seconds > 0. && copy_bytes_per_second > 0.;
    }
    /** Time that the nearer of both limits allows, over that of one. */
    double share_of_limit() const;
    bool limited_by_copy() const;
  };

  /** "2 ranks, each per step at most: 160 messages of 1.3 kB, ..." */
  std::string messages_text(const CostRecord &cost);

  /** The last lines of a run. */
  std::string cost_text(const CostRecord &cost, double peak_memory_mb);
} // namespace nsfd
