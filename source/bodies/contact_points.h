#pragma once

#include "body_layout.h"
#include "moving_row.h"

#include "nonsmooth/one_step_problem.h"

#include <array>
#include <map>
#include <vector>

namespace nsfd
{
  /**
   * The points of a step: those of the mesh and, between those that the rank
   * owns and the others, the contacts of the step. This rank has the contacts
   * of its bodies: its own, whose body 2 is here, then the others.
   */
  template <int dim>
  class ContactPoints
  {
  public:
    using Vector = dealii::Tensor<1, dim>;

    ContactPoints(const Discretization<dim> &discretization,
                  const BodyLayout<dim> &layout);

    /** @p rows of all ranks; the slots of @p bodies are set for them. */
    void set(const std::vector<MovingRow<dim>> &rows, Bodies &bodies);

    /** Bodies are those of this rank, cells of faces those of BodyTable. */
    const InterfacePoints<dim> &points() const { return points_; }
    const std::vector<MovingRow<dim>> &rows() const { return rows_; }
    std::size_t n_own_rows() const { return n_own_rows_; }
    std::size_t row_point(const std::size_t row) const
    {
      return n_own_mesh_points_ + row;
    }
    /** Where point @p i of the mesh is among all points. */
    std::size_t mesh_point(const std::size_t i) const
    {
      return point_of_step(i, n_own_mesh_points_, rows_.size());
    }

    struct RowBodies {
      std::array<int, 2> body{{-1, -1}}; ///< of this rank, or -1
      std::array<unsigned int, 2> slot{};
      int other_rank = -1; ///< of the other body, if it is not this one
    };
    const RowBodies &bodies_of(const std::size_t row) const
    {
      return row_bodies_[row];
    }
    /** Rows with a body on another rank, by this rank, in their order. */
    const std::map<int, std::vector<unsigned int>> &rows_by_rank() const
    {
      return rows_by_rank_;
    }

    void set_position(std::size_t point, const dealii::Point<dim> &position);
    /** Normal and tangents. */
    void set_frame(std::size_t point, const std::array<Vector, dim> &frame);

  private:
    void choose(const std::vector<MovingRow<dim>> &rows,
                std::vector<unsigned int> &n_slots);
    void place_points();
    void add_faces();
    void set_slots(const std::vector<unsigned int> &n_slots,
                   Bodies &bodies) const;
    void set_neighbors();

    const Discretization<dim> &discretization_;
    const BodyLayout<dim> &layout_;
    InterfacePoints<dim> points_;
    const std::size_t n_mesh_points_, n_own_mesh_points_, n_mesh_faces_;
    std::vector<MovingRow<dim>> rows_; ///< own ones first
    std::size_t n_own_rows_ = 0;
    std::vector<RowBodies> row_bodies_;
    std::map<int, std::vector<unsigned int>> rows_by_rank_;
  };
} // namespace nsfd
