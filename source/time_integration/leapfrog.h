#pragma once

#include "face_release.h"
#include "leapfrog_ghosts.h"
#include "leapfrog_large.h"
#include "leapfrog_loads.h"
#include "leapfrog_points.h"
#include "prescribed_groups.h"
#include "rigid_groups.h"
#include "step_check.h"
#include "time_integrator.h"

#include "joined/cell_forces.h"

#include <memory>
#include <optional>

namespace nsfd
{
  struct SceneInput;

  /**
   * The explicit scheme on joined cells with lumped mass,
   *
   *   M (v_{k+1/2} - v_{k-1/2}) = k f(q_k) + P,   q_{k+1} = q_k + h v_{k+1/2},
   *
   * k = h, and h/2 in the first step. Faces whose mean traction has reached the
   * strength are released before the forces of a step act; their points,
   * contact and friction are implicit in small problems at the nodes, so that
   * only the free cells bound the step. For any loads and any impulses,
   *
   *   E_{k+1/2} = v.M v/2 + U(q_k) - (h/2) f.v
   *             = v.(M - h^2 K/4) v/2 + U(q_k + h v/2)
   *
   * changes by the sum of P.(v+ + v-)/2; the two parts on the right are the
   * kinetic and elastic energy of the state. The first step takes
   * h/4 f.(v+ - v-), which is numerical.
   *
   * In small motions all steps have the same length. With v_k = v_{k-1/2} +
   * (h/2) M^-1 f,
   *
   *   E = v_k.M v_k/2 + U(q_k) - (h^2/8) f.M^-1 f,
   *
   * so that no step shorter than the last one could leave q_k without energy
   * from nothing where bodies come to rest, v_k = 0: whatever its velocity.
   */
  template <int dim>
  class Leapfrog final : public TimeIntegrator<dim>
  {
  public:
    /**
     * @p layer around the cells of @p discretization, null on one rank.
     * @throws std::runtime_error with a sentence for the user, on all ranks.
     */
    Leapfrog(const SceneInput &input, const Discretization<dim> &discretization,
             const Communicator &communicator,
             std::unique_ptr<const GhostLayer<dim>> layer = nullptr);

    /** At t = 0, as the scene gives it; start_from() joins it. */
    State initial_state() const;

    /** What it consists of. */
    struct Parts {
      const OneStepProblem<dim> &constants; ///< of the points of the mesh
      /// of the points that are stepped, with ghosts, and which of the others
      /// they are: see LeapfrogGhosts
      const OneStepProblem<dim> &stepped;
      const Discretization<dim> &discretization;
      const std::vector<unsigned int> &own_points;
      const JoinedMesh<dim> &mesh;
      const HangingNodes<dim> &hanging;
      const FaceRelease<dim> &faces;
      const LeapfrogPoints<dim> &points;
    };
    Parts parts() const
    {
      return {own_ ? *own_ : all_,
              all_,
              discretization_,
              ghosts_.own_points(),
              mesh_,
              hanging_,
              faces_,
              points_};
    }
    /** Faces at hanging nodes; nothing: there are none. Collective. */
    std::optional<typename FaceRelease<dim>::Held> held_faces() const
    {
      if (!hanging_.any())
        return std::nullopt;
      return faces_.worst_held(communicator_);
    }

    State start_from(State given) override;
    void resume_from(const State &given) override;
    StepReport advance(const State &old, double time_step, State &next,
                       unsigned int idle_rounds) override;
    void show(State &state) const override;
    bool keeps_motion() const override { return true; }
    double stable_share() const override
    {
      return large_ ? large_->stable_share() : 1.;
    }

    const std::vector<double> &reactions() const override
    {
      return supports_.reactions();
    }
    void fill_counters(std::map<std::string, double> &counters) const override;
    /** Of one on another mesh. */
    void continue_counters(const Leapfrog &before)
    {
      counters_ = before.counters_;
    }
    std::vector<std::pair<std::string, double>> stage_seconds() const override
    {
      return {{"explicit steps", counters_.seconds}};
    }
    void serialize(Archive &archive) override;

  private:
    using Energies = LeapfrogEnergies;

    void take(const State &state, std::vector<std::uint8_t> intact, bool start);
    void show_at(State &state, const std::vector<unsigned int> &place) const;
    void serialize_all(Archive &archive);
    void find_supports();
    void set_energies(double kick, double h, double last, Energies &energies);
    void gather(std::size_t node);
    unsigned int let_go();
    void move_freely(double kick, double time, double h);
    void damp(double h, double last, Energies &energies);
    void account(const State &old, double h, const Energies &bodies,
                 State &next, StepReport &report);

    const SceneInput &input_;
    LeapfrogGhosts<dim> ghosts_;
    const Communicator &communicator_; ///< of those that take steps together
    const Discretization<dim> &discretization_; ///< with ghosts
    /// constant data of the points, and without ghosts if there may be some
    const OneStepProblem<dim> all_;
    const std::unique_ptr<const OneStepProblem<dim>> own_;
    const JoinedMesh<dim> mesh_;
    HangingNodes<dim> hanging_;
    const std::unique_ptr<CellForces<dim>> forces_;
    FaceRelease<dim> faces_;
    PrescribedGroups<dim> supports_;
    LeapfrogPoints<dim> points_;
    LeapfrogLoads<dim> loads_;
    StepCheck check_;
    std::unique_ptr<CornerGroups<dim>> groups_;
    std::unique_ptr<RigidGroups<dim>> rigid_;   ///< null: there are none
    std::unique_ptr<LeapfrogLarge<dim>> large_; ///< null: forces are linear
    struct {
      std::vector<double> displacement, velocity;
      FrontViscosity::Powers front;
    } before_; ///< the step
    std::vector<double> terms_;
    struct Counters {
      double excess = 0.; ///< of a traction over the strength, less 1
      unsigned long long problems = 0, sweeps = 0, newton = 0, released = 0,
                         inexact = 0, held = 0;
      double seconds = 0.; ///< of steps

      /** What all ranks have done at the nodes. Collective. */
      void add(const Communicator &communicator,
               const typename LeapfrogPoints<dim>::Outcome &mine,
               StepReport &report);
    } counters_;
  };
} // namespace nsfd
