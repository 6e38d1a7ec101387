#pragma once

#include "bodies/inelastic_bodies.h"

#include "moreau_jean.h"

namespace nsfd
{
  /**
   * The implicit Moreau-Jean step of small motions with materials that
   * remember. Newton's iteration around the nonsmooth problem: the cells move
   * under the impulses at hand, each by itself and exactly; what more impulse
   * would do is linear, with their tangents, and makes the nonsmooth problem of
   * linear bodies. It ends when cells move as their tangents have said. A step
   * without flow is that of MoreauJean.
   */
  template <int dim>
  class InelasticMotion final : public MoreauJean<dim>
  {
  public:
    /** @p dynamics is that of @p bodies. */
    InelasticMotion(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    InelasticBodies<dim> &bodies, Dynamics<dim> &dynamics,
                    NonsmoothSolver<dim> &solver);

    State initial_state() const override;
    StepReport advance(const State &old, double time_step, State &next,
                       unsigned int idle_rounds) override;

    struct MotionCounters {
      unsigned long long iterations = 0, most_iterations = 0;
    };
    const MotionCounters &motion_counters() const { return motion_counters_; }

  private:
    bool move_bodies(const std::vector<double> &impulse,
                     std::vector<double> &v);
    double kinetic_product(const std::vector<double> &v) const;
    void linearise(const State &old, double time_step);
    bool begin(const State &old, double time_step, const State &next);
    SolverReport iterate(const State &old, double time_step,
                         const SolverControl &control, State &next,
                         std::unique_ptr<LawEvaluation<dim>> &evaluation);
    void correct_motion(const State &old, State &next) const;

    InelasticBodies<dim> &bodies_;
    MotionCounters motion_counters_;

    // of the step
    std::vector<double> crack_impulse_;
    std::vector<double> v_, v_linear_; ///< of the bodies, and of their tangents
    double energy_scale_ = 0.;
  };
} // namespace nsfd
