#pragma once

#include "load_step_iterate.h"

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/solver.h"

#include <utility>
#include <vector>

namespace nsfd
{
  template <int dim>
  class StaticBonds;

  /**
   * The laws of a load step held as what they are as long as nothing is damaged
   * beyond its history: springs, and joints that do not open. The equilibrium
   * of that is unique but for contact, no round goes astray, and it is the one
   * sought where no point is damaged in it.
   */
  template <int dim>
  class HeldLaws
  {
  public:
    /** All are those of the rounds and outlive this; @p bonds or null. */
    HeldLaws(const Discretization<dim> &discretization,
             const DelassusOperator<dim> &delassus,
             OneStepProblem<dim> &problem, LoadStepIterate<dim> &iterate,
             const bool has_extrinsic, StaticBonds<dim> *const bonds)
        : discretization_(discretization), delassus_(delassus),
          problem_(problem), iterate_(iterate), has_extrinsic_(has_extrinsic),
          bonds_(bonds)
    {
    }

    /** A load step starts, with laws. */
    void begin();

    /** From now on the rounds see springs; until release() or begin(). */
    void hold();
    /** Laws again, next to where the held rounds have ended. */
    void release();
    bool holds() const { return holds_; }
    /** Of a spring, while laws are held: as far as the point is damaged. */
    Reach &held(const std::size_t point) { return held_[point]; }
    const Interaction &law(const std::size_t point) const
    {
      return interactions_[interaction_[point]];
    }
    /** G/R_max of a point, m, while laws are held. */
    double opening_scale(std::size_t point) const;
    /** The point has a law that it follows or will follow. */
    bool may_damage(std::size_t point) const;
    /** The damage of the start of the step. */
    Reach history(std::size_t point) const;

    /** Springs in place of the laws of a round; joints stay as they are. */
    void put_springs();

    /**
     * The loads of joined points over their strength at the start of the step,
     * from the forces at hand, once per step. Collective.
     */
    void find_joint_loads();

    /** Where the held rounds have come to. */
    struct Prediction {
      bool damages = false; ///< some point does not stay what it was held to be
      /// of the step until the first point comes to its peak that is not there
      /// yet, by straight lines; 1: none does
      double share = 1.;
      bool certain = false;  ///< lines are right: it is elastic to its peak
      std::size_t point = 0; ///< local, where this rank has the first one
    };
    /** Collective, after held rounds that have settled. */
    Prediction prediction();

    /**
     * The same springs, of points that are damaged as far as the last held
     * rounds have opened them, and @p stretch times the growth: the next ones
     * along the path of an overdamped motion. False if nothing grows.
     */
    bool let_damage_grow(double &largest_growth, double stretch);

    /** How the points of this rank went along their laws, see Passage. */
    struct Passages {
      double least = 1.;     ///< what the point has seen that saw least
      std::size_t point = 0; ///< that point
      double largest = 0.;   ///< of the points that damage
    };
    /**
     * In the step from the last equilibrium to @p next. What was
     * damaged on an overdamped @p path has seen what it carried on it.
     */
    Passages passages(const State &next, bool path) const;

  private:
    std::vector<double> joint_shares() const;
    void let_joints_go(std::vector<char> &fresh);
    double load_at_start(std::size_t point, double now,
                         const std::vector<double> &joints) const;
    Reach held_reach(std::size_t point) const;

    const Discretization<dim> &discretization_;
    const DelassusOperator<dim> &delassus_;
    OneStepProblem<dim> &problem_;
    LoadStepIterate<dim> &iterate_;
    const bool has_extrinsic_; ///< points that are rigid until they activate
    StaticBonds<dim> *bonds_;  ///< of bodies that share nodes, or null
    bool holds_ = false;
    std::vector<Reach> held_;               ///< histories of the springs
    std::vector<Interaction> interactions_; ///< of the laws
    std::vector<unsigned int> interaction_; ///< of the points in these
    std::vector<double> joint_loads_;       ///< over the strength, at the start
    bool joint_loads_known_ = false;
  };
} // namespace nsfd
