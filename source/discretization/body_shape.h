#pragma once

#include "materials/elasticity.h"

#include "bodies.h"

#include <deal.II/base/point.h>
#include <deal.II/base/quadrature.h>
#include <deal.II/base/tensor.h>
#include <deal.II/grid/reference_cell.h>

#include <array>
#include <memory>
#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class FiniteElement;
} // namespace dealii

namespace nsfd
{
  struct MaterialInput;
  struct SceneInput;

  /// over the height of a cell, the radius up to which a place is on the axis
  /// of an axisymmetric scene
  constexpr double axis_tolerance = 1e-9;

  /**
   * What the bodies of one class share besides their blocks: tables of the
   * cell with its corner 0 at the origin. Bodies of a class without blocks (see
   * ClassBuilder) differ in what depends on their corners.
   */
  template <int dim>
  struct BodyShape {
    dealii::ReferenceCell reference;
    std::vector<dealii::Point<dim>> corners;
    unsigned int divided = 0; ///< bit f: there are smaller cells behind face f
    unsigned int n_nodes = 0;
    std::vector<dealii::Point<dim>> nodes;
    /// of axisymmetric scenes: of corner 0; that of a place is in radius_at()
    double corner_radius = 0.;
    std::vector<char> on_axis; ///< the same, by node: it has no radial motion
    // cell quadrature: positions, JxW (of axisymmetric scenes times the
    // radius), values and gradients (point x node)
    std::vector<dealii::Point<dim>> positions;
    std::vector<double> JxW;
    std::vector<double> values;
    std::vector<dealii::Tensor<1, dim>> gradients;
    std::vector<dealii::Point<dim>> slot_positions;
    std::vector<dealii::Tensor<1, dim>> slot_normals; ///< outward, times w
    std::vector<dealii::Point<dim>> slot_places;      ///< in the reference cell
    std::vector<unsigned int> slot_faces;
    /// of axisymmetric scenes: what the area of a slot is times, see axis.h
    std::vector<double> slot_radii;
    std::vector<double> corner_values; ///< corner x node
    double volume = 0.;                ///< of axisymmetric scenes per radian
    dealii::Point<dim> centre;
    double height = 0.; ///< way of a wave through the cell
    /// of a graded material, at the positions of the quadrature and, in scenes
    /// with bonded faces, at the slots; else one for all of them
    std::vector<LocalModuli> moduli;
    std::vector<LinearElasticity<dim>> elasticity; ///< the same; rigid: none
    MaterialExtremes extremes; ///< of a rigid body only the density
    Block modes;               ///< rigid: nodal values = modes * unknowns
    Block projection;          ///< rigid: unknowns = projection * nodal values
    Block nodal_mass;          ///< rigid: of the nodal values
  };

  template <int dim>
  bool is_axisymmetric(const BodyShape<dim> &shape)
  {
    return !shape.on_axis.empty();
  }

  /** Of an axisymmetric one, at a place relative to corner 0. */
  template <int dim>
  double radius_at(const BodyShape<dim> &shape,
                   const dealii::Point<dim> &relative)
  {
    return shape.corner_radius + relative[0];
  }

  /** What measures there are times. */
  template <int dim>
  double radius_or_one(const BodyShape<dim> &shape,
                       const dealii::Point<dim> &relative)
  {
    return is_axisymmetric(shape) ? radius_at(shape, relative) : 1.;
  }

  /** Area of a slot, times its weight. */
  template <int dim>
  double slot_area(const BodyShape<dim> &shape, const std::size_t slot)
  {
    const double area = shape.slot_normals[slot].norm();
    return shape.slot_radii.empty() ? area : area * shape.slot_radii[slot];
  }

  /** The shape of a body: kept by its class, or made when it is asked for, in
      memory that is given back for the next one. */
  template <int dim>
  class ShapeOfBody
  {
  public:
    /// shapes of a class that nobody looks at any more
    using Spare = std::vector<std::unique_ptr<BodyShape<dim>>>;

    explicit ShapeOfBody(const BodyShape<dim> &kept) : shape_(&kept) {}
    /** @p spare is to live longer. */
    ShapeOfBody(std::unique_ptr<BodyShape<dim>> made, Spare &spare)
        : made_(std::move(made)), shape_(made_.get()), spare_(&spare)
    {
    }
    ShapeOfBody(ShapeOfBody &&) noexcept = default;
    ShapeOfBody &operator=(ShapeOfBody &&) = delete;
    ~ShapeOfBody()
    {
      if (made_)
        spare_->push_back(std::move(made_));
    }
    const BodyShape<dim> &operator*() const { return *shape_; }
    const BodyShape<dim> *operator->() const { return shape_; }

  private:
    std::unique_ptr<BodyShape<dim>> made_;
    const BodyShape<dim> *shape_;
    Spare *spare_ = nullptr;
  };

  /** Of the places of a class: one for all, or one for each. */
  template <typename T>
  const T &at_place(const std::vector<T> &values, const std::size_t place)
  {
    return values.size() == 1 ? values[0] : values[place];
  }

  /** Lumped mass of a node, kg or kg/m: its share of the integral of rho. */
  template <int dim>
  double lumped_mass(const BodyShape<dim> &shape, const unsigned int node)
  {
    double mass = 0.;
    for (std::size_t q = 0; q < shape.JxW.size(); ++q)
      mass += at_place(shape.moduli, q).density * shape.JxW[q] *
              shape.values[q * shape.n_nodes + node];
    return mass;
  }

  /** From a place on the surface of a body, a billionth of the way inwards. */
  template <int dim>
  dealii::Point<dim> a_little_inside(const dealii::Point<dim> &x,
                                     const dealii::Point<dim> &centre)
  {
    return x + 0x1p-30 * (centre - x);
  }

  /**
   * Shape and blocks of a class from its corners: mass, stiffness, traces at
   * the interface points of every face, face by face; of a divided face
   * (hypercubes only) those of its halves or quarters, one after the other.
   * @p size scales the rotations of a rigid body. Bodies of a graded material
   * are of one class if their moduli are the same everywhere.
   *
   * Axisymmetric ones are integrated with r dr dz and have the hoop strain
   * u_r / r as well, and are of one class if their @p corner_radius is the
   * same. Nodes on the axis do not move radially: those unknowns have no row
   * in traces, tractions and forces, and of a matrix only their diagonal.
   */
  template <int dim>
  class ClassBuilder
  {
  public:
    /** Both are to live longer. */
    ClassBuilder(const dealii::FiniteElement<dim, dim> &element,
                 const SceneInput &input);

    void build(const dealii::ReferenceCell &reference,
               const std::vector<dealii::Point<dim>> &corners, double size,
               double corner_radius, unsigned int material,
               unsigned int divided, const std::vector<LocalModuli> &moduli,
               BodyShape<dim> &shape, BodyClass &body) const;

    /** Dashpots on the @p faces (bit f) of a class that is built. */
    void add_absorbing(unsigned int faces, const BodyShape<dim> &shape,
                       BodyClass &body) const;

    /**
     * Where the moduli of a cell are needed, relative to its corner 0: the
     * positions of its quadrature, then its slots if there are bonded faces, a
     * little inside: a layer may end at the face.
     */
    std::vector<dealii::Point<dim>>
    moduli_places(const dealii::ReferenceCell &reference,
                  const std::vector<dealii::Point<dim>> &corners,
                  unsigned int divided) const;

    /**
     * Explicit steps on joined simplices take gradients and volumes alone,
     * unless a material asks for more: cells have no blocks, and those of a
     * material are of one class whatever their corners.
     */
    bool has_no_blocks() const { return no_blocks_; }
    /** Into a copy of the shape of a class without blocks: what its corners
        say, which are others now. */
    void set_corners(BodyShape<dim> &shape) const;

  private:
    /** What does not depend on the corners, then what does. */
    void set_tables(BodyShape<dim> &shape) const;
    void set_cell(BodyShape<dim> &shape) const;
    /** Of a ring: weights, and what is on the axis. */
    void set_axis(BodyShape<dim> &shape) const;
    void set_slots(BodyShape<dim> &shape) const;
    void set_elasticity(BodyShape<dim> &shape, unsigned int material) const;
    Block mass(const BodyShape<dim> &shape, bool lumped) const;
    /** To a @p stiffness, that of the strain along the hoops of a ring. */
    void add_hoop(const BodyShape<dim> &shape,
                  const std::vector<LinearElasticity<dim>> &local,
                  Block &stiffness) const;
    void set_slot_radii(BodyShape<dim> &shape) const;
    /** Of @p local at the positions of the quadrature. */
    Block stiffness(const BodyShape<dim> &shape,
                    const std::vector<LinearElasticity<dim>> &local) const;
    /** Of shapes with slots. */
    Block trace(const BodyShape<dim> &shape) const;
    /** The traction of @p local at the slots. */
    Block traction(const BodyShape<dim> &shape, const BodyClass &body,
                   const std::vector<LinearElasticity<dim>> &local) const;

    const dealii::FiniteElement<dim, dim> &element_;
    const SceneInput &input_;
    dealii::Quadrature<dim> cell_rule_;
    dealii::Quadrature<dim - 1> face_rule_;
    bool no_blocks_;
    /// of a simplex, by its faces: the corner that the face does not have
    std::array<unsigned int, dim + 1> opposite_{};
  };
} // namespace nsfd
