#include "run_costs.h"

#include "delassus/delassus_cost.h"
#include "nsfd/core/archive.h"

#include <algorithm>
#include <sstream>

namespace nsfd
{
  template <int dim>
  void RunCosts<dim>::record(const SolverReport &report,
                             const unsigned long long applications)
  {
    ++counts_[0][report.newton];
    ++counts_[1][report.krylov];
    ++counts_[2][report.sweeps];
    // those of rejected attempts belong to the step that comes of them
    ++counts_[3][unsigned(applications - applications_)];
    applications_ = applications;
  }

  /** With those before the checkpoint; each line once. */
  template <int dim>
  std::vector<CostLine> RunCosts<dim>::lines() const
  {
    std::vector<CostLine> all = cost_lines();
    for (const CostLine &earlier : before_) {
      const auto same =
          std::find_if(all.begin(), all.end(), [&](const CostLine &line) {
            return line.name == earlier.name;
          });
      if (same == all.end())
        all.push_back(earlier);
      else {
        same->seconds += earlier.seconds;
        same->calls += earlier.calls;
      }
    }
    return all;
  }

  template <int dim>
  MessageCounts RunCosts<dim>::sent() const
  {
    MessageCounts sum = message_counts();
    sum.messages += sent_before_.messages;
    sum.message_bytes += sent_before_.message_bytes;
    sum.collectives += sent_before_.collectives;
    sum.collective_bytes += sent_before_.collective_bytes;
    return sum;
  }

  template <int dim>
  void RunCosts<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "costs");
    for (std::size_t k = 0; k < counts_.size(); ++k) {
      std::vector<double> pairs;
      for (const auto &[count, steps] : counts_[k]) {
        pairs.push_back(double(count));
        pairs.push_back(double(steps));
      }
      archive.common("iterations_" + std::to_string(k), pairs);
      counts_[k].clear();
      for (std::size_t i = 0; i + 1 < pairs.size(); i += 2)
        counts_[k][unsigned(pairs[i])] =
            static_cast<unsigned long long>(pairs[i + 1]);
    }
    std::string names;
    std::vector<double> values;
    for (const CostLine &line : lines()) {
      names += line.name + '\n';
      values.push_back(line.seconds);
      values.push_back(double(line.calls));
    }
    archive.on_root("lines", names);
    archive.on_root("seconds_and_calls", values);
    const MessageCounts so_far = sent();
    std::vector<double> counts = {so_far.messages, so_far.message_bytes,
                                  so_far.collectives, so_far.collective_bytes};
    archive.on_root("sent", counts);
    if (!archive.reads())
      return;
    if (counts.size() == 4)
      sent_before_ = {counts[0], counts[1], counts[2], counts[3]};
    before_.clear();
    std::istringstream stream(names);
    std::string name;
    for (std::size_t i = 0; std::getline(stream, name); i += 2)
      before_.push_back({name, values.at(i),
                         static_cast<unsigned long long>(values.at(i + 1))});
  }

  /** What one application of W takes, and what the machine allows for. */
  template <int dim>
  void RunCosts<dim>::measure(const DelassusOperator<dim> &delassus,
                              CostRecord &cost) const
  {
    const Communicator &communicator = delassus.communicator();
    const DelassusCost one = count_delassus(delassus);
    cost.flops = one.flops;
    cost.bytes = one.bytes;
    double total = 0.;
    for (const auto &part : cost.parts)
      total += part.seconds;
    if (!communicator.any(total > 1.))
      return;
    MachineLimits alone;
    if (communicator.is_root())
      alone = measure_machine(one);
    if (communicator.size() > 1)
      MPI_Barrier(communicator.mpi());
    const MachineLimits limits =
        communicator.size() > 1 ? measure_machine(one) : alone;
    cost.copy_bytes_per_second = limits.copy_bytes_per_second;
    cost.product_flops_per_second = limits.product_flops_per_second;
    if (communicator.size() > 1) {
      cost.copy_gain = communicator.sum({limits.copy_bytes_per_second}) /
                       communicator.max(alone.copy_bytes_per_second);
      cost.product_gain = communicator.sum({limits.product_flops_per_second}) /
                          communicator.max(alone.product_flops_per_second);
    }
  }

  template <int dim>
  CostRecord RunCosts<dim>::finish(const Communicator &communicator,
                                   const DelassusOperator<dim> *delassus) const
  {
    CostRecord cost;
    const MessageCounts mine = sent();
    cost.ranks = unsigned(communicator.size());
    cost.sent = {communicator.max(mine.messages),
                 communicator.max(mine.message_bytes),
                 communicator.max(mine.collectives),
                 communicator.max(mine.collective_bytes)};
    for (const auto &line : lines()) {
      cost.parts.push_back({line.name, line.seconds, line.calls});
      if (line.name == cost_name(Cost::delassus)) {
        cost.applications = double(line.calls);
        cost.seconds = line.seconds / std::max(1., cost.applications);
      }
    }
    const std::array<const char *, 4> names = {
        {"Newton", "Krylov", "sweeps", "applications of W"}};
    for (std::size_t k = 0; k < names.size(); ++k) {
      CostRecord::Spread spread{names[k], 0., 0.};
      unsigned long long total_steps = 0, below = 0;
      for (const auto &[count, steps] : counts_[k])
        total_steps += steps;
      for (const auto &[count, steps] : counts_[k]) {
        if (below <= total_steps / 2)
          spread.median = count;
        spread.worst = count;
        below += steps;
      }
      cost.per_step.push_back(spread);
      if (k == 0)
        cost.steps = double(total_steps);
    }
    cost.memory = memory_lines();
    if (delassus && communicator.any(cost.applications > 0.))
      measure(*delassus, cost);
    return cost;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  stage_timings(const Model<dim> &model, const double setup,
                const double output)
  {
    std::vector<std::pair<std::string, double>> stages = {{"set-up", setup}};
    const auto add = [&stages](const TimeIntegrator<dim> &integrator) {
      const auto more = integrator.stage_seconds();
      stages.insert(stages.end(), more.begin(), more.end());
    };
    if (model.other)
      add(*model.other);
    if (model.equilibria)
      add(*model.equilibria);
    if (model.stepper)
      add(*model.stepper);
    else if (model.equilibria) { // the same rows in all summaries
      const auto none = stage_seconds(StepTimings());
      stages.insert(stages.end(), none.begin(), none.end());
    }
    stages.emplace_back("output", output);
    return stages;
  }

  template std::vector<std::pair<std::string, double>>
  stage_timings<2>(const Model<2> &, double, double);
  template std::vector<std::pair<std::string, double>>
  stage_timings<3>(const Model<3> &, double, double);
  template class RunCosts<2>;
  template class RunCosts<3>;
} // namespace nsfd
