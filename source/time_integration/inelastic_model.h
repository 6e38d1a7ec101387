#pragma once

#include "body_model.h"
#include "step_parts.h"

#include "bodies/inelastic_bodies.h"

namespace nsfd
{
  /**
   * Bodies of small motions with history-dependent materials. Only their
   * stresses are no linear function of the motion: where the cells move as
   * their tangents have foretold, the linear problem was the right one. A step
   * without flow is that of LinearMoreauJean.
   */
  template <int dim>
  class InelasticModel final : public BodyModel<dim>
  {
  public:
    InelasticModel(const StepParts<dim> &parts, InelasticBodies<dim> &bodies);

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

    StepPoints<dim> points() override;
    const std::vector<double> &velocity() const override { return v_; }
    std::vector<double>
    free_velocity(const std::vector<double> &impulse) const override;
    void relative_velocity(const std::vector<double> &v,
                           std::vector<double> &U) const override;
    double kinetic_product(const std::vector<double> &v) const override;

    std::string describe(std::size_t point) const override;

  private:
    const StepParts<dim> parts_;
    InelasticBodies<dim> &bodies_;

    // of the step
    const State *old_ = nullptr;
    double time_step_ = 0.;
    std::vector<double> pressure_, pressure_impulse_; ///< in cracks
    std::vector<double> v_, v_linear_; ///< of the bodies, and of their tangents
  };
} // namespace nsfd
