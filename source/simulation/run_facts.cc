#include "run_facts.h"

#include "nsfd/core/archive.h"
#include "zone_resolution.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  void SolvedSteps::add(const ResidualKind kind, const double residual)
  {
    switch (kind) {
    case ResidualKind::one_step_problem:
      ++dynamic_;
      residual_ = std::max(residual_, residual);
      break;
    case ResidualKind::force_balance:
      ++quasi_static_;
      imbalance_ = std::max(imbalance_, residual);
      break;
    case ResidualKind::none:
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

  void SolvedSteps::serialize(Archive &archive)
  {
    archive.numbers("solved_steps", dynamic_, quasi_static_, smooth_, residual_,
                    imbalance_);
  }

  namespace
  {
    /** Something of the scene can rub, and the like. */
    bool has_line(const WatchedLine line, const SceneInput &input,
                  const State &state)
    {
      const auto any = [](const auto &blocks, const auto &test) {
        return std::any_of(blocks.begin(), blocks.end(), test);
      };
      const auto rubs = [](const auto &b) { return b.friction > 0.; };
      const EnergyLines &e = state.energy;
      switch (line) {
      case WatchedLine::friction:
        return any(input.interfaces, rubs) || any(input.obstacles, rubs) ||
               any(input.contacts, rubs);
      case WatchedLine::damage:
        return any(input.interfaces, [](const auto &b) { return bool(b.law); });
      case WatchedLine::impact:
        return !input.obstacles.empty() || !input.contacts.empty() ||
               any(input.interfaces,
                   [](const auto &b) { return b.may_open(); });
      case WatchedLine::viscous:
        return e.viscous != 0.;
      case WatchedLine::plastic:
        return e.plastic != 0.;
      case WatchedLine::joints:
        return any(input.interfaces, [](const auto &b) {
          return b.intact == IntactFaces::rigid;
        });
      case WatchedLine::supports:
        return any(input.boundaries, [](const auto &b) {
          const auto given = [](const auto &x) { return x.has_value(); };
          return b.exact_motion ||
                 std::any_of(b.velocity.begin(), b.velocity.end(), given) ||
                 std::any_of(b.displacement.begin(), b.displacement.end(),
                             given);
        });
      case WatchedLine::load_steps:
        return input.statics && input.statics->steps;
      case WatchedLine::large_motion:
        return input.iterates() && input.time.scheme.at_nodes;
      default:
        return true;
      }
    }

    std::string advice_of(const WatchedLine line, const SceneInput &input)
    {
      const TimeInput &time = input.time;
      switch (line) {
      case WatchedLine::friction:
        return time.sliding == Sliding::velocity ? "set sliding = energy safe"
                                                 : "lower Solver/tolerance";
      case WatchedLine::impact:
        return time.contact_target != ContactTarget::energy_safe
                   ? "set contact target = energy safe"
               : time.theta > 0.5 ? "lower theta to 1 / (1 + restitution)"
                                  : "lower Solver/tolerance";
      case WatchedLine::joints:
      case WatchedLine::supports:
        return "lower Solver/tolerance; joints may be redundant";
      case WatchedLine::scheme:
        return time.cohesion_rule != CohesionRule::exact && !input.statics
                   ? "set cohesion rule = exact"
                   : "set step to a shorter time";
      case WatchedLine::load_steps:
      case WatchedLine::large_motion:
        return "set step to a shorter time";
      default:
        return "";
      }
    }

    /** The time scheme does. */
    bool keeps_energy(const SceneInput &input)
    {
      const TimeInput &time = input.time;
      const auto breaks = [](const InterfaceInput &block) {
        return block.law && block.intact == IntactFaces::bonded;
      };
      const bool by_steps = time.scheme.explicit_forces &&
                            time.cohesion_rule == CohesionRule::exact &&
                            std::none_of(input.interfaces.begin(),
                                         input.interfaces.end(), breaks);
      return by_steps || time.scheme.at_nodes ||
             never_gives(WatchedLine::scheme, input);
    }

    std::vector<GivenEnergy> given_energy(const SceneInput &input,
                                          const EnergyWatch &watch,
                                          const State &state)
    {
      // what the rules of explicit steps, end points, released faces and
      // frames of large motions make comes and goes: as well as curves can be
      // read
      constexpr double of_pure_rules = 1e-2;
      // Contacts at rest have no energy but round-off of what loads would give
      // in a step, which in long steps is far more than all energies there are.
      const double scale =
          std::max(watch.round_off / energy_round_off, state.largest_energy);
      const auto share = [&](const double energy) {
        return energy == 0. ? 0. : energy / scale;
      };
      std::vector<GivenEnergy> result;
      for (std::size_t k = 0; k < n_watched_lines; ++k) {
        const auto line = WatchedLine(k);
        if (!has_line(line, input, state))
          continue;
        const bool of_rows =
            line == WatchedLine::joints || line == WatchedLine::supports;
        GivenEnergy given;
        given.line = line == WatchedLine::scheme ? "time scheme"
                     : line == WatchedLine::large_motion && !input.large_motion
                         ? "flow"
                         : name_of(line);
        given.share = share(watch.given[k]);
        given.bound = energy_round_off;
        if (of_rows)
          given.bound += share(watch.of_rows);
        if (line == WatchedLine::scheme)
          given.bound = keeps_energy(input) ? energy_round_off : of_pure_rules;
        if (line == WatchedLine::large_motion)
          given.bound = most_of_large_motion;
        if (line == WatchedLine::load_steps) // as much as a single step may
          given.bound = EquilibriumSearch<2>::jump_share;
        given.advice = advice_of(line, input);
        result.push_back(std::move(given));
      }
      return result;
    }
  } // namespace

  template <int dim>
  RunFacts run_facts(const SceneInput &input, const Model<dim> &model,
                     const SolvedSteps &steps, const Extremes<dim> &extremes,
                     const EnergyWatch &watch, const State &state,
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
    facts.balance_residual = summary.balance_residual_max;
    const auto crossed = summary.counters.find("cells_crossed_by_heat");
    if (crossed != summary.counters.end())
      facts.cells_crossed_by_heat = crossed->second;
    if (summary.heat)
      facts.heat_residual = state.heat.moved > 0.
                                ? std::abs(state.heat.stored - state.heat.made -
                                           state.heat.given) /
                                      state.heat.moved
                                : 0.;
    const EnergyLines &e = summary.energy;
    if (!std::isfinite(e.kinetic + e.elastic + e.cohesive + e.numerical))
      facts.balance_residual = std::numeric_limits<double>::quiet_NaN();
    facts.given = given_energy(input, watch, state);
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
    if (model.leapfrog)
      if (const auto held = model.leapfrog->held_faces()) {
        facts.held.emplace();
        facts.held->share = held->share;
        if (held->share > 0.)
          facts.held->place = fmt::format("({:.6g}) of Interface: {}",
                                          fmt::join(held->centre, ", "),
                                          input.interfaces[held->block].name);
      }
    extremes.fill(facts);
    facts.follows_jumps =
        input.statics && input.statics->at_jump == SolutionJump::dynamic;
    facts.takes_jumps =
        input.statics && input.statics->at_jump == SolutionJump::relax;
    facts.maximum_bisections = input.time.maximum_bisections;
    facts.automatic_steps = input.time.step_kind == StepKind::automatic;
    facts.explicit_steps = input.time.scheme.at_nodes;
    facts.beyond_unique = counter("steps_beyond_uniqueness");
    facts.solution_jumps = counter("solution_jumps");
    facts.rejected = counter("rejected_steps");
    facts.overshoots =
        counter("redone_steps") + counter("shortened_load_steps");
    if (facts.softens)
      facts.zone = zone_resolution(input, *model.discretization, model.points(),
                                   state, communicator);
    return facts;
  }

  template RunFacts run_facts(const SceneInput &, const Model<2> &,
                              const SolvedSteps &, const Extremes<2> &,
                              const EnergyWatch &, const State &,
                              const Summary &, const Communicator &);
  template RunFacts run_facts(const SceneInput &, const Model<3> &,
                              const SolvedSteps &, const Extremes<3> &,
                              const EnergyWatch &, const State &,
                              const Summary &, const Communicator &);
} // namespace nsfd
