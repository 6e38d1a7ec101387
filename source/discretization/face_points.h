#pragma once

#include "cells.h"

#include "discretization.h"

#include <vector>

namespace nsfd
{
  /** The points on the faces of the cells of this rank. */
  template <int dim>
  struct FacePoints {
    InterfacePoints<dim> points;
    std::vector<PointOrigin> origins;         ///< per point
    std::vector<int> springs_inside;          ///< per body, or empty: none
    std::vector<ObstacleFace> obstacle_faces; ///< with large motions
    std::vector<InnerFace> inner_faces;       ///< the same
  };

  /**
   * A set of points for every face between two cells, and one for every
   * prescribed motion and obstacle that holds for a boundary face. @p driven
   * are the boundaries with a prescribed motion. The points of shared faces
   * are the same on both ranks; with ghosts, all faces between two cells of
   * @p set are those of this rank. @throws std::runtime_error on all ranks if
   * no interface block holds for a face of one of them.
   */
  template <int dim>
  FacePoints<dim>
  make_face_points(const Communicator &communicator,
                   const dealii::Triangulation<dim, dim> &triangulation,
                   const MeshGroups<dim> &groups,
                   const std::vector<unsigned int> &materials,
                   const std::vector<unsigned int> &driven,
                   const SceneInput &input, CellSet set = CellSet::own);

  /** Puts the points on the slots of the bodies, by their positions. */
  template <int dim>
  void fill_slots(const InterfacePoints<dim> &points, Cells<dim> &cells);
} // namespace nsfd
