#pragma once

#include "prescribed_groups.h"

#include "core/order_free_sum.h"
#include "joined/ghost_cells.h"

#include <array>

namespace nsfd
{
  class Archive;

  /**
   * Rigid bodies in the steps of Leapfrog: cells of rigid materials that intact
   * faces join, and the groups of corners that they take along. With V the
   * translation of the centre and the rotation, times a length,
   *
   *   v = R V on its groups,   M (V+ - V-) = k R^T f + R^T P + C^T lambda,
   *
   * M the inertia of the rigid cells and the lumped masses of deformable
   * corners in its groups. Supports ask for C V = g: V = G^+ C^T g + E y, G =
   * C^T C, C E = 0, E^T M E = 1, and y is free. All of it is the same on all
   * ranks.
   */
  template <int dim>
  class RigidGroups
  {
  public:
    static constexpr unsigned int n_motions = dim == 2 ? 3 : 6;
    using Motion = std::array<double, n_motions>; ///< m/s, N s or sqrt(J)

    /**
     * @p body_of_corner: see rigid_clusters(); @p ghosts of the cells, if there
     * may be some. Collective.
     */
    RigidGroups(const Discretization<dim> &discretization,
                const JoinedMesh<dim> &mesh, const Communicator &communicator,
                const GhostCells *ghosts, std::vector<int> body_of_corner);

    /**
     * Groups are others now, and so are their rows in @p supports. Collective.
     * @throws std::runtime_error on all ranks where two bodies share a node and
     * no face.
     */
    void find(const CornerGroups<dim> &groups, PrescribedGroups<dim> &supports);
    /** @throws std::runtime_error on all ranks if supports ask for what is no
        motion of a rigid body. Collective. */
    void check(double end, const CornerGroups<dim> &groups,
               const PrescribedGroups<dim> &supports) const;

    /** Velocities of the bodies are nearest to those of the groups. */
    void start(CornerGroups<dim> &groups);

    /**
     * Sets the velocities of the bodies and of their groups in a step as
     * PrescribedGroups does, without impulses of points. Collective.
     */
    void set_velocities(double time, double h, double kick,
                        const std::vector<double> &forces,
                        const std::vector<double> &loads,
                        const PrescribedGroups<dim> &supports,
                        CornerGroups<dim> &groups);

    /** Of all bodies: what supports leave free. */
    std::size_t n_free() const { return n_free_; }
    bool takes(const unsigned int group) const
    {
      return group < member_.size() && member_[group] >= 0;
    }
    /** By free unknown of the body of a group that it takes, the first of which
        is @p first: the velocity of the group. */
    std::vector<std::array<double, dim>> columns(unsigned int group,
                                                 std::size_t &first) const;
    /** Velocities without impulses of points, and what the free unknowns @p y,
        sqrt(J), add to them. */
    void move(const std::vector<double> &y, CornerGroups<dim> &groups);
    /** v.M v of the bodies without impulses of points, J. */
    double size_of_motion() const;

    /**
     * Work of the impulses that the motions ask for, J; adds to the reactions
     * of @p supports, which has the impulses of the points in its rows.
     * Collective.
     */
    double work(double kick, PrescribedGroups<dim> &supports) const;

    /** v.M v/2 of the bodies, J; @p terms, those of all groups, are then
        without their rigid cells. */
    double kinetic_energy(const CornerGroups<dim> &groups,
                          std::vector<double> &terms) const;

    /** The step is not taken. */
    void go_back();
    /** Velocities. */
    void serialize(Archive &archive);

  private:
    using Matrix = std::array<Motion, n_motions>;

    /** A group that a body takes along. */
    struct Member {
      unsigned int group, body;
      std::array<Motion, dim> R;
      double mass = 0.; ///< of corners of cells that deform
      bool counts;
    };
    struct Body {
      dealii::Point<dim> centre;
      double size = 1.; ///< length of the rotations, m
      Matrix rigid_mass{}, mass{};
      Matrix inverse_of_rows{}; ///< G^+
      std::vector<Motion> free; ///< columns of E
      bool is_held = false;     ///< there are rows
      std::size_t first_free = 0;
      Motion velocity{}, before{}, without{}; ///< without: points
      Motion given{};                         ///< k R^T f, N s
      std::vector<Motion> rows; ///< sums of C by driven boundary and component
    };

    std::array<Motion, dim> motions(const Body &body,
                                    const dealii::Point<dim> &x) const;
    void set_inertia();
    void find_members(const CornerGroups<dim> &groups);
    void set_masses();
    void hold(const PrescribedGroups<dim> &supports);
    std::vector<Motion> sums(const std::vector<OrderFreeSum> &own) const;
    std::vector<Motion> asked(double time, double h,
                              const PrescribedGroups<dim> &supports,
                              const CornerGroups<dim> &groups) const;
    void scatter(CornerGroups<dim> &groups) const;

    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const Communicator &communicator_;
    const GhostCells *ghosts_;
    const std::vector<int> body_of_corner_;
    std::vector<Body> bodies_;
    std::vector<Member> members_;
    std::vector<int> member_; ///< by group, -1: none
    std::size_t n_free_ = 0;
  };
} // namespace nsfd
