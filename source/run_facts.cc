#include "run_facts.h"

#include "nsfd/base/archive.h"
#include "nsfd/scene/zone_resolution.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  void SolvedSteps::add(const Kind kind, const double residual)
  {
    switch (kind) {
    case Kind::dynamic:
      ++dynamic_;
      residual_ = std::max(residual_, residual);
      break;
    case Kind::quasi_static:
      ++quasi_static_;
      imbalance_ = std::max(imbalance_, residual);
      break;
    case Kind::smooth:
      ++smooth_;
    }
  }

  void SolvedSteps::fill(RunFacts &facts) const
  {
    facts.steps = dynamic_;
    facts.static_steps = quasi_static_;
    facts.smooth_steps = smooth_;
    facts.residual = residual_;
    facts.imbalance = imbalance_;
  }

  void SolvedSteps::remember(Archive &archive)
  {
    archive.numbers("solved_steps", dynamic_, quasi_static_, smooth_, residual_,
                    imbalance_);
  }

  template <int dim>
  RunFacts run_facts(const SceneInput &input, const Model<dim> &model,
                     const SolvedSteps &steps, const Extremes<dim> &extremes,
                     const State &state,
                     const Summary &summary, const Communicator &communicator)
  {
    const auto counter = [&summary](const char *name) {
      const auto found = summary.counters.find(name);
      return found == summary.counters.end()
                 ? 0ull
                 : static_cast<unsigned long long>(found->second);
    };
    RunFacts facts;
    steps.fill(facts);
    facts.completed = summary.completed;
    facts.failure = summary.failure;
    facts.time = summary.final_time;
    facts.tolerance = input.solver.tolerance;
    if (input.statics)
      facts.static_tolerance = input.statics->tolerance;
    facts.ledger_defect = summary.ledger_defect_max;
    const EnergyLines &e = summary.energy;
    if (!std::isfinite(e.kinetic + e.elastic + e.cohesive + e.numerical))
      facts.ledger_defect = std::numeric_limits<double>::quiet_NaN();
    if (state.largest_energy > 0.)
      facts.created = std::max(0., -e.numerical) / state.largest_energy;
    if (std::isnan(facts.ledger_defect))
      facts.created = facts.ledger_defect;
    facts.penetration = summary.penetration_max;
    facts.penetration_bound = summary.penetration_bound;
    facts.penetration_excess = state.penetration_excess;
    double largest = 0.;
    for (const double u : state.displacement)
      largest = std::max(largest, std::abs(u));
    facts.displacement = communicator.max(largest);
    for (const auto &block : input.interfaces)
      if (block.law) {
        facts.softens = true;
        facts.brittle |= std::isinf(block.law->steepest_softening());
      }
    extremes.fill(facts);
    facts.follows_jumps = input.statics &&
                          input.statics->at_jump == SolutionJump::dynamic;
    facts.takes_jumps =
        input.statics && input.statics->at_jump == SolutionJump::relax;
    facts.moreau_jean = input.time.scheme == Scheme::moreau_jean;
    facts.maximum_halvings = input.time.maximum_halvings;
    facts.automatic_steps = input.time.step_kind == StepKind::automatic;
    facts.beyond_unique = counter("steps_beyond_uniqueness");
    facts.solution_jumps = counter("solution_jumps");
    facts.rejected = counter("rejected_steps");
    facts.redone = counter("redone_steps") + counter("shortened_load_steps");
    if (facts.softens)
      facts.zone = zone_resolution(input, *model.discretization,
                                   model.stepper->problem(), state,
                                   communicator);
    return facts;
  }

  template RunFacts run_facts(const SceneInput &, const Model<2> &,
                              const SolvedSteps &, const Extremes<2> &,
                              const State &,
                              const Summary &, const Communicator &);
  template RunFacts run_facts(const SceneInput &, const Model<3> &,
                              const SolvedSteps &, const Extremes<3> &,
                              const State &,
                              const Summary &, const Communicator &);
} // namespace nsfd
