#pragma once

#include "bodies/moving_bodies.h"
#include "bodies/surface_contacts.h"

#include "moreau_jean.h"

#include <memory>

namespace nsfd
{
  /**
   * The implicit Moreau-Jean step with rotations and strains of any size
   * (report, 3.1-3.2 and (127)-(133)): deformable cells by the
   * energy-conserving rule (129), rigid bodies by Newton-Euler, contact between
   * any two surfaces.
   *
   * Newton's iteration (131): the bodies move under the impulses at hand, each
   * by itself and exactly; what more impulse would do is linear, with traces,
   * frames and tangents at the middle of the motion, and makes the nonsmooth
   * problem of small motions. It ends when the velocities rest. Then points
   * have moved by exactly h H v_theta: energies and both momenta are those of
   * the impulses.
   */
  template <int dim>
  class LargeMotion final : public MoreauJean<dim>
  {
  public:
    /** @p dynamics is that of @p bodies. */
    LargeMotion(const SceneInput &input,
                const Discretization<dim> &discretization,
                MovingBodies<dim> &bodies, Dynamics<dim> &dynamics,
                NonsmoothSolver<dim> &solver);
    ~LargeMotion() override;

    State initial_state() const override;
    StepReport advance(const State &old, double time_step, State &next,
                       unsigned int idle_rounds) override;

    void fill_counters(std::map<std::string, double> &counters) const override;

    struct MotionCounters {
      unsigned long long iterations = 0, most_iterations = 0;
      double search_seconds = 0.;
    };
    const MotionCounters &motion_counters() const { return motion_counters_; }
    /** Null if nothing can touch. */
    const SurfaceContacts<dim> *contacts() const { return contacts_.get(); }

  protected:
    using MoreauJean<dim>::describe;
    std::string describe(std::size_t point) const override;

  private:
    std::vector<MovingRow<dim>> pins(const State &old) const;
    void set_shifts(const State &old, double time_step, State &next) const;
    template <typename Array>
    void insert_rows(Array &array, unsigned int width,
                     typename Array::value_type value) const;
    template <typename Array>
    void erase_rows(Array &array, unsigned int width) const;
    void extend(const State &old);
    void set_row_memory(std::size_t row, const State &old);
    void start(const State &old, double time_step, State &next);
    std::array<double, dim> obstacle_velocity(std::size_t row,
                                              double time) const;
    void relative_velocity(const std::vector<double> &v, double time,
                           std::vector<double> &U) const;
    void set_problem(double time_step);
    void keep_gaps();
    void forecast(double time_step, bool first);
    void warm_start(const State &old);
    bool move_bodies(const std::vector<double> &v);
    SolverReport iterate(const State &old, double time_step,
                         const SolverControl &control,
                         std::unique_ptr<LawEvaluation<dim>> &evaluation);
    std::string lost_body(double time_step, double time) const;
    void finish(double time_step, const LawEvaluation<dim> &evaluation,
                State &next, StepReport &report);
    std::vector<double> obstacle_work() const;
    struct SurfaceMemory;
    std::vector<SurfaceMemory> own_memory(const State &next) const;
    void remember_surfaces(const State &old, State &next) const;
    std::vector<SurfaceTouch> touches(const State &next) const;
    void forget_rows(State &next) const;

    MovingBodies<dim> &bodies_;
    const bool lifts_; ///< by dilatancy or wear
    std::unique_ptr<SurfaceContacts<dim>> contacts_;
    MotionCounters motion_counters_;

    // of the step: points as MovingBodies has them
    State old_;
    OneStepProblem<dim> step_problem_;
    std::vector<PointOrigin> origins_;
    std::vector<double> mesh_jumps_; ///< Cartesian, at the start
    std::vector<char> active_;       ///< contacts of the step: forecast
    std::vector<double> impulse_, crack_impulse_;
    double energy_scale_ = 0.;
  };
} // namespace nsfd
