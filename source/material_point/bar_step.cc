#include "bar.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/scene/time_input.h"

#include <algorithm>

namespace nsfd
{
  BarStep::BarStep(const Interaction &interaction, const Bar &bar) : bar_(bar)
  {
    const CohesiveLaw &law = *interaction.law;
    resize(problem_, 1);
    problem_.n_owned = 1;
    problem_.theta = bar.theta;
    problem_.rule = bar.rule;
    problem_.interactions = {interaction};
    problem_.kind = {law.extrinsic() ? PointKind::rigid : PointKind::cohesive};
    problem_.weight = {1.};
    if (bar.viscosity > 0.)
      problem_.viscosity = {bar.viscosity};
    if (!law.extrinsic())
      problem_.opening_max = {law.elastic_limit()};
    if (law.mixed())
      problem_.slip_max = {0.};
  }

  void BarStep::set_state(const double opening, const double velocity)
  {
    problem_.jump_old[0] = opening;
    velocity_ = velocity;
    problem_.opening_max[0] = std::max(problem_.opening_max[0], opening);
    if (opening > 0.)
      problem_.kind[0] = PointKind::cohesive;
  }

  LocalSolution<2> BarStep::solve(const double h, const double grip_old,
                                  const double grip, const double start)
  {
    const double theta = bar_.theta, k = bar_.stiffness, u = opening();
    h_ = h;
    grip_theta_ = (1. - theta) * grip_old + theta * grip;
    problem_.time_step = h;
    problem_.jump_free[0] = u + h * (1. - theta) * velocity_;
    // a broken or pressed point may close, an overlap never grows
    problem_.contact[0] = u + 0.5 * h * velocity_ <= 0.;
    problem_.target[0] =
        velocity_ > 0. ? -(1. - theta) / theta * velocity_ : 0.;

    const double mass = bar_.mass + h * h * theta * theta * k;
    const double free =
        velocity_ + h * (k * (grip_theta_ - u - h * theta * velocity_)) / mass;
    problem_.free_velocity[0] = free;
    problem_.majorant_normal[0] = problem_.majorant_tangential[0] = 1. / mass;
    return solve_point<2>(problem_, 0, {free, 0.}, 1. / mass, 1. / mass,
                          {start, 0.});
  }

  double BarStep::end_opening(const LocalSolution<2> &solution) const
  {
    return problem_.jump_free[0] + h_ * bar_.theta * solution.velocity[0];
  }

  /** Of the cohesion rule over a step that ends at @p end, from its formula. */
  double BarStep::traction(const double end) const
  {
    const CohesiveLaw &law = *problem_.interactions[0].law;
    const double u = opening(), d_m = largest_opening();
    const bool is_rigid = problem_.kind[0] == PointKind::rigid;
    const double b_m = is_rigid ? 0. : law.secant(d_m);
    if (problem_.rule != CohesionRule::exact) {
      const double seen =
          problem_.rule == CohesionRule::end_point
              ? end
              : u + (end - problem_.jump_free[0]) / problem_.theta;
      return end > d_m ? law.traction(end) * seen / end : b_m * seen;
    }
    // mean of the traction between u and the end, unloading up to d_m
    if (end <= d_m)
      return b_m * (end + u) / 2.;
    return (b_m * (d_m - u) * (d_m + u) / 2. + law.energy_increment(d_m, end)) /
           (end - u);
  }

  unsigned int BarStep::count_solutions() const
  {
    const double R = problem_.majorant_normal[0], reach = h_ * bar_.theta,
                 last =
                     problem_.jump_free[0] + reach * problem_.free_velocity[0];
    if (last <= 0.)
      return 1;
    const auto excess = [&](const double end) {
      return last - reach * R * h_ * traction(end) - end;
    };
    // held at 0 or pressed; broken
    unsigned int n = 0;
    constexpr unsigned int n_samples = 4000;
    bool above = excess(1e-9 * last) > 0.;
    n += above ? 0 : 1;
    for (unsigned int i = 1; i <= n_samples; ++i) {
      const bool next = i < n_samples && excess(i * last / n_samples) > 0.;
      n += next != above ? 1 : 0;
      above = next;
    }
    return n;
  }

  void BarStep::accept(const LocalSolution<2> &solution, const double grip,
                       BarRow &row)
  {
    const PointEnergies<2> energies =
        point_energies<2>(problem_, 0, solution.velocity, solution.frozen);
    const double theta = bar_.theta, k = bar_.stiffness;
    const double u_old = opening(), u = end_opening(solution);
    const double u_theta = (1. - theta) * u_old + theta * u;
    row.work += k * (grip_theta_ - u_theta) * (grip - row.grip);
    row.time += h_;
    row.grip = grip;
    row.opening = u;
    row.pull = k * (grip - u);
    row.elastic = 0.5 * k * (grip - u) * (grip - u);
    // without mass, the step sees the velocity only through its mean
    velocity_ = bar_.mass > 0. ? solution.velocity[0] : (u - u_old) / h_;
    row.velocity = velocity_;
    row.kinetic = 0.5 * bar_.mass * velocity_ * velocity_;
    row.beta = energies.beta;
    row.stored = energies.stored;
    row.damage += energies.damage;
    row.viscous += energies.viscous;

    problem_.jump_old[0] = u;
    problem_.opening_max[0] = energies.history.opening;
    if (!problem_.slip_max.empty())
      problem_.slip_max[0] = energies.history.slip;
    // unlike `free`, a broken cohesive point keeps its viscosity: without
    // mass something has to hold it back
    if (problem_.kind[0] == PointKind::rigid && solution.damages)
      problem_.kind[0] = PointKind::cohesive;
    const CohesiveLaw &law = *problem_.interactions[0].law;
    row.cohesion = problem_.kind[0] == PointKind::rigid
                       ? row.pull
                       : law.secant(energies.history.opening) * std::max(u, 0.);
  }
} // namespace nsfd
