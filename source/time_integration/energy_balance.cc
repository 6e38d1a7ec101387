#include "energy_balance.h"

#include "discretization/loads.h"

#include "common_balance.h"
#include "point_balance.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd
{
  template <int dim>
  EnergyBalance<dim>::EnergyBalance(const SceneInput &input,
                                    const Discretization<dim> &discretization,
                                    const DelassusOperator<dim> &delassus,
                                    const UniquenessBound<dim> &uniqueness)
      : discretization_(discretization), delassus_(delassus),
        uniqueness_(uniqueness), theta_(input.time.theta),
        reactions_(discretization.driven_boundaries().size() * dim, 0.)
  {
  }

  /**
   * Energies, what theta > 1/2 and viscosity take, and the work of the loads.
   */
  template <int dim>
  BodyEnergies EnergyBalance<dim>::book_bodies(
      const std::vector<double> &forces, const double h, const State &old,
      const State &next, const ElasticForces<dim> *elastic) const
  {
    using Operator = typename DelassusOperator<dim>::Operator;
    const auto &communicator = delassus_.communicator();
    const std::size_t n = next.velocity.size();
    // row by row: all terms of all rows at once would be the largest thing of
    // the whole step
    std::vector<double> terms(n), change;
    BodyEnergies result;
    const auto energy = [&](const Operator op, const std::vector<double> &x) {
      delassus_.apply(op, x.data(), terms.data());
      for (std::size_t i = 0; i < n; ++i)
        terms[i] *= x[i];
      return communicator.sum(terms);
    };
    const auto change_of =
        [&](const std::vector<double> &after,
            const std::vector<double> &before) -> const std::vector<double> & {
      change.resize(n);
      for (std::size_t i = 0; i < n; ++i)
        change[i] = after[i] - before[i];
      return change;
    };
    result.kinetic = 0.5 * energy(Operator::mass, next.velocity);
    if (elastic) {
      for (std::size_t i = 0; i < n; ++i)
        terms[i] = 0.5 * next.displacement[i] * elastic->at_end()[i];
      result.elastic = communicator.sum(terms);
      // the energy that is kept depends on the step
      result.kinetic -= elastic->kinetic_share(next);
      result.of_strain = elastic->share_of_step();
    } else
      result.elastic = 0.5 * energy(Operator::stiffness, next.displacement);
    if (!elastic && theta_ > 0.5) {
      const double share = theta_ - 0.5;
      result.of_mass = share * energy(Operator::mass,
                                      change_of(next.velocity, old.velocity));
      result.of_strain =
          share * energy(Operator::stiffness,
                         change_of(next.displacement, old.displacement));
    }
    if (delassus_.terms().viscous_theta > 0.) {
      change.resize(n);
      for (std::size_t i = 0; i < n; ++i)
        change[i] = theta_ * next.velocity[i] + (1. - theta_) * old.velocity[i];
      result.viscous = h * energy(Operator::damping, change);
    }
    if (discretization_.input().has_absorbing_sides()) {
      result.absorbed = h * absorbed_power(change);
      result.viscous = discretization_.input().has_viscous_bodies()
                           ? result.viscous - result.absorbed
                           : 0.;
    }
    if (discretization_.loads().any()) {
      for (std::size_t i = 0; i < n; ++i)
        terms[i] =
            h * forces[i] *
            (theta_ * next.velocity[i] + (1. - theta_) * old.velocity[i]);
      result.work = communicator.sum(terms);
    }
    return result;
  }

  /** v.C v of the dashpots alone. */
  template <int dim>
  double
  EnergyBalance<dim>::absorbed_power(const std::vector<double> &velocity) const
  {
    const Bodies &bodies = discretization_.bodies();
    std::vector<double> terms(velocity.size(), 0.);
    for (const BodyClass &one : bodies.classes) {
      const Block &C = one.absorbing;
      for (const unsigned int b : one.bodies) {
        const double *const v = &velocity[bodies.first_dof[b]];
        for (unsigned int j = 0; j < C.cols; ++j)
          for (unsigned int i = 0; i < C.rows; ++i)
            terms[bodies.first_dof[b] + i] += v[i] * C(i, j) * v[j];
      }
    }
    return delassus_.communicator().sum(terms);
  }

  /** w h p U_theta,N of the pressure in cracks. */
  template <int dim>
  double EnergyBalance<dim>::pressure_work(const OneStepProblem<dim> &problem,
                                           const State &old,
                                           const State &next) const
  {
    std::vector<double> terms(problem.n_owned);
    for (std::size_t i = 0; i < problem.n_owned; ++i)
      terms[i] = problem.weight[i] * problem.time_step * next.pressure[i] *
                 (theta_ * next.relative_velocity[i * dim] +
                  (1. - theta_) * old.relative_velocity[i * dim]);
    return delassus_.communicator().sum(terms);
  }

  template <int dim>
  void EnergyBalance<dim>::account(const OneStepProblem<dim> &problem,
                                   const LawEvaluation<dim> &evaluation,
                                   const std::vector<PointOrigin> &origins,
                                   const BodyEnergies &bodies, const State &old,
                                   State &next, StepReport &report)
  {
    const auto &communicator = delassus_.communicator();
    using Points = PointBalance<dim>;
    Points points(discretization_, uniqueness_, problem, evaluation, origins,
                  theta_, old, next);
    points.add();
    const auto sums =
        communicator.sums(points.terms.data(), points.n_rows, points.n_owned);
    if (!reactions_.empty())
      reactions_ = communicator.sums(points.reactions.data(), reactions_.size(),
                                     points.n_owned);

    EnergyLines &energy = next.energy;
    energy = old.energy;
    energy.kinetic = bodies.kinetic;
    energy.elastic = bodies.elastic;
    energy.cohesive = sums[Points::stored];
    energy.damage += sums[Points::damage];
    energy.friction += sums[Points::friction];
    energy.impact += sums[Points::impact];
    if (has_rates(discretization_.input(), problem))
      energy.viscous += sums[Points::viscous];
    energy.plastic += bodies.plastic;
    energy.viscous += bodies.viscous;
    energy.absorbed += bodies.absorbed;
    if (has_opening_viscosity(discretization_.input())) {
      next.viscous_traction =
          std::max(old.viscous_traction.value_or(0.),
                   communicator.max(points.viscous_traction));
    }
    energy.numerical +=
        sums[Points::numerical] + bodies.of_mass + bodies.of_strain;
    energy.work += sums[Points::motion] + bodies.work;
    next.pressure_work = old.pressure_work;
    if (has_crack_pressure(discretization_.input())) {
      const double work = pressure_work(problem, old, next);
      energy.work += work;
      next.pressure_work += work;
    }
    next.broken_area = old.broken_area + sums[Points::broken];
    next.positive_friction_work =
        old.positive_friction_work + sums[Points::positive_friction];
    next.initial_energy = old.initial_energy;
    next.penetration =
        std::max(old.penetration, communicator.max(points.penetration));
    next.penetration_excess =
        std::max(old.penetration_excess, communicator.max(points.excess));
    next.rigid_drift =
        std::max(old.rigid_drift, communicator.max(points.drift));
    report.active = unsigned(communicator.sum_integer(points.active));
    report.beyond_unique = communicator.any(points.beyond_unique);

    report.changes.impulses = sums[Points::impulses];
    // a motion of nodes knows U itself
    if (problem.free_motion == FreeVelocity::known)
      report.changes.impulses_of_rows = sums[Points::of_rows];
    const auto set = [&](const WatchedLine line, const double taken,
                         const std::size_t worst) {
      report.changes.taken[std::size_t(line)] = taken;
      report.changes.worst[std::size_t(line)] = worst;
    };
    set(WatchedLine::friction, sums[Points::friction],
        points.worst(Points::friction));
    set(WatchedLine::damage, sums[Points::damage],
        points.worst(Points::damage));
    set(WatchedLine::impact, sums[Points::impact],
        points.worst(Points::impact));
    set(WatchedLine::viscous, energy.viscous - old.energy.viscous,
        LineChanges::no_point);
    set(WatchedLine::plastic, bodies.plastic, LineChanges::no_point);
    set(WatchedLine::joints, sums[Points::joint], points.worst(Points::joint));
    set(WatchedLine::supports, sums[Points::support],
        points.worst(Points::support));
    set(WatchedLine::scheme, energy.numerical - old.energy.numerical,
        points.worst(Points::numerical));

    close_balance(old, next, report);
  }

  template class EnergyBalance<2>;
  template class EnergyBalance<3>;
} // namespace nsfd
