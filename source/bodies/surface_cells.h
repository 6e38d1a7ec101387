#pragma once

#include "body_layout.h"
#include "face_nodes.h"

#include "core/communicator.h"

#include <vector>

namespace nsfd
{
  /**
   * The surfaces of the cells of all ranks, the same on all of them: cells and
   * bodies of the BodyTable; node i of cell c is node c n + i, n nodes to a
   * cell; centres of rigid bodies follow. What does not change with time.
   */
  template <int dim>
  class SurfaceCells
  {
  public:
    /** Collective. */
    SurfaceCells(const Discretization<dim> &discretization,
                 const BodyLayout<dim> &bodies,
                 const Communicator &communicator);

    std::size_t size() const { return class_of_.size(); }
    std::size_t n_nodes() const { return size() * nodes_per_cell_; }
    unsigned int nodes_per_cell() const { return nodes_per_cell_; }
    std::size_t first_node(const unsigned int cell) const
    {
      return std::size_t(cell) * nodes_per_cell_;
    }
    std::size_t centre_node(const unsigned int body) const
    {
      return n_nodes() + std::size_t(table_.bodies[body].rigid);
    }
    /** The first node of its rigid body at the same place; else itself. */
    unsigned int merged(const std::size_t node) const { return merged_[node]; }

    const std::vector<FaceNodes<dim>> &faces(const unsigned int cell) const
    {
      return faces_[class_of_[cell]];
    }

    /** Of the faces between cells that have points. */
    struct MeshFace {
      unsigned int body_1, body_2;
    };
    const std::vector<MeshFace> &mesh_faces() const { return mesh_faces_; }
    static constexpr int boundary = -1, inside = -2;
    /** One of these, or a mesh face. */
    int kind_of(const unsigned int cell, const unsigned int face) const
    {
      return kind_of_[first_face_[cell] + face];
    }
    /** Of a face of the points of this rank; -1: on the boundary. */
    int mesh_face(const std::size_t face_of_points) const
    {
      return own_mesh_faces_[face_of_points];
    }

    /** By cell and face; `body` is a cell. */
    const std::vector<ObstacleFace> &obstacle_faces() const
    {
      return obstacle_faces_;
    }
    /** 0: it is no ball. */
    double ball_radius(const unsigned int body) const { return radii_[body]; }

  private:
    struct CellFace;

    unsigned int cell_of(unsigned int own_cell) const;
    void gather_faces();
    void gather_balls();
    void merge_nodes();
    void gather_mesh_faces();
    void gather_obstacle_faces();

    const Discretization<dim> &discretization_;
    const BodyTable &table_;
    const BodyLayout<dim> &bodies_;
    const Communicator &all_;
    const unsigned int nodes_per_cell_;
    std::vector<std::vector<FaceNodes<dim>>> faces_; ///< by class
    std::vector<unsigned int> class_of_;             ///< by cell
    std::vector<std::size_t> first_face_;            ///< by cell
    std::vector<int> kind_of_;                       ///< by face of all cells
    std::vector<unsigned int> merged_;               ///< by node
    std::vector<MeshFace> mesh_faces_;
    std::vector<int> own_mesh_faces_;
    std::vector<ObstacleFace> obstacle_faces_;
    std::vector<double> radii_; ///< by body
  };
} // namespace nsfd
