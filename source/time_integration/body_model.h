#pragma once

#include "bodies/body_energies.h"

#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"
#include "nonsmooth/solver.h"
#include "state/state.h"

#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  struct StepReport;

  /** The points of a step, and its start as they see it. */
  template <int dim>
  struct StepPoints {
    OneStepProblem<dim> &problem;
    const std::vector<PointOrigin> &origins;
    const State &old;
  };

  /**
   * Bodies whose motion is no linear function of the impulses, with the points
   * at which these act, as NewtonMoreauJean steps them. Impulses and velocities
   * of points are components in the frames of the step, dim per point; those of
   * bodies are by unknown. All functions but the short ones are collective.
   */
  template <int dim>
  class BodyModel
  {
  public:
    virtual ~BodyModel() = default;

    virtual State initial_state() const = 0;
    /** Kinetic, elastic and cohesive energy of @p state, and its bonds. */
    virtual void complete(State &state) const = 0;

    // --- one step, in this order ---

    /**
     * From @p old, which stays, over @p time_step under @p loads in N by
     * unknown; what acts in it goes into @p next.
     */
    virtual void start(const State &old, double time_step,
                       const std::vector<double> &loads, State &next) = 0;
    /**
     * The motion under the impulses of the last step, or none if it @p
     * starts_cold, which go to @p impulse. Tangents and data of the points are
     * those for the first solve. False if a body has no motion.
     */
    virtual bool predict(bool starts_cold, std::vector<double> &impulse) = 0;
    /** Tangents and data of the points at the motion at hand. */
    virtual void linearise() = 0;
    /**
     * Each body by itself and exactly under @p impulse, from velocities near
     * @p v, which its tangents have foretold. False if one has no motion.
     */
    virtual bool move(const std::vector<double> &impulse,
                      const std::vector<double> &v) = 0;
    /** v.M v of how far the motion is off what the last solve took it for. */
    virtual double error() const = 0;
    /** The motion of the step into @p next, whose impulses are known. */
    virtual void finish(const LawEvaluation<dim> &evaluation,
                        State &next) const = 0;
    /** Of the bodies in the step to @p next, whose motion is known; what
        materials keep goes there. */
    virtual BodyEnergies account(State &next) const = 0;
    /** Points and bodies are accounted for in @p next: what is left. */
    virtual void account_rest(State &, StepReport &) const {}
    /** The step is accepted: what later ones need to know of it. */
    virtual void accept(State &) {}

    // --- during a step ---

    virtual StepPoints<dim> points() = 0;
    /** Of the bodies now. */
    virtual const std::vector<double> &velocity() const = 0;
    /** The motion without the impulses that it was found with, linear in them;
        @p impulse are those. */
    virtual std::vector<double>
    free_velocity(const std::vector<double> &impulse) const = 0;
    /** H v at the end of the step, relative to obstacles that move. */
    virtual void relative_velocity(const std::vector<double> &v,
                                   std::vector<double> &U) const = 0;
    /** v.M v, J. */
    virtual double kinetic_product(const std::vector<double> &v) const = 0;

    // --- for messages ---

    virtual std::string describe(std::size_t point) const = 0;
    virtual void fill_counters(std::map<std::string, double> &) const {}
  };
} // namespace nsfd
