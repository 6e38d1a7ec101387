#include "large_motion_model.h"

#include "common_balance.h"
#include "contact_fields.h"
#include "initial_state.h"
#include "nonsmooth/point_law.h"
#include "passing_bodies.h"
#include "point_name.h"

#include "contact_detection/touching_rules.h"
#include "core/gather.h"
#include "core/stopwatch.h"
#include "discretization/face_sizes.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** Those of all ranks. */
    template <int dim>
    std::vector<MovingRow<dim>>
    pin_rows(const SceneInput &input, const MovingBodies<dim> &bodies,
             const Communicator &communicator, const State &old)
    {
      std::vector<MovingRow<dim>> own;
      for (unsigned int k = 0; k < input.pins.size(); ++k) {
        MovingRow<dim> row;
        row.partner = MovingRow<dim>::Partner::pin;
        row.body_2 = bodies.rigid_motions().body_of_pin(k);
        if (!bodies.layout().is_own(row.body_2))
          continue;
        row.pin = row.block = k;
        row.weight = 1.;
        // as a support
        row.interaction =
            unsigned(input.interfaces.size() + input.obstacles.size());
        row.jump = bodies.rigid_motions().pin_drift(k, old);
        own.push_back(row);
      }
      if (input.pins.empty())
        return own;
      auto all = gather_all(communicator, own);
      std::sort(all.begin(), all.end(),
                [](const auto &a, const auto &b) { return a.pin < b.pin; });
      return all;
    }

    template <int dim>
    PointOrigin origin_of(const MovingRow<dim> &row)
    {
      using Partner = typename MovingRow<dim>::Partner;
      PointOrigin origin;
      origin.block = row.block;
      origin.kind = row.partner == Partner::pin ? PointOrigin::Kind::pin
                    : row.partner == Partner::obstacle
                        ? PointOrigin::Kind::obstacle
                        : PointOrigin::Kind::surface;
      return origin;
    }

    /**
     * The speed that vanished at the end of the last step is not quite zero in
     * the frame of this one: what is closed and rests would sink in as its
     * bodies turn. Its mean velocity vanishes, which does no work.
     */
    template <int dim>
    void keep_gaps(const ContactPoints<dim> &contacts, const State &old,
                   const bool lifts, OneStepProblem<dim> &problem)
    {
      const double theta = problem.theta;
      for (std::size_t k = 0; k < contacts.rows().size(); ++k) {
        const std::size_t i = contacts.row_point(k);
        const auto &law = problem.interactions[problem.interaction[i]];
        if (!old.contact[i] || law.restitution != 0.)
          continue;
        const double lift_speed =
            lifts ? old.dilation_speed[i] - old.wear_speed[i] : 0.;
        problem.target[i] = -(1. - theta) / theta *
                            (old.relative_velocity[i * dim] - lift_speed);
      }
    }

    /**
     * Jumps are differences of places: of a face that has just begun to open
     * they are known to a few digits only. One beyond its history would hold
     * more than its strength.
     */
    template <int dim>
    void keep_histories(const ContactPoints<dim> &contacts,
                        const std::size_t n_mesh_points,
                        const OneStepProblem<dim> &problem, State &old)
    {
      for (std::size_t j = 0; j < n_mesh_points; ++j) {
        const std::size_t i = contacts.mesh_point(j);
        const auto &interaction = problem.interactions[problem.interaction[i]];
        if (old.kind[i] != PointKind::cohesive || !interaction.law->extrinsic())
          continue;
        const Reach reach = reach_of<dim>(interaction, &old.jump[i * dim]);
        old.opening_max[i] = std::max(old.opening_max[i], reach.opening);
        if (!old.slip_max.empty())
          old.slip_max[i] = std::max(old.slip_max[i], reach.slip);
      }
    }

    /**
     * The two places of a point that slides turn about each other with its
     * face, by as much as they are apart: what of an overlap comes by this is
     * there like that of a spring, and what closes in the step comes on top.
     */
    template <int dim>
    void explain_turns(const ContactPoints<dim> &contacts,
                       const std::size_t n_mesh_points, const State &start,
                       State &old)
    {
      for (std::size_t j = 0; j < n_mesh_points; ++j) {
        const std::size_t i = contacts.mesh_point(j);
        const double depth = -old.jump[i * dim],
                     turned = depth + start.jump[j * dim];
        double &overlap = old.released_overlap[i];
        overlap = start.released_overlap[j];
        if (has_impulse(old.kind[i]) && depth > 0. && turned > 0.)
          overlap += std::min(depth, turned);
      }
    }

    /**
     * Broken points whose sides have slid past each other, though others of
     * their face still hold: what keeps the distance of two places along the
     * normal of the face is no contact there. @p face_size and the result by
     * point of the mesh.
     */
    template <int dim>
    std::vector<char> slid_apart(const std::vector<double> &face_size,
                                 const State &next)
    {
      std::vector<char> slid(face_size.size(), 0);
      for (std::size_t j = 0; j < slid.size(); ++j) {
        if (next.kind[j] != PointKind::free || next.two_sided[j])
          continue;
        double square = 0.;
        for (unsigned int c = 1; c < dim; ++c)
          square += next.jump[j * dim + c] * next.jump[j * dim + c];
        const double least = inset * face_size[j];
        slid[j] = square > least * least;
      }
      return slid;
    }
  } // namespace

  template <int dim>
  LargeMotionModel<dim>::LargeMotionModel(const StepParts<dim> &parts,
                                          MovingBodies<dim> &bodies)
      : parts_(parts), bodies_(bodies), lifts_(has_sliding_lift(parts.input)),
        obstacles_(parts.input, bodies.contacts()), held_rows_(parts, bodies),
        history_(parts.discretization, bodies.contacts(),
                 parts.delassus.communicator())
  {
    if (parts.input.contacts.empty() && parts.input.obstacles.empty())
      return;
    contacts_ = std::make_unique<SurfaceContacts<dim>>(
        parts.input, parts.discretization, bodies.layout(),
        parts.delassus.communicator());
    face_size_ = face_sizes(parts.discretization.points());
  }

  template <int dim>
  LargeMotionModel<dim>::~LargeMotionModel() = default;

  template <int dim>
  State LargeMotionModel<dim>::initial_state() const
  {
    const SceneInput &input = parts_.input;
    State state = initial_motion(input, parts_.discretization);
    bodies_.set_initial(state);
    state.obstacle_shift = initial_shifts(input);
    bodies_.start(state, 0., input.time.theta,
                  std::vector<double>(state.velocity.size(), 0.),
                  state.obstacle_shift, state.obstacle_shift);
    bodies_.set_rows({});
    bodies_.set_middle();
    parts_.delassus.renew(0., input.time.theta);
    const std::size_t n = bodies_.points().n_points;
    const auto jumps = bodies_.jumps(state.displacement);
    state.jump.assign(n * dim, 0.);
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          state.jump[i * dim + a] +=
              bodies_.points().axes(i)[a * dim + d] * jumps[i * dim + d];
    state.relative_velocity.resize(n * dim);
    parts_.delassus.relative_velocity(bodies_.old_velocity().data(),
                                      state.relative_velocity.data());
    set_points(input, parts_.discretization, parts_.problem, state);
    if (contacts_)
      contacts_->set_initial(state);
    complete(state);
    begin_balance(state);
    return state;
  }

  template <int dim>
  void LargeMotionModel<dim>::complete(State &state) const
  {
    const Communicator &all = parts_.delassus.communicator();
    const BodyEnergies energies = sum(all, bodies_.energies(state));
    state.energy.kinetic = energies.kinetic;
    state.energy.elastic = energies.elastic;
    state.energy.cohesive = stored_in_points(all, parts_.problem, state);
  }

  // ------------------------------------------------------- data of one step

  template <int dim>
  void LargeMotionModel<dim>::start(const State &old, const double h,
                                    const std::vector<double> &loads,
                                    State &next)
  {
    const double theta = parts_.input.time.theta;
    start_ = &old;
    time_step_ = h;
    applied_.clear();
    held_rows_.start(old);
    next.obstacle_shift = obstacles_.shifts(old, h);
    bodies_.start(old, h, theta, loads, old.obstacle_shift,
                  next.obstacle_shift);
    std::vector<MovingRow<dim>> rows;
    if (contacts_) {
      const Stopwatch watch(parts_.timings.contact_search);
      rows = contacts_->rows(old, h, bodies_.largest_speed(old));
    }
    const auto pins =
        pin_rows(parts_.input, bodies_, parts_.delassus.communicator(), old);
    rows.insert(rows.end(), pins.begin(), pins.end());
    bodies_.set_rows(rows);
    add_contacts();
    mesh_jumps_ = bodies_.jumps(old.displacement);
    pressure_impulse_.clear();
    if (parts_.free_motion.has_crack_pressure()) {
      parts_.free_motion.set_pressure(old, old.time + theta * h, next.pressure);
      pressure_impulse_ = parts_.free_motion.pressure_impulse(next.pressure, h);
      insert_contacts(bodies_.contacts(), pressure_impulse_, dim, 0.);
      insert_contacts(bodies_.contacts(), next.pressure, 1, 0.);
    }
  }

  /** State and problem with the contacts of the step. */
  template <int dim>
  void LargeMotionModel<dim>::add_contacts()
  {
    const std::size_t n = bodies_.points().n_points;
    old_ = *start_;
    insert_contacts(parts_.input, bodies_.contacts(), old_);
    resize(problem_, n);
    problem_.n_owned = bodies_.points().n_owned;
    problem_.theta = parts_.problem.theta;
    problem_.rule = parts_.problem.rule;
    problem_.interactions = parts_.problem.interactions;
    problem_.interaction = parts_.problem.interaction;
    problem_.strength_factor = parts_.problem.strength_factor;
    problem_.opening_factor = parts_.problem.opening_factor;
    insert_contacts(bodies_.contacts(), problem_.interaction, 1, 0);
    insert_contacts(bodies_.contacts(), problem_.strength_factor, 1, 1.);
    insert_contacts(bodies_.contacts(), problem_.opening_factor, 1, 1.);
    problem_.weight = bodies_.points().weight;
    if (has_opening_viscosity(parts_.input))
      problem_.viscosity.assign(n, 0.);
    if (lifts_) {
      problem_.dilatancy.assign(n, 0.);
      problem_.lift_left.assign(n, 0.);
    }
    origins_ = parts_.discretization.origins();
    insert_contacts(bodies_.contacts(), origins_, 1, {});
    for (std::size_t k = 0; k < bodies_.contacts().rows().size(); ++k) {
      const MovingRow<dim> &row = bodies_.contacts().rows()[k];
      const std::size_t i = bodies_.contacts().row_point(k);
      origins_[i] = origin_of(row);
      problem_.interaction[i] = row.interaction;
      if (row.partner == MovingRow<dim>::Partner::pin)
        old_.kind[i] = PointKind::prescribed;
    }
    history_.take(*start_, old_);
  }

  template <int dim>
  StepPoints<dim> LargeMotionModel<dim>::points()
  {
    return {problem_, origins_, old_};
  }

  template <int dim>
  const std::vector<double> &LargeMotionModel<dim>::velocity() const
  {
    return bodies_.velocity();
  }

  template <int dim>
  void LargeMotionModel<dim>::relative_velocity(const std::vector<double> &v,
                                                std::vector<double> &U) const
  {
    parts_.delassus.relative_velocity(v.data(), U.data());
    obstacles_.subtract_velocity(old_.time + time_step_, U);
  }

  template <int dim>
  double
  LargeMotionModel<dim>::kinetic_product(const std::vector<double> &v) const
  {
    return parts_.delassus.communicator().sum(bodies_.kinetic_products(v, v));
  }

  /** In the frames at hand: jumps, relative velocities, what acts where. */
  template <int dim>
  void LargeMotionModel<dim>::set_problem()
  {
    const auto &rows = bodies_.contacts().rows();
    const std::size_t n = parts_.discretization.points().n_points;
    for (std::size_t j = 0; j < n; ++j)
      for (unsigned int a = 0; a < dim; ++a) {
        const std::size_t i = bodies_.contacts().mesh_point(j);
        const double *const frame = bodies_.points().axes(i);
        double value = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          value += frame[a * dim + d] * mesh_jumps_[j * dim + d];
        old_.jump[i * dim + a] = value;
      }
    keep_histories(bodies_.contacts(), n, problem_, old_);
    explain_turns(bodies_.contacts(), n, *start_, old_);
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (unsigned int a = 0; a < dim; ++a)
        old_.jump[bodies_.contacts().row_point(k) * dim + a] =
            rows[k].partner == MovingRow<dim>::Partner::pin ? rows[k].jump[a]
            : a == 0                                        ? rows[k].gap
                                                            : 0.;
    parts_.delassus.relative_velocity(bodies_.old_velocity().data(),
                                      old_.relative_velocity.data());
    obstacles_.subtract_velocity(old_.time, old_.relative_velocity);
    parts_.step_problem.set(origins_, old_, time_step_, problem_);
    held_rows_.set(origins_, old_, problem_);
    if (parts_.input.time.contact_target == ContactTarget::energy_safe)
      keep_gaps(bodies_.contacts(), old_, lifts_, problem_);
  }

  /**
   * (134), (136) for contacts of surfaces: gap + h (gamma_1 rate + gamma_2
   * U_N), the rate that of the start of the step, where a contact that rests
   * has none, and U_N that of the motion at hand. What has once been active in
   * a step stays so, or the iteration could go round. Corners are rounded to
   * 2^-41 of a cell, so that equal cells have one matrix: bodies that stand on
   * each other at the start may be as far apart, and must not fall as long as a
   * step.
   */
  template <int dim>
  void LargeMotionModel<dim>::forecast(const bool first)
  {
    const auto &time = parts_.input.time;
    const double h = time_step_;
    const auto &rows = bodies_.contacts().rows();
    if (first)
      active_.assign(rows.size(), 0);
    std::vector<double> U;
    if (time.forecast_gamma2 > 0.) {
      U.resize(old_.jump.size());
      relative_velocity(bodies_.velocity(), U);
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k].partner == MovingRow<dim>::Partner::pin)
        continue;
      const std::size_t i = bodies_.contacts().row_point(k);
      double gap = rows[k].gap + h * time.forecast_gamma1 * rows[k].rate;
      if (!U.empty())
        gap += h * time.forecast_gamma2 * U[i * dim];
      if (!old_.worn.empty())
        gap += old_.worn[i] + h * time.forecast_gamma1 * old_.wear_speed[i];
      const auto &law = problem_.interactions[problem_.interaction[i]];
      const bool rests = old_.contact[i] && law.restitution == 0.;
      if ((first || !U.empty()) &&
          gap <= (rests ? 1e-9 : 1e-12) * parts_.discretization.extent())
        active_[k] = 1;
      problem_.contact[i] = active_[k];
    }
  }

  // ------------------------------------------------------- end of the step

  template <int dim>
  void LargeMotionModel<dim>::finish(const LawEvaluation<dim> &,
                                     State &next) const
  {
    const std::size_t n = next.impulse.size();
    next.relative_velocity.resize(n);
    relative_velocity(bodies_.velocity(), next.relative_velocity);
    next.jump.resize(n);
    for (std::size_t k = 0; k < n; ++k)
      next.jump[k] = problem_.jump_free[k] +
                     time_step_ * problem_.theta * next.relative_velocity[k];
    bodies_.finish(next);
    if (!parts_.input.contacts.empty()) {
      next.last_way.resize(next.displacement.size());
      for (std::size_t k = 0; k < next.last_way.size(); ++k)
        next.last_way[k] = next.displacement[k] - start_->displacement[k];
    }
    refuse_missed_contacts(next);
  }

  /** A step that would pass over a contact ends where this begins. */
  template <int dim>
  void LargeMotionModel<dim>::refuse_missed_contacts(const State &next) const
  {
    if (!contacts_)
      return;
    const auto missed = contacts_->missed(*start_, next);
    if (!missed)
      return;
    throw passing_bodies(parts_.input, parts_.discretization.body_table(),
                         *missed, start_->time, time_step_);
  }

  template <int dim>
  BodyEnergies LargeMotionModel<dim>::account(State &) const
  {
    return sum(parts_.delassus.communicator(), bodies_.account());
  }

  template <int dim>
  void LargeMotionModel<dim>::account_rest(State &next,
                                           StepReport &report) const
  {
    const Communicator &all = parts_.delassus.communicator();
    next.energy.work +=
        all.sum(obstacles_.work(next.impulse, old_.time, problem_.time_step));
    // springs of two stiffnesses store other energies as their frames turn
    std::vector<double> stored;
    for (std::size_t i = 0; i < parts_.problem.n_owned; ++i)
      stored.push_back(problem_.weight[i] * stored_energy<dim>(problem_, i));
    next.energy.numerical -= all.sum(stored) - old_.energy.cohesive;
    close_balance(old_, next, report);
  }

  template <int dim>
  void LargeMotionModel<dim>::accept(State &next)
  {
    if (contacts_) {
      history_.leave(*start_, next);
      contacts_->store_facets(next);
      if (!parts_.input.observables.empty())
        next.touches = history_.touches(next);
    }
    erase_contacts(parts_.input, bodies_.contacts(), next);
    if (contacts_)
      contacts_->part(next, slid_apart<dim>(face_size_, next));
  }

  template <int dim>
  std::string LargeMotionModel<dim>::describe(const std::size_t i) const
  {
    return name_of_point<dim>(parts_.input, origins_, bodies_.points().position,
                              i);
  }

  template <int dim>
  void
  LargeMotionModel<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    if (!contacts_)
      return;
    const auto &contacts = contacts_->counters();
    c["contact_searches"] = double(contacts.searches);
    c["contact_facets"] = double(contacts.facets);
    c["contact_rows"] = double(contacts.rows);
    c["contact_overlap"] = contacts.largest_overlap;
  }

  template class LargeMotionModel<2>;
  template class LargeMotionModel<3>;
} // namespace nsfd
