#pragma once

#include "deformable_cells.h"
#include "row_geometry.h"

#include "core/neighbor_messages.h"
#include "delassus/dynamics.h"
#include "nsfd/bodies/rigid_step.h"
#include "nsfd/discretization/discretization.h"
#include "nsfd/nonsmooth/one_step_problem.h"
#include "state/state.h"

#include <array>
#include <map>
#include <memory>
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

    /** Collective. */
    MovingBodies(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 const Communicator &communicator);
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
    /** Of the BodyTable. */
    unsigned int number(const std::size_t b) const { return movers_[b].number; }
    bool is_own(const unsigned int body_of_table) const
    {
      return local_body_[body_of_table] >= 0;
    }

    /** Of a node of SurfaceCells in a cell of this rank: that of the state. */
    std::size_t own_node(const std::size_t node) const
    {
      return discretization_.first_node(local_cell_[node / nodes_per_cell_]) +
             node % nodes_per_cell_;
    }

    const Bodies &bodies() const { return bodies_; }
    const InterfacePoints<dim> &points() const { return points_; }

    // --- between steps ---

    /** The rigid motions nearest to the nodal fields of @p state; materials
        have not been strained yet. Collective. */
    void set_initial(State &state) const;
    /** Of a node of the state. */
    Place place(const State &state, const std::size_t node) const
    {
      return at_nodes(rest_, node) + Vector(at_nodes(state.displacement, node));
    }
    /** Of all ranks. Collective. */
    double largest_speed(const State &state) const;
    /** Kinetic and elastic energy, by body. */
    std::vector<BodyEnergies> energies(const State &state) const;
    /** The body of the table that pin @p k holds; how far its place is off if
        it is a body of this rank. */
    unsigned int body_of_pin(unsigned int k) const;
    std::array<double, dim> pin_drift(unsigned int k, const State &state) const;
    /** x2 - x1 of the points of the mesh, less its value at rest. Collective.
     */
    std::vector<double> jumps(const std::vector<double> &displacement) const;

    // --- one step ---

    /** @p forces by node, @p shifts of the obstacles at its start and end. */
    void start(const State &old, double time_step, double theta,
               const std::vector<double> &forces,
               const std::vector<double> &shift_old,
               const std::vector<double> &shift_new);
    /**
     * The contacts of the step, those of all ranks. This rank has rows() of
     * them: its own, whose body 2 is here, then others with its bodies. They
     * are points between those that the rank owns on the mesh and the others.
     */
    void set_rows(const std::vector<MovingRow<dim>> &rows);
    const std::vector<MovingRow<dim>> &rows() const { return rows_; }
    std::size_t n_own_rows() const { return n_own_rows_; }
    std::size_t row_point(const std::size_t row) const
    {
      return n_own_mesh_points_ + row;
    }
    /** Where point @p i of the mesh is among all points. */
    std::size_t mesh_point(const std::size_t i) const
    {
      return point_of_step(i, n_own_mesh_points_, rows_.size());
    }
    /** Unknown velocities at the start and now. */
    const std::vector<double> &old_velocity() const { return v_old_; }
    const std::vector<double> &velocity() const { return v_; }
    /** Frames, traces and tangents at the middle of the motion with v.
        Collective. */
    void set_middle();
    /**
     * The bodies under the generalised impulses @p r, from velocities near
     * @p v: velocity() and the motion. False if one of them has no solution.
     */
    bool move(const std::vector<double> &r, const std::vector<double> &v);
    /** The motion of the step into @p next. Collective. */
    void finish(State &next) const;
    /** Energies at the end of the step, losses, work of the loads, by body. */
    std::vector<BodyEnergies> book() const;
    /** M (x, y): the kinetic product of velocities by unknown, by body. */
    std::vector<double> kinetic_products(const std::vector<double> &x,
                                         const std::vector<double> &y) const;

  private:
    struct Mover {
      std::vector<unsigned int> cells;
      unsigned int number = 0; ///< in the table
      unsigned int material = 0;
      int rigid = -1; ///< index of the rigid body on this rank, or -1
      std::size_t rigid_number = 0; ///< among those of all ranks
      double radius = 0.;           ///< of a ball
      RigidInertia inertia;
      Vec3 centre{};            ///< at rest
      double extra_weight = 0.; ///< mass beyond that of its cells, kg
    };
    /** A place of a point of the mesh on a body. */
    struct Slot {
      unsigned int cell, slot, point;
      signed char sign;
    };

    /** Of a contact of this rank. */
    struct RowBodies {
      std::array<int, 2> body{{-1, -1}}; ///< of this rank, or -1
      std::array<unsigned int, 2> slot{};
      int other_rank = -1; ///< of the other body, if it is not this one
    };

    void make_movers();
    void set_inertia(Mover &mover);
    void make_points();
    void set_slot_gradients();
    RigidState rigid_state(const State &state, const Mover &mover) const;
    void put_rigid(const RigidState &rigid, const Mover &mover,
                   State &state) const;
    void share_rigid(State &state) const;
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
    void choose_rows(const std::vector<MovingRow<dim>> &rows,
                     std::vector<unsigned int> &n_slots);
    void place_points();
    void add_row_faces();
    void set_slots(const std::vector<unsigned int> &n_slots);
    void set_neighbors();
    void place_rows();
    void set_own_ends(std::size_t k);
    void share_ends();
    void set_row(std::size_t k);
    void share_sides(std::array<std::vector<double>, 2> &side,
                     unsigned int stride) const;
    Place at_nodes(const std::vector<double> &x, std::size_t node) const;
    Place middle(std::size_t node) const;
    Place middle_centre(std::size_t body) const;
    Place middle_of_pin(std::size_t body, unsigned int pin) const;
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
    const Communicator &all_;
    std::size_t n_nodes_ = 0, nodes_per_cell_ = 0;
    std::vector<double> rest_; ///< nodal places
    std::vector<Mover> movers_;
    std::vector<unsigned int> mover_of_; ///< by cell
    std::vector<int> local_body_;        ///< by body of the table, -1: not here
    std::vector<unsigned int> local_cell_; ///< by cell of the table
    std::vector<std::vector<Slot>> slots_; ///< by body
    /// per class of the cells: gradients at the slots, slot x node
    std::vector<std::vector<Vector>> slot_gradients_;
    DeformableCells<dim> cells_;
    FiniteScratch scratch_;
    Bodies bodies_;
    InterfacePoints<dim> points_;
    std::size_t n_mesh_points_ = 0, n_own_mesh_points_ = 0, n_mesh_faces_ = 0;

    // of the step
    double time_step_ = 0., theta_ = 0.5;
    std::vector<double> u_old_, u_new_, forces_, middle_; ///< by node
    std::vector<double> history_;   ///< of the materials, at the start
    std::vector<double> v_old_, v_; ///< by unknown
    std::vector<RigidStep> rigid_;
    std::vector<double> shift_middle_;
    std::vector<MovingRow<dim>> rows_; ///< own ones first
    std::size_t n_own_rows_ = 0;
    std::vector<RowBodies> row_bodies_;
    std::vector<RowEnds<dim>> row_ends_;
    /// rows with a body on another rank, by this rank, in their order
    std::map<int, std::vector<unsigned int>> rows_by_rank_;
  };
} // namespace nsfd
