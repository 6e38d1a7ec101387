#include "energy_watch.h"
#include "equilibrium_search.h"
#include "relaxation.h"
#include "static_balance.h"

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
    constexpr double aside_share = 1e-3, no_increment = 1e-4;
    /** Of the dissipation of a step: of one in which faces open. */
    constexpr double first_opening_share = 0.01;
    /** Change of the springs in a round, of themselves: where they are those
        of the laws, and what is good enough where rounds come no closer. */
    constexpr double at_laws = 1e-10, near_laws = 1e-8;
    constexpr unsigned int most_path_rounds = 24, most_elastic_rounds = 12,
                           most_spring_rounds = 80;
  } // namespace

  /** The displacements @p q of the last round as the state after @p old. */
  template <int dim>
  void EquilibriumSearch<dim>::take(const State &old, const double time,
                                    const std::vector<double> &q, State &next)
  {
    ++counters_.equilibria;
    next.step = old.step + 1;
    next.time = time;
    next.last_step = 0.;
    next.displacement = q;
    next.velocity.assign(q.size(), 0.);
    next.relative_velocity.assign(old.jump.size(), 0.);
    next.point_force = relaxation_->point_force();
    next.pressure = relaxation_->pressure();
    next.impulse.assign(old.jump.size(), 0.);
    next.viscous_traction = old.viscous_traction;
    std::vector<double> change(q.size());
    for (std::size_t k = 0; k < q.size(); ++k)
      change[k] = q[k] - old.displacement[k];
    next.jump.resize(old.jump.size());
    delassus_->relative_velocity(change.data(), next.jump.data());
    for (std::size_t k = 0; k < next.jump.size(); ++k)
      next.jump[k] += old.jump[k];
  }

  /**
   * Rounds of springs. Stiff ones beside contacts may leave the point laws
   * above their goal while the forces balance: a weaker goal is enough then,
   * what is left over is measured in the end.
   */
  template <int dim>
  bool EquilibriumSearch<dim>::settle_springs(std::vector<double> &q,
                                              StepReport &report)
  {
    constexpr double weaker = 100., weakest = 1e-8;
    for (double goal = input_.statics->tolerance;; goal *= weaker) {
      if (settle(q, most_spring_rounds, goal, report, nullptr))
        return true;
      if (solved_ || !(weaker * goal <= weakest))
        return false;
    }
  }

  /** Two equilibria of the present springs, the second at @p time. */
  template <int dim>
  void EquilibriumSearch<dim>::respond(const State &old, const double time,
                                       const double aside,
                                       std::vector<double> &q,
                                       StepReport &report)
  {
    for (const double s : {time - aside, time}) {
      relaxation_->aim(s, s - start_);
      if (!settle_springs(q, report)) {
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
    const std::size_t held = laws.start();
    if (held != PathLaws<dim>::End::none)
      throw StepRejected(
          fmt::format("the path of equilibria does not open joints that are "
                      "held by rows: {}",
                      relaxation_->face(held)),
          StepRejected::Cure::none);
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
      // at no opening the nodes give points that open other shares of their
      // force: next to nothing is lost where they open by little at first
      control.dissipation = dissipation;
      if (laws.open(start))
        control.dissipation *= first_opening_share;
      laws.guess(start, control.dissipation);
      damage = laws.damage();
      end.load_time = start;
      double best = std::numeric_limits<double>::infinity();
      auto best_damage = damage;
      auto best_end = end;
      auto &nodes = dynamic_cast<VelocitySolver &>(*delassus_);
      for (unsigned int n = 0; n < most_path_rounds; ++n) {
        laws.set_damage(damage);
        respond(old, end.load_time, aside, q, work);
        const double guess = end.load_time;
        // springs that are too stiff carry too much to tell another end
        control.alone = n == 0;
        end = laws.end(control);
        if (!end.found && control.alone) {
          control.alone = false; // there is not so much left to dissipate
          end = laws.end(control);
        }
        change = laws.follow(end.load_time, damage);
        ++report.rounds;
        if (end.found && change < best && n > 0) {
          best = change;
          best_damage = damage;
          best_end = end;
        }
        // the load time itself is a part of the rounds
        if (n > 0 && std::max(change, std::abs(end.load_time - guess) /
                                          longest) < at_laws)
          break;
        if (n > 0 && end.found)
          laws.improve(nodes, relaxation_->support(), longest, end, damage);
      }
      if (!(best <= near_laws))
        throw StepRejected(fmt::format(
            "no equilibrium was found on the path after the load time {:.6g}: "
            "springs in place of the laws still change by {:.2e}",
            start, best));
      damage = best_damage;
      end = best_end;
    }
    laws.set_damage(damage);
    respond(old, end.load_time, aside, q, work);
    // other points may be joined now than in the best round
    control.alone = false;
    const auto again = laws.end(control);
    change = laws.follow(end.load_time, damage);
    if (!again.found ||
        !(std::abs(again.load_time - end.load_time) <=
          no_increment * longest) ||
        !(change <= 10. * near_laws))
      throw StepRejected(fmt::format(
          "no equilibrium was found on the path after the load time {:.6g}: "
          "points open and close in turn",
          start));
    const auto dissipated = laws.dissipated(end.load_time);
    if (!elastic && end.load_time < start - no_increment * longest &&
        !(dissipated.sum > near_laws * dissipation))
      throw StepRejected(fmt::format(
          "no equilibrium was found on the path after the load time {:.6g}: "
          "nothing is dissipated where the loads run backwards",
          start));
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

  template void EquilibriumSearch<2>::take(const State &, double,
                                           const std::vector<double> &,
                                           State &);
  template void EquilibriumSearch<3>::take(const State &, double,
                                           const std::vector<double> &,
                                           State &);
  template bool EquilibriumSearch<2>::settle_springs(std::vector<double> &,
                                                     StepReport &);
  template bool EquilibriumSearch<3>::settle_springs(std::vector<double> &,
                                                     StepReport &);
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
