#pragma once

#include "elastic_forces.h"
#include "uniqueness.h"

#include "bodies/body_energies.h"

#include "discretization/discretization.h"
#include "nonsmooth/solver.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  struct StepReport;

  /**
   * The energy balance of a step that has been solved: every energy line on its
   * own
   * ([AM06], 5.3), the history of the points (d_m, beta, kind, slip, bound of
   * the penetration), and the forces on driven boundaries.
   */
  template <int dim>
  class EnergyBalance
  {
  public:
    EnergyBalance(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const DelassusOperator<dim> &delassus,
                  const UniquenessBound<dim> &uniqueness);

    /**
     * From @p old to @p next, whose motion and impulses are known: everything
     * else of @p next, and all of @p report but the solver's. @p origins are
     * those of the points of @p problem. Collective.
     */
    void account(const OneStepProblem<dim> &problem,
                 const LawEvaluation<dim> &evaluation,
                 const std::vector<PointOrigin> &origins,
                 const BodyEnergies &bodies, const State &old, State &next,
                 StepReport &report);

    /** Of small motions; @p forces are the loads of the step, @p elastic K q of
        an explicit one, else null. Collective. */
    BodyEnergies book_bodies(const std::vector<double> &forces,
                             double time_step, const State &old,
                             const State &next,
                             const ElasticForces<dim> *elastic) const;

    /** Force on each driven boundary during the last step, dim per boundary. */
    const std::vector<double> &reactions() const { return reactions_; }

  private:
    double absorbed_power(const std::vector<double> &velocity) const;
    double pressure_work(const OneStepProblem<dim> &problem, const State &old,
                         const State &next) const;

    const Discretization<dim> &discretization_;
    const DelassusOperator<dim> &delassus_;
    const UniquenessBound<dim> &uniqueness_;
    double theta_; ///< of the velocity that impulses and loads work with
    std::vector<double> reactions_;
  };
} // namespace nsfd
