#include "run_costs.h"

#include "nsfd/base/cost.h"
#include "nsfd/dynamics/delassus_cost.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  void RunCosts<dim>::record(const SolverReport &report,
                             const unsigned long long applications)
  {
    counts_[0].push_back(report.newton);
    counts_[1].push_back(report.krylov);
    counts_[2].push_back(report.sweeps);
    // those of rejected attempts belong to the step that comes of them
    counts_[3].push_back(unsigned(applications - applications_));
    applications_ = applications;
  }

  template <int dim>
  CostRecord RunCosts<dim>::finish(const Dynamics<dim> &dynamics) const
  {
    CostRecord cost;
    double total = 0.;
    for (const auto &line : cost_lines()) {
      cost.parts.push_back({line.name, line.seconds, line.calls});
      total += line.seconds;
      if (line.name == cost_name(Cost::delassus)) {
        cost.applications = double(line.calls);
        cost.seconds = line.seconds / std::max(1., cost.applications);
      }
    }
    const std::array<const char *, 4> names = {
        {"Newton", "Krylov", "sweeps", "applications of W"}};
    for (std::size_t k = 0; k < names.size(); ++k) {
      auto sorted = counts_[k];
      std::sort(sorted.begin(), sorted.end());
      CostRecord::Spread spread{names[k], 0., 0.};
      if (!sorted.empty()) {
        spread.median = sorted[sorted.size() / 2];
        spread.worst = sorted.back();
      }
      cost.per_step.push_back(spread);
    }
    cost.memory = memory_lines();
    if (cost.applications > 0.) {
      const DelassusCost one = count_delassus(dynamics);
      cost.flops = one.flops;
      cost.bytes = one.bytes;
      if (total > 1.) {
        const MachineLimits limits = measure_machine(one);
        cost.copy_bytes_per_second = limits.copy_bytes_per_second;
        cost.product_flops_per_second = limits.product_flops_per_second;
      }
    }
    return cost;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  stage_timings(const Model<dim> &model, const double setup,
                const double output)
  {
    const auto &t = model.stepper->timings();
    std::vector<std::pair<std::string, double>> stages = {
        {"set-up", setup},           {"loads and free motion", t.assembly},
        {"nonsmooth solve", t.solve}, {"update of bodies", t.update},
        {"energy ledger", t.ledger}, {"output", output}};
    if (model.quasi_static) {
      const auto &q = model.quasi_static->timings();
      stages.insert(stages.begin() + 1,
                    {"equilibria", q.assembly + q.solve + q.update});
    }
    return stages;
  }

  template std::vector<std::pair<std::string, double>>
  stage_timings<2>(const Model<2> &, double, double);
  template std::vector<std::pair<std::string, double>>
  stage_timings<3>(const Model<3> &, double, double);
  template class RunCosts<2>;
  template class RunCosts<3>;
} // namespace nsfd
