#pragma once

#include "prescribed_groups.h"
#include "rigid_share.h"
#include "turning_body.h"

#include "bodies/body_layout.h"
#include "core/order_free_sum.h"
#include "joined/ghost_cells.h"

#include <array>
#include <string>

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
   *
   * In motions of any size R is that of the places at the start of a step,
   * about the centre of mass of all that moves with the body. The kick changes
   * V there; on the way to the next places both momenta and the energy stay.
   * A place moves by h (v + omega x r) + h^2/2 omega x (omega x r) then, to
   * third order, which supports know.
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

    // of motions of any size

    /** They are where @p state has them, before find(). */
    void set_places(const State &state);
    /** To the end of a step of length @p h, with velocities there. The name of
        the fastest of the bodies that it turns too far; empty: none. */
    std::string fly(double h, CornerGroups<dim> &groups);
    void show(State &state) const;

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
    /** v.M v of the bodies, J: without impulses of points, and of what impulses
        have done to their velocities. */
    struct Sizes {
      double motion = 0., impulses = 0.;
    };
    Sizes sizes() const;

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
      dealii::Point<dim> rest;
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
      bool is_given = false;    ///< mass or inertia are not those of its cells
      std::size_t first_free = 0;
      Motion velocity{}, before{}, without{}; ///< without: points
      Motion given{};                         ///< k R^T f, N s
      std::vector<Motion> rows; ///< sums of C by driven boundary and component
      TurningBody cells{}, cells_before{}; ///< rigid ones; any size
      dealii::Point<dim> centre_before;    ///< the step
      /// in State::rigid: number, and centre at rest
      std::vector<std::pair<std::size_t, Vec3>> parts;

      /** R of a place: translation, and rotation times the size. */
      std::array<Motion, dim> motions(const dealii::Point<dim> &x) const;
      /** The angular velocity, axes of space. */
      Vec3 spin() const;
      /** Where a place at rest is now. */
      dealii::Point<dim> place(const Vec3 &at_rest) const;
      /** What a turn adds to the velocity of a place @p x on its way through a
          step of length @p h. */
      Vec3 beside_chord(const dealii::Point<dim> &x, const double h) const
      {
        using namespace space;
        const Vec3 omega = spin();
        return (h / 2.) * cross(omega, cross(omega, in_space<dim>(x - centre)));
      }
    };

    /** A place that does not move: at rest, and in space. */
    struct Pin {
      std::size_t body;
      Vec3 at;
    };

    void set_inertia();
    void set_centres(const CornerGroups<dim> &groups);
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
    const bool large_; ///< motions of any size
    std::vector<Body> bodies_;
    std::vector<Pin> pins_;
    std::vector<Member> members_;
    std::vector<int> member_; ///< by group, -1: none
    std::size_t n_free_ = 0;
  };

  /** Adds @p share of the velocity of @p group to @p shares, if a body that can
      move takes it. */
  template <int dim>
  void add_share(const RigidGroups<dim> &rigid, unsigned int group,
                 double share, std::vector<RigidShare<dim>> &shares);
} // namespace nsfd
