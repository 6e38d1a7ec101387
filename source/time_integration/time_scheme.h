#pragma once

#include "moreau_jean.h"
#include "time_integrator.h"

#include "joined/ghost_layer.h"
#include "nsfd/core/registry.h"
#include "nsfd/scene/scene_input.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  class SectionReader;
  template <int dim>
  class JoinedDelassus;
  template <int dim>
  class InelasticBodies;
  template <int dim>
  class MovingBodies;

  /** What integrators are built from; what the scene has not is null. */
  template <int dim>
  struct IntegratorParts {
    const SceneInput &input;
    const Communicator &communicator;
    const Discretization<dim> &discretization;
    DelassusOperator<dim> *delassus = nullptr; ///< not of points at nodes
    JoinedDelassus<dim> *bonded = nullptr;     ///< the same, if faces are
    MovingBodies<dim> *moving = nullptr;       ///< of large motions
    InelasticBodies<dim> *inelastic = nullptr; ///< of materials with history
    NonsmoothSolver<dim> *solver = nullptr;    ///< of linear bodies
    /// the cells of other ranks around those of this one; null on one rank
    std::function<std::unique_ptr<const GhostLayer<dim>>()> ghost_layer;
  };

  template <int dim>
  struct Integrators {
    /// has the points and the initial state of a scene with a Delassus
    /// operator, and takes its steps unless there is another one
    std::unique_ptr<MoreauJean<dim>> stepper;
    std::unique_ptr<TimeIntegrator<dim>> other;
  };

  /**
   * A time integrator: what `scheme` of section Time names. A class in one file
   * that registers itself.
   */
  class TimeScheme
  {
  public:
    virtual ~TimeScheme() = default;

    /** Lists name schemes in this order, those of equal place by their names.
     */
    virtual unsigned int place() const { return 100; }

    virtual SchemeTraits traits() const = 0;

    /** Bodies of large motions and materials with history. */
    virtual bool takes_nonlinear_bodies() const { return false; }

    /** Steps of the load come first, from one equilibrium to the next. */
    virtual bool is_static() const { return false; }

    /** What solves the problem of a step, in place of `Solver/method`. */
    virtual std::string solver() const { return ""; }

    /**
     * The entries of section Time that not every scheme has; those of the
     * others are refused.
     */
    virtual std::vector<std::string> entries() const = 0;

    /** Report at the entry `scheme` what the materials cannot be. */
    virtual void demand(SectionReader &, const SceneInput &) const {}

    /** `step`, and what else says how long the steps are. */
    virtual void read_steps(SectionReader &reader, SceneInput &scene) const;

    /**
     * Read the entries of the scheme into @p scene.time. What cannot be is
     * reported at the reader.
     */
    virtual void read(SectionReader &reader, SceneInput &scene) const = 0;

    /**
     * @throws std::runtime_error with a sentence for the user, on all ranks.
     * Collective.
     */
    template <int dim>
    Integrators<dim> build(const IntegratorParts<dim> &parts) const
    {
      Integrators<dim> integrators;
      make(parts, integrators);
      return integrators;
    }

  private:
    virtual void make(const IntegratorParts<2> &parts,
                      Integrators<2> &integrators) const = 0;
    virtual void make(const IntegratorParts<3> &parts,
                      Integrators<3> &integrators) const = 0;
  };

  using TimeSchemeRegistry = Registry<TimeScheme>;

  /** The names of all schemes, in the order of lists. */
  std::vector<std::string> time_scheme_names();

  /** Null if there is no such scheme. */
  std::unique_ptr<const TimeScheme> find_time_scheme(const std::string &name);

  /** Report the entries that only other schemes than @p name have. */
  void refuse_other_entries(SectionReader &reader, const std::string &name);
} // namespace nsfd
