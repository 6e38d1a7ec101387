#pragma once

#include "leapfrog_contacts.h"
#include "leapfrog_energies.h"
#include "leapfrog_points.h"

#include "joined/finite_forces.h"

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>

namespace nsfd
{
  class Archive;

  /**
   * What motions of any size add to the steps of Leapfrog: points turn with
   * their faces, surfaces meet others, and forces are no linear function. In
   * small motions with materials that have a history only the last of these. In
   *
   *   E_{k+1/2} = v.M v/2 + U(q_k) - (h/2) f.v
   *
   * the way from q_{k-1} to q_k then leaves
   * U(q_k) - U(q_{k-1}) + (h/2) (f_{k-1} + f_k).v, the error of the trapezoidal
   * rule, of third order in h and without a sign: it is numerical.
   */
  template <int dim>
  class LeapfrogLarge
  {
  public:
    LeapfrogLarge(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const JoinedMesh<dim> &mesh, const OneStepProblem<dim> &all,
                  const Communicator &communicator,
                  NonlinearForces<dim> &forces);

    void set_initial(State &state) const;
    /** What materials keep in @p state, before its forces. */
    void take_histories(const State &state)
    {
      forces_.histories().set(state.material_history, state.last_step);
    }
    /** From @p state, with the forces there. */
    void start(const State &state, const CornerGroups<dim> &groups);

    /** Of the bound of the step at rest: what is stable now. */
    double stable_share() const;

    /** Before the velocities change in a step of length @p h from @p time. */
    void begin(double time, double h,
               const std::vector<std::uint8_t> &prescribed,
               const RigidGroups<dim> *rigid, const CornerGroups<dim> &groups,
               LeapfrogPoints<dim> &points, LeapfrogEnergies &energies);
    /** See LeapfrogPoints::solve(); with the @p rigid bodies, if not null, and
        what meets these. */
    typename LeapfrogPoints<dim>::Outcome
    solve(double h, double last, const std::vector<std::uint8_t> &prescribed,
          double tolerance, RigidGroups<dim> *rigid,
          LeapfrogPoints<dim> &points, CornerGroups<dim> &groups);
    void add_impulses(const std::vector<int> &row_of_group,
                      std::vector<double> &rows) const;
    /** What bodies and contacts have, with the forces that acted in the step;
        @p before are the velocities before it; @p h and @p last as there. */
    void take_energies(double h, double last, const std::vector<double> &before,
                       const CornerGroups<dim> &groups,
                       LeapfrogEnergies &energies);
    /** With the forces at its end, of step number @p step and length @p h;
        `power_after` is that of all forces before. */
    void take_forces(unsigned int step, double h,
                     const CornerGroups<dim> &groups,
                     LeapfrogEnergies &energies);
    /** A frame may turn by what its sides move: overlaps up to the largest
        @p way of a step so far are explained by it, m. */
    double widen(const double way) { return way_ = std::max(way_, way); }
    /** The step is taken; true if points have been left to the search. */
    bool accept(LeapfrogPoints<dim> &points);

    /** See LeapfrogContacts. */
    std::optional<StepRejected> missed(const CornerGroups<dim> &groups)
    {
      return contacts_ ? contacts_->missed(groups) : std::nullopt;
    }

    /** Collective. */
    double stored() const { return communicator_.sum(forces_.stored()); }
    /** Before the forces at the end of a step of length @p h, which may not be:
        see inverted(). */
    void begin_forces(const double h, const FrontViscosity &front)
    {
      before_ = {bulk_, stored_, stiffening_, front_held_, flow_};
      forces_.histories().begin_step(h);
      if (front.acts())
        front_ = front;
    }
    /** The step is not taken: before the forces are those at its start again,
        with the @p front that they had. */
    void go_back(FrontViscosity &front)
    {
      forces_.histories().go_back();
      std::tie(bulk_, stored_, stiffening_, front_held_, flow_) = before_;
      if (front.acts())
        front = front_;
    }
    /** Forces change so much in the step, or in one before, that the bulk gives
        what the certificate does not allow, in this step or when it comes back,
        and a shorter step would not give more; @p largest: energy of the run so
        far. */
    bool is_too_long(double largest);
    /** No cell was well in a step of this length. */
    void ask_for_shorter_steps()
    {
      stiffening_ *= 4.;
      halving_.waits = false;
    }
    /** Where a cell is turned inside out, on all ranks the same; empty:
        nowhere. Collective. */
    std::string inverted() const;
    void show(State &state) const;
    void fill_counters(std::map<std::string, double> &counters) const;
    void serialize(Archive &archive, const LeapfrogPoints<dim> &points);

  private:
    std::vector<double> front_powers(
        const CornerGroups<dim> &groups,
        const std::vector<const std::vector<double> *> &velocities) const;
    void take_front(double held, LeapfrogEnergies &energies);
    std::vector<std::size_t>
    nodes_of_groups(const LeapfrogPoints<dim> &points,
                    const CornerGroups<dim> &groups) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const Communicator &communicator_;
    NonlinearForces<dim> &forces_;
    std::unique_ptr<LeapfrogContacts<dim>> contacts_; ///< null: none
    FrontViscosity front_; ///< of the forces that act in the step
    double turned_ = 0.;   ///< see LeapfrogEnergies, until a step is taken, J
    double bulk_ = 0.;     ///< of the last way, which the next step takes, J
    /// what a step of half the length would give at once, J; it waits for a
    /// time at which that is little
    struct {
      double gives = 0.;
      bool waits = false;
    } halving_;
    double front_taken_ = 0.; ///< by the front viscosity in the step, J
    double front_held_ = 0.;  ///< of the kinetic energy, by the same, J
    /// what the last forces have changed, as it was before them
    std::tuple<double, double, double, double, std::array<double, 2>> before_{};
    std::array<double, 2> flow_{};    ///< plastic and viscous, likewise, J
    double stored_ = 0., power_ = 0.; ///< of the step
    double stiffening_ = 1., way_ = 0.;
    std::size_t n_open_ = 0; ///< how far points have opened, in sum
    unsigned long long rounds_ = 0;
  };
} // namespace nsfd
