#pragma once

#include "body_layout.h"
#include "contact_points.h"
#include "deformable_cells.h"
#include "middle_of_step.h"
#include "moving_faces.h"
#include "rigid_motions.h"
#include "step_motion.h"

#include "core/communicator.h"
#include "discretization/discretization.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  struct BodyEnergies;

  /**
   * The bodies of this rank in a scene with large motions: deformable cells
   * with nodal velocities, and rigid ones, each of one cell or of all connected
   * cells of a material. A rigid body has the unknowns of RigidStep (in the
   * plane V_x, V_y, a_z). Displacements of the state are nodal for all cells;
   * those of rigid bodies follow from their places and turns, which all ranks
   * know: State::rigid, in the order of BodyTable.
   *
   * During a step they are linear in what DelassusOperator sees: bodies() and
   * points() with traces, frames and tangents at the middle of the motion.
   * There a point moves by exactly h H v_theta.
   */
  template <int dim>
  class MovingBodies
  {
  public:
    /** Collective. */
    MovingBodies(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 const Communicator &communicator);
    MovingBodies(const MovingBodies &) = delete;

    const BodyLayout<dim> &layout() const { return layout_; }
    const RigidMotions<dim> &rigid_motions() const { return rigid_motions_; }
    const ContactPoints<dim> &contacts() const { return contacts_; }
    const Bodies &bodies() const { return bodies_; }
    const InterfacePoints<dim> &points() const { return contacts_.points(); }

    // --- between steps ---

    /** The rigid motions nearest to the nodal fields of @p state; materials
        have not been strained yet. Collective. */
    void set_initial(State &state) const;
    /** Of all ranks. Collective. */
    double largest_speed(const State &state) const;
    /** Kinetic and elastic energy, by body. */
    std::vector<BodyEnergies> energies(const State &state) const;
    /** See MovingFaces. Collective. */
    std::vector<double> jumps(const std::vector<double> &displacement) const
    {
      return faces_.jumps(displacement);
    }

    // --- one step ---

    /** @p forces by node, @p shifts of the obstacles at its start and end. */
    void start(const State &old, double time_step, double theta,
               const std::vector<double> &forces,
               const std::vector<double> &shift_old,
               const std::vector<double> &shift_new);
    /** The contacts of the step, those of all ranks. */
    void set_rows(const std::vector<MovingRow<dim>> &rows)
    {
      contacts_.set(rows, bodies_);
    }
    /** Unknown velocities at the start and now. */
    const std::vector<double> &old_velocity() const { return motion_.v_old; }
    const std::vector<double> &velocity() const { return motion_.v; }
    /** Frames, traces and tangents at the middle of the motion with v.
        Collective. */
    void set_middle();
    /**
     * The bodies under the generalised impulses @p r, from velocities near
     * @p v: velocity() and the motion. False if one of them has no solution.
     */
    bool move(const std::vector<double> &r, const std::vector<double> &v);
    /** In place of move(), if all bodies are rigid: they stay where they are,
        without a velocity. */
    void stay();
    /** The motion of the step into @p next. Collective. */
    void finish(State &next) const;
    /** Energies at the end of the step, losses, work of the loads, by body. */
    std::vector<BodyEnergies> account() const;
    /** M (x, y): the kinetic product of velocities by unknown, by body. */
    std::vector<double> kinetic_products(const std::vector<double> &x,
                                         const std::vector<double> &y) const;

  private:
    using Vector = dealii::Tensor<1, dim>;
    using Place = dealii::Point<dim>;

    void make_bodies();
    RigidLoad load_of(const MovingBody &mover) const;
    void set_step_end(std::size_t b);
    void set_body(std::size_t b);
    CellMotion motion_of(unsigned int cell) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const Communicator &all_;
    const BodyLayout<dim> layout_;
    const RigidMotions<dim> rigid_motions_;
    const MovingFaces<dim> faces_;
    ContactPoints<dim> contacts_;
    StepMotion motion_;
    Bodies bodies_;
    MiddleOfStep<dim> middle_;
    DeformableCells<dim> cells_;
    FiniteScratch scratch_;
  };
} // namespace nsfd
