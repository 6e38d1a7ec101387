#pragma once

#include "body_model.h"
#include "held_rows.h"
#include "obstacle_motion.h"
#include "step_parts.h"
#include "surface_history.h"

#include "bodies/moving_bodies.h"
#include "bodies/surface_contacts.h"

#include <memory>

namespace nsfd
{
  /**
   * Bodies with rotations and strains of any size (report, 3.1-3.2 and
   * (127)-(133)): deformable cells by the energy-conserving rule (129), rigid
   * bodies by Newton-Euler, contact between any two surfaces.
   *
   * Traces, frames and tangents are those at the middle of the motion. They
   * turn with it: the iteration ends when the velocities rest. Then points
   * have moved by exactly h H v_theta: energies and both momenta are those of
   * the impulses.
   */
  template <int dim>
  class LargeMotionModel final : public BodyModel<dim>
  {
  public:
    LargeMotionModel(const StepParts<dim> &parts, MovingBodies<dim> &bodies);
    ~LargeMotionModel() override;

    State initial_state() const override;
    void complete(State &state) const override;

    void start(const State &old, double time_step,
               const std::vector<double> &loads, State &next) override;
    bool predict(bool starts_cold, std::vector<double> &impulse) override;
    void linearise() override;
    bool move(const std::vector<double> &impulse,
              const std::vector<double> &v) override;
    double error() const override;
    void finish(const LawEvaluation<dim> &evaluation,
                State &next) const override;
    BodyEnergies account(State &next) const override;
    void account_rest(State &next, StepReport &report) const override;
    void accept(State &next) override;

    StepPoints<dim> points() override;
    const std::vector<double> &velocity() const override;
    std::vector<double>
    free_velocity(const std::vector<double> &impulse) const override;
    void relative_velocity(const std::vector<double> &v,
                           std::vector<double> &U) const override;
    double kinetic_product(const std::vector<double> &v) const override;

    std::string describe(std::size_t point) const override;
    void fill_counters(std::map<std::string, double> &counters) const override;

    /** Null if nothing can touch. */
    const SurfaceContacts<dim> *contacts() const { return contacts_.get(); }

  private:
    void add_contacts();
    void set_problem();
    void forecast(bool first);
    void refuse_missed_contacts(const State &next) const;

    const StepParts<dim> parts_;
    MovingBodies<dim> &bodies_;
    const bool lifts_; ///< by dilatancy or wear
    const ObstacleMotion<dim> obstacles_;
    HeldRows<dim> held_rows_;
    const SurfaceHistory<dim> history_;
    std::unique_ptr<SurfaceContacts<dim>> contacts_;
    std::vector<double> face_size_; ///< by point of the mesh; empty without

    // of the step: points as MovingBodies has them
    const State *start_ = nullptr; ///< without contacts
    State old_;                    ///< with them
    double time_step_ = 0.;
    OneStepProblem<dim> problem_;
    std::vector<PointOrigin> origins_;
    std::vector<double> mesh_jumps_;       ///< Cartesian, at the start
    std::vector<char> active_;             ///< contacts of the step: forecast
    std::vector<double> pressure_impulse_; ///< in cracks
    std::vector<double> tangent_velocity_; ///< of the tangents at hand
    std::vector<double> applied_; ///< to bodies, with the traces of then
    double share_ = 1.; ///< of the way to the impulses of the last round
  };
} // namespace nsfd
