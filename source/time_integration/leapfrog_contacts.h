#pragma once

#include "leapfrog_points.h"
#include "time_integrator.h"

#include "bodies/rigid_places.h"
#include "bodies/row_geometry.h"
#include "bodies/surface_contacts.h"
#include "joined/corner_groups.h"
#include "nonsmooth/one_step_problem.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * Contact between any two surfaces, and with obstacles, in explicit steps of
   * joined cells. A contact is between a node of a surface and a facet, or
   * between two edges; their groups carry its impulses P. The gap g at the
   * start of a step of length h asks for
   *
   *   U_N+ >= a = min(-g/h, -U_N-),   P_N >= 0,   P_N (U_N+ - a) = 0,
   *
   * (-0.1 U_N- where it overlaps and closes: it shall not bounce)
   * and -e U_N- at least where the contact closes with a restitution e. The
   * first is no overlap at the end of the step, the second that the work
   * P_N (U_N+ + U_N-)/2 of a contact on the bodies is never positive. Friction
   * opposes the velocity after the step and, where that would do work on the
   * bodies, the mean of both. What slides and overlaps, since facets turn in a
   * step, may be pushed apart by work that friction takes in the same step.
   */
  template <int dim>
  class LeapfrogContacts
  {
  public:
    /** @p all are the constant data of the points of the mesh. */
    LeapfrogContacts(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const OneStepProblem<dim> &all,
                     const Communicator &communicator);
    ~LeapfrogContacts();

    /** Nothing kept yet. */
    void set_initial(State &state) const { surfaces_.set_initial(state); }
    /** What the surfaces keep is that of @p state, with its groups. */
    void start(const State &state, const CornerGroups<dim> &groups);

    /** How far the faces of active points have opened, @p way as for left():
        after every step, and when chains have been read. */
    void set_kinds(const LeapfrogChains<dim> &chains, double way);
    /** Points of the mesh that are left to the search now, by what active ones
        are; @p way as for left(). */
    std::vector<unsigned int> part(const LeapfrogChains<dim> &chains,
                                   double way);
    /** How far active point @p a, which softens or is broken, has left its
        other side: its two sides touch other places than each other (slid), or
        overlap by more than they can have closed on the largest @p way of a
        step, since its face has turned after it has slid. */
    struct Left {
      bool slid = false, overlaps = false;
    };
    Left left(const LeapfrogChains<dim> &chains, std::size_t a,
              double way) const;

    /**
     * What may touch in a step of length @p h from @p time, groups at its
     * start; @p prescribed: bit c of a group, component c.
     */
    void find(double time, double h,
              const std::vector<std::uint8_t> &prescribed,
              const RigidGroups<dim> *rigid, const CornerGroups<dim> &groups);
    bool any() const { return !contacts_.empty(); }

    using Cluster = typename LeapfrogPoints<dim>::Cluster;
    /**
     * Those that push have groups in common with nodes: @p node_of
     * group is the node that has points and it, or no_node. Others stay out.
     */
    std::vector<Cluster> clusters(const std::vector<std::size_t> &node_of);
    static constexpr std::size_t no_node = std::size_t(-1);
    /** The impulses of the last clusters(). */
    void take(const std::vector<Cluster> &clusters);
    static constexpr double part_of_tolerance = 1e-4;
    static constexpr double same_normal = 0.999; ///< cosine between two
    /** The others that push: their impulses, and what these do to the
       velocities of @p groups, which have none of them, and @p of_bodies, see
       RigidGroups::move(). What is left over of a problem with rigid bodies,
       0 without. */
    double solve_others(double tolerance, std::vector<double> &of_bodies,
                        CornerGroups<dim> &groups);
    /** With the velocities after all: those that overlap at the end push from
        now on, friction that works on the bodies opposes the mean velocity.
        False if there is nothing new. */
    bool improve(const CornerGroups<dim> &groups);

    struct Balance {
      double friction = 0., positive_friction = 0., impact = 0.,
             work = 0.;                     ///< J; of obstacles
      double penetration = 0., excess = 0.; ///< m
      unsigned int active = 0;
    };
    /** What the step passes over, with @p groups and rigid bodies at its end.
     */
    std::optional<StepRejected> missed(const CornerGroups<dim> &groups);
    /** Of the step, with the velocities of the groups after it. */
    Balance account(const CornerGroups<dim> &groups);
    /** The balanced step is taken. */
    void accept();
    /** See LeapfrogPoints. */
    void add_impulses(const std::vector<int> &row_of_group,
                      std::vector<double> &rows) const;

    /** Places of the surfaces, and what touched in the last step. */
    void show(State &state) const;
    void fill_counters(std::map<std::string, double> &counters) const;

  private:
    using Vector = std::array<double, dim>;
    struct Contact {
      MovingRow<dim> row;
      std::vector<std::size_t> places; ///< of all rows that are the same
      double known = 0.; ///< overlap that the way of a step explains, m
      std::array<double, dim> place{};
      std::array<double, dim * dim> frame{}; ///< rows n, t1, t2
      /// groups and what they have in the velocity of body 2 less that of
      /// body 1
      std::vector<std::pair<unsigned int, double>> ends;
      std::vector<RigidShare<dim>> bodies; ///< and what moves such groups
      Vector before{}, impulse{}, velocity{}, obstacle{}; ///< local
      double target = 0., least = 0., friction = 0.; ///< target without work
      bool turned = false, pushes = false; ///< friction opposes the mean
      bool can_part = true; ///< the motion along the normal is not prescribed

      /** Of U_T where friction opposes the sum. */
      Vector offset() const
      {
        Vector result{};
        for (unsigned int c = 1; c < dim; ++c)
          result[c] = -obstacle[c] + (turned ? before[c] : 0.);
        return result;
      }
      /** It goes no deeper, and is not pushed apart. */
      void hold()
      {
        least = std::min(least, 0.);
        target = std::min(target, 0.);
      }
      Vector in_frame(const Vector &v) const
      {
        Vector result{};
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c)
            result[r] += frame[r * dim + c] * v[c];
        return result;
      }
    };

    void follow(const CornerGroups<dim> &groups);
    bool make(const MovingRow<dim> &row, const CornerGroups<dim> &groups,
              Contact &contact) const;
    Vector relative_velocity(const Contact &contact,
                             const std::vector<double> &velocity) const;
    void add(const Contact &contact, const Vector &impulse,
             std::vector<double> &velocity) const;
    bool turn(Contact &contact) const;
    bool set_yield(const dealii::Tensor<1, dim> &normal,
                   const CornerGroups<dim> &groups, Contact &contact) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const OneStepProblem<dim> &all_;
    const BodyLayout<dim> layout_;
    const RigidPlaces<dim> balls_;
    SurfaceContacts<dim> surfaces_;
    State state_; ///< of the surfaces
    State after_; ///< where they are at the end of the step
    std::vector<unsigned int> part_of_; ///< by body: of what was one
    std::vector<double> face_size_;     ///< of the points of the mesh, m
    std::size_t n_groups_ = 0; ///< of the wholes that the surfaces know
    double time_step_ = 0.;
    const RigidGroups<dim> *rigid_ = nullptr; ///< of the step; null: none
    std::vector<Contact> contacts_;           ///< of the step
    /// of these, those that push or have pushed in the step; which cluster they
    /// are in, -1: none
    std::vector<unsigned int> chosen_;
    std::vector<int> cluster_of_;
    std::vector<double> inverse_mass_; ///< dim per group, 1/kg
    unsigned long long inexact_ = 0;   ///< not solved to the tolerance
  };
} // namespace nsfd
