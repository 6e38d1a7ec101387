#include "run_tally.h"

#include "run_info.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  RunTally<dim>::RunTally(const SceneInput &input, const Model<dim> &model,
                          const TimeStepping<dim> &steps,
                          const Communicator &communicator)
      : input_(input), model_(model), steps_(steps),
        communicator_(communicator),
        wall_start_(wall_seconds() - passed_since_begin().wall),
        setup_start_(cpu_seconds() - passed_since_begin().cpu)
  {
  }

  namespace
  {
    template <typename Counters>
    void fill_products(const Counters &delassus,
                       std::map<std::string, double> &c)
    {
      c["delassus_applications"] = double(delassus.delassus);
      c["block_factorisations"] = double(delassus.factorisations);
      c["global_factorisations"] = double(delassus.global_factorisations);
      c["coarse_spaces"] = double(delassus.coarse_spaces);
      c["global_solves"] = double(delassus.global_solves);
      c["inner_iterations"] = double(delassus.inner_iterations);
      // products with W and, inside the preconditioner, with A
      c["operator_applications"] =
          double(delassus.delassus + delassus.inner_iterations);
    }
  } // namespace

  template <int dim>
  void RunTally<dim>::add(const StepReport &report)
  {
    beyond_unique_ += report.beyond_unique;
    released_ += report.released;
    watch_.add(report.changes);
    costs_.record(report.solver,
                  model_.delassus ? model_.delassus->counters().delassus : 0);
    solved_steps_.add(steps_.integrator().residual_kind(),
                      report.solver.residual);
    for (const auto &name : report.solver.switches)
      ++switches_[name];
    balance_residual_max_ =
        std::max(balance_residual_max_, report.balance_residual);
    residual_max_ = std::max(residual_max_, report.solver.residual);
  }

  template <int dim>
  void
  RunTally<dim>::fill_counters(const State &state,
                               std::map<std::string, double> &counters) const
  {
    auto &c = counters;
    // equilibria count theirs by themselves
    if (model_.delassus || model_.equilibria)
      fill_products(model_.delassus
                        ? model_.delassus->counters()
                        : typename DelassusOperator<dim>::Counters(),
                    c);
    if (model_.bonded || (!model_.delassus && input_.has_bonded_faces()))
      c["released_bonds"] = double(released_);
    c["steps_beyond_uniqueness"] = beyond_unique_;
    c["penetration_excess"] = state.penetration_excess;
    count_points(input_, *model_.discretization, communicator_, c);
    c["body_classes"] = communicator_.max(
        double(model_.discretization->bodies().classes.size()));
    for (const auto &[name, count] : switches_)
      c["switches_to_" + name] = count;
    steps_.fill_counters(c);
  }

  /** Without what was counted before the checkpoint. */
  template <int dim>
  RunTotals
  RunTally<dim>::of_process(const State &state, const double output,
                            const unsigned int failed_checkpoints) const
  {
    RunTotals sums;
    fill_counters(state, sums.counters);
    if (resumed_)
      sums.counters["resumed"] = 1.;
    if (failed_checkpoints > 0)
      sums.counters["failed_checkpoints"] = failed_checkpoints;
    sums.timings = stage_timings(model_, setup_seconds_, output);
    sums.wall_seconds = wall_seconds() - wall_start_;
    sums.cpu_seconds = cpu_seconds();
    return sums;
  }

  template <int dim>
  RunTotals RunTally<dim>::totals(const State &state, const double output,
                                  const unsigned int failed_checkpoints) const
  {
    RunTotals sums = of_process(state, output, failed_checkpoints);
    earlier_.add_to(sums);
    return sums;
  }

  template <int dim>
  void RunTally<dim>::serialize(Archive &archive, const State &state,
                                const double output,
                                const unsigned int failed_checkpoints)
  {
    watch_.serialize(archive);
    archive.numbers("largest", balance_residual_max_, residual_max_);
    solved_steps_.serialize(archive);
    costs_.serialize(archive);
    earlier_.serialize(archive, of_process(state, output, failed_checkpoints));
  }

  template class RunTally<2>;
  template class RunTally<3>;
} // namespace nsfd
