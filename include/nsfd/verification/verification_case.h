#pragma once

#include "nsfd/bodies/rigid_step.h"
#include "nsfd/core/registry.h"
#include "nsfd/records/run_record.h"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  struct BrokenPoint;
  struct SceneInput;
  class SectionReader;

  /** Positions, displacements and velocities at the centre of one cell. */
  struct CellState {
    std::array<double, 3> centre{}, displacement{}, velocity{};
    std::array<double, 6> stress{}; ///< xx, yy, zz, xy, xz, yz, cell average
    double volume = 0.;
  };

  /** What a verification case may look at after a step (same on all ranks). */
  struct StepView {
    double time = 0., time_step = 0.;
    const HistoryRow *row = nullptr;
    /// cells in an order that does not depend on the rank count; gathered only
    /// for cases that ask for it
    const std::vector<CellState> *cells = nullptr;
    /// rigid bodies of a scene with large motions, by their first cells; in
    /// the plane they turn about z
    const std::vector<RigidState> *rigid_bodies = nullptr;
    /// mean u_N and U_N over the points of the obstacles, m and m/s; only for
    /// cases that ask for them
    double opening = 0., opening_rate = 0.;
    /// of this step, as far as they are due
    const std::vector<ObservableRecord> *observables = nullptr;

    /**
     * The last value of a column of an observable; NaN if there is none yet.
     * @throws std::runtime_error if the scene has no such observable.
     */
    double observed(const std::string &name, const std::string &column) const;
  };

  /**
   * An exact solution, or exact quantities of a scene. Selected by
   * `subsection Verification, set case = NAME`. What it finds goes into the
   * `errors` of summary.json.
   */
  class VerificationCase
  {
  public:
    virtual ~VerificationCase() = default;

    /**
     * Put what follows from the exact solution into the scene, once it has
     * been read: initial fields, body forces, motion of the boundaries that
     * ask for it. @throws std::runtime_error with a sentence for the user.
     */
    virtual void provide(SceneInput &) const {}

    /** True if provide() moves boundaries with `motion = exact`. */
    virtual bool has_motion() const { return false; }

    /** True if it knows scenes with plane = axisymmetric. */
    virtual bool is_axisymmetric() const { return false; }

    /** Called once, after all of the input has been read. */
    virtual void initialise(const SceneInput &) {}

    /** True if displacement(), velocity() (and stress()) are known fields. */
    virtual bool has_fields() const { return false; }
    virtual bool has_stress() const { return false; }
    using Vector = std::array<double, 3>;
    virtual Vector displacement(const Vector &, double) const { return {}; }
    virtual Vector velocity(const Vector &, double) const { return {}; }

    /** Jump u2 - u1 at a point of a face with normal @p n from 1 to 2. */
    virtual bool has_jump() const { return false; }
    virtual Vector jump(const Vector & /*x*/, const Vector & /*n*/,
                        double /*t*/) const
    {
      return {};
    }

    /** xx, yy, zz, xy, xz, yz in Pa. */
    virtual std::array<double, 6> stress(const Vector &, double) const
    {
      return {};
    }

    /** True if observe() wants StepView::cells after every step. */
    virtual bool wants_cells() const { return false; }

    /** True if observe() wants the opening of the obstacles. */
    virtual bool wants_opening() const { return false; }

    /** Called with the initial state (row->step = 0) and after each step. */
    virtual void observe(const StepView &) {}

    /**
     * True if the case is to be shown, before finish(), the points that have
     * broken since the start, in an order that does not depend on the ranks.
     */
    virtual bool wants_broken_points() const { return false; }
    virtual void see_broken_points(const std::vector<BrokenPoint> &) {}

    /** What observe() has collected so far; nothing if it has no memory. */
    virtual void serialize(Archive &) {}

    /** Relative errors and scene quantities, added to `errors`. */
    virtual void finish(std::map<std::string, double> &) const {}
  };

  using VerificationRegistry = Registry<VerificationCase, SectionReader &>;
} // namespace nsfd
