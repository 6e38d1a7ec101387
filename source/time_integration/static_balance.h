#pragma once

#include "relaxation.h"
#include "time_integrator.h"

namespace nsfd
{
  /** What a step from equilibrium to equilibrium has left over. */
  struct EnergyLeft {
    double energy = 0.;   ///< in the cohesion, J
    double turnover = 0.; ///< what the step has moved: work, stored, dissipated
    double above_mean = 0.; ///< work of the loads above that of their mean, J
    std::size_t worst_point = 0; ///< local, of the largest share
    double worst = 0.;           ///< its share, J, this rank
  };

  /**
   * The energy balance of a step from equilibrium to equilibrium. Forces
   * balance at both ends, so that over a change dq of the displacements
   *
   *     d(q.K q/2) = (F_k + F_{k+1})/2 . dq + sum (r_k + r_{k+1})/2 . du,
   *
   * without any term of the scheme. What a point takes from the bodies by its
   * mean force is booked by its law: stored, damage, friction, nothing for a
   * contact. What is over is booked as numerical: of third order in the step
   * as long as the path is continuous, and what a solution jump leaves over.
   *
   * It is never negative. The laws take what they take on any path, so that
   * the loads and the prescribed motion have given no less than what is stored
   * and dissipated: where their mean forces come to less (the traction between
   * the two equilibria is above the straight line between its ends), that
   * least is their work, and what it is above the mean is reported.
   */
  template <int dim>
  class StaticBalance
  {
  public:
    StaticBalance(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const DelassusOperator<dim> &delassus)
        : discretization_(discretization), delassus_(delassus),
          reactions_(discretization.driven_boundaries().size() * dim, 0.),
          has_pressure_(has_pressure(input))
    {
    }

    /**
     * From @p old to @p next, of which displacement, jump, force and pressure
     * are known: everything else of it, and of @p report. @p forces_old are
     * the loads at @p old. Collective.
     */
    EnergyLeft account(Relaxation<dim> &relaxation,
                       const std::vector<double> &forces_old, const State &old,
                       State &next, StepReport &report);

    const std::vector<double> &reactions() const { return reactions_; }
    /** Those of another way to the same time. */
    void set_reactions(const std::vector<double> &reactions)
    {
      reactions_ = reactions;
    }

  private:
    static bool has_pressure(const SceneInput &input);

    const Discretization<dim> &discretization_;
    const DelassusOperator<dim> &delassus_;
    std::vector<double> reactions_;
    bool has_pressure_;
  };
} // namespace nsfd
