#pragma once

#include "discretization/cells.h"
#include "discretization/discretization.h"
#include "nsfd/bodies/rigid_step.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** Of a nodal field with dim components. */
  template <int dim>
  dealii::Point<dim> at_node(const std::vector<double> &field,
                             const std::size_t node)
  {
    dealii::Point<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = field[node * dim + d];
    return result;
  }

  template <int dim>
  Vec3 in_space(const dealii::Tensor<1, dim> &v)
  {
    Vec3 result{};
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = v[d];
    return result;
  }

  /** A deformable cell, or a rigid body of one or more cells. */
  struct MovingBody {
    std::vector<unsigned int> cells;
    unsigned int number = 0; ///< in the BodyTable
    unsigned int material = 0;
    int rigid = -1; ///< index of the rigid body on this rank, or -1
    std::size_t rigid_number = 0; ///< among those of all ranks
    double radius = 0.;           ///< of a ball, else 0
    RigidInertia inertia;         ///< in its own frame
    Vec3 centre{};                ///< at rest
    double extra_weight = 0.;     ///< mass beyond that of its cells, kg

    bool is_rigid() const { return rigid >= 0; }
  };

  /** A place of a point of the mesh on a body. */
  struct BodySlot {
    unsigned int cell, slot, point;
    signed char sign;
  };

  /**
   * The bodies of this rank in a scene with large motions, as they are at rest:
   * what no step changes.
   */
  template <int dim>
  class BodyLayout
  {
  public:
    using Vector = dealii::Tensor<1, dim>;
    using Place = dealii::Point<dim>;
    /// unknowns of a rigid body
    static constexpr unsigned int n_rigid = dim == 2 ? 3 : 6;

    BodyLayout(const SceneInput &input,
               const Discretization<dim> &discretization);

    const std::vector<MovingBody> &bodies() const { return bodies_; }
    std::size_t size() const { return bodies_.size(); }
    const MovingBody &operator[](const std::size_t b) const
    {
      return bodies_[b];
    }
    unsigned int body_of_cell(const unsigned int cell) const
    {
      return body_of_[cell];
    }
    /** Of a body of the table; -1: it is not on this rank. */
    int own_body(const unsigned int body_of_table) const
    {
      return own_body_[body_of_table];
    }
    bool is_own(const unsigned int body_of_table) const
    {
      return own_body_[body_of_table] >= 0;
    }
    unsigned int own_cell(const unsigned int cell_of_table) const
    {
      return own_cell_[cell_of_table];
    }
    std::size_t nodes_per_cell() const { return nodes_per_cell_; }
    /** Of a node of SurfaceCells in a cell of this rank: that of the state. */
    std::size_t own_node(const std::size_t node) const
    {
      return discretization_.cells()
                 .first_node[own_cell_[node / nodes_per_cell_]] +
             node % nodes_per_cell_;
    }

    /** Nodal places. */
    const std::vector<double> &rest() const { return rest_; }
    /** Of a node of the state. */
    Place place(const State &state, const std::size_t node) const
    {
      return at_node<dim>(rest_, node) +
             Vector(at_node<dim>(state.displacement, node));
    }

    const std::vector<BodySlot> &slots(const std::size_t b) const
    {
      return slots_[b];
    }
    /** Of a class of the cells: shape gradients at a slot, by node. */
    const Vector *slot_gradients(const unsigned int class_of_cell,
                                 const unsigned int slot,
                                 const unsigned int n_nodes) const
    {
      return slot_gradients_[class_of_cell].data() +
             std::size_t(slot) * n_nodes;
    }

  private:
    void make_bodies();
    void set_inertia(MovingBody &body) const;
    void make_slots();
    void set_slot_gradients();

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const std::size_t nodes_per_cell_;
    std::vector<double> rest_;
    std::vector<MovingBody> bodies_;
    std::vector<unsigned int> body_of_;  ///< by cell
    std::vector<int> own_body_;          ///< by body of the table
    std::vector<unsigned int> own_cell_; ///< by cell of the table
    std::vector<std::vector<BodySlot>> slots_;
    std::vector<std::vector<Vector>> slot_gradients_; ///< slot x node
  };

  /** V + a x arm at a slot of a rigid body, by unknown V, a: rows of its
      @p trace. */
  template <int dim>
  void set_rigid_trace(const dealii::Tensor<1, dim> &arm,
                       const unsigned int slot, Block &trace)
  {
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int j = 0; j < BodyLayout<dim>::n_rigid; ++j)
        trace(slot * dim + d, j) = d == j ? 1. : 0.;
    if constexpr (dim == 2) {
      trace(slot * dim, 2) = -arm[1];
      trace(slot * dim + 1, 2) = arm[0];
    } else
      for (unsigned int a = 0; a < 3; ++a) {
        Vec3 e{};
        e[a] = 1.;
        const Vec3 w = space::cross(e, in_space<dim>(arm));
        for (unsigned int d = 0; d < 3; ++d)
          trace(slot * dim + d, 3 + a) = w[d];
      }
  }
} // namespace nsfd
