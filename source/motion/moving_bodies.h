#pragma once

#include "deformable_cells.h"
#include "moving_row.h"

#include "nsfd/mesh/discretization.h"
#include "nsfd/motion/rigid_step.h"
#include "nsfd/time/state.h"

#include <memory>
#include <optional>
#include <vector>

namespace nsfd
{
  struct BodyEnergies;

  /**
   * The bodies of a scene with large motions: deformable cells with nodal
   * velocities, and rigid ones, each of one cell or of all connected cells of
   * a material. A rigid body has the unknowns of RigidStep (in the plane
   * V_x, V_y, a_z). Displacements of the state are nodal for all cells; those
   * of rigid bodies follow from their places and turns.
   *
   * During a step they are linear in what Dynamics sees: bodies() and points()
   * with traces, frames and tangents at the middle of the motion. There a point
   * moves by exactly h H v_theta.
   */
  template <int dim>
  class MovingBodies
  {
  public:
    using Vector = dealii::Tensor<1, dim>;
    using Place = dealii::Point<dim>;
    static constexpr unsigned int n_rigid = dim == 2 ? 3 : 6;

    MovingBodies(const SceneInput &input,
                 const Discretization<dim> &discretization);
    ~MovingBodies();

    std::size_t size() const { return movers_.size(); }
    bool is_rigid(const std::size_t b) const { return movers_[b].rigid >= 0; }
    unsigned int material_of(const std::size_t b) const
    {
      return movers_[b].material;
    }
    unsigned int body_of_cell(const unsigned int cell) const
    {
      return mover_of_[cell];
    }
    /** Of a rigid body, in its own frame, and what State::rigid says of it. */
    const RigidInertia &inertia(const std::size_t b) const
    {
      return movers_[b].inertia;
    }
    RigidState rigid_state(const State &state, const std::size_t b) const
    {
      return rigid_state(state, movers_[b]);
    }
    /** Radius of a body that is a ball, else 0. */
    double ball_radius(const std::size_t b) const { return movers_[b].radius; }

    const Bodies &bodies() const { return bodies_; }
    const InterfacePoints<dim> &points() const { return points_; }

    // --- between steps ---

    /** The rigid motions nearest to the nodal fields of @p state; materials
        have not been strained yet. */
    void set_initial(State &state) const;
    /** Nodes at x, dim per node of every cell, then the centres of all rigid
        bodies. */
    std::vector<double> positions(const State &state) const;
    std::size_t n_nodes() const { return n_nodes_; }
    std::size_t centre_node(const std::size_t body) const
    {
      return n_nodes_ + std::size_t(movers_[body].rigid);
    }
    double largest_speed(const State &state) const;
    /** Kinetic and elastic energy. */
    BodyEnergies energies(const State &state) const;
    /** The body that pin @p k holds, and how far its place is off. */
    unsigned int body_of_pin(unsigned int k) const;
    Vector pin_drift(unsigned int k, const State &state) const;
    /** x2 - x1 of the points of the mesh, less its value at rest. */
    std::vector<double> jumps(const std::vector<double> &displacement) const;

    // --- one step ---

    /** @p forces by node, @p shifts of the obstacles at its start and end. */
    void start(const State &old, double time_step, double theta,
               const std::vector<double> &forces,
               const std::vector<double> &shift_old,
               const std::vector<double> &shift_new);
    /** The contacts of the step, behind the points of the mesh. */
    void set_rows(std::vector<MovingRow<dim>> rows);
    const std::vector<MovingRow<dim>> &rows() const { return rows_; }
    /** Unknown velocities at the start and now. */
    const std::vector<double> &old_velocity() const { return v_old_; }
    const std::vector<double> &velocity() const { return v_; }
    /** Frames, traces and tangents at the middle of the motion with v. */
    void set_middle();
    /**
     * The bodies under the generalised impulses @p r, from velocities near
     * @p v: velocity() and the motion. False if one of them has no solution.
     */
    bool move(const std::vector<double> &r, const std::vector<double> &v);
    /** The motion of the step into @p next. */
    void finish(State &next) const;
    /** Energies at the end of the step, losses, work of the loads. */
    BodyEnergies book() const;
    /** M (x, y): the kinetic product of velocities by unknown. */
    double kinetic_product(const std::vector<double> &x,
                           const std::vector<double> &y) const;

  private:
    struct Mover
    {
      std::vector<unsigned int> cells;
      unsigned int material = 0;
      int rigid = -1;   ///< index of the rigid body, or -1
      double radius = 0.; ///< of a ball
      RigidInertia inertia;
      Vec3 centre{}; ///< at rest
      double extra_weight = 0.; ///< mass beyond that of its cells, kg
    };
    /** A place of a point of the mesh on a body. */
    struct Slot
    {
      unsigned int cell, slot, point;
      signed char sign;
    };

    void make_movers();
    void set_inertia(Mover &mover);
    void make_points();
    void set_slot_gradients();
    RigidState rigid_state(const State &state, const Mover &mover) const;
    void put_rigid(const RigidState &rigid, const Mover &mover,
                   State &state) const;
    void place_rigid(const RigidState &rigid, const Mover &mover,
                     std::vector<double> &displacement) const;
    RigidLoad load_of(const Mover &mover) const;
    void take_rigid_velocity(std::size_t b);
    void set_step_end(std::size_t b);
    void set_frames();
    void set_body(std::size_t b);
    void rigid_trace(std::size_t b, unsigned int slot, const Vector &arm);
    void deformable_trace(std::size_t b, unsigned int slot,
                          const dealii::Point<dim> &place);
    void set_row(std::size_t k);
    Place at_nodes(const std::vector<double> &x, std::size_t node) const;
    Place middle(std::size_t node) const;
    Place middle_centre(std::size_t body) const;
    Vector row_normal(const MovingRow<dim> &row) const;
    Place row_place(const MovingRow<dim> &row, const Vector &normal) const;
    /** A place of a cell as shape functions have it. */
    dealii::Point<dim> in_reference_cell(unsigned int cell,
                                         const std::size_t *nodes,
                                         const double *weights,
                                         unsigned int n_nodes,
                                         const Place &x) const;
    Vec3 in_space(const Vector &v) const;
    CellMotion motion_of(unsigned int cell) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    std::size_t n_nodes_ = 0;
    std::vector<double> rest_; ///< nodal places
    std::vector<Mover> movers_;
    std::vector<unsigned int> mover_of_; ///< by cell
    std::vector<std::vector<Slot>> slots_; ///< by body
    /// per class of the cells: gradients at the slots, slot x node
    std::vector<std::vector<Vector>> slot_gradients_;
    DeformableCells<dim> cells_;
    FiniteScratch scratch_;
    Bodies bodies_;
    InterfacePoints<dim> points_;
    std::size_t n_mesh_points_ = 0, n_mesh_faces_ = 0;

    // of the step
    double time_step_ = 0., theta_ = 0.5;
    std::vector<double> u_old_, u_new_, forces_, middle_; ///< by node
    std::vector<double> history_; ///< of the materials, at the start
    std::vector<double> v_old_, v_;                       ///< by unknown
    std::vector<RigidStep> rigid_;
    std::vector<double> shift_middle_;
    std::vector<MovingRow<dim>> rows_;
    std::vector<std::array<unsigned int, 2>> row_slots_;
  };
} // namespace nsfd
