#pragma once

#include "deformable_cells.h"

#include "discretization/discretization.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  struct BodyEnergies;

  /**
   * The bodies of a scene of small motions with history-dependent materials. To
   * DelassusOperator, bodies() are linear: a cell of such a material is a class
   * of its own, with the tangent of its motion as its stiffness.
   */
  template <int dim>
  class InelasticBodies
  {
  public:
    explicit InelasticBodies(const Discretization<dim> &discretization);

    const Bodies &bodies() const { return bodies_; }
    /** Of a scene that has never been strained. */
    std::vector<double> begin_history() const { return cells_.begin_history(); }

    /** @p forces of the loads by unknown, N; they and @p old must stay. */
    void start(const State &old, double time_step, double theta,
               const std::vector<double> &forces);
    /** Tangents of the motion with @p v; true if there are others now. */
    bool set_tangents(const std::vector<double> &v);
    /** Of the history-dependent cells, those at the start of the step. */
    void put_old_velocities(std::vector<double> &v) const;
    /** The history-dependent cells move under the generalised impulses @p r,
       from velocities near @p v; false if one of them has no solution. */
    bool move(const std::vector<double> &r, std::vector<double> &v);
    /** By body, energies of the step to @p next, whose motion is known, losses,
        work of the loads; the internal variables of the materials goes into @p
       next. */
    std::vector<BodyEnergies> account(State &next) const;

  private:
    void set_end(const std::vector<double> &v, std::size_t body);
    CellMotion motion_of(std::size_t body, const double *end) const;

    const Discretization<dim> &discretization_;
    DeformableCells<dim> cells_;
    Bodies bodies_;
    std::vector<unsigned int> history_bodies_; ///< bodies
    FiniteScratch scratch_;

    // of the step
    const State *old_ = nullptr;
    const std::vector<double> *forces_ = nullptr;
    double time_step_ = 0., theta_ = 0.5;
    std::vector<double> end_, tangent_;
  };
} // namespace nsfd
