#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** CPU time of the stages of all steps so far, s. */
  struct StepTimings {
    double assembly = 0., solve = 0., update = 0., ledger = 0.;
    double contact_search = 0.; ///< a part of the assembly
  };

  /** Work of all steps so far. */
  struct StepCounters {
    unsigned long long solves = 0, newton = 0, krylov = 0, sweeps = 0,
                       law_sweeps = 0, line_searches = 0, load_assemblies = 0,
                       activation_rounds = 0, sliding_rounds = 0;
  };

  /** By the names of summaries. */
  void fill_counters(const StepCounters &steps,
                     std::map<std::string, double> &counters);
  std::vector<std::pair<std::string, double>>
  stage_seconds(const StepTimings &steps);
} // namespace nsfd
