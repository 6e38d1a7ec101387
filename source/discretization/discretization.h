#pragma once

#include "bodies.h"

#include "core/communicator.h"
#include "materials/material_extremes.h"
#include "mesh/body_table.h"
#include "mesh/cell_set.h"
#include "nsfd/discretization/point_origin.h"
#include "state/load_clock.h"

#include <deal.II/base/point.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  template <int dim>
  class MeshGroups;
  template <int dim>
  struct Cells;
  template <int dim>
  class Loads;

  /** Place of a face point. */
  template <int dim>
  dealii::Point<dim> position_of(const InterfacePoints<dim> &points,
                                 const std::size_t point)
  {
    dealii::Point<dim> x;
    for (unsigned int c = 0; c < dim; ++c)
      x[c] = points.position[point * dim + c];
    return x;
  }

  /** Where an obstacle may be touched, in scenes with large motions. */
  struct ObstacleFace {
    unsigned int body = 0, face = 0, obstacle = 0;
  };

  /** Between two cells of one rigid body, in scenes with large motions. */
  struct InnerFace {
    std::array<unsigned int, 2> bodies, faces;
  };

  /**
   * The cells of this rank as bodies, and the points on their faces: matrices,
   * traces, frames, weights. Straight-sided cells; cells of the same shape and
   * material share their blocks, built from the shape rounded to 2^-42 of its
   * size, so that they are the same on every rank. Units of the scene. With
   * large motions rigid cells have nodal unknowns too, without stiffness, and
   * obstacles no points: see bodies/moving_bodies.h.
   */
  template <int dim>
  class Discretization
  {
  public:
    /**
     * With ghosts, what is said of this rank holds for them too; sizes of
     * cells and constants of materials are still those of all ranks.
     * @throws std::runtime_error with a sentence for the user.
     */
    Discretization(const Communicator &communicator,
                   const dealii::Triangulation<dim, dim> &triangulation,
                   const MeshGroups<dim> &groups,
                   const std::vector<unsigned int> &materials,
                   const SceneInput &input, CellSet set = CellSet::own);
    ~Discretization();
    Discretization(Discretization &&) noexcept;
    /** For a mesh that has changed; what refers to bodies() is void then. */
    Discretization &operator=(Discretization &&) noexcept;

    const SceneInput &input() const { return *input_; }
    /** The cells of this rank: shapes, materials, places, nodes. */
    const Cells<dim> &cells() const { return *cells_; }
    const Bodies &bodies() const;
    const InterfacePoints<dim> &points() const { return points_; }
    const std::vector<PointOrigin> &origins() const { return origins_; }
    /**
     * The interface block with springs that new faces inside a cell would have
     * and that are to keep the modulus of the body; -1: none.
     */
    int springs_inside(unsigned int body) const
    {
      return springs_inside_.empty() ? -1 : springs_inside_[body];
    }

    /** Empty but in scenes with large motions. */
    const std::vector<ObstacleFace> &obstacle_faces() const
    {
      return obstacle_faces_;
    }

    /** The same; such faces have no points. */
    const std::vector<InnerFace> &inner_faces() const { return inner_faces_; }

    /** Of all ranks, where SceneInput::has_body_table(). */
    const BodyTable &body_table() const { return *body_table_; }

    /**
     * Unknowns of the bodies to nodal values (rigid modes are expanded):
     * node-major, dim components, Cells::n_nodal() in all.
     */
    std::vector<double> to_nodal(const std::vector<double> &unknowns) const;

    using Field = std::function<void(const dealii::Point<dim> &,
                                     unsigned int body, double *values)>;

    /**
     * Interpolate at the nodes; rigid bodies take the rigid motion nearest in
     * the norm of their mass, and nodes on the axis of a scene have no radial
     * component.
     */
    std::vector<double> interpolate(const Field &field) const;

    /**
     * Generalised forces at time @p t of gravity, body forces, tractions and
     * pressures, in N (N per metre of depth in two dimensions). Sides that
     * @p clock has stopped keep theirs.
     */
    void add_loads(double t, std::vector<double> &forces,
                   const LoadClock &clock = {}) const;
    const Loads<dim> &loads() const { return *loads_; }

    /**
     * Call @p visit at every quadrature point of every cell of this rank:
     * (body, position, JxW, values of @p nodal, its gradient [component][dir]).
     */
    using Visitor = std::function<void(
        unsigned int body, const dealii::Point<dim> &position, double JxW,
        const double *value, const double *gradient)>;
    void visit_quadrature(const std::vector<double> &nodal,
                          const Visitor &visit) const;

    /**
     * Stress xx, yy, zz, xy, xz, yz from displacement and its gradient at @p x,
     * of a material without history; see bodies/cell_stresses.h for others. Of
     * axisymmetric scenes rr, zz, hoop, rz.
     */
    std::array<double, 6> stress(unsigned int body, const dealii::Point<dim> &x,
                                 const double *value,
                                 const double *gradient) const;

    /** What velocity and its gradient add to it in a viscous material. */
    std::array<double, 6> viscous_stress(unsigned int body,
                                         const dealii::Point<dim> &x,
                                         const double *value,
                                         const double *rate) const;

    /** Of a material; BodyShape has those of the cell of a body alone. */
    const MaterialExtremes &extremes(const unsigned int material) const
    {
      return extremes_[material];
    }
    /** The shortest crossing time of the fastest wave over all cells. */
    double crossing_time() const { return crossing_time_; }
    double cell_size() const { return cell_size_; }
    /** Diagonal of the bounding box: a length that no mesh changes. */
    double extent() const { return extent_; }

    /** Driven boundaries in the order of the reactions of a history row. */
    const std::vector<unsigned int> &driven_boundaries() const
    {
      return driven_;
    }

  private:
    const SceneInput *input_;
    std::unique_ptr<const Cells<dim>> cells_;
    InterfacePoints<dim> points_;
    std::vector<PointOrigin> origins_;
    std::vector<int> springs_inside_; ///< by body; empty: none anywhere
    std::vector<ObstacleFace> obstacle_faces_;
    std::vector<InnerFace> inner_faces_;
    std::unique_ptr<const BodyTable> body_table_; ///< or null
    std::unique_ptr<const Loads<dim>> loads_;
    double crossing_time_ = 0., cell_size_ = 0., extent_ = 0.;
    std::vector<unsigned int> driven_;
    std::vector<MaterialExtremes> extremes_; ///< by material
  };
} // namespace nsfd
