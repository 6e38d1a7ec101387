#pragma once

#include "bodies/inelastic_bodies.h"
#include "bodies/moving_bodies.h"
#include "delassus/joined_delassus.h"
#include "mesh/mesh_builder.h"
#include "nsfd/scene/scene_input.h"
#include "time_integration/leapfrog.h"
#include "time_integration/moreau_jean.h"
#include "time_integration/quasi_static.h"
#include "time_integration/step_control.h"
#include "time_integration/time_integrator.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * The parts that a scene names, in the order in which they are built: the one
   * factory of runs and tests.
   */
  template <int dim>
  struct Model {
    static constexpr int dimension = dim;

    std::unique_ptr<dealii::Triangulation<dim>> triangulation;
    std::unique_ptr<MeshGroups<dim>> groups;
    std::unique_ptr<Discretization<dim>> discretization;
    /// by active cell, where cells are parts of others; empty: as blocks say
    std::vector<unsigned int> cell_materials;
    bool warns = true; ///< of blocks without cells
    std::unique_ptr<StepControl> control;
    double explicit_limit = 0.; ///< of explicit steps, s
    double compression = 0.;    ///< of the impact with which a scene begins
    std::string path;           ///< of the linear algebra: local or assembled
    std::unique_ptr<DelassusOperator<dim>> delassus;
    JoinedDelassus<dim> *bonded = nullptr; ///< the same, if faces are bonded
    std::unique_ptr<MovingBodies<dim>> moving; ///< of large motions, or null
    /// of small motions with history-dependent materials, or null
    std::unique_ptr<InelasticBodies<dim>> inelastic;
    std::string method; ///< name of the nonsmooth solver
    /// of a linear stepper; others make one for every problem
    std::unique_ptr<NonsmoothSolver<dim>> solver;
    /// has the points and the initial state; null with `leapfrog`, and where
    /// its work is done, see forget_dynamics()
    std::unique_ptr<MoreauJean<dim>> stepper;
    std::unique_ptr<TimeIntegrator<dim>> other;   ///< in its place, or null
    Leapfrog<dim> *leapfrog = nullptr;            ///< the same, or null
    std::unique_ptr<QuasiStatic<dim>> equilibria; ///< before it, or null

    /** At t = 0. */
    State initial_state() const;
    /** The constant data of the points. */
    const OneStepProblem<dim> &points() const;
    /** What takes the steps of a run, one after the other. */
    std::vector<TimeIntegrator<dim> *> integrators() const;

    /** Step in time that the input asks for, s. */
    double dynamic_step(const SceneInput &input) const;
    /** Steps with explicit forces keep the energy of the longest one on the
        present mesh, see StepTerms. */
    void keep_longest_step();
    /** Steps in time from @p start on. */
    std::unique_ptr<StepControl> dynamic_control(const SceneInput &input,
                                                 double start) const;
    /** Steps of the load from @p start on. */
    std::unique_ptr<StepControl> load_control(const SceneInput &input,
                                              double start) const;

    /**
     * All parts. Returns sentences on where the input does not fit the mesh;
     * none if all is built. Collective.
     */
    std::vector<std::string> build(const SceneInput &input,
                                   const Communicator &communicator);

    /**
     * After cells have changed: all parts again, and steps that the explicit
     * scheme can take on them. Collective.
     */
    void rebuild(const SceneInput &input, const Communicator &communicator);

    /**
     * The same of joined cells, on a mesh of the present kind. @p materials of
     * its cells. Collective. @throws std::runtime_error with a sentence.
     */
    void rebuild_joined(const SceneInput &input,
                        const Communicator &communicator,
                        const std::vector<unsigned int> &materials);
    /** One that has taken no state yet. Collective. */
    void renew_leapfrog(const SceneInput &input,
                        const Communicator &communicator);

    /** Bodies and points are all that a run needs of it. */
    void forget_mesh()
    {
      groups.reset();
      triangulation.reset();
    }

    /** The initial state is known, and equilibria are all that follows. */
    void forget_dynamics();

  private:
    void build_mesh_parts(const SceneInput &input,
                          const Communicator &communicator,
                          std::vector<std::string> &problems);
    void build_control(const SceneInput &input,
                       const Communicator &communicator,
                       std::vector<std::string> &problems);
    double stable_limit(const SceneInput &input,
                        const Communicator &communicator) const;
    void check_stability(const SceneInput &input,
                         const Communicator &communicator,
                         std::vector<std::string> &problems);
    void choose_path(const SceneInput &input);
    void build_delassus(const SceneInput &input,
                        const Communicator &communicator);
    void build_equilibria(const SceneInput &input,
                          const Communicator &communicator);
    void build_integrators(const SceneInput &input,
                           const Communicator &communicator,
                           std::vector<std::string> &problems);
    std::unique_ptr<const GhostLayer<dim>>
    ghost_layer(const SceneInput &input, const Communicator &communicator);
    std::unique_ptr<const GhostLayer<dim>>
    whole_mesh(const SceneInput &input, const Communicator &communicator) const;
  };
} // namespace nsfd
