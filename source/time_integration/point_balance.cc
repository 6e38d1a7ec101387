#include "point_balance.h"

#include "common_balance.h"
#include "step_data.h"

#include "nonsmooth/healing.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  /** Something that a point does takes time. */
  template <int dim>
  bool has_rates(const SceneInput &input, const OneStepProblem<dim> &problem)
  {
    return has_opening_viscosity(input) ||
           std::any_of(problem.interactions.begin(), problem.interactions.end(),
                       [](const Interaction &interaction) {
                         return interaction.law &&
                                interaction.law->rate_dependent();
                       });
  }

  namespace
  {
    /** Not those whose energy is one of the bodies, or of other points. */
    std::vector<unsigned int> with_energy(const State &old)
    {
      std::vector<unsigned int> points;
      for (std::size_t i = 0; i < old.kind.size(); ++i)
        if (has_impulse(old.kind[i]))
          points.push_back(unsigned(i));
      return points;
    }
  } // namespace

  template <int dim>
  PointBalance<dim>::PointBalance(const Discretization<dim> &discretization,
                                  const UniquenessBound<dim> &uniqueness,
                                  const OneStepProblem<dim> &problem,
                                  const LawEvaluation<dim> &evaluation,
                                  const std::vector<PointOrigin> &origins,
                                  const double work_theta, const State &old,
                                  State &next)
      : points(with_energy(old)),
        n_owned(std::size_t(
            std::lower_bound(points.begin(), points.end(), problem.n_owned) -
            points.begin())),
        n_rows(has_rates(discretization.input(), problem) ? viscous + 1
                                                          : viscous),
        terms(n_rows * n_owned, 0.),
        reactions(discretization.driven_boundaries().size() * dim * n_owned,
                  0.),
        discretization_(discretization), uniqueness_(uniqueness),
        problem_(problem), evaluation_(evaluation), origins_(origins),
        work_theta_(work_theta), old_(old), next_(next)
  {
    next.heat.of_points.assign(
        discretization.input().has_heat() ? old.kind.size() : 0, 0.);
    carry_history(old, next);
    next.dilated = old.dilated;
    next.worn = old.worn;
    next.dilation_speed.assign(old.dilated.size(), 0.);
    next.wear_speed.assign(old.dilated.size(), 0.);
  }

  template <int dim>
  void PointBalance<dim>::add()
  {
    for (place_ = 0; place_ < points.size(); ++place_)
      add(std::size_t(points[place_]));
    if (!has_healing(problem_))
      return;
    for (place_ = 0; place_ < points.size(); ++place_)
      if (may_heal(problem_, points[place_]))
        heal(std::size_t(points[place_]));
  }

  template <int dim>
  void PointBalance<dim>::add(const std::size_t i)
  {
    Vector U, U_theta;
    for (unsigned int c = 0; c < dim; ++c) {
      const double P = next_.impulse[i * dim + c];
      const double square = (c == 0 ? problem_.majorant_normal
                                    : problem_.majorant_tangential)[i] *
                            P * P;
      put(impulses, square);
      if (problem_.kind[i] == PointKind::prescribed)
        put(of_rows, square);
      U[c] = next_.relative_velocity[i * dim + c];
      U_theta[c] = work_theta_ * U[c] +
                   (1. - work_theta_) * old_.relative_velocity[i * dim + c];
    }
    if (problem_.kind[i] == PointKind::prescribed) {
      add_prescribed(i, U_theta);
      return;
    }
    const auto energies =
        point_energies<dim>(problem_, i, U, evaluation_.solutions[i].frozen);
    add_law(i, U_theta, energies);
    keep_history(i, energies);
    add_penetration(i);
  }

  template <int dim>
  void PointBalance<dim>::add_prescribed(const std::size_t i,
                                         const Vector &U_theta)
  {
    const double *P = &next_.impulse[i * dim];
    double power = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      power += P[c] * U_theta[c];
    const PointOrigin origin = origins_[i];
    if (origin.kind == PointOrigin::Kind::motion) {
      put(motion, power);
      double beyond = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        beyond += P[c] * (next_.relative_velocity[i * dim + c] -
                          problem_.given_velocity[i * dim + c]);
      put(support, -work_theta_ * beyond);
      const auto &driven = discretization_.driven_boundaries();
      const std::size_t d =
          std::find(driven.begin(), driven.end(), origin.block) -
          driven.begin();
      if (place_ < n_owned)
        for (unsigned int c = 0; c < dim; ++c)
          reactions[(d * dim + c) * n_owned + place_] =
              P[c] / problem_.time_step;
    } else {
      // the first step closes what jump of velocities the scene began with; all
      // others only have what the solver leaves
      const double *U_old = &old_.relative_velocity[i * dim];
      const bool closes = old_.last_step == 0. &&
                          std::any_of(U_old, U_old + dim,
                                      [](const double U) { return U != 0.; });
      put(closes ? impact : numerical, -power);
      put(joint, closes ? 0. : -power);
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        square += next_.jump[i * dim + c] * next_.jump[i * dim + c];
      drift = std::max(drift, std::sqrt(square));
    }
  }

  template <int dim>
  void PointBalance<dim>::add_law(const std::size_t i, const Vector &U_theta,
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
      put(numerical, -residual);
    } else {
      const bool closed = solution.contact_impulse > 0.;
      const double lift = closed ? add_lift(i) : 0.;
      if (closed)
        put(impact, -contact[0] * (U_theta[0] - lift));
      else
        residual += contact[0] * U_theta[0];
      double rubbing = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        rubbing += contact[c] * U_theta[c];
      if (solution.frozen.threshold > 0. || lift != 0.) {
        // climbing takes from what rubs, wear adds to it
        put(friction, -rubbing - contact[0] * lift);
        put(positive_friction, rubbing > 0. ? rubbing : 0.);
      } else
        residual += rubbing;
      put(numerical, -residual);
      next_.contact[i] = closed;
      if (closed) {
        double square = 0.;
        for (unsigned int c = 1; c < dim; ++c) {
          const double step = moved(i * dim + c);
          square += step * step;
        }
        next_.slip[i] += std::sqrt(square);
      }
      if (place_ < n_owned && (closed || solution.damages))
        ++active;
    }

    const double dissipated = w * energies.damage;
    put(stored, w * energies.stored);
    put(damage, dissipated);
    // -w h R.U_theta = -w (d psi + d D + N)
    double spent =
        w * (energies.stored + energies.overlap_released - energies.stored_old);
    if (energies.viscous > 0.) {
      put(viscous, w * energies.viscous);
      spent += w * energies.viscous;
      viscous_traction = std::max(viscous_traction, energies.viscous_traction);
    }
    put(numerical, -cohesive_work - spent - dissipated);
    put(numerical, w * energies.overlap_released);
  }

  /**
   * Dilatancy and wear of a closed point, moved by the theta rule as the
   * jump is. @return the mean speed of the lift
   */
  template <int dim>
  double PointBalance<dim>::add_lift(const std::size_t i)
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
  void PointBalance<dim>::keep_history(const std::size_t i,
                                       const PointEnergies<dim> &energies)
  {
    const auto &solution = evaluation_.solutions[i];
    const bool breaks = record_damage<dim>(
        energies, i, problem_.kind[i] == PointKind::rigid && solution.damages,
        old_, next_);
    if (breaks)
      put(broken, problem_.weight[i]);
    if (problem_.kind[i] != PointKind::cohesive &&
        problem_.kind[i] != PointKind::rigid)
      return;
    // a softening point in a step above the uniqueness bound
    const auto &law = *problem_.interactions[problem_.interaction[i]].law;
    if (solution.damages &&
        past_peak(law, problem_.opening_factor[i], energies.history))
      beyond_unique |= uniqueness_.ratio(problem_, i, problem_.time_step) >= 1.;
  }

  /** At the end of the step, under its mean pressure. */
  template <int dim>
  void PointBalance<dim>::heal(const std::size_t i)
  {
    if (!next_.contact[i] || (next_.kind[i] != PointKind::cohesive &&
                              next_.kind[i] != PointKind::free))
      return;
    const double w = problem_.weight[i], h = problem_.time_step;
    double *jump = &next_.jump[i * dim];
    const Healing healing =
        healing_of<dim>(problem_, i, next_.beta[i], next_.opening_max[i], jump,
                        evaluation_.solutions[i].contact_impulse / (w * h), h);
    if (!healing.heals)
      return;
    put(stored, -w * healing.dissipated);
    put(damage, w * healing.dissipated);
    next_.kind[i] = PointKind::cohesive;
    next_.opening_max[i] = healing.opening_max;
    next_.beta[i] = healing.beta;
    for (unsigned int c = 1; c < dim; ++c)
      jump[c] *= healing.slip_share;
  }

  /**
   * Penetration against its bound: the overlap of the spring where it turned
   * into a contact, and h times the largest approach speed at an activation.
   * In every step the solver leaves R (P - P*) of the velocity that the law
   * asks for. A point that was forecast to stay open may have come in during
   * the last step, with the speed of its end: then that step counts, and the
   * part of this one that is before its impact. One that was parting from an
   * overlap and is pushed back comes on top of it.
   */
  template <int dim>
  void PointBalance<dim>::add_penetration(const std::size_t i)
  {
    if (next_.two_sided[i])
      return;
    const double h = problem_.time_step;
    const double depth =
        (next_.dilated.empty() ? 0. : next_.dilated[i] - next_.worn[i]) -
        next_.jump[i * dim];
    double &released = next_.released_overlap[i], &approach = next_.approach[i];
    if (old_.two_sided[i])
      released = std::max(released, depth);
    if (problem_.contact[i]) {
      const bool came_in = !old_.contact[i] && old_.jump[i * dim] < 0.;
      const double way =
          came_in ? std::max(h, old_.last_step + (1. - problem_.theta) * h) : h;
      approach = std::max(approach, -way * old_.relative_velocity[i * dim]);
    } else if (depth > 0.) // the forecast did not see it come
      approach = std::max(approach, std::max(0., -old_.jump[i * dim]) -
                                        h * next_.relative_velocity[i * dim]);
    approach +=
        h * problem_.majorant_normal[i] * std::abs(evaluation_.defect[i * dim]);
    penetration = std::max(penetration, depth);
    // speeds change within a step: bounds hold to first order in its length
    excess = std::max(excess, depth - 1.001 * (released + approach));
  }

#define INSTANTIATE(dim)                                                       \
  template bool has_rates<dim>(const SceneInput &,                             \
                               const OneStepProblem<dim> &);                   \
  template class PointBalance<dim>

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
