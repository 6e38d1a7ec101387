#include "step_costs.h"

namespace nsfd
{
  void fill_counters(const StepCounters &steps,
                     std::map<std::string, double> &counters)
  {
    counters["solver_calls"] = double(steps.solves);
    counters["newton"] = double(steps.newton);
    counters["krylov"] = double(steps.krylov);
    counters["gauss_seidel_sweeps"] = double(steps.sweeps);
    counters["line_searches"] = double(steps.line_searches);
    counters["law_sweeps"] = double(steps.law_sweeps);
    counters["load_assemblies"] = double(steps.load_assemblies);
    counters["activation_rounds"] = double(steps.activation_rounds);
  }

  std::vector<std::pair<std::string, double>>
  stage_seconds(const StepTimings &steps)
  {
    return {{"loads and free motion", steps.assembly},
            {"nonsmooth solve", steps.solve},
            {"update of bodies", steps.update},
            {"energy ledger", steps.ledger}};
  }
} // namespace nsfd
