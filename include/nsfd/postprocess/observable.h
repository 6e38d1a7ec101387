#pragma once

#include "nsfd/core/registry.h"
#include "nsfd/discretization/point_origin.h"
#include "nsfd/records/observable_record.h"
#include "nsfd/records/run_record.h"
#include "nsfd/state/point_kind.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  struct SceneInput;
  class SectionReader;

  /** A block of the scene with faces: `on = NAME`. */
  struct NamedSurface {
    enum class Kind {
      boundary,
      obstacle,
      interface,
      contact ///< of large motions, between two materials
    };
    Kind kind = Kind::boundary;
    unsigned int block = 0;
    std::string name;
  };

  /**
   * What an observable may look at: the state after a step. Vectors have three
   * components, in the plane the third is 0; gradients are
   * [3 component + direction]. What is not asked for is not computed. Functions
   * named collective must be called by all ranks alike, and answer alike.
   */
  class RunView
  {
  public:
    using Vector = std::array<double, 3>;
    using Gradient = std::array<double, 9>;
    using Stress = std::array<double, 6>; ///< xx, yy, zz, xy, xz, yz, Pa

    virtual ~RunView() = default;

    virtual const SceneInput &input() const = 0;
    virtual unsigned int dimension() const = 0;
    virtual double time() const = 0;
    virtual double time_step() const = 0; ///< of the last step, 0 at the start
    virtual const HistoryRow &row() const = 0;
    virtual double cell_size() const = 0; ///< smallest height of a cell, m
    /** The way of a pressure wave through the smallest cell, s. */
    virtual double crossing_time() const = 0;

    /** A point on a face, of those that this rank owns. */
    struct Point {
      Vector position{}, normal{}; ///< from body 1 to body 2
      /// of the piece of the face it stands for; in space the point itself
      std::array<Vector, 2> ends{};
      double area = 0.; ///< weight, m^2; m in two dimensions
      PointOrigin origin;
    };
    virtual const std::vector<Point> &points() const = 0;

    struct PointState {
      Vector jump{};     ///< u_2 - u_1, m
      Vector velocity{}; ///< its rate, m/s
      Vector traction{}; ///< sigma n on body 1, Pa; mean of the step
      double beta = 1.;
      bool contact = false; ///< pressed together in the step
      double pressure = 0.; ///< of the contact, Pa; mean of the step
    };
    virtual PointState at(std::size_t point) const = 0;
    /** That of at(), which takes time, alone. */
    virtual double beta(std::size_t point) const = 0;

    /** A place of an obstacle, an interface or a contact. */
    struct Place {
      Vector position{}, normal{}; ///< towards the body, or body 2
      Vector force{};              ///< on it, mean of the step, N
      double area = 0., opening = 0.;
      bool contact = false; ///< pressed together in the step
      double pressure = 0.; ///< of the contact, Pa; mean of the step
    };
    /**
     * Those of this rank: of an interface, or an obstacle in small motions, all
     * points(); in large motions those that were touched in the step, and only
     * on obstacles and contacts, body 2 being the second material.
     */
    virtual std::vector<Place> places(const NamedSurface &surface) const = 0;

    /** Force of the support of a driven boundary on the body, N. */
    virtual Vector reaction(unsigned int boundary) const = 0;

    /** beta up to which the point is broken. */
    virtual double broken_beta(std::size_t point) const = 0;

    /** Mean values over faces or cells. */
    struct Means {
      double size = 0.; ///< area of the faces, number of the cells; 0: none
      Vector displacement{}, velocity{};
      Stress stress{};
    };
    /** Over the faces of a block, both sides of an interface. Collective. */
    virtual Means on(const NamedSurface &surface) const = 0;
    /** Over the cells that hold or touch a place at t = 0. Collective. */
    virtual Means at(const Vector &place) const = 0;

    /**
     * Fields inside a cell at t_k + theta h, where the step is in balance:
     * rho a = div sigma + f.
     */
    struct CellPoint {
      Vector position{};
      double JxW = 0., density = 0.;
      Gradient gradient{}, velocity_gradient{};
      Vector velocity{}, acceleration{}, force{}; ///< f, N/m^3
      Stress stress{};
    };
    /** All quadrature points of cells of this rank that reach into a ball. */
    virtual void
    visit_cells(const Vector &centre, double radius,
                const std::function<void(const CellPoint &)> &visit) const = 0;

    /** What a cell says at a point between it and another cell. */
    struct SidePoint {
      Vector position{}, normal{}; ///< from body 1 to body 2
      double sign = 0.;            ///< 1: the cell is body 2, -1: body 1
      double area = 0., density = 0.;
      Gradient gradient{};
      Vector velocity{};
      Stress stress{};
      Vector traction{}, jump{}; ///< sigma n, u_2 - u_1
      PointKind kind = PointKind::prescribed;
      double beta = 1., broken_beta = 0.;
      unsigned int block = 0; ///< of SceneInput::interfaces
    };
    /** The same at the interface points, once per cell of this rank. */
    virtual void
    visit_sides(const Vector &centre, double radius,
                const std::function<void(const SidePoint &)> &visit) const = 0;

    /**
     * Sums of @p rows blocks of terms, the same bits for any number of ranks.
     * Collective.
     */
    virtual std::vector<double> sums(const std::vector<double> &terms,
                                     unsigned int rows) const = 0;
    virtual double max(double value) const = 0;
    virtual double min(double value) const = 0;
    /** Those of all ranks, one after the other. Collective. */
    virtual std::vector<double>
    gather(const std::vector<double> &values) const = 0;
  };

  /**
   * Something that a scene asks for: numbers after each step. Registered by
   * name, one file each; built from its block `Observable: name` and the scene,
   * which has been read. Its constructor reports what is wrong to the reader.
   */
  class Observable
  {
  public:
    virtual ~Observable() = default;

    /**
     * Called when the mesh has been built, and when it has changed. @throws
     * std::runtime_error with a sentence for the user. Collective.
     */
    virtual void find(const RunView &) {}

    /** Of observables/NAME.csv, after step and time; known after find(). */
    virtual std::vector<ObservedColumn> columns() const = 0;

    /** Called at the start and after every step. Collective. */
    virtual void follow(const RunView &) {}

    /** A row of the file. Collective; the answer counts on all ranks. */
    virtual std::vector<double> values(const RunView &) = 0;

    /**
     * Of observables/NAME_profile.csv, after step and time: a row per place,
     * whenever fields are written. None by default.
     */
    virtual std::vector<ObservedColumn> profile_columns() const { return {}; }
    /** The rows of this rank, one after the other. */
    virtual std::vector<double> profile(const RunView &) const { return {}; }

    /** What it looks at, for `--check`. */
    virtual std::string text() const = 0;

    /** What it has collected so far; nothing if it has no memory. */
    virtual void serialize(Archive &) {}
  };

  using ObservableRegistry =
      Registry<Observable, SectionReader &, const SceneInput &>;
} // namespace nsfd
