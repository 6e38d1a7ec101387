#include "nsfd/time/smooth_motion.h"

#include "bond_release.h"
#include "common_books.h"
#include "driven_motion.h"
#include "row_system.h"
#include "step_data.h"

#include "nsfd/base/cost.h"
#include "nsfd/dynamics/bulk_traction.h"
#include "nsfd/input/scene_input.h"

#include <deal.II/base/index_set.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/sundials/arkode.h>

#include <arkode/arkode_arkstep.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
    using Values = std::vector<double>;
  } // namespace

  /** The right-hand side, its linear solves, and what is read off at the end. */
  template <int dim>
  class SmoothMotion<dim>::Equations
  {
  public:
    using Operator = typename Dynamics<dim>::Operator;

    Equations(const SceneInput &input,
              const Discretization<dim> &discretization,
              Dynamics<dim> &dynamics, const State &start);

    StepReport advance(const State &old, double h, State &next);

    Counters counters;
    Values reactions;

  private:
    void find_scales(const State &start);
    void set_rows();
    double *displacement(Vector &y) const { return y.begin(); }
    const double *displacement(const Vector &y) const { return y.begin(); }
    double *velocity(Vector &y) const { return y.begin() + n_; }
    const double *velocity(const Vector &y) const { return y.begin() + n_; }

    double motion(std::size_t point, unsigned int component, double t) const;
    void set_motion(double t, Values &g) const;
    void set_motion_rate(double t, Values &rate) const;
    const Values &loads(double t);
    void project(double t, const double *v, Values &result);
    void add_springs(const double *q, Values &force) const;
    const Values &acceleration(double t, const double *q);
    void set_reaction_forces(double t, const double *a);
    void evaluate(double t, const Vector &y, Vector &rate);
    void solve_shifted(double gamma, const Vector &b, Vector &x);
    void integrate(double t, double h, Vector &y);
    void read_off(const State &old, double h, const Vector &y, State &next);

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    Dynamics<dim> &dynamics_;
    std::unique_ptr<BulkTraction<dim>> bulk_; ///< null without bonds
    const Communicator &communicator_;
    const DrivenMotion<dim> motion_;
    std::unique_ptr<Dynamics<dim>> free_; ///< of the mass alone
    OneStepProblem<dim> problem_;
    std::vector<PointKind> kind_;
    const std::size_t n_; ///< unknowns of this rank
    const std::size_t n_rows_;
    bool moves_ = false; ///< a prescribed velocity is not zero
    RowSystem<dim> joined_, shifted_;
    Values D_joined_;
    double gamma_ = -1.;
    double velocity_scale_ = 0., displacement_scale_ = 0., energy_scale_ = 0.;
    double inner_step_ = 0.;
    double length_ = 0., loads_time_ = 0.;
    bool loads_known_ = false;
    Values loads_, given_, mu_, lambda_, jump_, rows_, force_, rate_, v_,
      body_;
  };

  template <int dim>
  SmoothMotion<dim>::Equations::Equations(
    const SceneInput &input, const Discretization<dim> &discretization,
    Dynamics<dim> &dynamics, const State &start)
    : input_(input)
    , discretization_(discretization)
    , dynamics_(dynamics)
    , communicator_(dynamics.communicator())
    , motion_(input, discretization)
    , free_(make_elementwise_dynamics<dim>(
        dynamics.communicator(), discretization.bodies(),
        discretization.points()))
    , problem_(constant_data(input, discretization))
    , kind_(start.kind)
    , n_(discretization.bodies().n_dofs())
    , n_rows_(discretization.points().n_points * dim)
    , joined_(*free_, discretization.points().n_owned)
    , shifted_(dynamics, discretization.points().n_owned)
  {
    free_->reinit(0., 1.);
    if (input.has_bonded_faces())
      bulk_ = std::make_unique<BulkTraction<dim>>(dynamics);
    for (auto *vector : {&given_, &mu_, &lambda_, &jump_, &rows_})
      vector->assign(n_rows_, 0.);
    for (auto *vector : {&loads_, &force_, &rate_, &v_, &body_})
      vector->assign(n_, 0.);
    reactions.assign(discretization.driven_boundaries().size() * dim, 0.);
    set_rows();
    find_scales(start);
  }

  /** Joints all over, driven boundaries in the components that they drive. */
  template <int dim>
  void SmoothMotion<dim>::Equations::set_rows()
  {
    D_joined_.assign(n_rows_, -1.);
    for (std::size_t i = 0; i < n_rows_ / dim; ++i) {
      if (kind_[i] != PointKind::prescribed)
        continue;
      const PointOrigin origin = discretization_.origins()[i];
      for (unsigned int c = 0; c < dim; ++c) {
        if (origin.kind == PointOrigin::Kind::motion) {
          if (!motion_.drives(i, c))
            continue;
          const Expression *velocity = motion_.velocity(i, c);
          moves_ |= !(velocity && velocity->is_zero());
        }
        D_joined_[i * dim + c] = 0.;
      }
    }
    moves_ = communicator_.any(moves_);
    joined_.set(D_joined_);
  }

  template <int dim>
  double SmoothMotion<dim>::Equations::motion(const std::size_t point,
                                              const unsigned int c,
                                              const double t) const
  {
    if (const Expression *velocity = motion_.velocity(point, c))
      return motion_.at(*velocity, point, t);
    const Expression *displacement = motion_.displacement(point, c);
    if (displacement == nullptr)
      return 0.;
    // fourth order: what is left is of the size of round-off
    const double d = 1e-4 * input_.time.end;
    const auto u = [&](const double at) {
      return motion_.at(*displacement, point, at);
    };
    return (8. * (u(t + d) - u(t - d)) - (u(t + 2. * d) - u(t - 2. * d))) /
           (12. * d);
  }

  template <int dim>
  void SmoothMotion<dim>::Equations::set_motion(const double t, Values &g) const
  {
    for (std::size_t k = 0; k < n_rows_; ++k)
      g[k] = moves_ && D_joined_[k] == 0. ? motion(k / dim, k % dim, t) : 0.;
  }

  /** For the work and the reactions alone. */
  template <int dim>
  void SmoothMotion<dim>::Equations::set_motion_rate(const double t,
                                                     Values &rate) const
  {
    const double d = 1e-3 * input_.time.end;
    for (std::size_t k = 0; k < n_rows_; ++k) {
      if (!moves_ || D_joined_[k] != 0.) {
        rate[k] = 0.;
        continue;
      }
      const auto g = [&](const double at) {
        return motion(k / dim, k % dim, at);
      };
      rate[k] =
        (8. * (g(t + d) - g(t - d)) - (g(t + 2. * d) - g(t - 2. * d))) /
        (12. * d);
    }
  }

  template <int dim>
  const Values &SmoothMotion<dim>::Equations::loads(const double t)
  {
    if (!discretization_.has_loads() ||
        (loads_known_ &&
         (loads_time_ == t || !discretization_.loads_depend_on_time())))
      return loads_;
    std::fill(loads_.begin(), loads_.end(), 0.);
    discretization_.add_loads(t, loads_);
    loads_known_ = true;
    loads_time_ = t;
    return loads_;
  }

  /**
   * The size of the motion, for tolerances that ask for no number of the user:
   * what the start, the loads and the driven boundaries can bring about.
   */
  template <int dim>
  void SmoothMotion<dim>::Equations::find_scales(const State &start)
  {
    double speed = 0., mass = 0., largest = 0.;
    const auto &bodies = discretization_.bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const unsigned int m = discretization_.material_of(unsigned(b));
      mass += input_.materials[m].density *
              discretization_.volume(unsigned(b));
      if (!input_.materials[m].rigid)
        speed = std::max(speed, discretization_.pressure_wave_speed(m));
    }
    mass = communicator_.sum(Values{mass});
    speed = communicator_.max(speed);
    length_ = discretization_.extent();
    const double end = input_.time.end;
    const double crossing = speed > 0. ? std::min(end, length_ / speed) : end;
    for (const double u : start.displacement)
      largest = std::max(largest, std::abs(u));
    velocity_scale_ = largest / crossing;
    for (const double v : start.velocity)
      velocity_scale_ = std::max(velocity_scale_, std::abs(v));
    constexpr unsigned int samples = 32;
    for (unsigned int k = 0; k <= samples; ++k) {
      const double t = k * end / samples;
      set_motion(t, given_);
      for (const double g : given_)
        velocity_scale_ = std::max(velocity_scale_, std::abs(g));
      free_->apply(Operator::inverse, loads(t).data(), rate_.data());
      for (const double a : rate_)
        velocity_scale_ = std::max(velocity_scale_, std::abs(a) * crossing);
    }
    velocity_scale_ = communicator_.max(velocity_scale_);
    displacement_scale_ = velocity_scale_ * crossing;
    energy_scale_ = mass * velocity_scale_ * velocity_scale_;
    inner_step_ =
      1e-2 * (speed > 0. ? discretization_.crossing_time() : end);
  }

  /** @p result: v with the impulses that joints and driven boundaries need. */
  template <int dim>
  void SmoothMotion<dim>::Equations::project(const double t, const double *v,
                                             Values &result)
  {
    result.assign(v, v + n_);
    if (joined_.empty())
      return;
    set_motion(t, given_);
    free_->relative_velocity(v, rows_.data());
    for (std::size_t k = 0; k < n_rows_; ++k)
      rows_[k] = given_[k] - rows_[k];
    counters.iterations += joined_.solve(
      rows_, 1e-14 * velocity_scale_ * std::sqrt(double(n_rows_)), mu_);
    free_->add_velocity_change(mu_.data(), result.data());
  }

  /** force -= H^T w C H q. */
  template <int dim>
  void SmoothMotion<dim>::Equations::add_springs(const double *q,
                                                 Values &force) const
  {
    Values jump(n_rows_, 0.), sum(n_);
    bool any = false;
    free_->relative_velocity(q, jump.data());
    for (std::size_t i = 0; i < kind_.size(); ++i) {
      const auto &joint = problem_.interactions[problem_.interaction[i]];
      const bool elastic = kind_[i] == PointKind::elastic;
      any |= elastic;
      for (unsigned int c = 0; c < dim; ++c)
        jump[i * dim + c] *= !elastic ? 0.
                                      : -problem_.weight[i] *
                                          joint.normal_stiffness *
                                          (c == 0 ? 1. : joint.stiffness_ratio);
    }
    if (!communicator_.any(any))
      return;
    free_->generalised_impulse(jump.data(), sum.data());
    for (std::size_t k = 0; k < n_; ++k)
      force[k] += sum[k];
  }

  /** Without the forces of joints and driven boundaries. */
  template <int dim>
  const Values &SmoothMotion<dim>::Equations::acceleration(const double t,
                                                           const double *q)
  {
    dynamics_.apply(Operator::stiffness, q, force_.data());
    const Values &external = loads(t);
    for (std::size_t k = 0; k < n_; ++k)
      force_[k] = external[k] - force_[k];
    add_springs(q, force_);
    free_->apply(Operator::inverse, force_.data(), rate_.data());
    return rate_;
  }

  /** lambda: forces of the rows, W lambda = g' - H a. */
  template <int dim>
  void SmoothMotion<dim>::Equations::set_reaction_forces(const double t,
                                                         const double *a)
  {
    if (joined_.empty())
      return;
    Values rate(n_rows_);
    set_motion_rate(t, rate);
    free_->relative_velocity(a, rows_.data());
    double scale = 0.;
    for (std::size_t k = 0; k < n_rows_; ++k) {
      scale = std::max(scale, std::abs(rows_[k]));
      rows_[k] = rate[k] - rows_[k];
    }
    counters.iterations += joined_.solve(
      rows_, 1e-13 * communicator_.max(scale) * std::sqrt(double(n_rows_)),
      lambda_);
  }

  template <int dim>
  void SmoothMotion<dim>::Equations::evaluate(const double t, const Vector &y,
                                              Vector &rate)
  {
    ++counters.evaluations;
    project(t, velocity(y), v_);
    std::copy(v_.begin(), v_.end(), displacement(rate));
    const Values &a = acceleration(t, displacement(y));
    std::copy(a.begin(), a.end(), velocity(rate));
    Values power(n_ + n_rows_, 0.);
    const Values &external = loads(t);
    for (std::size_t k = 0; k < n_; ++k)
      power[k] = external[k] * v_[k];
    if (moves_) {
      set_reaction_forces(t, velocity(rate));
      const std::size_t n_owned = discretization_.points().n_owned * dim;
      for (std::size_t k = 0; k < n_owned; ++k)
        power[n_ + k] = lambda_[k] * given_[k];
    }
    const double sum = communicator_.sum(power);
    if (communicator_.is_root())
      rate.local_element(2 * n_) = sum;
  }

  /**
   * (1 - gamma J) x = b in the velocity w that the rows allow:
   *
   *     (M + gamma^2 K) w + ... = M b_v - gamma K b_q + H^T P,
   *
   * springs as rows of compliance 1 / (gamma^2 w C). x_q = b_q + gamma w.
   */
  template <int dim>
  void SmoothMotion<dim>::Equations::solve_shifted(const double gamma,
                                                   const Vector &b, Vector &x)
  {
    ++counters.linear_solves;
    const auto spring = [&](const std::size_t k) {
      const auto &joint =
        problem_.interactions[problem_.interaction[k / dim]];
      return problem_.weight[k / dim] * joint.normal_stiffness *
             (k % dim == 0 ? 1. : joint.stiffness_ratio);
    };
    if (gamma != gamma_) {
      gamma_ = gamma;
      dynamics_.reinit(gamma, 1.);
      Values D = D_joined_;
      for (std::size_t k = 0; k < n_rows_; ++k)
        if (kind_[k / dim] == PointKind::elastic)
          D[k] = 1. / (gamma * gamma * spring(k));
      shifted_.set(D);
    }
    Values w(n_), momentum(n_), product(n_), P(n_rows_, 0.), U(n_rows_),
      jump(n_rows_);
    dynamics_.apply(Operator::mass, velocity(b), momentum.data());
    dynamics_.apply(Operator::stiffness, displacement(b), product.data());
    for (std::size_t k = 0; k < n_; ++k)
      momentum[k] -= gamma * product[k];
    dynamics_.apply(Operator::inverse, momentum.data(), w.data());
    if (!shifted_.empty()) {
      free_->relative_velocity(w.data(), U.data());
      free_->relative_velocity(displacement(b), jump.data());
      double norm = 0.;
      for (std::size_t k = 0; k < n_rows_; ++k) {
        U[k] = -U[k] -
               (kind_[k / dim] == PointKind::elastic ? jump[k] / gamma : 0.);
        norm = std::max(norm, std::abs(U[k]));
      }
      counters.iterations += shifted_.solve(
        U, 1e-13 * communicator_.max(norm) * std::sqrt(double(n_rows_)), P);
      dynamics_.add_velocity_change(P.data(), w.data());
    }
    for (std::size_t k = 0; k < n_; ++k)
      displacement(x)[k] = displacement(b)[k] + gamma * w[k];
    Values force(n_);
    dynamics_.apply(Operator::stiffness, displacement(x), force.data());
    for (double &f : force)
      f = -f;
    add_springs(displacement(x), force);
    free_->apply(Operator::inverse, force.data(), product.data());
    for (std::size_t k = 0; k < n_; ++k)
      velocity(x)[k] = velocity(b)[k] + gamma * product[k];
    if (communicator_.is_root())
      x.local_element(2 * n_) = b.local_element(2 * n_);
  }

  template <int dim>
  void SmoothMotion<dim>::Equations::integrate(const double t, const double h,
                                               Vector &y)
  {
    const double tolerance = input_.time.tolerance;
    using Solver = dealii::SUNDIALS::ARKode<Vector>;
    const typename Solver::AdditionalData data(
      t, t + h, std::min(inner_step_, h), 2. * h, 1e-12 * h, input_.time.order,
      10, false, false, true, 0, tolerance, tolerance);
    Solver solver(data, communicator_.mpi());
    void *memory = nullptr;
    // what fails in a callback must not leave through C code
    std::string failure;
    const auto guard = [&failure](const auto &work) {
      try {
        work();
      } catch (const std::exception &error) {
        failure = error.what();
        return -1;
      }
      return 0;
    };
    const auto rate = [&](const double at, const Vector &in, Vector &out) {
      return guard([&] { evaluate(at, in, out); });
    };
    if (input_.time.implicit_pairs) {
      solver.implicit_function = rate;
      solver.jacobian_times_vector = [](const Vector &, Vector &, double,
                                        const Vector &,
                                        const Vector &) { return 0; };
      solver.solve_linearized_system =
        [&](auto &, auto &, Vector &x, const Vector &b, double) {
          return guard([&] {
            double gamma = 0.;
            ARKStepGetCurrentGamma(memory, &gamma);
            solve_shifted(gamma, b, x);
          });
        };
    } else
      solver.explicit_function = rate;
    Vector tolerances(y);
    std::fill(displacement(tolerances), velocity(tolerances),
              tolerance * displacement_scale_);
    std::fill(velocity(tolerances), velocity(tolerances) + n_,
              tolerance * velocity_scale_);
    if (communicator_.is_root())
      tolerances.local_element(2 * n_) = tolerance * energy_scale_;
    solver.get_local_tolerances = [&]() -> Vector & { return tolerances; };
    solver.custom_setup = [&](void *arkode) {
      memory = arkode;
      ARKStepSetMaxNumSteps(arkode, 10000000);
    };
    try {
      solver.solve_ode(y);
    } catch (const std::exception &) {
      throw StepRejected(fmt::format(
        "ARKODE could not go on between t = {:.6g} and {:.6g}{}", t, t + h,
        failure.empty() ? "" : ": " + failure));
    }
    long int steps = 0;
    ARKStepGetNumSteps(memory, &steps);
    counters.steps += static_cast<unsigned long long>(steps);
    ARKStepGetCurrentStep(memory, &inner_step_);
  }

  template <int dim>
  StepReport SmoothMotion<dim>::Equations::advance(const State &old,
                                                   const double h, State &next)
  {
    const Charge charge(Cost::solver);
    const bool holds_work = communicator_.is_root();
    const unsigned long long mine = 2 * n_ + (holds_work ? 1 : 0);
    unsigned long long last = 0, total = 0;
    MPI_Scan(&mine, &last, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM,
             communicator_.mpi());
    MPI_Allreduce(&mine, &total, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM,
                  communicator_.mpi());
    dealii::IndexSet owned(total);
    owned.add_range(last - mine, last);
    Vector y(owned, communicator_.mpi());
    std::copy(old.displacement.begin(), old.displacement.end(),
              displacement(y));
    std::copy(old.velocity.begin(), old.velocity.end(), velocity(y));
    std::fill(mu_.begin(), mu_.end(), 0.);
    const Counters before = counters;
    integrate(old.time, h, y);
    read_off(old, h, y, next);
    double work = holds_work ? y.local_element(2 * n_) : 0.;
    work = communicator_.sum(Values{work});
    StepReport report;
    next.energy.work = old.energy.work + work;
    report.solver.converged = true;
    report.solver.newton = unsigned(counters.steps - before.steps);
    report.solver.krylov = unsigned(counters.iterations - before.iterations);
    close_books(old, next, report);
    return report;
  }

  /** Motion, forces and energies at the end of the step. */
  template <int dim>
  void SmoothMotion<dim>::Equations::read_off(const State &old, const double h,
                                              const Vector &y, State &next)
  {
    const double t = old.time + h;
    carry_history(old, next);
    next.step = old.step + 1;
    next.time = t;
    next.displacement.assign(displacement(y), displacement(y) + n_);
    project(t, velocity(y), next.velocity);
    next.jump.resize(n_rows_);
    next.relative_velocity.resize(n_rows_);
    free_->relative_velocity(next.displacement.data(), next.jump.data());
    free_->relative_velocity(next.velocity.data(),
                             next.relative_velocity.data());
    set_reaction_forces(t, acceleration(t, next.displacement.data()).data());

    next.impulse.assign(n_rows_, 0.);
    Values stored(problem_.n_owned, 0.);
    double drift = 0.;
    for (std::size_t i = 0; i < kind_.size(); ++i) {
      const auto &joint = problem_.interactions[problem_.interaction[i]];
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        const double u = next.jump[k];
        if (kind_[i] == PointKind::elastic) {
          const double pull = problem_.weight[i] * joint.normal_stiffness *
                              (c == 0 ? 1. : joint.stiffness_ratio) * u;
          next.impulse[k] = -h * pull;
          if (i < problem_.n_owned)
            stored[i] += pull * u / 2.;
        } else if (D_joined_[k] == 0.) {
          next.impulse[k] = h * lambda_[k];
          square += u * u;
        }
      }
      if (discretization_.origins()[i].kind == PointOrigin::Kind::interface)
        drift = std::max(drift, std::sqrt(square));
    }
    next.rigid_drift = std::max(old.rigid_drift, communicator_.max(drift));

    const auto half = [&](const Operator op, const Values &x) {
      dynamics_.apply(op, x.data(), body_.data());
      return communicator_.dot(x.data(), body_.data(), n_) / 2.;
    };
    next.energy = old.energy;
    next.energy.kinetic = half(Operator::mass, next.velocity);
    next.energy.elastic = half(Operator::stiffness, next.displacement);
    next.energy.cohesive = communicator_.sum(stored);
    next.initial_energy = old.initial_energy;
    if (bulk_)
      set_bond_tractions(*bulk_, next);

    const auto &driven = discretization_.driven_boundaries();
    const std::size_t n_owned = problem_.n_owned;
    Values terms(reactions.size() * n_owned, 0.);
    for (std::size_t i = 0; i < n_owned; ++i) {
      const PointOrigin origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::motion)
        continue;
      const std::size_t d = std::size_t(
        std::find(driven.begin(), driven.end(), origin.block) - driven.begin());
      for (unsigned int c = 0; c < dim; ++c)
        terms[(d * dim + c) * n_owned + i] = next.impulse[i * dim + c] / h;
    }
    if (!reactions.empty())
      reactions = communicator_.sums(terms.data(), reactions.size(), n_owned);
  }

  template <int dim>
  SmoothMotion<dim>::SmoothMotion(const SceneInput &input,
                                  const Discretization<dim> &discretization,
                                  Dynamics<dim> &dynamics, const State &start)
    : equations_(std::make_unique<Equations>(input, discretization, dynamics,
                                             start))
  {}

  template <int dim>
  SmoothMotion<dim>::~SmoothMotion() = default;

  template <int dim>
  StepReport SmoothMotion<dim>::advance(const State &old, const double h,
                                        State &next)
  {
    return equations_->advance(old, h, next);
  }

  template <int dim>
  const std::vector<double> &SmoothMotion<dim>::reactions() const
  {
    return equations_->reactions;
  }

  template <int dim>
  auto SmoothMotion<dim>::counters() const -> const Counters &
  {
    return equations_->counters;
  }

  template class SmoothMotion<2>;
  template class SmoothMotion<3>;
} // namespace nsfd
