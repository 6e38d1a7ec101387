#include "relaxation.h"

#include "activation.h"
#include "driven_motion.h"
#include "point_name.h"
#include "step_data.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "state/point_fields.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  SceneInput static_scene(const SceneInput &input)
  {
    SceneInput scene = input;
    scene.time.scheme = SchemeTraits();
    scene.time.theta = 1.;
    scene.time.cohesion_rule = CohesionRule::end_point;
    scene.time.contact_target = ContactTarget::position;
    for (auto &block : scene.interfaces)
      block.opening_viscosity = 0.;
    for (auto &material : scene.materials)
      material.shear_viscosity = material.bulk_viscosity = 0.;
    return scene;
  }

  template <int dim>
  Relaxation<dim>::Relaxation(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              DelassusOperator<dim> &delassus,
                              NonsmoothSolver<dim> &solver,
                              JoinedDelassus<dim> *const bonded)
      : input_(input), discretization_(discretization), delassus_(delassus),
        solver_(solver), problem_(constant_data(input, discretization)),
        free_motion_(input, discretization, delassus),
        step_problem_(input, discretization, delassus, counters_),
        balance_(delassus, free_motion_),
        bonds_(bonded
                   ? std::make_unique<StaticBonds<dim>>(
                         discretization, *bonded,
                         input.discretization.degree == 1, problem_, iterate_)
                   : nullptr),
        laws_(discretization, delassus, problem_, iterate_,
              step_problem_.has_extrinsic(), bonds_.get()),
        path_laws_(delassus.communicator(), delassus.points(), problem_,
                   iterate_, laws_, bonds_.get()),
        driven_(input, discretization)
  {
  }

  template <int dim>
  std::string Relaxation<dim>::face(const std::size_t point) const
  {
    return name_of_point<dim>(input_, discretization_.origins(),
                              discretization_.points().position, point);
  }

  template <int dim>
  void Relaxation<dim>::begin(const State &old, const double time,
                              const double duration)
  {
    iterate_.old = &old;
    time_ = time;
    iterate_.at = old;
    std::fill(iterate_.at.velocity.begin(), iterate_.at.velocity.end(), 0.);
    std::fill(iterate_.at.relative_velocity.begin(),
              iterate_.at.relative_velocity.end(), 0.);
    release_zeros(iterate_.at);
    iterate_.force = old.point_force;
    iterate_.force.resize(old.jump.size(), 0.);
    iterate_.activated.assign(old.kind.size(), 0);
    laws_.begin();
    driven_.set(old, time, duration);
    if (support_.empty())
      set_support();
    if (bonds_)
      bonds_->set();
    balance_.begin(old.displacement, iterate_.force, support_, problem_.n_owned,
                   driven_.largest(), input_.statics->tolerance);
    aim(time, duration);
  }

  template <int dim>
  void Relaxation<dim>::aim(const double time, const double duration)
  {
    time_ = time;
    driven_.set(*iterate_.old, time, duration);
    if (free_motion_.set_loads(time, iterate_.old->clock))
      ++counters_.load_assemblies;
    free_motion_.set_pressure(*iterate_.old, time, pressure_);
  }

  /** What counts from the last equilibrium instead of from the iterate. */
  template <int dim>
  void Relaxation<dim>::constrain(const double h)
  {
    auto &problem = problem_;
    const State &old = *iterate_.old;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      const double *u = &iterate_.at.jump[i * dim], *start = &old.jump[i * dim];
      if (old.kind[i] == PointKind::prescribed) {
        for (unsigned int c = 0; c < dim; ++c)
          if (problem.mask[i] & (1u << c))
            problem.given_velocity[i * dim + c] = (driven_.at(i, c) - u[c]) / h;
        continue;
      }
      if (iterate_.at.kind[i] == PointKind::bonded)
        continue;
      for (unsigned int c = 1; c < dim; ++c)
        problem.sliding_offset[i * dim + c] = (u[c] - start[c]) / h;
      double closed = std::min(0., start[0]);
      if (bonds_ && bonds_->is_closed(iterate_.at, i) &&
          iterate_.activated[i] != LoadStepIterate<dim>::opened) {
        problem.kind[i] =
            laws_.holds() ? PointKind::prescribed : PointKind::rigid;
        closed = start[0];
        for (unsigned int c = 0; c < dim; ++c) {
          const std::size_t k = i * dim + c;
          problem.jump_free[k] = problem.jump_old[k] = u[c] - start[c];
          problem.given_velocity[k] = -problem.jump_free[k] / h;
        }
        if (laws_.holds()) {
          problem.mask[i] = std::uint8_t((1u << dim) - 1u);
          continue;
        }
      }
      if (old.kind[i] == PointKind::rigid) {
        // the law counts from the joint, not from its drift
        closed = start[0];
        if (iterate_.activated[i])
          for (unsigned int c = 0; c < dim; ++c)
            problem.jump_free[i * dim + c] = problem.jump_old[i * dim + c] =
                u[c] - start[c];
      }
      if (problem.compression_stiffness[i] == 0.) {
        problem.contact[i] = 1;
        problem.target[i] = (closed - u[0]) / h;
      }
    }
  }

  template <int dim>
  void Relaxation<dim>::set_support()
  {
    const auto &problem = problem_;
    double stiffness = 0.;
    for (unsigned int m = 0; m < input_.materials.size(); ++m)
      stiffness =
          std::max(stiffness, discretization_.extremes(m).stiffest.young);
    stiffness /= discretization_.cell_size();
    support_.resize(problem.n_points);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      double kappa = stiffness;
      const auto &law = problem.interactions[problem.interaction[i]].law;
      if (law && std::isfinite(law->steepest_softening()))
        kappa = std::max(kappa, 2. * problem.strength_factor[i] *
                                    problem.opening_factor[i] *
                                    law->steepest_softening());
      support_[i] = problem.weight[i] * kappa;
    }
  }

  template <int dim>
  void Relaxation<dim>::soften(const double h)
  {
    auto &problem = problem_;
    std::vector<double> least(problem.n_points * dim);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      for (auto *majorant :
           {&problem.majorant_normal, &problem.majorant_tangential})
        (*majorant)[i] = std::min((*majorant)[i], 1. / (h * h * support_[i]));
      for (unsigned int c = 0; c < dim; ++c)
        least[i * dim + c] = 0.03 * (c == 0 ? problem.majorant_normal[i]
                                            : problem.majorant_tangential[i]);
    }
    delassus_.set_least_compliance(std::move(least));
  }

  /** As far as the iterate is open, or the equilibrium before it. */
  template <int dim>
  void Relaxation<dim>::set_start(const std::size_t i, Reach &start) const
  {
    const auto &problem = problem_;
    start = reach_of<dim>(problem.interactions[problem.interaction[i]],
                          &problem.jump_old[i * dim]);
    start.opening = std::max(start.opening, iterate_.at.opening_max[i]);
    if (!iterate_.at.slip_max.empty())
      start.slip = std::max(start.slip, iterate_.at.slip_max[i]);
  }

  template <int dim>
  SolverReport Relaxation<dim>::relax(std::vector<double> &q, const double h,
                                      const double tolerance)
  {
    auto &delassus = delassus_;
    const std::size_t n = q.size();
    iterate_.h = h;
    {
      const Stopwatch watch(timings_.assembly);
      const Charge charge(Cost::free_motion);
      std::vector<double> change(n);
      for (std::size_t k = 0; k < n; ++k)
        change[k] = q[k] - iterate_.old->displacement[k];
      delassus.relative_velocity(change.data(), iterate_.at.jump.data());
      for (std::size_t k = 0; k < iterate_.at.jump.size(); ++k)
        iterate_.at.jump[k] += iterate_.old->jump[k];
      iterate_.at.displacement = q;
      iterate_.at.time = time_ - h;
      if (bonds_)
        bonds_->set();
      delassus.reinit(h, 1.);
      set_step(input_, discretization_, discretization_.origins(), delassus,
               step_problem_.motion(), iterate_.at, h, problem_);
      if (bonds_)
        bonds_->constrain();
      constrain(h);
      laws_.find_joint_loads();
      if (laws_.holds())
        laws_.put_springs();
      soften(h);
      if (bonds_)
        bonds_->start_from_rest(h, free_motion_.loads(),
                                free_motion_.pressure_impulse(pressure_, h), q,
                                balance_.largest_forces());
      else
        free_motion_.move(iterate_.at, pressure_, problem_, {});
    }
    // the floor of the natural map: the largest forces so far
    const double share = std::max(1e-6, 1e-14 / tolerance);
    const double energy_scale = balance_.point_scale() / (share * share);
    LawEvaluation<dim> evaluation(problem_, delassus, energy_scale, tolerance);
    for (std::size_t i = 0; i < iterate_.activated.size(); ++i)
      if (problem_.interactions[problem_.interaction[i]].law)
        set_start(i, evaluation.solutions[i].reach);
    std::vector<double> impulse = iterate_.force;
    for (double &P : impulse)
      P *= h;
    SolverControl control = step_problem_.control(1);
    control.tolerance = tolerance;
    SolverReport report;
    {
      const Stopwatch watch(timings_.solve);
      const Charge charge(Cost::solver);
      report = step_problem_.solve(solver_, problem_, discretization_.origins(),
                                   control, energy_scale, iterate_.at, impulse,
                                   evaluation, laws_.holds());
    }
    const Stopwatch watch(timings_.update);
    const Charge charge(Cost::update);
    worst_point_ = evaluation.worst_point;
    // near round-off a solve may end above its goal: the balance judges it
    report.converged = report.residual <= 10. * tolerance;
    if (!report.converged)
      return report;
    std::vector<double> velocity, left;
    if (bonds_)
      bonds_->finish_from_rest(h, velocity, left);
    else {
      velocity = free_motion_.velocity();
      delassus.add_velocity_change(impulse.data(), velocity.data());
      left = balance_.left_over(h, velocity);
    }
    for (std::size_t k = 0; k < n; ++k)
      q[k] += h * velocity[k];
    iterate_.at.displacement = q;
    for (std::size_t k = 0; k < impulse.size(); ++k)
      iterate_.force[k] = impulse[k] / h;
    iterate_.solutions = std::move(evaluation.solutions);
    for (std::size_t i = 0; i < iterate_.activated.size(); ++i)
      if (problem_.kind[i] == PointKind::rigid &&
          iterate_.solutions[i].damages) {
        iterate_.activated[i] = LoadStepIterate<dim>::opened;
        if (iterate_.at.kind[i] != PointKind::rigid)
          continue;
        // on its envelope from now on; far below any opening it is held
        iterate_.at.kind[i] = PointKind::cohesive;
        iterate_.at.opening_max[i] = 1e-9 * iterate_.solutions[i].reach.opening;
      }
    balance_.measure(q, std::move(left), iterate_.force);
    return report;
  }

  template <int dim>
  const OneStepProblem<dim> &Relaxation<dim>::load_step()
  {
    auto &problem = problem_;
    State start = *iterate_.old;
    start.time = time_ - iterate_.h;
    std::fill(start.relative_velocity.begin(), start.relative_velocity.end(),
              0.);
    set_step(input_, discretization_, discretization_.origins(), delassus_,
             step_problem_.motion(), start, iterate_.h, problem);
    for (std::size_t i = 0; i < iterate_.activated.size(); ++i)
      if (iterate_.activated[i] || (bonds_ && bonds_->is_closed(start, i))) {
        problem.kind[i] = PointKind::rigid;
        problem.mask[i] = 0;
        if (start.kind[i] != PointKind::rigid)
          problem.opening_max[i] = iterate_.at.opening_max[i];
      }
    return problem;
  }

  template class Relaxation<2>;
  template class Relaxation<3>;
} // namespace nsfd
