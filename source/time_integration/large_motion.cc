#include "large_motion.h"

#include "common_books.h"
#include "core/gather.h"
#include "crack_pressure.h"
#include "driven_motion.h"
#include "energy_safe_sliding.h"
#include "initial_state.h"
#include "ledger.h"
#include "save_problem.h"
#include "state/point_fields.h"
#include "step_data.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int most_newton_steps = 40;
  } // namespace

  template <int dim>
  LargeMotion<dim>::LargeMotion(const SceneInput &input,
                                const Discretization<dim> &discretization,
                                MovingBodies<dim> &bodies,
                                Dynamics<dim> &dynamics,
                                NonsmoothSolver<dim> &solver)
      : MoreauJean<dim>(input, discretization, dynamics, solver),
        bodies_(bodies), lifts_(has_sliding_lift(input))
  {
    if (!input.contacts.empty() || !input.obstacles.empty())
      contacts_ = std::make_unique<SurfaceContacts<dim>>(
          input, discretization, bodies, dynamics.communicator());
  }

  template <int dim>
  LargeMotion<dim>::~LargeMotion() = default;

  template <int dim>
  State LargeMotion<dim>::initial_state() const
  {
    const SceneInput &input = this->input_;
    State state = initial_motion(input, this->discretization_);
    bodies_.set_initial(state);
    if (std::any_of(input.obstacles.begin(), input.obstacles.end(),
                    [](const auto &obstacle) { return obstacle.moves(); }))
      state.obstacle_shift.assign(3 * input.obstacles.size(), 0.);
    bodies_.start(state, 0., input.time.theta,
                  std::vector<double>(state.velocity.size(), 0.),
                  state.obstacle_shift, state.obstacle_shift);
    bodies_.set_rows({});
    bodies_.set_middle();
    this->dynamics_.renew(0., input.time.theta);
    const std::size_t n = bodies_.points().n_points;
    const auto jumps = bodies_.jumps(state.displacement);
    state.jump.assign(n * dim, 0.);
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          state.jump[i * dim + a] +=
              bodies_.points().frame[(i * dim + a) * dim + d] *
              jumps[i * dim + d];
    state.relative_velocity.resize(n * dim);
    this->dynamics_.relative_velocity(bodies_.old_velocity().data(),
                                      state.relative_velocity.data());
    set_points(input, this->discretization_, this->problem_, state);
    if (contacts_)
      contacts_->set_initial(state);
    const Communicator &all = this->dynamics_.communicator();
    const BodyEnergies energies = sum(all, bodies_.energies(state));
    state.energy.kinetic = energies.kinetic;
    state.energy.elastic = energies.elastic;
    state.energy.cohesive = stored_in_points(all, this->problem_, state);
    begin_books(state);
    return state;
  }

  // ------------------------------------------------------- data of one step

  /** Those of all ranks. */
  template <int dim>
  std::vector<MovingRow<dim>> LargeMotion<dim>::pins(const State &old) const
  {
    std::vector<MovingRow<dim>> own;
    for (unsigned int k = 0; k < this->input_.pins.size(); ++k) {
      MovingRow<dim> row;
      row.partner = MovingRow<dim>::Partner::pin;
      row.body_2 = bodies_.body_of_pin(k);
      if (!bodies_.is_own(row.body_2))
        continue;
      row.pin = row.block = k;
      row.weight = 1.;
      // as a support
      row.interaction = unsigned(this->input_.interfaces.size() +
                                 this->input_.obstacles.size());
      row.jump = bodies_.pin_drift(k, old);
      own.push_back(row);
    }
    if (this->input_.pins.empty())
      return own;
    auto all = gather_all(this->dynamics_.communicator(), own);
    std::sort(all.begin(), all.end(),
              [](const auto &a, const auto &b) { return a.pin < b.pin; });
    return all;
  }

  template <int dim>
  void LargeMotion<dim>::set_shifts(const State &old, const double h,
                                    State &next) const
  {
    next.obstacle_shift = old.obstacle_shift;
    const double theta = this->input_.time.theta;
    const auto &obstacles = this->input_.obstacles;
    for (std::size_t k = 0; k < next.obstacle_shift.size(); ++k)
      if (const auto &velocity = obstacles[k / 3].velocity[k % 3])
        next.obstacle_shift[k] +=
            h * (theta * velocity->at(dealii::Point<dim>(), old.time + h) +
                 (1. - theta) * velocity->at(dealii::Point<dim>(), old.time));
  }

  /** Values for the contacts of the step. */
  template <int dim>
  template <typename Array>
  void
  LargeMotion<dim>::insert_rows(Array &array, const unsigned int width,
                                const typename Array::value_type value) const
  {
    array.insert(array.begin() + long(bodies_.row_point(0) * width),
                 bodies_.rows().size() * width, value);
  }

  /** State and problem with the contacts of the step. */
  template <int dim>
  void LargeMotion<dim>::extend(const State &old)
  {
    const std::size_t n = bodies_.points().n_points;
    old_ = old;
    for_point_fields([&](const PointField &field, const auto member,
                         const auto &, const auto added) {
      using Value = typename std::decay_t<decltype(old_.*member)>::value_type;
      if (has_field(this->input_, field))
        insert_rows(old_.*member, field.width(dim), Value(added));
    });

    OneStepProblem<dim> &problem = step_problem_;
    problem.resize(n);
    problem.n_owned = bodies_.points().n_owned;
    problem.theta = this->problem_.theta;
    problem.rule = this->problem_.rule;
    problem.interactions = this->problem_.interactions;
    problem.interaction = this->problem_.interaction;
    problem.strength_factor = this->problem_.strength_factor;
    problem.opening_factor = this->problem_.opening_factor;
    insert_rows(problem.interaction, 1, 0);
    insert_rows(problem.strength_factor, 1, 1.);
    insert_rows(problem.opening_factor, 1, 1.);
    problem.weight = bodies_.points().weight;
    if (has_opening_viscosity(this->input_))
      problem.viscosity.assign(n, 0.);
    if (lifts_) {
      problem.dilatancy.assign(n, 0.);
      problem.lift_left.assign(n, 0.);
    }
    origins_ = this->discretization_.origins();
    insert_rows(origins_, 1, {});
    for (std::size_t k = 0; k < bodies_.rows().size(); ++k) {
      const MovingRow<dim> &row = bodies_.rows()[k];
      const std::size_t i = bodies_.row_point(k);
      using Partner = typename MovingRow<dim>::Partner;
      origins_[i].block = row.block;
      origins_[i].kind = row.partner == Partner::pin ? PointOrigin::Kind::pin
                         : row.partner == Partner::obstacle
                             ? PointOrigin::Kind::obstacle
                             : PointOrigin::Kind::surface;
      problem.interaction[i] = row.interaction;
      if (row.partner == Partner::pin)
        old_.kind[i] = PointKind::prescribed;
      if (row.place != row.nowhere)
        set_row_memory(k, old);
    }
  }

  /** What its place remembers. */
  template <int dim>
  void LargeMotion<dim>::set_row_memory(const std::size_t k, const State &old)
  {
    const MovingRow<dim> &row = bodies_.rows()[k];
    const std::size_t i = bodies_.row_point(k);
    old_.slip[i] = old.surface_slip[row.place];
    old_.approach[i] = std::max(row.approach, old.surface_approach[row.place]);
    old_.released_overlap[i] =
        std::max(row.overlap, old.surface_overlap[row.place]);
    if (row.twin != row.nowhere) {
      old_.approach[i] =
          std::max(old_.approach[i], old.surface_approach[row.twin]);
      old_.released_overlap[i] =
          std::max(old_.released_overlap[i], old.surface_overlap[row.twin]);
    }
    // lips of springs that were closed are born with their overlap
    if (row.released)
      old_.released_overlap[i] = std::max(old_.released_overlap[i], -row.gap);
    old_.contact[i] =
        old.surface_contact[row.place] & SurfaceContacts<dim>::touches;
    if (!old_.worn.empty()) {
      old_.worn[i] = old.surface_worn[row.place];
      old_.wear_speed[i] = old.surface_wear_speed[row.place];
    }
  }

  template <int dim>
  void LargeMotion<dim>::start(const State &old, const double h, State &next)
  {
    const double theta = this->input_.time.theta;
    this->set_loads(old.time + theta * h);
    set_shifts(old, h, next);
    bodies_.start(old, h, theta, this->forces_, old.obstacle_shift,
                  next.obstacle_shift);
    std::vector<MovingRow<dim>> rows;
    if (contacts_) {
      const Stopwatch watch(motion_counters_.search_seconds);
      rows = contacts_->rows(old, h);
    }
    const auto held = pins(old);
    rows.insert(rows.end(), held.begin(), held.end());
    bodies_.set_rows(rows);
    extend(old);
    this->sliding_->begin();
    mesh_jumps_ = bodies_.jumps(old.displacement);
    crack_impulse_.clear();
    if (this->crack_pressure_) {
      this->crack_pressure_->evaluate(old, old.time + theta * h, next.pressure);
      crack_impulse_ = this->crack_pressure_->impulse(next.pressure, h);
      insert_rows(crack_impulse_, dim, 0.);
      insert_rows(next.pressure, 1, 0.);
    }
  }

  /** Of the obstacle of a contact, in its frame; zero for others. */
  template <int dim>
  std::array<double, dim>
  LargeMotion<dim>::obstacle_velocity(const std::size_t k,
                                      const double time) const
  {
    std::array<double, dim> result{};
    const MovingRow<dim> &row = bodies_.rows()[k];
    if (row.partner != MovingRow<dim>::Partner::obstacle)
      return result;
    const auto &obstacle = this->input_.obstacles[row.obstacle];
    const std::size_t i = bodies_.row_point(k);
    for (unsigned int d = 0; d < dim; ++d)
      if (obstacle.velocity[d]) {
        const double v = obstacle.velocity[d]->at(dealii::Point<dim>(), time);
        for (unsigned int a = 0; a < dim; ++a)
          result[a] += bodies_.points().frame[(i * dim + a) * dim + d] * v;
      }
    return result;
  }

  template <int dim>
  void LargeMotion<dim>::relative_velocity(const std::vector<double> &v,
                                           const double time,
                                           std::vector<double> &U) const
  {
    this->dynamics_.relative_velocity(v.data(), U.data());
    for (std::size_t k = 0; k < bodies_.rows().size(); ++k) {
      const auto own = obstacle_velocity(k, time);
      for (unsigned int a = 0; a < dim; ++a)
        U[bodies_.row_point(k) * dim + a] -= own[a];
    }
  }

  /** In the frames at hand: jumps, relative velocities, what acts where. */
  template <int dim>
  void LargeMotion<dim>::set_problem(const double h)
  {
    const auto &rows = bodies_.rows();
    const auto &frame = bodies_.points().frame;
    const std::size_t n = this->discretization_.points().n_points;
    for (std::size_t j = 0; j < n; ++j)
      for (unsigned int a = 0; a < dim; ++a) {
        const std::size_t i = bodies_.mesh_point(j);
        double value = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          value += frame[(i * dim + a) * dim + d] * mesh_jumps_[j * dim + d];
        old_.jump[i * dim + a] = value;
      }
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (unsigned int a = 0; a < dim; ++a)
        old_.jump[bodies_.row_point(k) * dim + a] =
            rows[k].partner == MovingRow<dim>::Partner::pin ? rows[k].jump[a]
            : a == 0                                        ? rows[k].gap
                                                            : 0.;
    relative_velocity(bodies_.old_velocity(), old_.time,
                      old_.relative_velocity);
    this->set_problem_of_step(origins_, old_, h, step_problem_);
    // what is joined stays where it is: the mean velocity vanishes
    const double theta = step_problem_.theta;
    for (std::size_t i = 0; i < step_problem_.n_points; ++i)
      if (step_problem_.kind[i] == PointKind::prescribed &&
          origins_[i].kind != PointOrigin::Kind::motion)
        for (unsigned int a = 0; a < dim; ++a)
          step_problem_.given_velocity[i * dim + a] =
              -(1. - theta) / theta * old_.relative_velocity[i * dim + a];
    if (this->input_.time.contact_target == ContactTarget::energy_safe)
      keep_gaps();
  }

  /**
   * The speed that vanished at the end of the last step is not quite zero in
   * the frame of this one: what is closed and rests would sink in as its bodies
   * turn. Its mean velocity vanishes, which does no work.
   */
  template <int dim>
  void LargeMotion<dim>::keep_gaps()
  {
    const double theta = step_problem_.theta;
    for (std::size_t k = 0; k < bodies_.rows().size(); ++k) {
      const std::size_t i = bodies_.row_point(k);
      const auto &law =
          step_problem_.interactions[step_problem_.interaction[i]];
      if (!old_.contact[i] || law.restitution != 0.)
        continue;
      const double lift_speed =
          lifts_ ? old_.dilation_speed[i] - old_.wear_speed[i] : 0.;
      step_problem_.target[i] = -(1. - theta) / theta *
                                (old_.relative_velocity[i * dim] - lift_speed);
    }
  }

  /**
   * (134), (136) for contacts of surfaces: gap + h (gamma_1 rate + gamma_2
   * U_N), the rate that of the start of the step, where a contact that rests
   * has none, and U_N that of the motion at hand. What has once been active in
   * a step stays so, or the iteration could go round.
   */
  template <int dim>
  void LargeMotion<dim>::forecast(const double h, const bool first)
  {
    const auto &time = this->input_.time;
    const auto &rows = bodies_.rows();
    if (first)
      active_.assign(rows.size(), 0);
    std::vector<double> U;
    if (time.forecast_gamma2 > 0.) {
      U.resize(old_.jump.size());
      relative_velocity(bodies_.velocity(), old_.time + h, U);
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k].partner == MovingRow<dim>::Partner::pin)
        continue;
      const std::size_t i = bodies_.row_point(k);
      double gap = rows[k].gap + h * time.forecast_gamma1 * rows[k].rate;
      if (!U.empty())
        gap += h * time.forecast_gamma2 * U[i * dim];
      if (!old_.worn.empty())
        gap += old_.worn[i] + h * time.forecast_gamma1 * old_.wear_speed[i];
      const auto &law =
          step_problem_.interactions[step_problem_.interaction[i]];
      // as set_step() has it for the points of the mesh
      const bool rests = old_.contact[i] && law.restitution == 0.;
      if ((first || !U.empty()) &&
          gap <= (rests ? 1e-9 : 1e-14) * this->discretization_.extent())
        active_[k] = 1;
      step_problem_.contact[i] = active_[k];
    }
  }

  /** The impulses of the last step, in the frames at hand. */
  template <int dim>
  void LargeMotion<dim>::warm_start(const State &old)
  {
    impulse_ = old_.impulse;
    if (this->starts_cold_) {
      std::fill(impulse_.begin(), impulse_.end(), 0.);
      return;
    }
    const auto &rows = bodies_.rows();
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (unsigned int a = 0; a < dim && rows[k].place != rows[k].nowhere; ++a)
        for (unsigned int d = 0; d < dim; ++d) {
          const std::size_t c = bodies_.row_point(k) * dim + a;
          impulse_[c] += rows[k].share * bodies_.points().frame[c * dim + d] *
                         old.surface_impulse[rows[k].place * dim + d];
        }
    // what does not touch in this step has none
    for (std::size_t i = 0; i < step_problem_.n_points; ++i)
      if (step_problem_.kind[i] == PointKind::free && !step_problem_.contact[i])
        std::fill_n(impulse_.begin() + long(i * dim), dim, 0.);
  }

  // ---------------------------------------------------------- the iteration

  template <int dim>
  bool LargeMotion<dim>::move_bodies(const std::vector<double> &v)
  {
    std::vector<double> all(impulse_), r(v.size());
    for (std::size_t k = 0; k < crack_impulse_.size(); ++k)
      all[k] += crack_impulse_[k];
    this->dynamics_.generalised_impulse(all.data(), r.data());
    return !this->dynamics_.communicator().any(!bodies_.move(r, v));
  }

  template <int dim>
  SolverReport
  LargeMotion<dim>::iterate(const State &old, const double h,
                            const SolverControl &control,
                            std::unique_ptr<LawEvaluation<dim>> &evaluation)
  {
    auto &dynamics = this->dynamics_;
    const Communicator &all = dynamics.communicator();
    const double theta = this->input_.time.theta;
    // velocities rest, over the root of the kinetic energy: well within what
    // the solver leaves
    const double rest = std::max(0.1 * control.tolerance, 1e-13);
    SolverReport total;
    std::vector<double> difference(bodies_.old_velocity().size());
    for (unsigned int round = 0;; ++round) {
      const std::vector<double> v_middle = bodies_.velocity();
      bodies_.set_middle();
      dynamics.renew(h, theta);
      set_problem(h);
      forecast(h, round == 0);
      if (round == 0) {
        warm_start(old);
        if (!move_bodies(v_middle))
          throw StepRejected(lost_body(h, old.time));
      }
      // linear in what further impulses do
      this->v_free_ = bodies_.velocity();
      std::vector<double> less(impulse_);
      for (double &P : less)
        P = -P;
      dynamics.add_velocity_change(less.data(), this->v_free_.data());
      relative_velocity(this->v_free_, old.time + h,
                        step_problem_.free_velocity);
      dynamics.set_free_velocity(&this->v_free_);
      if (round == 0)
        energy_scale_ =
            2. * old.energy.kinetic +
            all.sum(bodies_.kinetic_products(this->v_free_, this->v_free_));
      evaluation = std::make_unique<LawEvaluation<dim>>(
          step_problem_, dynamics, energy_scale_, control.tolerance);
      const auto solver = SolverRegistry<dim>::instance().create(
          this->input_.solver.method == "auto" ? "contacts alone"
                                               : this->input_.solver.method);
      const SolverReport part =
          this->solve(*solver, step_problem_, origins_, control, energy_scale_,
                      old_, impulse_, *evaluation);
      total.go_on_with(part);
      if (!part.converged)
        return total;
      std::vector<double> v = this->v_free_;
      dynamics.add_velocity_change(impulse_.data(), v.data());
      if (!move_bodies(v))
        throw StepRejected(lost_body(h, old.time));
      if (energy_scale_ == 0.) // all at rest, and something hits it
        energy_scale_ = all.sum(
            bodies_.kinetic_products(bodies_.velocity(), bodies_.velocity()));
      for (std::size_t k = 0; k < difference.size(); ++k)
        difference[k] = bodies_.velocity()[k] - v_middle[k];
      const double change =
          all.sum(bodies_.kinetic_products(difference, difference));
      ++motion_counters_.iterations;
      motion_counters_.most_iterations = std::max<unsigned long long>(
          motion_counters_.most_iterations, round + 1);
      if (change <= rest * rest * energy_scale_)
        return total;
      if (round == most_newton_steps || !std::isfinite(change))
        throw StepRejected(fmt::format(
            "the motion of the step of {:.4g} at t = {:.6g} did not come to "
            "rest: velocities change by {:.1e} of all after {} iterations",
            h, old.time, std::sqrt(change / energy_scale_), round + 1));
    }
  }

  template <int dim>
  std::string LargeMotion<dim>::lost_body(const double h,
                                          const double time) const
  {
    return fmt::format("a body has no motion in the step of {:.4g} at t = "
                       "{:.6g}: it would be turned inside out",
                       h, time);
  }

  template <int dim>
  StepReport LargeMotion<dim>::advance(const State &old, const double h,
                                       State &next,
                                       const unsigned int idle_rounds)
  {
    {
      const Stopwatch watch(this->timings_.assembly);
      const Charge charge(Cost::free_motion);
      start(old, h, next);
    }
    StepReport report;
    std::unique_ptr<LawEvaluation<dim>> evaluation;
    {
      const Stopwatch watch(this->timings_.solve);
      const Charge charge(Cost::solver);
      report.solver =
          iterate(old, h, this->solver_control(idle_rounds), evaluation);
    }
    save_problem<dim>(this->input_, step_problem_, this->dynamics_, *evaluation,
                      report.solver, old.step + 1, old.time);
    if (!report.solver.converged)
      this->reject(h, old.time, report.solver, evaluation->worst_point);
    const Stopwatch watch(this->timings_.ledger);
    const Charge charge(Cost::ledger);
    finish(h, *evaluation, next, report);
    this->check_books(h, old.time, energy_scale_, next, report,
                      evaluation->worst_point);
    this->watch_energy(energy_scale_, old, next, report);
    relate_defect(energy_scale_, next, report);
    if (contacts_) {
      remember_surfaces(old, next);
      contacts_->remember_facets(next);
      if (!this->input_.observables.empty())
        next.touches = touches(next);
    }
    forget_rows(next);
    if (contacts_)
      contacts_->part(next);
    return report;
  }

  template <int dim>
  void LargeMotion<dim>::finish(const double h,
                                const LawEvaluation<dim> &evaluation,
                                State &next, StepReport &report)
  {
    const double theta = step_problem_.theta;
    next.step = old_.step + 1;
    next.time = old_.time + h;
    next.last_step = h;
    next.impulse = impulse_;
    next.relative_velocity.resize(impulse_.size());
    relative_velocity(bodies_.velocity(), next.time, next.relative_velocity);
    next.jump.resize(impulse_.size());
    for (std::size_t k = 0; k < impulse_.size(); ++k)
      next.jump[k] =
          step_problem_.jump_free[k] + h * theta * next.relative_velocity[k];
    bodies_.finish(next);
    const Communicator &all = this->dynamics_.communicator();
    this->ledger_->book(step_problem_, evaluation, origins_,
                        sum(all, bodies_.book()), old_, next, report);
    next.energy.work += all.sum(obstacle_work());
    // springs of two stiffnesses store other energies as their frames turn
    std::vector<double> stored;
    for (std::size_t i = 0; i < this->problem_.n_owned; ++i)
      stored.push_back(step_problem_.weight[i] *
                       stored_energy<dim>(step_problem_, i));
    next.energy.numerical -= all.sum(stored) - old_.energy.cohesive;
    close_books(old_, next, report);
  }

  /** By contact of this rank. */
  template <int dim>
  std::vector<double> LargeMotion<dim>::obstacle_work() const
  {
    const double theta = this->input_.time.theta;
    std::vector<double> result;
    for (std::size_t k = 0; k < bodies_.n_own_rows(); ++k) {
      double &work = result.emplace_back();
      const auto before = obstacle_velocity(k, old_.time),
                 after =
                     obstacle_velocity(k, old_.time + step_problem_.time_step);
      for (unsigned int a = 0; a < dim; ++a)
        work += impulse_[bodies_.row_point(k) * dim + a] *
                (theta * after[a] + (1. - theta) * before[a]);
    }
    return result;
  }

  /** What a contact leaves to its place. */
  template <int dim>
  struct LargeMotion<dim>::SurfaceMemory {
    std::size_t index, place, twin; ///< index of the row
    std::array<double, dim> impulse;
    double slip, overlap, approach, worn, wear_speed;
    std::uint8_t contact;
  };

  template <int dim>
  std::vector<typename LargeMotion<dim>::SurfaceMemory>
  LargeMotion<dim>::own_memory(const State &next) const
  {
    std::vector<SurfaceMemory> result;
    for (std::size_t k = 0; k < bodies_.n_own_rows(); ++k) {
      const MovingRow<dim> &row = bodies_.rows()[k];
      const std::size_t i = bodies_.row_point(k);
      if (row.place == row.nowhere)
        continue;
      SurfaceMemory memory{};
      memory.index = row.index;
      memory.place = row.place;
      memory.twin = row.twin;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          memory.impulse[d] += bodies_.points().frame[(i * dim + a) * dim + d] *
                               next.impulse[i * dim + a];
      memory.slip = next.slip[i];
      memory.overlap = next.released_overlap[i];
      memory.approach = next.approach[i];
      memory.contact = next.contact[i];
      if (!next.worn.empty()) {
        memory.worn = next.worn[i];
        memory.wear_speed = next.wear_speed[i];
      }
      result.push_back(memory);
    }
    return result;
  }

  /** Contacts live for one step; what their places remember stays, on all
      ranks. Collective. */
  template <int dim>
  void LargeMotion<dim>::remember_surfaces(const State &old, State &next) const
  {
    next.surface_impulse.assign(old.surface_impulse.size(), 0.);
    next.surface_slip = old.surface_slip;
    next.surface_worn = old.surface_worn;
    next.surface_wear_speed.assign(old.surface_wear_speed.size(), 0.);
    next.surface_overlap = old.surface_overlap;
    next.surface_approach = old.surface_approach;
    next.surface_contact.assign(old.surface_contact.size(), 0);
    const auto raise = [](std::vector<double> &values, const std::size_t place,
                          const double value) {
      values[place] = std::max(values[place], value);
    };
    auto rows = gather_all(this->dynamics_.communicator(), own_memory(next));
    std::sort(rows.begin(), rows.end(),
              [](const auto &a, const auto &b) { return a.index < b.index; });
    for (const SurfaceMemory &row : rows) {
      for (unsigned int d = 0; d < dim; ++d)
        next.surface_impulse[row.place * dim + d] += row.impulse[d];
      next.surface_slip[row.place] = row.slip;
      for (const std::size_t place : {row.place, row.twin})
        if (place != MovingRow<dim>::nowhere) {
          raise(next.surface_overlap, place, row.overlap);
          raise(next.surface_approach, place, row.approach);
        }
      next.surface_contact[row.place] |= row.contact;
      if (!next.worn.empty()) {
        next.surface_worn[row.place] = row.worn;
        next.surface_wear_speed[row.place] = row.wear_speed;
      }
    }
  }

  /** The contacts of this rank that carried something. */
  template <int dim>
  std::vector<SurfaceTouch> LargeMotion<dim>::touches(const State &next) const
  {
    std::vector<SurfaceTouch> result;
    const auto &points = bodies_.points();
    for (std::size_t k = 0; k < bodies_.n_own_rows(); ++k) {
      const MovingRow<dim> &row = bodies_.rows()[k];
      const std::size_t i = bodies_.row_point(k);
      if (row.partner == MovingRow<dim>::Partner::pin || !next.contact[i])
        continue;
      SurfaceTouch &touch = result.emplace_back();
      touch.obstacle = row.partner == MovingRow<dim>::Partner::obstacle;
      touch.block = row.block;
      touch.material_2 =
          this->discretization_.body_table().bodies[row.body_2].material;
      touch.weight = row.weight;
      touch.opening = next.jump[i * dim];
      for (unsigned int d = 0; d < dim; ++d) {
        touch.position[d] = points.position[i * dim + d];
        touch.normal[d] = points.frame[i * dim * dim + d];
        for (unsigned int a = 0; a < dim; ++a)
          touch.impulse[d] +=
              points.frame[(i * dim + a) * dim + d] * next.impulse[i * dim + a];
      }
    }
    return result;
  }

  template <int dim>
  template <typename Array>
  void LargeMotion<dim>::erase_rows(Array &array,
                                    const unsigned int width) const
  {
    const auto first = array.begin() + long(bodies_.row_point(0) * width);
    if (!array.empty())
      array.erase(first, first + long(bodies_.rows().size() * width));
  }

  template <int dim>
  void LargeMotion<dim>::forget_rows(State &next) const
  {
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          if (has_field(this->input_, field))
            erase_rows(next.*member, field.width(dim));
        });
  }

  template <int dim>
  std::string LargeMotion<dim>::describe(const std::size_t i) const
  {
    if (i >= origins_.size())
      return "unknown";
    return MoreauJean<dim>::describe(origins_[i],
                                     &bodies_.points().position[i * dim]);
  }

  template <int dim>
  void LargeMotion<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    MoreauJean<dim>::fill_counters(c);
    c["motion_iterations"] = double(motion_counters_.iterations);
    c["motion_iterations_most"] = double(motion_counters_.most_iterations);
    if (!contacts_)
      return;
    const auto &contacts = contacts_->counters();
    c["contact_searches"] = double(contacts.searches);
    c["contact_facets"] = double(contacts.facets);
    c["contact_rows"] = double(contacts.rows);
    c["contact_overlap"] = contacts.largest_overlap;
  }

  template class LargeMotion<2>;
  template class LargeMotion<3>;
} // namespace nsfd
