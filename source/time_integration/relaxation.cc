#include "relaxation.h"

#include "activation.h"
#include "driven_motion.h"
#include "point_name.h"
#include "step_data.h"

#include "core/archive.h"
#include "core/cost.h"
#include "core/stopwatch.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  SceneInput static_scene(const SceneInput &input)
  {
    SceneInput scene = input;
    scene.time.scheme = Scheme::moreau_jean;
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
                              Dynamics<dim> &dynamics,
                              NonsmoothSolver<dim> &solver)
      : input_(input), discretization_(discretization), dynamics_(dynamics),
        solver_(solver), problem_(constant_data(input, discretization)),
        free_motion_(input, discretization, dynamics),
        step_problem_(input, discretization, dynamics, counters_)
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
    old_ = &old;
    time_ = time;
    at_ = old;
    std::fill(at_.velocity.begin(), at_.velocity.end(), 0.);
    std::fill(at_.relative_velocity.begin(), at_.relative_velocity.end(), 0.);
    force_ = old.point_force;
    force_.resize(old.jump.size(), 0.);
    let_go_.assign(old.kind.size(), 0);
    free_laws();
    joint_loads_known_ = false;
    target_ = old.jump;
    for (std::size_t i = 0; i < old.kind.size(); ++i) {
      const PointOrigin origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::motion)
        continue;
      const auto &boundary = input_.boundaries[origin.block];
      const auto x = discretization_.position(i);
      for (unsigned int c = 0; c < dim; ++c)
        if (boundary.displacement[c])
          target_[i * dim + c] = boundary.displacement[c]->at(x, time);
        else if (boundary.velocity[c] && duration > 0.)
          target_[i * dim + c] +=
              duration * boundary.velocity[c]->at(x, time - duration / 2.);
    }
    if (support_.empty())
      set_support();
    set_scales();
    if (free_motion_.set_loads(time))
      ++counters_.load_assemblies;
    free_motion_.set_pressure(old, time, pressure_);
  }

  template <int dim>
  void Relaxation<dim>::serialize(Archive &archive)
  {
    archive.numbers("largest_forces", point_scale_, present_);
  }

  /** Forces at the last equilibrium, and what the motion makes round-off of. */
  template <int dim>
  void Relaxation<dim>::set_scales()
  {
    const auto &communicator = dynamics_.communicator();
    const auto &bodies = dynamics_.bodies();
    double largest = 0.;
    for (const double value : old_->displacement)
      largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < old_->kind.size(); ++i)
      if (discretization_.origins()[i].kind == PointOrigin::Kind::motion)
        for (unsigned int c = 0; c < dim; ++c)
          largest = std::max(largest, std::abs(target_[i * dim + c]));
    // some bits of K q, seen from the goal
    const double share =
        1e-14 / input_.statics->tolerance * communicator.max(largest);
    std::vector<double> diagonal(bodies.n_dofs(), 0.);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const BodyClass &body = bodies.classes[bodies.class_of[b]];
      for (unsigned int k = 0; k < body.n_dofs && !body.rigid; ++k)
        diagonal[bodies.first_dof[b] + k] = body.stiffness(k, k);
    }
    round_off_ =
        share * std::sqrt(communicator.dot(diagonal.data(), diagonal.data(),
                                           bodies.n_dofs()));
    std::vector<double> terms(problem_.n_owned, 0.), supports = terms;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      supports[i] = support_[i];
      for (unsigned int c = 0; c < dim; ++c)
        terms[i] += force_[i * dim + c] * force_[i * dim + c] / support_[i];
    }
    point_round_off_ = share * share * communicator.sum(supports);
    point_scale_ = std::max(point_scale_, communicator.sum(terms));
    present_ = std::max(present_, forces_present(old_->displacement));
  }

  /** What counts from the last equilibrium instead of from the iterate. */
  template <int dim>
  void Relaxation<dim>::constrain(const double h)
  {
    auto &problem = problem_;
    const State &old = *old_;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      const double *u = &at_.jump[i * dim], *start = &old.jump[i * dim];
      if (old.kind[i] == PointKind::prescribed) {
        for (unsigned int c = 0; c < dim; ++c)
          if (problem.mask[i] & (1u << c))
            problem.given_velocity[i * dim + c] =
                (target_[i * dim + c] - u[c]) / h;
        continue;
      }
      for (unsigned int c = 1; c < dim; ++c)
        problem.sliding_offset[i * dim + c] = (u[c] - start[c]) / h;
      double closed = std::min(0., start[0]);
      if (old.kind[i] == PointKind::rigid) {
        // the law counts from the joint, not from its drift
        closed = start[0];
        if (let_go_[i])
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
    dynamics_.set_least_compliance(std::move(least));
  }

  /** As far as the iterate is open, or the equilibrium before it. */
  template <int dim>
  void Relaxation<dim>::set_start(const std::size_t i, Reach &start) const
  {
    const auto &problem = problem_;
    start = reach_of<dim>(problem.interactions[problem.interaction[i]],
                          &problem.jump_old[i * dim]);
    start.opening = std::max(start.opening, at_.opening_max[i]);
    if (!at_.slip_max.empty())
      start.slip = std::max(start.slip, at_.slip_max[i]);
  }

  template <int dim>
  SolverReport Relaxation<dim>::relax(std::vector<double> &q, const double h,
                                      const double tolerance)
  {
    auto &dynamics = dynamics_;
    const std::size_t n = q.size();
    h_ = h;
    {
      const Stopwatch watch(timings_.assembly);
      const Charge charge(Cost::free_motion);
      std::vector<double> change(n);
      for (std::size_t k = 0; k < n; ++k)
        change[k] = q[k] - old_->displacement[k];
      dynamics.relative_velocity(change.data(), at_.jump.data());
      for (std::size_t k = 0; k < at_.jump.size(); ++k)
        at_.jump[k] += old_->jump[k];
      at_.displacement = q;
      at_.time = time_ - h;
      dynamics.reinit(h, 1.);
      set_step(input_, discretization_, discretization_.origins(), dynamics,
               step_problem_.motion(), at_, h, problem_);
      constrain(h);
      if (step_problem_.has_extrinsic() && !joint_loads_known_) {
        std::vector<double> impulse = force_;
        for (double &P : impulse)
          P *= h;
        joint_loads_ = strength_shares(dynamics, discretization_.origins(),
                                       impulse, problem_);
        joint_loads_known_ = true;
      }
      if (holds_)
        hold();
      soften(h);
      free_motion_.move(at_, pressure_, problem_);
    }
    // the floor of the natural map: the largest forces so far
    const double share = std::max(1e-6, 1e-14 / tolerance);
    const double energy_scale =
        std::max(point_scale_, point_round_off_) / (share * share);
    LawEvaluation<dim> evaluation(problem_, dynamics, energy_scale, tolerance);
    for (std::size_t i = 0; i < let_go_.size(); ++i)
      set_start(i, evaluation.solutions[i].reach);
    std::vector<double> impulse = force_;
    for (double &P : impulse)
      P *= h;
    SolverControl control = step_problem_.control(1);
    control.tolerance = tolerance;
    SolverReport report;
    {
      const Stopwatch watch(timings_.solve);
      const Charge charge(Cost::solver);
      report = step_problem_.solve(solver_, problem_, discretization_.origins(),
                                   control, energy_scale, at_, impulse,
                                   evaluation, holds_);
    }
    const Stopwatch watch(timings_.update);
    const Charge charge(Cost::update);
    worst_point_ = evaluation.worst_point;
    // near round-off a solve may end above its goal: the balance judges it
    report.converged = report.residual <= 10. * tolerance;
    if (!report.converged)
      return report;
    std::vector<double> velocity = free_motion_.velocity();
    dynamics.add_velocity_change(impulse.data(), velocity.data());
    for (std::size_t k = 0; k < n; ++k)
      q[k] += h * velocity[k];
    for (std::size_t k = 0; k < impulse.size(); ++k)
      force_[k] = impulse[k] / h;
    solutions_ = evaluation.solutions;
    for (std::size_t i = 0; i < let_go_.size(); ++i)
      if (problem_.kind[i] == PointKind::rigid && solutions_[i].damages &&
          !let_go_[i]) {
        let_go_[i] = 1;
        // on its envelope from now on; far below any opening it is held
        at_.kind[i] = PointKind::cohesive;
        at_.opening_max[i] = 1e-9 * solutions_[i].reach.opening;
      }
    measure(q, h, velocity);
    return report;
  }

  /** The largest of |K q|, |F| and |H^T r|, N. */
  template <int dim>
  double Relaxation<dim>::forces_present(const std::vector<double> &q) const
  {
    const auto &dynamics = dynamics_;
    const std::size_t n = q.size();
    const auto norm = [&](const std::vector<double> &x) {
      return std::sqrt(dynamics.communicator().dot(x.data(), x.data(), n));
    };
    std::vector<double> forces(n);
    dynamics.apply(Dynamics<dim>::Operator::stiffness, q.data(), forces.data());
    double present = std::max(norm(forces), norm(free_motion_.loads()));
    dynamics.generalised_impulse(force_.data(), forces.data());
    return std::max(present, norm(forces));
  }

  /** M v/h is what the forces leave over. */
  template <int dim>
  void Relaxation<dim>::measure(const std::vector<double> &q, const double h,
                                const std::vector<double> &velocity)
  {
    using Operator = typename Dynamics<dim>::Operator;
    const auto &dynamics = dynamics_;
    const auto &communicator = dynamics.communicator();
    const std::size_t n = q.size();
    residual_.resize(n);
    dynamics.apply(Operator::mass, velocity.data(), residual_.data());
    for (double &value : residual_)
      value /= h;
    const double left =
        std::sqrt(communicator.dot(residual_.data(), residual_.data(), n));
    const double present = std::max({present_, round_off_, forces_present(q)});
    imbalance_ = left == 0. ? 0. : left / present;
  }

  template <int dim>
  const OneStepProblem<dim> &Relaxation<dim>::load_step()
  {
    auto &problem = problem_;
    State start = *old_;
    start.time = time_ - h_;
    std::fill(start.relative_velocity.begin(), start.relative_velocity.end(),
              0.);
    set_step(input_, discretization_, discretization_.origins(), dynamics_,
             step_problem_.motion(), start, h_, problem);
    for (std::size_t i = 0; i < let_go_.size(); ++i)
      if (let_go_[i]) {
        problem.kind[i] = PointKind::rigid;
        problem.mask[i] = 0;
      }
    return problem;
  }

  template class Relaxation<2>;
  template class Relaxation<3>;
} // namespace nsfd
