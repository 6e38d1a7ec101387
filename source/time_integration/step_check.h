#pragma once

#include "time_integrator.h"

#include <functional>

namespace nsfd
{
  struct SceneInput;

  /** A step that was taken. */
  struct TakenStep {
    const State &old, &next;
    double time_step;
    /// of what moves before the impulses act, see LawEvaluation, J
    double energy_scale;
    std::size_t worst_point; ///< of the solve
  };

  /** Whether a step is kept: solved, in balance, no energy from nowhere. */
  class StepCheck
  {
  public:
    using Describe = std::function<std::string(std::size_t point)>;

    /** @p describe says where a point of the step is. */
    StepCheck(const SceneInput &input, Describe describe);

    /** @throws StepRejected if it was not solved to the tolerance. */
    void check_solution(
        double time_step, double time, const SolverReport &report,
        std::size_t worst_point,
        StepRejected::Cure cure = StepRejected::Cure::shorter_step) const;

    /** Energies add up for any impulses, unless these have lost their digits.
        @throws StepRejected */
    void check_balance(const TakenStep &step, const StepReport &report);

    /**
     * Notes what the lines of the balance took. @throws StepRejected where one
     * gave energy that its rule cannot give: line, step and place.
     */
    void watch_energy(const TakenStep &step, StepReport &report);

    /**
     * The last attempt lost its digits or its energy: rows that ask for the
     * same share what no motion tells, warm starts carry it on, and it grows.
     * The next attempt starts without impulses.
     */
    bool starts_cold() const { return starts_cold_; }

  private:
    const SceneInput &input_;
    const Describe describe_;
    bool starts_cold_ = false;
  };
} // namespace nsfd
