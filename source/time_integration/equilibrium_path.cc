#include "energy_watch.h"
#include "equilibrium_search.h"
#include "relaxation.h"
#include "static_balance.h"

#include "core/accelerated_rounds.h"
#include "discretization/loads.h"
#include "state/point_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Of the longest increment: how far the second equilibrium of a line is
        from the first, and what counts as no increment. */
    constexpr double aside_share = 1e-3, no_increment = 1e-6;
    /** Change of the springs in a round, of themselves: where they are those
        of the laws, and what is good enough where rounds come no closer. */
    constexpr double at_laws = 1e-10, near_laws = 1e-8;
    constexpr unsigned int plain_rounds = 4, most_path_rounds = 40,
                           most_elastic_rounds = 12, most_spring_rounds = 80;
  } // namespace

  /** Two equilibria of the present springs, the second at @p time. */
  template <int dim>
  void EquilibriumSearch<dim>::respond(const State &old, const double time,
                                       const double aside,
                                       std::vector<double> &q,
                                       StepReport &report)
  {
    for (const double s : {time - aside, time}) {
      relaxation_->aim(s, s - start_);
      if (!settle(q, most_spring_rounds, input_.statics->tolerance, report,
                  nullptr)) {
        refuse_rigid_body_modes(old, s);
        throw StepRejected(fmt::format(
            "no equilibrium was found on the path at the load time {:.6g}: "
            "{:.2e} of the forces are not balanced; worst face {}",
            s, relaxation_->balance().imbalance(), relaxation_->worst_face()));
      }
      relaxation_->path_laws().observe(s);
    }
  }

  template <int dim>
  PathReport
  EquilibriumSearch<dim>::follow(const State &old, const double delay,
                                 const double longest, const double share,
                                 const double points, State &next)
  {
    PathReport report;
    const double start = start_ = old.time - delay;
    const double aside = aside_share * longest;
    std::vector<double> forces_old(old.velocity.size(), 0.),
        q = old.displacement;
    if (discretization_.loads().any())
      discretization_.add_loads(start, forces_old, old.clock);
    hurried_ = false;
    begin(old, start + longest);
    auto &laws = relaxation_->path_laws();
    laws.start();
    const double dissipation = share * points * laws.toughness_of_point();

    // without further damage, to where the first point damages
    StepReport &work = report.equilibrium.step;
    PathControl control{start, longest, at_laws * dissipation};
    typename PathLaws<dim>::End end;
    respond(old, start + longest, longest / 2., q, work);
    end = laws.end(control);
    double at = start + longest;
    for (unsigned int n = 0; n < most_elastic_rounds; ++n) {
      if (!end.found || std::abs(end.load_time - at) <= at_laws * longest)
        break;
      at = end.load_time;
      respond(old, at, aside, q, work);
      end = laws.end(control);
    }
    const bool elastic =
        end.found && end.load_time - start > no_increment * longest;
    std::vector<double> damage = laws.damage();
    double change = laws.follow(end.load_time, damage);
    if (!elastic) {
      control.dissipation = dissipation;
      laws.open(start, dissipation);
      damage = laws.damage();
      end.load_time = start;
      double best = std::numeric_limits<double>::infinity();
      auto best_damage = damage;
      auto best_end = end;
      const auto round = [&](std::vector<double> &x) {
        laws.set_damage(x);
        respond(old, end.load_time, aside, q, work);
        const auto reached = laws.end(control);
        change = laws.follow(reached.load_time, x);
        // the load time itself is a part of the rounds
        const double moved =
            std::abs(reached.load_time - end.load_time) / longest;
        end = reached;
        ++report.rounds;
        if (reached.found && change < best) {
          best = change;
          best_damage = x;
          best_end = end;
        }
        return change > at_laws || moved > at_laws;
      };
      bool more = true;
      for (unsigned int n = 0; more && n < plain_rounds; ++n)
        more = round(damage);
      if (more)
        accelerated_rounds(communicator_, 8, most_path_rounds, damage, round);
      if (!(best <= near_laws))
        throw StepRejected(fmt::format(
            "no equilibrium was found on the path after the load time {:.6g}: "
            "springs in place of the laws still change by {:.2e}",
            start, best));
      damage = best_damage;
      end = best_end;
    }
    laws.set_damage(damage);
    relaxation_->aim(end.load_time, end.load_time - start);
    if (!settle(q, most_spring_rounds, input_.statics->tolerance, work,
                nullptr))
      throw StepRejected("no equilibrium was found on the path");
    laws.observe(end.load_time);
    const auto dissipated = laws.dissipated(end.load_time);
    laws.conclude();
    take(old, end.load_time, q, next);
    const EnergyLeft left =
        balance_->account(*relaxation_, forces_old, old, next, work);
    auto &equilibrium = report.equilibrium;
    equilibrium.released_energy = left.energy;
    equilibrium.above_mean = left.above_mean;
    equilibrium.round_off = energy_round_off * next.largest_energy;
    equilibrium.jumps = std::abs(left.energy) >
                        jump_share * left.turnover + equilibrium.round_off;
    if (equilibrium.jumps)
      equilibrium.place = face_of_all(left.worst, left.worst_point);
    release_zeros(next);
    report.load_time = end.load_time;
    report.dissipated = dissipated.sum;
    report.points = dissipated.points;
    report.at_longest = end.at_longest;
    return report;
  }

  template void EquilibriumSearch<2>::respond(const State &, double, double,
                                              std::vector<double> &,
                                              StepReport &);
  template void EquilibriumSearch<3>::respond(const State &, double, double,
                                              std::vector<double> &,
                                              StepReport &);
  template PathReport EquilibriumSearch<2>::follow(const State &, double,
                                                   double, double, double,
                                                   State &);
  template PathReport EquilibriumSearch<3>::follow(const State &, double,
                                                   double, double, double,
                                                   State &);
} // namespace nsfd
