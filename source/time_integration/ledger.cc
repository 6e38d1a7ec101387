#include "ledger.h"

#include "common_books.h"
#include "step_data.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Sums over the points. */
    enum PointRow {
      stored,
      damage,
      friction,
      positive_friction,
      impact,
      numerical,
      motion,
      broken,
      joint,    ///< work of rows of joints, a part of impact or numerical
      support,  ///< of supports beyond their prescribed velocity, of the work
      impulses, ///< sum R P^2, R the majorants: what the residual relates to
      viscous   ///< only where a point of the scene has_rates()
    };

    /** All points of one step, one after the other. */
    template <int dim>
    class PointBook
    {
    public:
      PointBook(const Discretization<dim> &discretization,
                const UniquenessBound<dim> &uniqueness,
                const OneStepProblem<dim> &problem,
                const LawEvaluation<dim> &evaluation,
                const std::vector<PointOrigin> &origins, double work_theta,
                const State &old, State &next);

      void book(std::size_t point);

      std::size_t n_owned;
      unsigned int n_rows;
      std::vector<double> terms;     ///< n_rows of n_owned
      std::vector<double> reactions; ///< the same, dim rows per boundary
      double penetration = 0., excess = 0., drift = 0., viscous_traction = 0.;
      unsigned int active = 0;
      bool beyond_unique = false;

      /** The own point that gave most in a row, or none. */
      std::size_t worst(const PointRow row) const
      {
        if (n_owned == 0)
          return LineChanges::no_point;
        const auto first = terms.begin() + long(row * n_owned);
        const auto least = std::min_element(first, first + long(n_owned));
        return *least < 0. ? std::size_t(least - first) : LineChanges::no_point;
      }

    private:
      using Vector = std::array<double, dim>;

      void put(const PointRow row, const std::size_t i, const double value)
      {
        if (i < n_owned)
          terms[row * n_owned + i] += value;
      }
      /** By the rule of the positions. */
      double moved(const std::size_t k) const
      {
        const double theta = problem_.theta;
        return problem_.time_step * (theta * next_.relative_velocity[k] +
                                     (1. - theta) * old_.relative_velocity[k]);
      }
      void book_prescribed(std::size_t i, const Vector &U_theta);
      void book_law(std::size_t i, const Vector &U_theta,
                    const PointEnergies<dim> &energies);
      double book_lift(std::size_t i);
      void remember(std::size_t i, const PointEnergies<dim> &energies);
      void book_penetration(std::size_t i);

      const Discretization<dim> &discretization_;
      const UniquenessBound<dim> &uniqueness_;
      const OneStepProblem<dim> &problem_;
      const LawEvaluation<dim> &evaluation_;
      const std::vector<PointOrigin> &origins_;
      const double work_theta_; ///< of the velocity that impulses work with
      const State &old_;
      State &next_;
    };

    /** Something that a point does takes time. */
    template <int dim>
    bool has_rates(const SceneInput &input, const OneStepProblem<dim> &problem)
    {
      return has_opening_viscosity(input) ||
             std::any_of(
                 problem.interactions.begin(), problem.interactions.end(),
                 [](const Interaction &interaction) {
                   return interaction.law && interaction.law->rate_dependent();
                 });
    }

    template <int dim>
    PointBook<dim>::PointBook(const Discretization<dim> &discretization,
                              const UniquenessBound<dim> &uniqueness,
                              const OneStepProblem<dim> &problem,
                              const LawEvaluation<dim> &evaluation,
                              const std::vector<PointOrigin> &origins,
                              const double work_theta, const State &old,
                              State &next)
        : n_owned(problem.n_owned),
          n_rows(has_rates(discretization.input(), problem) ? viscous + 1
                                                            : viscous),
          terms(n_rows * n_owned, 0.),
          reactions(discretization.driven_boundaries().size() * dim * n_owned,
                    0.),
          discretization_(discretization), uniqueness_(uniqueness),
          problem_(problem), evaluation_(evaluation), origins_(origins),
          work_theta_(work_theta), old_(old), next_(next)
    {
      carry_history(old, next);
      next.dilated = old.dilated;
      next.worn = old.worn;
      next.dilation_speed.assign(old.dilated.size(), 0.);
      next.wear_speed.assign(old.dilated.size(), 0.);
    }

    template <int dim>
    void PointBook<dim>::book(const std::size_t i)
    {
      if (old_.kind[i] == PointKind::bonded ||
          old_.kind[i] == PointKind::parted)
        return; // its energy is one of the bodies, or of other points
      Vector U, U_theta;
      for (unsigned int c = 0; c < dim; ++c) {
        const double P = next_.impulse[i * dim + c];
        put(impulses, i,
            (c == 0 ? problem_.majorant_normal
                    : problem_.majorant_tangential)[i] *
                P * P);
        U[c] = next_.relative_velocity[i * dim + c];
        U_theta[c] = work_theta_ * U[c] +
                     (1. - work_theta_) * old_.relative_velocity[i * dim + c];
      }
      if (problem_.kind[i] == PointKind::prescribed) {
        book_prescribed(i, U_theta);
        return;
      }
      const auto energies =
          point_energies<dim>(problem_, i, U, evaluation_.solutions[i].frozen);
      book_law(i, U_theta, energies);
      remember(i, energies);
      book_penetration(i);
    }

    template <int dim>
    void PointBook<dim>::book_prescribed(const std::size_t i,
                                         const Vector &U_theta)
    {
      const double *P = &next_.impulse[i * dim];
      double power = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        power += P[c] * U_theta[c];
      const PointOrigin origin = origins_[i];
      if (origin.kind == PointOrigin::Kind::motion) {
        put(motion, i, power);
        double beyond = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          beyond += P[c] * (next_.relative_velocity[i * dim + c] -
                            problem_.given_velocity[i * dim + c]);
        put(support, i, -work_theta_ * beyond);
        const auto &driven = discretization_.driven_boundaries();
        const std::size_t d =
            std::find(driven.begin(), driven.end(), origin.block) -
            driven.begin();
        if (i < n_owned)
          for (unsigned int c = 0; c < dim; ++c)
            reactions[(d * dim + c) * n_owned + i] = P[c] / problem_.time_step;
      } else {
        // the first step closes what jump of velocities the scene began with;
        // later ones only have what the solver leaves
        const bool closes = old_.last_step == 0.;
        put(closes ? impact : numerical, i, -power);
        put(joint, i, closes ? 0. : -power);
        double square = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          square += next_.jump[i * dim + c] * next_.jump[i * dim + c];
        drift = std::max(drift, std::sqrt(square));
      }
    }

    template <int dim>
    void PointBook<dim>::book_law(const std::size_t i, const Vector &U_theta,
                                  const PointEnergies<dim> &energies)
    {
      const double w = problem_.weight[i], h = problem_.time_step;
      const double *P = &next_.impulse[i * dim];
      const auto &solution = evaluation_.solutions[i];
      // contact part by the law, what is left over is the solver's residual
      double cohesive_work = 0., residual = 0.;
      Vector contact{};
      for (unsigned int c = 0; c < dim; ++c) {
        const double pull = w * h * energies.cohesive_traction[c];
        cohesive_work += -pull * U_theta[c];
        contact[c] = P[c] + pull;
      }
      if (problem_.kind[i] == PointKind::rigid && !solution.damages) {
        for (unsigned int c = 0; c < dim; ++c)
          residual += contact[c] * U_theta[c];
        put(numerical, i, -residual);
      } else {
        const bool closed = solution.contact_impulse > 0.;
        const double lift = closed ? book_lift(i) : 0.;
        if (closed)
          put(impact, i, -contact[0] * (U_theta[0] - lift));
        else
          residual += contact[0] * U_theta[0];
        double rubbing = 0.;
        for (unsigned int c = 1; c < dim; ++c)
          rubbing += contact[c] * U_theta[c];
        if (solution.frozen.threshold > 0. || lift != 0.) {
          // climbing takes from what rubs, wear adds to it
          put(friction, i, -rubbing - contact[0] * lift);
          put(positive_friction, i, rubbing > 0. ? rubbing : 0.);
        } else
          residual += rubbing;
        put(numerical, i, -residual);
        next_.contact[i] = closed;
        if (closed) {
          double square = 0.;
          for (unsigned int c = 1; c < dim; ++c) {
            const double step = moved(i * dim + c);
            square += step * step;
          }
          next_.slip[i] += std::sqrt(square);
        }
        if (i < n_owned && (closed || solution.damages))
          ++active;
      }

      const double dissipated = w * energies.damage;
      put(stored, i, w * energies.stored);
      put(damage, i, dissipated);
      // -w h R.U_theta = -w (d psi + d D + N)
      double spent = w * (energies.stored + energies.overlap_released -
                          energies.stored_old);
      if (energies.viscous > 0.) {
        put(viscous, i, w * energies.viscous);
        spent += w * energies.viscous;
        viscous_traction =
            std::max(viscous_traction, energies.viscous_traction);
      }
      put(numerical, i, -cohesive_work - spent - dissipated);
      put(numerical, i, w * energies.overlap_released);
    }

    /**
     * Dilatancy and wear of a closed point, moved by the theta rule as the
     * jump is. @return the mean speed of the lift
     */
    template <int dim>
    double PointBook<dim>::book_lift(const std::size_t i)
    {
      if (next_.dilated.empty())
        return 0.;
      const double h = problem_.time_step, theta = problem_.theta;
      const auto &solution = evaluation_.solutions[i];
      const double speed = sliding_speed<dim>(problem_, i, solution.velocity);
      const double up = std::min(problem_.dilatancy[i] * speed,
                                 problem_.lift_left[i] / (h * theta));
      next_.dilation_speed[i] = up;
      next_.wear_speed[i] = up - solution.frozen.lift;
      const double mean_up = theta * up + (1. - theta) * old_.dilation_speed[i],
                   mean_wear = theta * next_.wear_speed[i] +
                               (1. - theta) * old_.wear_speed[i];
      next_.dilated[i] += h * mean_up;
      next_.worn[i] += h * mean_wear;
      return mean_up - mean_wear;
    }

    template <int dim>
    void PointBook<dim>::remember(const std::size_t i,
                                  const PointEnergies<dim> &energies)
    {
      const auto &solution = evaluation_.solutions[i];
      const bool breaks = remember_damage<dim>(
          energies, i, problem_.kind[i] == PointKind::rigid && solution.damages,
          old_, next_);
      if (breaks)
        put(broken, i, problem_.weight[i]);
      if (problem_.kind[i] != PointKind::cohesive &&
          problem_.kind[i] != PointKind::rigid)
        return;
      // a softening point in a step above the uniqueness bound
      const auto &law = *problem_.interactions[problem_.interaction[i]].law;
      if (solution.damages &&
          past_peak(law, problem_.opening_factor[i], energies.history))
        beyond_unique |=
            uniqueness_.ratio(problem_, i, problem_.time_step) >= 1.;
    }

    /**
     * Penetration against its bound: the overlap of the spring where it turned
     * into a contact, and h times the largest approach speed at an activation.
     * In every step the solver leaves R (P - P*) of the velocity that the law
     * asks for. A point that was forecast to stay open may have come in during
     * the last step, with the speed of its end: then the longer of the two
     * steps counts.
     */
    template <int dim>
    void PointBook<dim>::book_penetration(const std::size_t i)
    {
      if (next_.two_sided[i] || old_.kind[i] == PointKind::bonded)
        return;
      const double h = problem_.time_step;
      const double depth =
          (next_.dilated.empty() ? 0. : next_.dilated[i] - next_.worn[i]) -
          next_.jump[i * dim];
      double &released = next_.released_overlap[i],
             &approach = next_.approach[i];
      if (old_.two_sided[i])
        released = std::max(released, depth);
      if (problem_.contact[i]) {
        const bool came_in = !old_.contact[i] && old_.jump[i * dim] < 0.;
        const double way = came_in ? std::max(h, old_.last_step) : h;
        approach = std::max(approach, -way * old_.relative_velocity[i * dim]);
      } else if (depth > 0.) // the forecast did not see it come
        approach = std::max(approach, -h * next_.relative_velocity[i * dim]);
      approach += h * problem_.majorant_normal[i] *
                  std::abs(evaluation_.defect[i * dim]);
      penetration = std::max(penetration, depth);
      // speeds change within a step: bounds hold to first order in its length
      excess = std::max(excess, depth - 1.001 * (released + approach));
    }
  } // namespace

  template <int dim>
  Ledger<dim>::Ledger(const SceneInput &input,
                      const Discretization<dim> &discretization,
                      const Dynamics<dim> &dynamics,
                      const UniquenessBound<dim> &uniqueness)
      : discretization_(discretization), dynamics_(dynamics),
        uniqueness_(uniqueness), theta_(input.time.work_theta()),
        reactions_(discretization.driven_boundaries().size() * dim, 0.)
  {
  }

  /**
   * Energies, what theta > 1/2 and viscosity take, and the work of the loads.
   */
  template <int dim>
  BodyEnergies Ledger<dim>::book_bodies(const std::vector<double> &forces,
                                        const double h, const State &old,
                                        const State &next,
                                        const ElasticForces<dim> *elastic) const
  {
    using Operator = typename Dynamics<dim>::Operator;
    const auto &communicator = dynamics_.communicator();
    const std::size_t n = next.velocity.size();
    const double kick = discretization_.input().time.kick(h, old.last_step);
    // row by row: all terms of all rows at once would be the largest thing of
    // the whole step
    std::vector<double> terms(n), change;
    BodyEnergies result;
    const auto energy = [&](const Operator op, const std::vector<double> &x) {
      dynamics_.apply(op, x.data(), terms.data());
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
      result.of_strain = symplectic_share(kick, *elastic, old, next);
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
    if (dynamics_.is_viscous()) {
      change.resize(n);
      for (std::size_t i = 0; i < n; ++i)
        change[i] = theta_ * next.velocity[i] + (1. - theta_) * old.velocity[i];
      result.viscous = h * energy(Operator::damping, change);
    }
    if (discretization_.has_loads()) {
      for (std::size_t i = 0; i < n; ++i)
        terms[i] =
            kick * forces[i] *
            (theta_ * next.velocity[i] + (1. - theta_) * old.velocity[i]);
      result.work = communicator.sum(terms);
    }
    return result;
  }

  /**
   * What the bodies take from k v.K q_k of the mean velocity, k the kick,
   * beyond their own change of energy: (k (v_k + v)/2 - dq).K q_k - dq.K dq
   * / 2. It comes and goes.
   */
  template <int dim>
  double Ledger<dim>::symplectic_share(const double kick,
                                       const ElasticForces<dim> &elastic,
                                       const State &old,
                                       const State &next) const
  {
    const std::size_t n = next.velocity.size();
    std::vector<double> terms(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double dq = next.displacement[i] - old.displacement[i],
                   before = elastic.at_start()[i], after = elastic.at_end()[i];
      terms[i] =
          before * (kick / 2. * (old.velocity[i] + next.velocity[i]) - dq) -
          dq * (after - before) / 2.;
    }
    return dynamics_.communicator().sum(terms);
  }

  /** w h p U_theta,N of the pressure in cracks. */
  template <int dim>
  double Ledger<dim>::pressure_work(const OneStepProblem<dim> &problem,
                                    const State &old, const State &next) const
  {
    std::vector<double> terms(problem.n_owned);
    for (std::size_t i = 0; i < problem.n_owned; ++i)
      terms[i] = problem.weight[i] * problem.time_step * next.pressure[i] *
                 (theta_ * next.relative_velocity[i * dim] +
                  (1. - theta_) * old.relative_velocity[i * dim]);
    return dynamics_.communicator().sum(terms);
  }

  template <int dim>
  void Ledger<dim>::book(const OneStepProblem<dim> &problem,
                         const LawEvaluation<dim> &evaluation,
                         const std::vector<PointOrigin> &origins,
                         const BodyEnergies &bodies, const State &old,
                         State &next, StepReport &report)
  {
    const auto &communicator = dynamics_.communicator();
    PointBook<dim> points(discretization_, uniqueness_, problem, evaluation,
                          origins, theta_, old, next);
    for (std::size_t i = 0; i < problem.n_points; ++i)
      points.book(i);
    const auto sums =
        communicator.sums(points.terms.data(), points.n_rows, points.n_owned);
    if (!reactions_.empty())
      reactions_ = communicator.sums(points.reactions.data(), reactions_.size(),
                                     points.n_owned);

    EnergyLines &energy = next.energy;
    energy = old.energy;
    energy.kinetic = bodies.kinetic;
    energy.elastic = bodies.elastic;
    energy.cohesive = sums[stored];
    energy.damage += sums[damage];
    energy.friction += sums[friction];
    energy.impact += sums[impact];
    if (has_rates(discretization_.input(), problem))
      energy.viscous += sums[viscous];
    energy.plastic += bodies.plastic;
    energy.viscous += bodies.viscous;
    if (has_opening_viscosity(discretization_.input())) {
      next.viscous_traction =
          std::max(old.viscous_traction.value_or(0.),
                   communicator.max(points.viscous_traction));
    }
    energy.numerical += sums[numerical] + bodies.of_mass + bodies.of_strain;
    energy.work += sums[motion] + bodies.work;
    next.pressure_work = old.pressure_work;
    if (has_crack_pressure(discretization_.input())) {
      const double work = pressure_work(problem, old, next);
      energy.work += work;
      next.pressure_work += work;
    }
    next.broken_area = old.broken_area + sums[broken];
    next.positive_friction_work =
        old.positive_friction_work + sums[positive_friction];
    next.initial_energy = old.initial_energy;
    next.penetration =
        std::max(old.penetration, communicator.max(points.penetration));
    next.penetration_excess =
        std::max(old.penetration_excess, communicator.max(points.excess));
    next.rigid_drift =
        std::max(old.rigid_drift, communicator.max(points.drift));
    report.active = unsigned(communicator.sum_integer(points.active));
    report.beyond_unique = communicator.any(points.beyond_unique);

    report.changes.impulses = sums[impulses];
    const auto set = [&](const WatchedLine line, const double taken,
                         const std::size_t worst) {
      report.changes.taken[std::size_t(line)] = taken;
      report.changes.worst[std::size_t(line)] = worst;
    };
    set(WatchedLine::friction, sums[friction], points.worst(friction));
    set(WatchedLine::damage, sums[damage], points.worst(damage));
    set(WatchedLine::impact, sums[impact], points.worst(impact));
    set(WatchedLine::viscous, energy.viscous - old.energy.viscous,
        LineChanges::no_point);
    set(WatchedLine::plastic, bodies.plastic, LineChanges::no_point);
    set(WatchedLine::joints, sums[joint], points.worst(joint));
    set(WatchedLine::supports, sums[support], points.worst(support));
    set(WatchedLine::scheme, energy.numerical - old.energy.numerical,
        points.worst(numerical));

    close_books(old, next, report);
  }

  template class Ledger<2>;
  template class Ledger<3>;
} // namespace nsfd
